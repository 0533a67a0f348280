/*
   The result of a task is one tree of named values, a JSON object. A line of a report fills it and prints: the name of
   a value stands in the text, behind the value. So a new result is one line in one place.

     MpmResultSay(run, "load: the fullest rank had %.2f{load} times the mean number of particles\n", load);

   prints the text without {load}, and keeps "load" with all digits in the object run.
*/
#pragma once
#include "scene/request.h"
#include <mpmstab/errors.h>
#include <jansson.h>

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
   MpmResultPut - keeps a value of any kind, and takes it over. MpmResultIn, MpmResultList - the object, or the list, of a
   name, which is made if there is none. MpmResultNext - a new object at the end of the list of a name. MpmResultNumbers -
   keeps a list of numbers, with null for one that is not finite. MpmResultVector - does so, or keeps the number itself
   where there is one direction.

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
   MpmResultOfFile (report.h), and frees the tree. One that cannot be written is refused before anything is printed.

   Collective. wall_s: the time that the task has taken.
*/
PetscErrorCode MpmResultEnd(const MpmRequest *request, PetscReal wall_s, json_t **result);
