/* What fuzz targets share: the program around them, a folder of their own, and what is no finding. */
#pragma once
#include <mpmstab/compat.h>
#include <stdint.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Ends the program when something else than what the fuzzer does to its input fails, or when a finding is made. */
void FuzzNeed(PetscBool condition, const char what[]);

/* Starts SLEPc. From here on whatever fails but by a refusal is a finding, and so is a refusal that is no one line. */
void FuzzStart(const char name[], const char file[]);

/* The target's folder, where 'file' is the input as a reader sees it; and back: names of inputs may be relative. */
void FuzzEnter(void);
void FuzzReturn(void);
void FuzzWrite(const uint8_t *data, size_t size);
