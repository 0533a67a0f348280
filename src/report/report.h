/*
   The result of a task is one tree of named values, a JSON object. A line of a report fills it and prints: the name of
   a value stands in the text, behind the value. So a new result is one line in one place.

     MpmResultSay(run, "load: the fullest rank had %.2f{load} times the mean number of particles\n", load);

   prints the text without {load}, and keeps "load" with all digits in the object run.

   Parts of reports that several tasks share follow: each prints, and fills the tree.
*/
#pragma once
#include "scene/request.h"
#include "symbol/predict.h"
#include <jansson.h>
#include <mpmstab/critical.h>
#include <mpmstab/errors.h>

/*
   MpmResultSay - prints as MpmPrint does, and keeps those values that have a name. MpmResultKeep only keeps them.

   Not collective; the first rank prints. Formats have d, c, s, e, f and g of printf, without '*'. Behind a value stands

     {name}    its name in the tree; {a.b}: inside the object a, which is made if there is none
     {name!}   a number that is not finite is kept as null; else it is not kept, since JSON has none
     {name?}   a whole number that is kept as true or false
*/
void MpmResultSay(json_t *result, const char format[], ...) __attribute__((format(printf, 2, 3)));
void MpmResultKeep(json_t *result, const char format[], ...) __attribute__((format(printf, 2, 3)));

/*
   MpmResultPut - keeps a value of any kind, and takes it over. MpmResultIn, MpmResultList - the object, or the list, of
   a name, which is made if there is none. MpmResultNext - a new object at the end of the list of a name.
   MpmResultNumbers - keeps a list of numbers, with null for one that is not finite. MpmResultVector - does so, or keeps
   the number itself where there is one direction.

   Not collective.
*/
void    MpmResultPut(json_t *result, const char name[], json_t *value);
json_t *MpmResultIn(json_t *result, const char name[]);
json_t *MpmResultList(json_t *result, const char name[]);
json_t *MpmResultNext(json_t *result, const char name[]);
void    MpmResultNumbers(json_t *result, const char name[], PetscInt n, const PetscReal values[]);
void    MpmResultVector(json_t *result, const char name[], PetscInt n, const PetscReal values[]);

/*
   MpmResultEnd - writes the tree where the request asks for it, prints what was said since MpmResultOfScene or
   MpmResultOfFile, and frees the tree. One that cannot be written is refused before anything is printed.

   Collective. wall_s: the time that the task has taken.
*/
PetscErrorCode MpmResultEnd(const MpmRequest *request, PetscReal wall_s, json_t **result);

/*
   MpmResultOfScene, MpmResultOfFile - begin a report: a tree with version, task, and scheme and grid or the file or
   code in place of a scene, which they also print in a few lines. what: a matrix, or blocks of a lattice; NULL: its
   line has been printed, by MpmReportFile. What is printed from here on is held until MpmResultEnd.

   Collective.
*/
PetscErrorCode MpmResultOfScene(const MpmScene *scene, const MpmRequest *request, json_t **result);
PetscErrorCode MpmResultOfFile(const MpmRequest *request, const char what[], json_t **result);
void           MpmReportFile(const MpmRequest *request, const char what[]);

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
   Not collective. The layout that an answer is of, in words, without walls and materials. What a map varies is said to
   vary.
*/
PetscErrorCode MpmReportLayout(const MpmScene *scene, const MpmRequest *request, size_t room, char text[]);

/*
   MpmReportLimit - prints a limit of the Courant number as the largest time step, in the scene's unit of time. A second
   line has the scene's own time step over the limit, if one was given. Where it grows this line also says growth per
   step at the scene's own Courant number; NaN: it is not known.

   Collective. Prints nothing of scenes that are not in physical units, nor of a limit that is undecided (NaN). courant
   may be 0 or infinite, as in MpmCritical. windows: there are windows of growth below the limit. of: its layout.
*/
void MpmReportLimit(const MpmScene *scene, PetscReal tolerance, PetscReal courant, PetscReal growth, PetscBool windows,
                    const char of[]);

/*
   Keeps windows of growth and how many Courant numbers were looked at, and prints those below a limit, each in a line
   that begins with so many blanks. Nothing where windows were not looked for; nothing is printed where there is no
   limit above them (0 or undecided).
*/
void MpmReportWindows(json_t *result, PetscInt blanks, PetscReal courant, const MpmCriticalWindows *windows);

/*
   A row of the growth table. key: of the number in the tree, where null stands for NaN; NULL: it is not kept. text: the
   formula, or what the number rests on; where growth is NaN, the reason.
*/
void MpmReportGrowth(json_t *result, const char key[], const char name[], PetscReal growth, const char text[]);

/* The rows of the closed forms, or the reason why they do not cover the scene, in the object 'predicted'. */
void MpmReportPredictions(json_t *result, const MpmPredictor *predictor, const MpmPredictions *predictions);

/* Where the published formula fails and whether the corrected one holds. */
void MpmReportComparison(json_t *result, const MpmPredictor *predictor, const MpmComparison *comparison);

/*
   MpmReportFinding - verdict, margin and evidence. scene: that of the layout, which stands beside the verdict; NULL:
   there is none. condition: that of the eigenvalue on which the verdict rests; NaN for none. MpmResultFinding keeps
   them without a word. MpmResultSymbol keeps phases and growth of a symbol as 'symbol'.
*/
PetscErrorCode MpmReportFinding(json_t *result, const MpmScene *scene, const MpmRequest *request,
                                const MpmFinding *finding, PetscReal condition);
void           MpmResultFinding(json_t *result, const MpmFinding *finding);
void           MpmResultSymbol(json_t *result, const MpmSymbol *symbol);

/*
   MpmVectorText - numbers of the directions as text, with so many digits: the number itself in one dimension, else (x,
                   y).
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
