/* Parts that the tasks' tables and JSON objects share. */
#pragma once
#include <mpmstab/errors.h>
#include "scene/request.h"
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include <jansson.h>

/* Collective. Prints the task and the file or code that takes the place of a scene. what: a matrix, or blocks of a lattice. */
void MpmReportFile(const MpmRequest *request, const char what[]);

/* Collective. Prints the task and its scene in two lines: scheme, grid and particles. */
PetscErrorCode MpmReportScene(const MpmScene *scene, const MpmRequest *request);

/*
   MpmReportNodal - prints, after the text before, the order of the matrix that takes the nodes of particles at rest
   through a step at a phase, and in one dimension what it acts on: what the nodes get of the particles.

   Not collective. Prints nothing for a table without such a matrix, where particles change by more than nodes send.
*/
PetscErrorCode MpmReportNodal(const MpmTable *table, const char before[]);

/*
   MpmReportUnits - prints wave speed, width of a cell, density and Poisson's ratio of a scene in physical units in one
   line. Where the Courant number is not one number, the line also has what a time step is.

   Collective. Prints nothing of other scenes.
*/
PetscErrorCode MpmReportUnits(const MpmScene *scene, const MpmRequest *request);

/*
   MpmReportLimit - prints a limit of the Courant number as the largest time step, in the scene's unit of time. A second
   line has the scene's own time step over the limit, if one was given. Where it grows this line also says growth per step at
   the scene's own Courant number; NaN: it is not known.

   Collective. Prints nothing of scenes that are not in physical units, nor of a limit that is undecided (NaN). courant
   may be 0 or infinite, as in MpmCritical. windows: there are windows of growth below the limit.
*/
void MpmReportLimit(const MpmScene *scene, PetscReal tolerance, PetscReal courant, PetscReal growth, PetscBool windows);

/*
   Prints windows of growth below a limit, each in a line that begins with so many blanks, and how many Courant numbers were
   looked at. Nothing where windows were not looked for, or where there is no limit above them (0 or undecided).
*/
void MpmReportWindows(PetscInt blanks, PetscReal courant, const MpmCriticalWindows *windows);

/*
   Collective. Prints a row of the growth table. text: the formula, or what the number rests on; where growth is NaN,
   the reason.
*/
void MpmReportGrowth(const char name[], PetscReal growth, const char text[]);

/* Collective. Prints the rows of the closed forms, or the reason why they do not cover the scene. */
void MpmReportPredictions(const MpmPredictor *predictor, const MpmPredictions *predictions);

/*
   MpmVectorText - numbers of the directions as text, with so many digits: the number itself in one dimension, else (x, y).
   MpmCountsText - whole numbers as text: 8, else 8 x 16.

   Not collective. They return text, which may be MPM_VECTOR_ROOM: room that lasts as long as the block around the call.
*/
#define MPM_VECTOR_TEXT 96
#define MPM_VECTOR_ROOM                                                                                                \
  (char[MPM_VECTOR_TEXT])                                                                                              \
  {                                                                                                                    \
    ""                                                                                                                 \
  }
const char *MpmVectorText(PetscInt n, const PetscReal values[], int digits, char text[MPM_VECTOR_TEXT]);
const char *MpmCountsText(PetscInt n, const PetscInt counts[], char text[MPM_VECTOR_TEXT]);

/* Collective. Prints in a sentence where the published formula fails and whether the corrected one holds. */
void MpmReportComparison(const MpmPredictor *predictor, const MpmComparison *comparison);

/*
   Collective. Prints verdict, margin and evidence. condition: that of the eigenvalue on which the verdict rests; NaN
   for none.
*/
void MpmReportFinding(const MpmFinding *finding, PetscReal condition);

/*
   Not collective. MpmJsonScene makes a new object with version, task, scheme and grid, and MpmJsonFile one with version,
   task and the file that takes the place of a scene. MpmJsonSet adds a number, unless
   it is not finite, which JSON cannot express; a key 'object.key' is inside an object, which the first of its keys creates.
   MpmJsonSetCount and MpmJsonSetText do so with a whole number and a text. MpmJsonNumbers makes a list, with null in the
   place of a number that is not finite; MpmJsonSetVector adds one without it, or the number itself where there is one. MpmJsonSetPrediction adds a growth, or null when the formula does not
   cover the scene. MpmJsonSetFinding adds verdict, growth and what they rest on. MpmJsonSetWindows adds windows of growth and
   at how many Courant numbers growth was looked at. MpmJsonPredicted makes the value of
   the key 'predicted' (symbol: NaN for none), MpmJsonSymbol that of the key 'symbol'.
*/
PetscErrorCode MpmJsonScene(const MpmScene *scene, const char task[], PetscReal wall_s, json_t **object);
PetscErrorCode MpmJsonFile(const MpmRequest *request, PetscReal wall_s, json_t **object);
void           MpmJsonSet(json_t *object, const char key[], PetscReal value);
void           MpmJsonSetCount(json_t *object, const char key[], PetscInt64 value);
void           MpmJsonSetText(json_t *object, const char key[], const char text[]);
void           MpmJsonSetVector(json_t *object, const char key[], PetscInt n, const PetscReal values[]);
json_t        *MpmJsonNumbers(PetscInt n, const PetscReal values[]);
void           MpmJsonSetPrediction(json_t *object, const char key[], PetscReal growth);
void           MpmJsonSetFinding(json_t *object, const MpmFinding *finding);
void           MpmJsonSetWindows(json_t *object, const MpmCriticalWindows *windows);
json_t        *MpmJsonPredicted(const MpmPredictions *predictions, const MpmComparison *comparison, PetscReal symbol);
json_t        *MpmJsonSymbol(const MpmSymbol *symbol);

/* Collective. Writes rank 0's object to a file and frees it on all ranks. */
PetscErrorCode MpmJsonWrite(const char path[], json_t *object);
