/* The scene, as every task's table and JSON object begin. */
#include <mpmstab/errors.h>
#include "scene/material.h"
#include "base/textfile.h"
#include "report/report.h"
#include <math.h>
#include <string.h>

#define WORTH_SAYING 1e-6 /* difference in abs(G) */

/* A number of the scene, or that the map goes over it. */
static const char *Value(const MpmScene *s, MpmAxisKind kind, const char number[])
{
  for (int a = 0; a < 2; a++)
    if (!strcmp(s->task, "map") && s->axes[a].kind == kind) return "varied";
  return number;
}

static PetscErrorCode PrintLayout(const MpmScene *s, PetscMPIInt ranks)
{
  char ppc[32], offset[32], courant[32], drift[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(ppc, sizeof ppc, "%" PetscInt_FMT, s->layout.ppc));
  PetscCall(PetscSNPrintf(offset, sizeof offset, "%.6g", s->layout.offset.value));
  PetscCall(PetscSNPrintf(courant, sizeof courant, "%.6g", s->step.courant));
  PetscCall(PetscSNPrintf(drift, sizeof drift, "%.6g", s->step.drift.value));
  if (s->step.drift.den > 1)
    PetscCall(PetscSNPrintf(drift, sizeof drift, "%" PetscInt64_FMT "/%" PetscInt64_FMT, s->step.drift.num,
                            s->step.drift.den));
  MpmPrint("%" PetscInt_FMT " cells x %s particles (%s, offset %s, jitter %.6g), Courant number %s, drift %s cells per "
           "step, %d rank%s\n",
           s->layout.grid.cells, Value(s, MPM_AXIS_PPC, ppc), s->layout.name, Value(s, MPM_AXIS_OFFSET, offset),
           s->layout.jitter, Value(s, MPM_AXIS_COURANT, courant), Value(s, MPM_AXIS_DRIFT, drift), ranks,
           ranks == 1 ? "" : "s");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportScene(const MpmScene *s, const char task[], PetscMPIInt ranks)
{
  char counts[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmSceneCountsText(s, sizeof counts, counts));
  MpmPrint("mpmstab %s %s: %s, %s basis, %s transfer", MPMSTAB_VERSION, task, s->scheme.formulation->name,
           s->scheme.basis->name, s->scheme.transfer->name);
  if (s->scheme.transfer->option)
    MpmPrint(" (%s %g)", s->scheme.transfer->option, s->scheme.transfer->number(&s->scheme.numbers));
  MpmPrint(", %s\n", s->boundary);
  PetscCall(PrintLayout(s, ranks));
  if (s->layout.counts.n > 1)
    MpmPrint("particles in cells: %s, repeated; %" PetscInt64_FMT " in all\n", counts, s->layout.particles);
  else if (!MpmSceneIsFull(s))
    MpmPrint("filled from cell %.6g to %.6g: %" PetscInt64_FMT " particles\n",
             (PetscReal)s->layout.first / s->layout.ppc,
             (PetscReal)(s->layout.first + s->layout.particles) / s->layout.ppc, s->layout.particles);
  if (s->layout.material.kind != MPM_MATERIAL_UNIFORM)
    MpmPrint("material %s: density ratio %.6g, stiffness ratio %.6g", MpmMaterialNames[s->layout.material.kind],
             s->layout.material.density, s->layout.material.stiffness);
  if (s->layout.material.kind == MPM_MATERIAL_TWO)
    MpmPrint(", in cells %.6g to %.6g", s->layout.material.inclusion[0], s->layout.material.inclusion[1]);
  if (s->layout.material.kind != MPM_MATERIAL_UNIFORM) MpmPrint("\n");
  if (s->layout.cluster[1] - s->layout.cluster[0] < 1)
    MpmPrint("particles within %.17g to %.17g of their cells\n", s->layout.cluster[0], s->layout.cluster[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportGrowth(const char name[], PetscReal growth, const char text[])
{
  PetscFunctionBegin;
  if (isnan(growth))
    MpmPrint("  %-11s %-13s %s\n", name, "-", text);
  else if (isinf(growth))
    MpmPrint("  %-11s %-13s %s\n", name, "off range", text);
  else
    MpmPrint("  %-11s %-13.9g %s\n", name, growth, text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportPredictions(const MpmPredictor *p, const MpmPredictions *predictions)
{
  const MpmFormulation *f    = p->scheme->formulation;
  const char           *text = f->published_text;

  PetscFunctionBegin;
  if (isnan(predictions->published))
    text = p->why_not_published ? p->why_not_published : "the slides give no formula for this Courant number";
  PetscCall(MpmReportGrowth("published", predictions->published, text));
  PetscCall(MpmReportGrowth("corrected", predictions->corrected,
                            p->why_not_corrected ? p->why_not_corrected : f->corrected_text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportComparison(const MpmPredictor *p, const MpmComparison *c)
{
  const MpmFormulation *f = p->scheme->formulation;

  PetscFunctionBegin;
  if (c->published > WORTH_SAYING) {
    MpmPrint("the published abs(G) is off by up to %.3g, at beta = %.4g:\n  %s\n", c->published, c->published_beta,
             f->published_slip);
    if (f->published_centred && fabs(p->e) > WORTH_SAYING)
      MpmPrint("  and it takes the particles for centred, where here C1 - C2 = %.3g\n", p->e);
  } else if (!isnan(c->published))
    MpmPrint("the published abs(G) is the symbol's at every phase\n");
  if (isfinite(c->corrected) && c->corrected > WORTH_SAYING)
    MpmPrint("the corrected abs(G) is off by up to %.3g, at beta = %.4g\n", c->corrected, c->corrected_beta);
  else if (isfinite(c->corrected))
    MpmPrint("the corrected abs(G) is within %.1e of the symbol's at every phase\n", c->corrected);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportFinding(const MpmFinding *f, PetscReal condition)
{
  PetscFunctionBegin;
  MpmPrint("\nverdict: %s", MpmVerdictNames[f->verdict]);
  if (isinf(f->growth))
    MpmPrint(", growth is beyond the range of doubles");
  else if (!isnan(f->growth)) {
    MpmPrint(", growth - 1 = %.3g where %.3g is tolerated", f->growth - 1, f->tolerance);
    if (f->growth > 1 + f->tolerance && isinf(f->uncertainty))
      MpmPrint("; that is lost to rounding");
    else if (f->growth > 1 + f->tolerance && isfinite(condition))
      MpmPrint("; its eigenvalue, of condition %.3g, is known to %.1g", condition, f->uncertainty);
  }
  if (f->verdict == MPM_UNDECIDED && isinf(f->defective_error))
    MpmPrint("; the operator is not what the march does");
  else if (f->verdict == MPM_UNDECIDED && f->growth <= 1 + f->tolerance && f->defective_error > f->tolerance)
    MpmPrint("; rounding may hide growth of %.1g per step", f->defective_error);
  MpmPrint("\nevidence: %s\n", f->evidence);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where particles are and in what they differ; absent where that is the default. */
static void SetDifferences(json_t *object, const MpmScene *s)
{
  json_t *counts = json_array();

  if (s->layout.offset.value != 0.5) json_object_set_new(object, "offset", json_real(s->layout.offset.value));
  if (s->layout.jitter != 0) json_object_set_new(object, "jitter", json_real(s->layout.jitter));
  if (s->layout.jitter != 0) json_object_set_new(object, "seed", json_integer((json_int_t)s->layout.seed));

  for (PetscInt r = 0; r < s->layout.counts.n; r++) json_array_append_new(counts, json_integer(s->layout.counts.of[r]));
  if (s->layout.counts.n > 1)
    json_object_set_new(object, "counts", counts);
  else
    json_decref(counts);
  if (s->layout.cluster[1] - s->layout.cluster[0] < 1)
    json_object_set_new(object, "cluster", json_pack("[f, f]", s->layout.cluster[0], s->layout.cluster[1]));
  if (s->layout.material.kind == MPM_MATERIAL_UNIFORM) return;
  json_object_set_new(object, "material",
                      json_pack("{s:s, s:f, s:f}", "kind", MpmMaterialNames[s->layout.material.kind], "density_ratio",
                                s->layout.material.density, "stiffness_ratio", s->layout.material.stiffness));
  if (s->layout.material.kind == MPM_MATERIAL_TWO)
    json_object_set_new(json_object_get(object, "material"), "inclusion",
                        json_pack("[f, f]", s->layout.material.inclusion[0], s->layout.material.inclusion[1]));
}

json_t *MpmJsonScene(const MpmScene *s, const char task[], PetscMPIInt ranks, PetscReal wall_s)
{
  json_t *object =
      json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:i, s:i, s:i, s:I, s:f, s:f, s:i, s:f}", "version", MPMSTAB_VERSION,
                "task", task, "formulation", s->scheme.formulation->name, "basis", s->scheme.basis->name, "transfer",
                s->scheme.transfer->name, "boundary", s->boundary, "dim", (int)s->dim, "cells",
                (int)s->layout.grid.cells, "ppc", (int)s->layout.ppc, "particles", (json_int_t)s->layout.particles,
                "courant", s->step.courant, "drift", s->step.drift.value, "ranks", (int)ranks, "wall_s", wall_s);

  if (s->scheme.transfer->option)
    json_object_set_new(object, s->scheme.transfer->option, json_real(s->scheme.transfer->number(&s->scheme.numbers)));
  SetDifferences(object, s);
  return object;
}

void MpmJsonSet(json_t *object, const char key[], PetscReal value)
{
  if (isfinite(value)) json_object_set_new(object, key, json_real(value));
}

void MpmJsonSetPrediction(json_t *object, const char key[], PetscReal growth)
{
  if (isnan(growth))
    json_object_set_new(object, key, json_null());
  else
    MpmJsonSet(object, key, growth);
}

void MpmJsonSetFinding(json_t *object, const MpmFinding *f)
{
  json_object_set_new(object, "verdict", json_string(MpmVerdictNames[f->verdict]));
  MpmJsonSet(object, "growth", f->growth);
  MpmJsonSet(object, "tolerance", f->tolerance);
  MpmJsonSet(object, "uncertainty", f->uncertainty);
  json_object_set_new(object, "evidence", json_string(f->evidence));
}

json_t *MpmJsonPredicted(const MpmPredictions *predictions, const MpmComparison *comparison, PetscReal symbol)
{
  json_t *object = json_object();

  MpmJsonSetPrediction(object, "published", predictions->published);
  MpmJsonSetPrediction(object, "corrected", predictions->corrected);
  MpmJsonSetPrediction(object, "symbol", symbol);
  MpmJsonSet(object, "published_off_by", comparison->published);
  MpmJsonSet(object, "published_off_at_beta", comparison->published_beta);
  MpmJsonSet(object, "corrected_off_by", comparison->corrected);
  return object;
}

json_t *MpmJsonSymbol(const MpmSymbol *symbol)
{
  json_t *object = json_object();

  json_object_set_new(object, "phases", json_integer(symbol->phases));
  MpmJsonSet(object, "growth", symbol->growth);
  MpmJsonSet(object, "beta_at_max", symbol->beta_at_max);
  MpmJsonSet(object, "seconds", symbol->seconds);
  return object;
}

PetscErrorCode MpmJsonWrite(const char path[], json_t *object)
{
  MpmTextFile file;

  PetscFunctionBegin;
  PetscCheck(object, PETSC_COMM_SELF, PETSC_ERR_LIB, "jansson could not build the result");
  PetscCall(MpmTextFileOpen(path, &file));
  if (file.stream &&
      (json_dumpf(object, file.stream, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) || fputc('\n', file.stream) == EOF))
    PetscCall(PetscInfo(NULL, "writing %s failed; closing it says why\n", path));
  json_decref(object);
  PetscCall(MpmTextFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}
