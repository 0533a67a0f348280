/* What the tasks' tables and JSON objects have in common. */
#pragma once
#include <mpmstab/errors.h>
#include "scene/request.h"
#include "symbol/predict.h"
#include <jansson.h>

/* Collective. The task and its scene in two lines: scheme, grid and particles. */
PetscErrorCode MpmReportScene(const MpmScene *scene, const MpmRequest *request, PetscMPIInt ranks);

/* Collective. A row of the growth table; text: the formula, or what the number rests on. NaN: text says why not. */
PetscErrorCode MpmReportGrowth(const char name[], PetscReal growth, const char text[]);

/* Collective. The rows of the closed forms, or why they say nothing. */
PetscErrorCode MpmReportPredictions(const MpmPredictor *predictor, const MpmPredictions *predictions);

/* Collective. In a sentence, where the published formula fails and whether the corrected one holds. */
PetscErrorCode MpmReportComparison(const MpmPredictor *predictor, const MpmComparison *comparison);

/* Collective. Verdict, margin and evidence; condition: of the eigenvalue it rests on, NaN for none. */
PetscErrorCode MpmReportFinding(const MpmFinding *finding, PetscReal condition);

/*
   Not collective. MpmJsonScene: a new object with version, task, scheme and grid. MpmJsonSet: a number, left out when
   it is not finite (JSON has none of those). MpmJsonSetPrediction: null when the formula does not cover the scene.
   MpmJsonPredicted: the key 'predicted' (symbol NaN: none). MpmJsonSetFinding: verdict, growth and what they rest on.
   MpmJsonSymbol: the key 'symbol'.
*/
PetscErrorCode MpmJsonScene(const MpmScene *scene, const char task[], PetscMPIInt ranks, PetscReal wall_s,
                            json_t **object);
void           MpmJsonSet(json_t *object, const char key[], PetscReal value);
void           MpmJsonSetPrediction(json_t *object, const char key[], PetscReal growth);
void           MpmJsonSetFinding(json_t *object, const MpmFinding *finding);
json_t        *MpmJsonPredicted(const MpmPredictions *predictions, const MpmComparison *comparison, PetscReal symbol);
json_t        *MpmJsonSymbol(const MpmSymbol *symbol);

/* Collective. Writes rank 0's object to a file and frees it on all ranks. */
PetscErrorCode MpmJsonWrite(const char path[], json_t *object);
