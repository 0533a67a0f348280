/* What fuzz targets share: the program around them, a folder of their own, and checks of what is a finding. */
#pragma once
#include <mpmstab/compat.h>
#include <stdint.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Ends the program with a finding, or when something fails that is not the fuzzer's input. */
void FuzzNeed(PetscBool condition, const char what[]);

/*
   Starts SLEPc. After this call every error that is no refusal is a finding, and so is a refusal of more than one line.
*/
void FuzzStart(const char name[], const char file[]);

/*
   FuzzEnter goes to the target's folder, in which 'file' is the input for a reader. FuzzReturn goes back, since names
   of inputs may be relative.
*/
void FuzzEnter(void);
void FuzzReturn(void);
void FuzzWrite(const uint8_t *data, size_t size);
