/* Names of the field, and those of this program. */
#include "scene/synonyms.h"
#include <mpmstab/compat.h>
#include <string.h>
#include <strings.h>

/* clang-format off */
static const char *const options[][2] = {
    {"cfl", "courant"}, {"cfl_number", "courant"}, {"courant_number", "courant"}, {"E", "young"},
    {"youngs_modulus", "young"}, {"nu", "poisson"}, {"poissons_ratio", "poisson"}, {"rho", "density"}, {"K", "bulk"},
    {"G", "shear"}, {"o", "output"}, {"out", "output"}, {"dx", "cell_width"}, {"time_step", "dt"}, {"timestep", "dt"},
    {"delta_t", "dt"}, {"particles_per_cell", "ppc"}, {"n_cells", "cells"}, {"ncells", "cells"}, {"dimension", "dim"},
    {"dimensions", "dim"}, {"ndim", "dim"}, {"method", "formulation"}, {"stress_update", "formulation"},
    {"shape", "basis"}, {"shape_function", "basis"}, {"kernel", "basis"}, {"flip_ratio", "blend_ratio"},
    {"bc", "boundary"}, {"U0", "velocity"}, {"speed", "velocity"}, {"tol", "tolerance"},
};
/* clang-format on */

/* option, the word, and what it is here */
static const char *const words[][3] = {
    {"formulation", "mls-mpm", "-formulation usl -transfer apic -gradient mls -basis quadratic"},
    {"formulation", "mlsmpm", "-formulation usl -transfer apic -gradient mls -basis quadratic"},
    {"formulation", "mls", "-formulation usl -transfer apic -gradient mls -basis quadratic"},
    {"formulation", "apic", "-formulation usl -transfer apic"},
    {"formulation", "flip", "-formulation usl, with -transfer flip"},
    {"formulation", "pic", "-formulation usl -transfer pic"},
    {"formulation", "gimp", "-formulation usl -basis gimp"},
    {"formulation", "mpm", "usl, usf, musl or usavg, by when the stress is updated"},
    {"basis", "bspline", "quadratic or cubic"},
    {"basis", "b-spline", "quadratic or cubic"},
    {"basis", "spline", "quadratic or cubic"},
    {"basis", "quadratic-spline", "quadratic"},
    {"basis", "cubic-spline", "cubic"},
    {"basis", "hat", "linear"},
    {"basis", "tent", "linear"},
    {"basis", "ugimp", "gimp"},
    {"transfer", "mls-mpm", "apic, with -gradient mls"},
    {"transfer", "mls", "apic, with -gradient mls"},
    {"gradient", "spline", "basis"},
    {"boundary", "wall", "fixed"},
};

const char *MpmOptionCalledHere(const char name[])
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options); i++)
    if (strlen(options[i][0]) == 1 ? !strcmp(options[i][0], name) : !strcasecmp(options[i][0], name))
      return options[i][1];
  return NULL;
}

const char *MpmWordCalledHere(const char option[], const char word[])
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(words); i++)
    if (!strcmp(words[i][0], option) && !strcasecmp(words[i][1], word)) return words[i][2];
  return NULL;
}
