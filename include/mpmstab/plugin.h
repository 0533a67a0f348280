/*
   Plugin: what a shared library exports so that mpmstab can probe the step of a code (option plugin). The library
   stands alone: this header needs nothing of mpmstab, and the library is not linked with it.

   Each rank of mpmstab starts a process for the library, and calls its functions there one after another, never at the
   same time. If they end this process, or do not come back within program_timeout, mpmstab says so and ends. What they
   print is shown when they fail. Their standard input is empty.
*/
#pragma once
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
   mpmstab_describe - describes the code, as the answer to 'describe' of the protocol for programs: an object of JSON
   with protocol, name, dim, cell_width, periodic, particles, fields, parameters and steps.

   Output Parameter: state - the base state, particles x numbers, particle by particle, fields in the order described.
   It stays valid while the library is loaded. A description with "scenes": true needs no particles and no base state.

   Returns: the text, or NULL when the code cannot start; mpmstab_error then says why.
*/
const char *mpmstab_describe(const double **state);

/* mpmstab_set - gives a parameter a value. Returns 0, or another number when the code does not take it. */
int mpmstab_set(const char name[], double value);

/*
   mpmstab_step - replaces the state of particles by the one after some steps. It depends on nothing but the state and
   the parameters: whatever the code keeps besides is set anew from the state.

   Input Parameters: steps; particles - the number that was described, or any if the description has "any_count": true.
   Returns: 0, or another number when the code cannot step from there.
*/
int mpmstab_step(int steps, int64_t particles, double state[]);

/*
   mpmstab_scene - needed if the description has "scenes": true: makes the base state of particles that mpmstab chooses,
   and the grid for them. Later steps are of these particles, or of another number of them.

   Input Parameters: message - the line of JSON; particles - their number; period - of the grid in each direction, 0:
   none;
   given - for each particle its place, volume and mass. Output Parameter: state - particles x numbers.
   Returns: 0, or another number when the code cannot take them.
*/
int mpmstab_scene(const char message[], int64_t particles, const double period[], const double given[], double state[]);

/*
   mpmstab_reset - needed if the description has "reset": true. It is then called before mpmstab_step, and forgets all
   that the code keeps besides the state, as if the library were loaded anew.
*/
void mpmstab_reset(void);

/* mpmstab_error - optional: says in a line what went wrong in the last call that failed. */
const char *mpmstab_error(void);

#ifdef __cplusplus
}
#endif
