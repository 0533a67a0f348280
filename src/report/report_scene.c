/* Describes the scene at the beginning of every task's table and JSON object. */
#include <mpmstab/errors.h>
#include "scene/fields.h"
#include "base/text.h"
#include "base/textfile.h"
#include "report/report.h"
#include <math.h>
#include <string.h>

#define WORTH_SAYING 1e-6 /* least difference in abs(G) that is printed */

static PetscMPIInt Ranks(void)
{
  return MpmRanksOf(PETSC_COMM_WORLD);
}

/* Returns whether a map varies the option, so that the scene's own number does not count. */
static PetscBool IsVaried(const MpmRequest *request, const char name[])
{
  if (!strcmp(name, "drift") && MpmRequestKeepsMach(request)) return PETSC_TRUE;
  for (PetscInt kind = 0; MpmAxisNames[kind]; kind++)
    if (!strcmp(MpmAxisNames[kind], name)) return MpmRequestVaries(request, (MpmAxisKind)kind);
  return PETSC_FALSE;
}

/* Prints a text in which {name} stands for the value of that field. */
static PetscErrorCode PrintFields(const MpmScene *scene, const MpmRequest *request, const char text[])
{
  PetscFunctionBegin;
  while (*text) {
    const char *open = strchr(text, '{'), *close = open ? strchr(open, '}') : NULL;
    char        name[32], number[MPM_COUNTS_TEXT];
    MpmValue    value;

    if (!close) {
      MpmPrint("%s", text);
      break;
    }
    (void)snprintf(name, (size_t)(close - open), "%s", open + 1);
    PetscCall(MpmValueOf(name, scene, request, &value));
    PetscCall(MpmValueHeading(&value, sizeof number, number));
    MpmPrint("%.*s%s", (int)(open - text), text, IsVaried(request, name) ? "varied" : number);
    text = close + 1;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says which part of the grid has particles. A shape is a word, and not all of the box around it has particles. */
static void PrintFilled(const MpmLayout *layout)
{
  MpmPrint("filled");
  if (layout->spans)
    MpmPrint(" in the shape %s", layout->shape);
  else
    for (PetscInt a = 0; a < layout->dim; a++) {
      const PetscReal ppc = layout->ppc[a];

      MpmPrint("%s from cell %.6g to %.6g", a ? "," : "", layout->first[a] / ppc,
               (layout->first[a] + layout->row[a]) / ppc);
      if (layout->dim > 1) MpmPrint(" along %c", "xyz"[a]);
    }
  MpmPrint(": %" PetscInt64_FMT " particle%s\n", layout->particles, layout->particles == 1 ? "" : "s");
}

/* Describes layout and material where they are not the default. */
static PetscErrorCode PrintDifferences(const MpmScene *s, const MpmRequest *request)
{
  const MpmMaterialKind material = s->layout.material.kind;

  PetscFunctionBegin;
  if (s->layout.counts.n > 1)
    PetscCall(PrintFields(s, request, "particles in cells: {counts}, repeated; {particles} in all\n"));
  else if (!MpmSceneIsFull(s))
    PrintFilled(&s->layout);
  if (s->scheme.space.finite) {
    PetscCall(PrintFields(s, request, "finite deformation, material {material}, from the stretch {stretch}"));
    PetscCall(PrintFields(s, request, s->scheme.space.loaded && !s->body_force ? ", gravity {gravity}\n" : "\n"));
  }
  if (material != MPM_MATERIAL_UNIFORM)
    PetscCall(PrintFields(s, request,
                          "material {material}: density ratio {density_ratio}, stiffness ratio {stiffness_ratio}"));
  if (material == MPM_MATERIAL_TWO) PetscCall(PrintFields(s, request, ", in cells {inclusion}"));
  if (material != MPM_MATERIAL_UNIFORM) MpmPrint("\n");
  if (s->layout.cluster[1] - s->layout.cluster[0] < 1)
    MpmPrint("particles within %.17g to %.17g of their cells\n", s->layout.cluster[0], s->layout.cluster[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What tells a scheme as text from others. Of parameters that a map varies the scene's own values do not count. */
static PetscErrorCode PrintScheme(const MpmScene *s, const MpmRequest *request)
{
  const PetscBool varied = MpmRequestVaries(request, MPM_AXIS_PARAMETER);

  PetscFunctionBegin;
  if (!s->written) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PrintFields(s, request, "scheme as text, hash {scheme}"));
  if (s->parameters[0])
    PetscCall(PrintFields(s, request, varied ? ", parameters varied" : ", parameters {parameters}"));
  MpmPrint("\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the Courant number of the scene is that of the task. */
static PetscBool HasOneStep(const MpmScene *s, const char task[])
{
  return MpmSceneHasStep(s) || strcmp(task, "critical") ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmReportUnits(const MpmScene *s, const MpmRequest *request)
{
  PetscFunctionBegin;
  if (!MpmSceneIsPhysical(s)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PrintFields(s, request, "units of the scene: wave speed {wave_speed}, cells {cell_width} wide"));
  if (s->density > 0) PetscCall(PrintFields(s, request, ", density {density}"));
  if (MpmSceneHasPoisson(s)) PetscCall(PrintFields(s, request, ", Poisson's ratio {poisson}"));
  if (request->survey || IsVaried(request, "courant") || !HasOneStep(s, request->task))
    MpmPrint("; dt is %.6g times the Courant number", MpmSceneTimeStep(s, 1));
  MpmPrint("\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prints Courant number and drift, in physical units beside time step and velocity where these have one value. */
static PetscErrorCode PrintStep(const MpmScene *s, const MpmRequest *request)
{
  const PetscBool both = MpmSceneIsPhysical(s) && !IsVaried(request, "courant") ? PETSC_TRUE : PETSC_FALSE;
  PetscReal       velocity[MPM_MAX_DIM];

  PetscFunctionBegin;
  if (s->safety > 0)
    PetscCall(PrintFields(s, request, "Courant number auto with safety {safety}, "));
  else if (HasOneStep(s, request->task))
    PetscCall(PrintFields(s, request, "Courant number {courant}, "));
  if (s->safety == 0 && HasOneStep(s, request->task) && both) PetscCall(PrintFields(s, request, "dt {dt}, "));
  if (request->at_mach && !HasOneStep(s, request->task))
    MpmPrint("drift M k cells per step, ");
  else if (s->safety == 0)
    PetscCall(PrintFields(s, request, "drift {drift} cells per step, "));
  if (!HasOneStep(s, request->task) || !(both || s->safety > 0) || IsVaried(request, "drift") ||
      IsVaried(request, "drift_angle"))
    PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < s->layout.dim; a++) velocity[a] = s->step.drift[a].value * s->cell_width / s->dt;
  MpmPrint("velocity %s, ", MpmVectorText(s->layout.dim, velocity, 6, MPM_VECTOR_ROOM));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The end of a task's first line. */
static void PrintRanks(const char before[])
{
  const PetscMPIInt ranks = Ranks();

  MpmPrint("%s%d rank%s\n", before, ranks, ranks == 1 ? "" : "s");
}

PetscErrorCode MpmReportScene(const MpmScene *s, const MpmRequest *request)
{
  PetscFunctionBegin;
  MpmPrint("mpmstab %s %s: ", MPMSTAB_VERSION, request->task);
  PetscCall(PrintFields(s, request, "{formulation}"));
  for (const char *const *reads = s->scheme.formulation->options; *reads; reads++) {
    const MpmField *option = &MpmOptions[MpmOptionIndex(*reads)];
    char            text[64];

    if (!option->shown(s, MPM_IN_JSON)) continue;
    (void)snprintf(text, sizeof text, ", %s {%s}", *reads, *reads);
    PetscCall(PrintFields(s, request, text));
  }
  PetscCall(PrintFields(s, request, ", {basis} basis, {transfer} transfer"));
  if (s->scheme.transfer->option)
    MpmPrint(" (%s %g)", s->scheme.transfer->option, s->scheme.transfer->number(&s->scheme.numbers));
  PetscCall(PrintFields(
      s, request, ", {boundary}\n{cells} cells x {ppc} particles ({layout}, offset {offset}, jitter {jitter}), "));
  PetscCall(PrintStep(s, request));
  PrintRanks("");
  PetscCall(PrintScheme(s, request));
  PetscCall(MpmReportUnits(s, request));
  PetscCall(PrintDifferences(s, request));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmReportFile(const MpmRequest *request, const char what[])
{
  MpmPrint("mpmstab %s %s: %s of %s", MPMSTAB_VERSION, request->task, what, MpmRequestSource(request));
  PrintRanks(", ");
}

void MpmReportGrowth(const char name[], PetscReal growth, const char text[])
{
  if (isnan(growth))
    MpmPrint("  %-11s %-13s %s\n", name, "-", text);
  else if (isinf(growth))
    MpmPrint("  %-11s %-13s %s\n", name, "off range", text);
  else
    MpmPrint("  %-11s %-13.9g %s\n", name, growth, text);
}

const char *MpmVectorText(PetscInt n, const PetscReal values[], int digits, char text[MPM_VECTOR_TEXT])
{
  int used = 0;

  for (PetscInt a = 0; a < n; a++)
    used += snprintf(text + used, (size_t)(MPM_VECTOR_TEXT - used), "%s%.*g%s",
                     a       ? ", "
                     : n > 1 ? "("
                             : "",
                     digits, values[a], n > 1 && a == n - 1 ? ")" : "");
  return text;
}

const char *MpmCountsText(PetscInt n, const PetscInt counts[], char text[MPM_VECTOR_TEXT])
{
  int used = 0;

  for (PetscInt a = 0; a < n; a++)
    used += snprintf(text + used, (size_t)(MPM_VECTOR_TEXT - used), "%s%" PetscInt_FMT, a ? " x " : "", counts[a]);
  return text;
}

void MpmReportPredictions(const MpmPredictor *p, const MpmPredictions *predictions)
{
  const MpmFormulation *f    = p->scheme->formulation;
  const char           *text = f->published_text;

  if (isnan(predictions->published))
    text = p->why_not_published ? p->why_not_published : "the slides give no formula for this Courant number";
  MpmReportGrowth("published", predictions->published, text);
  MpmReportGrowth("corrected", predictions->corrected,
                  p->why_not_corrected ? p->why_not_corrected : MpmPredictionText(p->scheme));
}

void MpmReportComparison(const MpmPredictor *p, const MpmComparison *c)
{
  const MpmFormulation *f = p->scheme->formulation;

  if (c->published > WORTH_SAYING) {
    MpmPrint("the published abs(G) is off by up to %.3g, at beta = %.4g:\n  %s\n", c->published, c->published_beta,
             f->published_slip);
    if (f->published_centred && fabs(p->e) > WORTH_SAYING)
      MpmPrint("  and it takes the particles for centred, where here C1 - C2 = %.3g\n", p->e);
  } else if (!isnan(c->published))
    MpmPrint("the published abs(G) is the symbol's at every phase\n");
  if (isfinite(c->corrected) && c->corrected > WORTH_SAYING)
    MpmPrint("the corrected abs(G) is off by up to %.3g, at beta = %s\n", c->corrected,
             MpmVectorText(p->layout->dim, c->corrected_beta, 4, MPM_VECTOR_ROOM));
  else if (isfinite(c->corrected))
    MpmPrint("the corrected abs(G) is within %.1e of the symbol's at every phase\n", c->corrected);
}

void MpmReportFinding(const MpmFinding *f, PetscReal condition)
{
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
}

static json_t *CountsArray(const MpmScene *s)
{
  json_t *counts = json_array();

  for (PetscInt r = 0; r < s->layout.counts.n; r++) json_array_append_new(counts, json_integer(s->layout.counts.of[r]));
  return counts;
}

static json_t *OneJson(const MpmScene *s, const MpmValue *value, PetscInt a)
{
  switch (value->kind) {
  case MPM_AS_COUNT:
  case MPM_AS_LONG:
    return json_integer((json_int_t)value->whole[a]);
  case MPM_AS_REAL:
    return json_real(value->number[a][0]);
  case MPM_AS_FRACTION:
    return json_real(value->fraction[a].value);
  case MPM_AS_RANGE:
    return json_pack("[f, f]", value->number[a][0], value->number[a][1]);
  case MPM_AS_COUNTS:
    return CountsArray(s);
  default:
    return json_string(value->text);
  }
}

/* One value, or a list of one for each direction. */
static json_t *ValueJson(const MpmScene *s, const MpmValue *value)
{
  json_t *list;

  if (value->n == 1) return OneJson(s, value, 0);
  list = json_array();
  for (PetscInt a = 0; a < value->n; a++) json_array_append_new(list, OneJson(s, value, a));
  return list;
}

/* Sets a value. A key 'object.key' is inside an object, which the first of its keys creates. */
static void Put(json_t *object, const char key[], json_t *value)
{
  for (const char *dot = strchr(key, '.'); dot; dot = strchr(key, '.')) {
    char outer[32];

    (void)snprintf(outer, sizeof outer, "%.*s", (int)(dot - key), key);
    if (!json_object_get(object, outer)) json_object_set_new(object, outer, json_object());
    object = json_object_get(object, outer);
    key    = dot + 1;
  }
  json_object_set_new(object, key, value);
}

static void SetValue(json_t *object, const MpmScene *s, const MpmValue *value)
{
  Put(object, value->field->json ? value->field->json : value->field->name, ValueJson(s, value));
}

/* Fields that only some scenes show come last. */
static PetscErrorCode Head(const MpmScene *s, const MpmRequest *request, const char task[], PetscReal wall_s,
                           json_t **object)
{
  MpmValue values[MPM_MAX_VALUES];
  PetscInt n;

  PetscFunctionBegin;
  *object = json_pack("{s:s, s:s}", "version", MPMSTAB_VERSION, "task", task);
  PetscCall(MpmValuesIn(MPM_IN_JSON, s, request, &n, values));
  for (PetscInt i = 0; i < n; i++)
    if (!values[i].field->shown) SetValue(*object, s, &values[i]);
  json_object_set_new(*object, "ranks", json_integer(Ranks()));
  json_object_set_new(*object, "wall_s", json_real(wall_s));
  for (PetscInt i = 0; i < n; i++)
    if (values[i].field->shown) SetValue(*object, s, &values[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmJsonScene(const MpmScene *s, const char task[], PetscReal wall_s, json_t **object)
{
  PetscFunctionBegin;
  PetscCall(Head(s, NULL, task, wall_s, object));
  if (!HasOneStep(s, task)) json_object_del(*object, "courant"); /* the default, of which nothing is said */
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmJsonFile(const MpmRequest *request, PetscReal wall_s, json_t **object)
{
  return Head(NULL, request, request->task, wall_s, object);
}

void MpmJsonSet(json_t *object, const char key[], PetscReal value)
{
  if (isfinite(value)) Put(object, key, json_real(value));
}

void MpmJsonSetCount(json_t *object, const char key[], PetscInt64 value)
{
  Put(object, key, json_integer((json_int_t)value));
}

void MpmJsonSetText(json_t *object, const char key[], const char text[])
{
  Put(object, key, json_string(text));
}

json_t *MpmJsonNumbers(PetscInt n, const PetscReal values[])
{
  json_t *array = json_array();

  for (PetscInt i = 0; i < n; i++)
    json_array_append_new(array, isfinite(values[i]) ? json_real(values[i]) : json_null());
  return array;
}

void MpmJsonSetVector(json_t *object, const char key[], PetscInt n, const PetscReal values[])
{
  json_t *array = n == 1 ? NULL : json_array();

  for (PetscInt a = 0; a < n && array; a++) json_array_append_new(array, json_real(values[a]));
  Put(object, key, array ? array : json_real(values[0]));
}

void MpmJsonSetPrediction(json_t *object, const char key[], PetscReal growth)
{
  if (isnan(growth))
    json_object_set_new(object, key, json_null());
  else
    MpmJsonSet(object, key, growth);
}

/* Nothing where windows were not looked for. */
void MpmJsonSetWindows(json_t *object, const MpmCriticalWindows *windows)
{
  json_t *all = windows->looked ? json_array() : NULL;

  if (!all) return;
  for (PetscInt i = 0; i < windows->n; i++) {
    const MpmCriticalWindow *w = &windows->window[i];

    json_array_append_new(all, json_pack("[f, f, f]", w->from, w->to, w->growth));
  }
  json_object_set_new(object, "windows", all);
  MpmJsonSetCount(object, "looked_at", windows->looked);
}

void MpmJsonSetFinding(json_t *object, const MpmFinding *f)
{
  MpmJsonSetText(object, "verdict", MpmVerdictNames[f->verdict]);
  MpmJsonSet(object, "growth", f->growth);
  MpmJsonSet(object, "tolerance", f->tolerance);
  MpmJsonSet(object, "uncertainty", f->uncertainty);
  MpmJsonSetText(object, "evidence", f->evidence);
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
  const PetscInt dim    = symbol->dim;
  json_t        *object = json_object(), *phases = json_array();

  for (PetscInt a = 0; a < dim; a++) json_array_append_new(phases, json_integer(symbol->phases[a]));
  json_object_set(object, "phases", dim == 1 ? json_array_get(phases, 0) : phases);
  MpmJsonSet(object, "growth", symbol->growth);
  MpmJsonSetVector(object, "beta_at_max", dim, symbol->beta_at_max);
  MpmJsonSet(object, "seconds", symbol->seconds);
  json_decref(phases);
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
