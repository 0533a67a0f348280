/* What several tasks report: scheme, grid and units, the closed forms, limits, verdict and evidence. */
#include "base/errors_private.h"
#include "base/text.h"
#include "operator/nodal.h"
#include "report/report.h"
#include "scene/fields.h"
#include "scene/layout.h"
#include <mpmstab/critical.h>
#include <mpmstab/errors.h>
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

/* Damping and viscosity, with what they are in units of the step where the scene has others. */
static PetscErrorCode PrintDamping(const MpmScene *s, const MpmRequest *request)
{
  const MpmSpace *space    = &s->scheme.space;
  const PetscBool physical = MpmSceneIsPhysical(s);
  const PetscBool viscous  = space->viscous[0] != 0 || space->viscous[1] != 0 ? PETSC_TRUE : PETSC_FALSE;
  const char     *between  = "";

  PetscFunctionBegin;
  if (space->damping != 0) {
    PetscCall(PrintFields(s, request,
                          physical ? "grid damping {grid_damping} per time" : "grid damping {grid_damping} c / h"));
    if (physical) MpmPrint(" (%.6g c / h)", space->damping);
    between = ", ";
  }
  if (viscous) {
    MpmPrint("%sviscosity lambda %.6g, mu %.6g rho c h", between, space->viscous[0], space->viscous[1]);
    if (physical)
      PetscCall(PrintFields(s, request, " (Kelvin-Voigt {viscosity}, shear {shear_viscosity}, bulk {bulk_viscosity})"));
  }
  if (space->local != 0) MpmPrint("%slocal damping %g", between[0] || viscous ? ", " : "", space->local);
  MpmPrint("\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool HasGravity(const MpmScene *s)
{
  return s->gravity[0] != 0 || s->gravity[1] != 0 || s->gravity[2] != 0 ? PETSC_TRUE : PETSC_FALSE;
}

#define SAME_DENSITY 1e-3 /* relative */

/*
   The particles of a file, and where their masses over volumes are not the density that the speed of waves is made of.
*/
static void PrintGiven(const MpmScene *s)
{
  const MpmGiven *given   = s->layout.given;
  const PetscReal density = s->density > 0 ? s->density : 1;
  char            text[512];

  MpmGivenText(given, sizeof text, text);
  MpmPrint("%s\n", text);
  if (given->of_bodies || (given->density[0] > 1 - SAME_DENSITY && given->density[1] < 1 + SAME_DENSITY)) return;
  MpmPrint("note: mass over volume of the particles is from %.6g to %.6g, but the density of the scene is %.6g%s, and "
           "c dt / h has "
           "the wave speed c of that density\n",
           given->density[0] * density, given->density[1] * density, density,
           s->density > 0 ? "" : ", since none was given");
}

/* Describes layout and material where they are not the default. */
static PetscErrorCode PrintDifferences(const MpmScene *s, const MpmRequest *request)
{
  const MpmMaterialKind material = s->layout.material.kind;

  PetscFunctionBegin;
  if (s->layout.counts.n > 1)
    PetscCall(PrintFields(s, request, "particles in cells: {counts}, repeated; {particles} in all\n"));
  else if (s->layout.given)
    PrintGiven(s);
  else if (!MpmSceneIsFull(s))
    PrintFilled(&s->layout);
  if (s->scheme.space.finite) {
    PetscCall(PrintFields(s, request, "finite deformation, material {material}, from the stretch {stretch}"));
    PetscCall(PrintFields(s, request, HasGravity(s) ? ", gravity {gravity}\n" : "\n"));
  }
  if (s->bodies[0]) PetscCall(PrintFields(s, request, "bodies: {bodies}\n"));
  if (s->layout.colliders) PetscCall(PrintFields(s, request, "colliders: {colliders}\n"));
  if (material != MPM_MATERIAL_UNIFORM)
    PetscCall(PrintFields(s, request,
                          "material {material}: density ratio {density_ratio}, stiffness ratio {stiffness_ratio}"));
  if (material == MPM_MATERIAL_TWO) PetscCall(PrintFields(s, request, ", in cells {inclusion}"));
  if (material != MPM_MATERIAL_UNIFORM) MpmPrint("\n");
  if (MpmSpaceIsDamped(&s->scheme.space)) PetscCall(PrintDamping(s, request));
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

static PetscErrorCode PrintScene(const MpmScene *s, const MpmRequest *request)
{
  PetscFunctionBegin;
  MpmPrint("mpmstab %s %s: ", MPMSTAB_VERSION, request->task);
  PetscCall(PrintFields(s, request, "{formulation}"));
  for (const char *const *reads = s->scheme.formulation->options; *reads; reads++) {
    const MpmField *option = &MpmOptions[MpmOptionIndex(*reads)];
    char            text[64];

    if (!option->shown(s, MPM_IN_JSON, option)) continue;
    (void)snprintf(text, sizeof text, ", %s {%s}", *reads, *reads);
    PetscCall(PrintFields(s, request, text));
  }
  PetscCall(PrintFields(s, request, ", {basis} basis, {transfer} transfer"));
  if (s->scheme.transfer->option)
    MpmPrint(" (%s %g)", s->scheme.transfer->option, s->scheme.transfer->number(&s->scheme.numbers));
  PetscCall(PrintFields(
      s, request,
      s->layout.given
          ? ", {boundary}\n{cells} cells, {particles} particles of {layout}, "
          : ", {boundary}\n{cells} cells x {ppc} particles ({layout}, offset {offset}, jitter {jitter}), "));
  PetscCall(PrintStep(s, request));
  PrintRanks("");
  PetscCall(PrintScheme(s, request));
  PetscCall(MpmReportUnits(s, request));
  PetscCall(PrintDifferences(s, request));
  PetscFunctionReturn(PETSC_SUCCESS);
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

/* A value, or a list of one for each direction. */
static void SetValue(json_t *result, const MpmScene *s, const MpmValue *value)
{
  json_t *list = value->n == 1 ? OneJson(s, value, 0) : json_array();

  for (PetscInt a = 0; a < value->n && value->n > 1; a++) json_array_append_new(list, OneJson(s, value, a));
  MpmResultPut(result, value->field->json ? value->field->json : value->field->name, list);
}

/* Sets the fields that record JSON shows; those that only some scenes show come last. */
static PetscErrorCode Begin(const MpmScene *s, const MpmRequest *request, json_t **result)
{
  const MpmRequest *source = s ? NULL : request; /* what a request says of a scene's task is not shown */
  MpmValue          values[MPM_MAX_VALUES];
  PetscInt          n;

  PetscFunctionBegin;
  *result = json_object();
  MpmResultKeep(*result, "%s{version} %s{task}", MPMSTAB_VERSION, request->task);
  PetscCall(MpmValuesIn(MPM_IN_JSON, s, source, &n, values));
  for (PetscInt i = 0; i < n; i++)
    if (!values[i].field->shown) SetValue(*result, s, &values[i]);
  MpmResultKeep(*result, "%d{ranks} %g{wall_s}", Ranks(), 0.0);
  for (PetscInt i = 0; i < n; i++)
    if (values[i].field->shown) SetValue(*result, s, &values[i]);
  MpmPrintHold();
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmResultOfScene(const MpmScene *s, const MpmRequest *request, json_t **result)
{
  PetscFunctionBegin;
  PetscCall(Begin(s, request, result));
  if (!HasOneStep(s, request->task))
    (void)json_object_del(*result, "courant"); /* the default, of which nothing is said */
  PetscCall(PrintScene(s, request));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmResultOfFile(const MpmRequest *request, const char what[], json_t **result)
{
  PetscFunctionBegin;
  PetscCall(Begin(NULL, request, result));
  if (what) MpmReportFile(request, what);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmReportFile(const MpmRequest *request, const char what[])
{
  MpmPrint("mpmstab %s %s: %s of %s", MPMSTAB_VERSION, request->task, what, MpmRequestSource(request));
  PrintRanks(", ");
}

void MpmReportGrowth(json_t *result, const char key[], const char name[], PetscReal growth, const char text[])
{
  if (isnan(growth) || isinf(growth))
    MpmPrint("  %-11s %-13s %s\n", name, isnan(growth) ? "-" : "off range", text);
  else
    MpmPrint("  %-11s %-13.9g %s\n", name, growth, text);
  if (key && !isinf(growth)) MpmResultPut(result, key, isnan(growth) ? json_null() : json_real(growth));
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

void MpmReportPredictions(json_t *result, const MpmPredictor *p, const MpmPredictions *predictions)
{
  const MpmFormulation *f    = p->scheme->formulation;
  const char           *text = f->published_text;

  if (isnan(predictions->published))
    text = p->why_not_published ? p->why_not_published : "the slides give no formula for this Courant number";
  MpmReportGrowth(result, "predicted.published", "published", predictions->published, text);
  MpmReportGrowth(result, "predicted.corrected", "corrected", predictions->corrected,
                  p->why_not_corrected ? p->why_not_corrected : MpmPredictionText(p->scheme));
}

void MpmReportComparison(json_t *result, const MpmPredictor *p, const MpmComparison *c)
{
  const MpmFormulation *f = p->scheme->formulation;

  MpmResultKeep(MpmResultIn(result, "predicted"), "%g{published_off_by} %g{published_off_at_beta} %g{corrected_off_by}",
                c->published, c->published_beta, c->corrected);
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

void MpmResultFinding(json_t *result, const MpmFinding *f)
{
  MpmResultKeep(result, "%s{verdict} %g{growth} %g{tolerance} %g{uncertainty} %s{evidence}",
                MpmVerdictNames[f->verdict], f->growth, f->tolerance, f->uncertainty, f->evidence);
}

/* A field of the layout, as a heading has it. */
static PetscErrorCode JoinField(const MpmScene *s, const MpmRequest *request, const char name[], size_t room,
                                char text[])
{
  MpmValue value;
  char     number[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmValueOf(name, s, request, &value));
  PetscCall(MpmValueHeading(&value, sizeof number, number));
  MpmTextJoin(text, ", ", room);
  MpmTextJoin(text, name, room);
  MpmTextJoin(text, " ", room);
  MpmTextJoin(text, IsVaried(request, name) ? "varied" : number, room);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportLayout(const MpmScene *s, const MpmRequest *request, size_t room, char text[])
{
  const MpmLayout *l        = &s->layout;
  const PetscBool  random   = l->jitter != 0 || IsVaried(request, "jitter") ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool  ensemble = !strcmp(request->task, "ensemble") ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (l->given)
    (void)snprintf(text, room, "layout %s", l->name);
  else
    (void)snprintf(text, room, "%s", ensemble ? "layouts" : random || !MpmLayoutIsUniform(l) ? "layout" : "lattice");
  if (!l->given && l->counts.n > 1)
    MpmTextJoin(text, " with the counts of the heading", room);
  else if (!l->given)
    PetscCall(JoinField(s, request, "ppc", room, text));
  if (!l->given) PetscCall(JoinField(s, request, "offset", room, text));
  if (!l->given && !MpmSceneIsFull(s)) MpmTextJoin(text, ", in a part of the grid", room);
  if (random) PetscCall(JoinField(s, request, "jitter", room, text));
  if ((random || (l->given && l->given->random)) && !ensemble) PetscCall(JoinField(s, request, "seed", room, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportFinding(json_t *result, const MpmScene *scene, const MpmRequest *request, const MpmFinding *f,
                                PetscReal condition)
{
  char layout[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  MpmResultFinding(result, f);
  MpmPrint("\nverdict: %s", MpmVerdictNames[f->verdict]);
  if (isinf(f->growth))
    MpmPrint(", growth is beyond the range of doubles");
  else if (!isnan(f->growth)) {
    MpmPrint(", growth - 1 = %.3g where %.3g is tolerated", f->growth - 1, f->tolerance);
    if (f->growth > 1 + f->tolerance && isinf(f->uncertainty))
      MpmPrint("; that is lost to %s", f->lost ? f->lost : "rounding");
    else if (f->growth > 1 + f->tolerance && isfinite(condition))
      MpmPrint("; its eigenvalue, of condition %.3g, is known to %.1g", condition, f->uncertainty);
  }
  if (f->verdict == MPM_UNDECIDED && isinf(f->defective_error))
    MpmPrint("; the operator is not what the march does");
  else if (f->verdict == MPM_UNDECIDED && f->growth <= 1 + f->tolerance && f->defective_error > f->tolerance)
    MpmPrint("; rounding may hide growth of %.1g per step", f->defective_error);
  if (scene) {
    PetscCall(MpmReportLayout(scene, request, sizeof layout, layout));
    MpmPrint("; %s", layout);
  }
  MpmPrint("\nevidence: %s\n", f->evidence);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmResultSymbol(json_t *result, const MpmSymbol *symbol)
{
  json_t *phases = json_array();

  for (PetscInt a = 0; a < symbol->dim; a++) json_array_append_new(phases, json_integer(symbol->phases[a]));
  MpmResultPut(result, "symbol.phases",
               symbol->dim == 1 ? json_incref(json_array_get(phases, 0)) : json_incref(phases));
  json_decref(phases);
  MpmResultKeep(result, "%g{symbol.growth} %g{symbol.seconds}", symbol->growth, symbol->seconds);
  MpmResultVector(result, "symbol.beta_at_max", symbol->dim, symbol->beta_at_max);
}

/* ---- the matrix by which a step maps nodal values at rest: its size says how many factors a phase has ---- */

/* The images by their maps and fields, in one dimension. */
static PetscErrorCode NameImages(const MpmTable *table, const MpmNodalPlan *plan, MpmText *text)
{
  PetscFunctionBegin;
  PetscCall(MpmTextAdd(text, "%s", ""));
  for (PetscInt g = 0; g < plan->nimages && table->dim == 1; g++)
    for (PetscInt i = 0; i < plan->image[g].n; i++) {
      const MpmOp *term = &plan->image[g].term[i];

      PetscCall(MpmTextAdd(text, "%s%s %s",
                           i   ? " + "
                           : g ? ", "
                               : ": ",
                           MpmOpTraitsOf(term->kind).weight == MPM_MASS ? "P2G" : "DIV", table->fields[term->src]));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportNodal(const MpmTable *table, const char before[])
{
  MpmNodalPlan *plan;
  MpmText       images = {NULL, 0};
  const char   *why;

  PetscFunctionBegin;
  PetscCall(MpmNodalPlanCreate(table, &why, &plan));
  if (why) MpmPrint("%sthe nodes have no matrix of their own: %s\n", before, why);
  if (!plan) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(NameImages(table, plan, &images));
  MpmPrint("%sat rest a step maps nodal values by a %" PetscInt_FMT " x %" PetscInt_FMT " matrix at each phase%s\n",
           before, plan->nimages, plan->nimages, images.text);
  MpmTextFree(&images);
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A limit of the Courant number as a time step of a scene in physical units, and how far the scene's own time step is
   from it.
*/

#define NEAR_LIMIT 0.005 /* this near to the limit three digits of the ratio do not tell on which side a step is */

static void PrintGrowth(PetscReal tolerance, PetscReal growth)
{
  if (isinf(growth))
    MpmPrint(": growth per step is beyond the range of doubles");
  else if (growth > 1 + tolerance)
    MpmPrint(": it grows by a factor of %.6g per step", growth);
  else if (!isnan(growth))
    MpmPrint(", but growth is still within tolerance");
}

void MpmReportWindows(json_t *result, PetscInt blanks, PetscReal courant, const MpmCriticalWindows *windows)
{
  const PetscBool said = courant > 0 ? PETSC_TRUE : PETSC_FALSE;

  if (!windows->looked) return;
  MpmResultKeep(result, "%" PetscInt_FMT "{looked_at}", windows->looked);
  (void)MpmResultList(result, "windows");
  for (PetscInt i = 0; i < windows->n; i++) {
    const MpmCriticalWindow *w = &windows->window[i];

    if (said)
      MpmPrint("%*sbelow that there is growth from %.6g to %.6g, by a factor of up to %.9g per step, at %.6g\n",
               (int)blanks, "", w->from, w->to, w->growth, w->at);
    (void)json_array_append_new(MpmResultList(result, "windows"), json_pack("[f, f, f]", w->from, w->to, w->growth));
  }
  if (said)
    MpmPrint("%*s%sgrowth was looked at for %" PetscInt_FMT
             " Courant numbers; a window between two of them is missed\n",
             (int)blanks, "", windows->n ? "" : "below that there is no growth; ", windows->looked);
}

void MpmReportLimit(const MpmScene *scene, PetscReal tolerance, PetscReal courant, PetscReal growth, PetscBool windows,
                    const char of[])
{
  const PetscReal   limit = MpmSceneTimeStep(scene, courant), ratio = scene->step.courant / courant;
  const char *const name = MpmSceneDrifts(scene) ? "largest dt with growth within tolerance" : "largest stable dt";

  if (!MpmSceneIsPhysical(scene) || isnan(courant)) return;
  if (isinf(courant)) {
    MpmPrint("%s: none up to %.6g is unstable%s; %s\n", name, MpmSceneTimeStep(scene, MPM_CRITICAL_TO),
             windows ? ", but for windows of growth" : "", of);
    return;
  }
  MpmPrint("%s: %.6g%s; %s\n", name, limit, windows ? ", with windows of growth below it" : "", of);
  if (!MpmSceneHasStep(scene)) return;
  if (courant == 0)
    MpmPrint("dt %.6g is beyond it", scene->dt);
  else
    MpmPrint("dt %.6g is %.*g %s %.6g", scene->dt, fabs(ratio - 1) < NEAR_LIMIT ? 6 : 3, ratio,
             ratio <= 1 ? "of the limit" : "times the limit", limit);
  if (ratio > 1 || growth > 1 + tolerance) PrintGrowth(tolerance, growth);
  MpmPrint("\n");
}
