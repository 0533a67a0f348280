/* Facts: what makes two scenes the same problem, name by name, as text. */
#pragma once
#include <mpmstab/scene.h>

#define MPM_MAX_SCENE_KEYS 32

typedef struct {
  const char *name;
  char        text[MPM_COUNTS_TEXT];
} MpmSceneKey;

/*
   MpmSceneKeys - what the state of a run depends on, but for its length.

   Not collective. Steps, files, tolerance and expectations are left out. Numbers have all their digits.
*/
PetscErrorCode MpmSceneKeys(const MpmScene *scene, PetscInt *n, MpmSceneKey facts[MPM_MAX_SCENE_KEYS]);
