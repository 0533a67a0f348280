/* How waves are damped and how far their frequency is off, in words, and as JSON, CSV and HDF5. */
#include "report/results.h"
#include "base/textfile.h"
#include "report/report.h"
#include <math.h>

#define ROUNDING 1e-12 /* decay of less per unit of time h / c is rounding */
#define STANDS -1      /* the error of the frequency of a wave that does not travel */

/* Of waves 1, 2, 4, 8, ... the table has a row. */
static PetscBool IsShown(PetscInt w)
{
  return ((w + 1) & w) == 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* Prints a row for each wave. unit: what decay is multiplied by, with a column for it; 0: none. */
static void PrintStep(const MpmDamping *d, PetscInt i, PetscReal unit)
{
  for (PetscInt w = 0; w < d->nwaves; w++) {
    const PetscInt  at    = d->nwaves * i + w;
    const PetscReal decay = fabs(d->decay[at]) < ROUNDING ? 0 : d->decay[at];

    if (!IsShown(w)) continue;
    MpmPrint("  %-10.6g  %-9.6g  %12.5g", d->courant[i], d->wavelength[w], decay);
    if (unit > 0) MpmPrint("  %12.5g", decay * unit);
    MpmPrint("  %13.6g", exp(-decay * d->wavelength[w]));
    if (isnan(d->frequency[at]))
      MpmPrint("  %15s", "not known");
    else if (fabs(d->frequency[at] - STANDS) < ROUNDING)
      MpmPrint("  %15s", "does not travel");
    else
      MpmPrint("  %+15.5g", d->frequency[at]);
    MpmPrint("  %7.4f\n", d->match[at]);
  }
}

/* Keeps a list for each time step. */
static void Rows(json_t *result, const char name[], const MpmDamping *d, const PetscReal values[], PetscReal unit)
{
  for (PetscInt i = 0; i < d->nsteps; i++) {
    json_t *row = json_array();

    for (const PetscReal *v = values + d->nwaves * i; v < values + d->nwaves * (i + 1); v++)
      (void)json_array_append_new(row, isfinite(*v) ? json_real(*v * unit) : json_null());
    (void)json_array_append_new(MpmResultList(result, name), row);
  }
}

void MpmDampingReport(json_t *result, const MpmScene *scene, const MpmDamping *d)
{
  const PetscReal unit = MpmSceneIsPhysical(scene) ? scene->wave_speed / scene->cell_width : 0;

  MpmPrint(
      "\ndamping of waves along x, of the mode of each that is nearest to the exact wave travelling to the right\n");
  MpmPrint("  %-10s  %-9s  %12s", "courant", "cells", "decay c/h");
  if (unit > 0) MpmPrint("  %12s", "decay 1/time");
  MpmPrint("  %13s  %15s  %7s\n", "kept a period", "frequency error", "match");
  for (PetscInt i = 0; i < d->nsteps; i++) PrintStep(d, i, unit);
  MpmPrint("\n");
  MpmResultNumbers(result, "wavelength", d->nwaves, d->wavelength);
  MpmResultNumbers(result, "courant", d->nsteps, d->courant);
  Rows(result, "decay", d, d->decay, 1);
  if (unit > 0) Rows(result, "decay_per_time", d, d->decay, unit);
  Rows(result, "frequency_error", d, d->frequency, 1);
  Rows(result, "match", d, d->match, 1);
  MpmResultKeep(result, "%g{seconds}", d->seconds);
}

PetscErrorCode MpmDampingWriteCsv(const MpmDamping *d, const char path[])
{
  MpmTextFile csv;

  PetscFunctionBegin;
  PetscCall(MpmTextFileOpen(path, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "courant,wavelength,decay,kept_a_period,frequency_error,match\n");
    for (PetscInt i = 0; i < d->nsteps * d->nwaves; i++) {
      const PetscReal cells = d->wavelength[i % d->nwaves];

      fprintf(csv.stream, "%.17g", d->courant[i / d->nwaves]);
      MpmTextFileCell(&csv, cells);
      MpmTextFileCell(&csv, d->decay[i]);
      MpmTextFileCell(&csv, exp(-d->decay[i] * cells));
      MpmTextFileCell(&csv, d->frequency[i]);
      MpmTextFileCell(&csv, d->match[i]);
      fprintf(csv.stream, "\n");
    }
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDampingWrite(const MpmDamping *d, MpmDataFile *file)
{
  PetscFunctionBegin;
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_wavelength", d->nwaves, 1, d->wavelength));
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_courant", d->nsteps, 1, d->courant));
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_decay", d->nsteps, d->nwaves, d->decay));
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_frequency_error", d->nsteps, d->nwaves, d->frequency));
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_match", d->nsteps, d->nwaves, d->match));
  PetscFunctionReturn(PETSC_SUCCESS);
}
