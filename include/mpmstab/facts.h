/* Facts: what makes two scenes the same problem, name by name, as text. */
#pragma once
#include <mpmstab/scene.h>

#define MPM_MAX_FACTS 32

typedef struct {
  const char *name;
  char        text[MPM_COUNTS_TEXT];
} MpmFact;

/*
   MpmSceneFacts - what the state of a run depends on, but for its length.

   Not collective. Steps, files, tolerance and expectations are left out. Numbers have all their digits.
*/
PetscErrorCode MpmSceneFacts(const MpmScene *scene, PetscInt *n, MpmFact facts[MPM_MAX_FACTS]);
