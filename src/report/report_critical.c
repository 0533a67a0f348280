/* The largest stable Courant number in words, in the tree of results, and as CSV. */
#include "report/results.h"
#include "base/text.h"
#include "scene/fields.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "base/textfile.h"
#include "report/report.h"
#include "linalg/dense.h"
#include <math.h>
#include <string.h>

#define ALONG 1e-3 /* a direction is that of an axis or of a diagonal within this */

void MpmReportQuiet(json_t *result, const MpmCritical *c)
{
  if (isinf(c->quiet))
    MpmPrint("  no limit     and it cannot ring: theorem, no step raises the energy of the particles (docs/theory.md, "
             "section 12)\n");
  else if (c->quiet > 0)
    MpmResultSay(result,
                 "  cannot ring  up to %.10g{quiet}: theorem, no step raises the energy of the particles "
                 "(docs/theory.md, section 12)\n",
                 c->quiet);
  if (isinf(c->quiet)) MpmResultPut(result, "quiet", json_string("no limit"));
  if (c->no_theorem)
    MpmResultSay(result, "  may ring     the theorem of docs/theory.md, section 12, does not hold: %s{no_theorem}\n",
                 c->no_theorem);
  if (c->cure)
    MpmResultSay(result,
                 "  with formulation %s{cure} in its place no step raises the energy of the particles up to "
                 "%.6g{cure_quiet}, so that it cannot ring\n",
                 c->cure->name, c->cured);
}

/* A field of the scene as text: all digits for files, or six for headings. */
static PetscErrorCode FieldText(const MpmScene *s, const char name[], PetscBool heading, size_t room, char text[])
{
  MpmValue value;

  PetscFunctionBegin;
  PetscCall(MpmValueOf(name, s, NULL, &value));
  PetscCall(heading ? MpmValueHeading(&value, room, text) : MpmValueText(&value, room, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is said about drift below the limit. */
static PetscErrorCode Drift(const MpmScene *s, const MpmCritical *c)
{
  char drift[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  if (!MpmSceneDrifts(s)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FieldText(s, "drift", PETSC_TRUE, sizeof drift, drift));
  if (s->layout.dim == 1)
    MpmPrint("  particles move by %.6g cells per step at every Courant number that is looked at\n",
             s->step.drift[0].value);
  else
    MpmPrint("  particles move by %s cells per step at every Courant number that is looked at\n", drift);
  if (c->followed)
    MpmPrint("  under drift growth comes in windows of Courant number; this is where the first one opens\n");
  else
    MpmPrint(
        "  under drift growth comes in windows of Courant number; one narrower than the steps of the search may be "
        "missed\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Limit(json_t *result, const MpmScene *s, const MpmRequest *request, const MpmCritical *c)
{
  const PetscReal tolerance = request->tolerance;
  const char     *name =
      MpmSceneDrifts(s) ? "largest Courant number with growth within tolerance" : "critical Courant number";
  char layout[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmReportLayout(s, request, sizeof layout, layout));
  if (c->too_large)
    MpmPrint("%s: not sought, since there are too many unknowns to find all eigenvalues (at most %d)", name,
             MPM_DENSE_MANY);
  else if (c->disputed)
    MpmPrint("%s: undecided, the search finds %.10g, but the closed form says otherwise", name, c->stable_at);
  else if (isnan(c->courant))
    MpmPrint("%s: undecided, tolerance %.6g is less than the growth of up to %.1g per step that rounding makes here",
             name, tolerance, c->rounding);
  else if (isinf(c->courant))
    MpmPrint("%s: none up to %.6g is unstable%s", name, MPM_CRITICAL_TO,
             c->windows.n ? ", but for windows of growth" : "");
  else if (c->courant == 0 && c->stable_at == 0 && c->windows.looked)
    MpmPrint("%s: 0, growth is beyond tolerance at each of %" PetscInt_FMT " Courant numbers from %.6g to %.6g", name,
             c->windows.looked, c->unstable_at, MPM_CRITICAL_TO);
  else if (c->courant == 0 && c->stable_at == 0)
    MpmPrint("%s: 0, growth is beyond tolerance even at %.6g", name, c->unstable_at);
  else if (c->courant == 0 && c->windows.looked)
    MpmPrint("%s: 0, growth only fades to the tolerance below %.6g", name, c->unstable_at);
  else if (c->courant == 0)
    MpmPrint("%s: 0, the scheme grows at every one", name);
  else if (isinf(c->stable_at))
    MpmPrint("%s: %.6g; any growth beyond it is within tolerance", name, c->courant);
  else if (c->courant < c->stable_at)
    MpmPrint("%s: %.6g; growth beyond it is within tolerance up to %.6g", name, c->courant, c->stable_at);
  else
    MpmPrint("%s: %.6g%s%s", name, c->courant, c->windows.n ? ", with windows of growth below it" : "",
             MpmSceneDrifts(s) || !MpmSceneIsPeriodic(s) ? "" : ", for particles at rest (-drift for those that move)");
  MpmPrint("; %s\n", layout);
  MpmReportWindows(result, 2, c->courant, &c->windows);
  if (c->stable_at > 0 && isfinite(c->unstable_at))
    MpmPrint("  bracket      growth within 1 + %.6g at %.10g, beyond at %.10g\n", tolerance, c->stable_at,
             c->unstable_at);
  PetscCall(Drift(s, c));
  MpmReportQuiet(result, c);
  if (isfinite(c->doubtful))
    MpmPrint("  near %.6g amplification factors could not be told apart: a window there may be missed\n", c->doubtful);
  if (!isnan(c->closed) && isfinite(c->closed))
    MpmResultSay(result, "  closed form  %.10g{closed_form}: %s\n", c->closed,
                 MpmSpaceIsDamped(&s->scheme.space) ? "with damping: docs/theory.md, section 13"
                                                    : s->scheme.formulation->limit_text);
  if (c->bound > 0)
    MpmResultSay(result,
                 "  any layout   of such particles at rest is stable up to %.10g{bound} = 2 sqrt(D / chi), jittered or "
                 "with gaps\n",
                 c->bound);
  if (c->bound > 0 && MpmSceneIsPhysical(s))
    MpmPrint("               which is dt %.6g\n", MpmSceneTimeStep(s, c->bound));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The direction of a wave of several phases. */
static void DirectionText(PetscInt dim, const PetscReal beta[], PetscReal length, size_t room, char text[])
{
  char part[32];

  PetscInt along = 0, alike = 0;

  for (PetscInt a = 0; a < dim; a++) {
    if (PetscAbsReal(beta[a]) > (1 - ALONG) * length) along = a + 1;
    if (PetscAbsReal(PetscAbsReal(beta[a]) * PetscSqrtReal((PetscReal)dim) - length) <= ALONG * length) alike++;
  }
  if (along) {
    (void)snprintf(text, room, "along %c", "xyz"[along - 1]);
    return;
  }
  (void)snprintf(text, room, "%s", alike == dim ? "along a diagonal " : "along ");
  for (PetscInt a = 0; a < dim; a++) {
    (void)snprintf(part, sizeof part, "%s%.4g", a ? ", " : "(", beta[a] / length);
    MpmTextJoin(text, part, room);
  }
  MpmTextJoin(text, ")", room);
}

/* Type, length, direction and phases of a wave of two or three dimensions. */
static void WaveText(PetscInt dim, PetscBool assembled, MpmWaveType wave, const PetscReal phase[], size_t room,
                     char text[])
{
  const char *const said[] = {[MPM_WAVE_NONE]  = "waves",
                              [MPM_WAVE_P]     = "P waves",
                              [MPM_WAVE_S]     = "S waves",
                              [MPM_WAVE_MIXED] = "mixed P and S waves"};
  PetscReal         length = 0;
  char              direction[96];

  for (PetscInt a = 0; a < dim; a++) length += PetscSqr(phase[a]);
  length = PetscSqrtReal(length);
  DirectionText(dim, phase, length, sizeof direction, direction);
  (void)snprintf(text, room, "%s%s of %.4g cells %s, beta = %s", assembled ? "a mode with " : "", said[wave],
                 2 * PETSC_PI / length, direction, MpmVectorText(dim, phase, 6, MPM_VECTOR_ROOM));
}

/* Whether all waves of the mode that limits are infinitely long. */
static PetscBool IsUniform(PetscInt dim, const PetscReal beta[])
{
  for (PetscInt a = 0; a < dim; a++)
    if (beta[a] != 0) return PETSC_FALSE;
  return PETSC_TRUE;
}

void MpmReportWave(PetscInt dim, PetscBool assembled, MpmWaveType wave, const PetscReal beta[], size_t room,
                   char text[])
{
  if (isnan(beta[0]))
    (void)snprintf(text, room, "%s", "a mode whose trace on the nodes has no phase");
  else if (IsUniform(dim, beta))
    (void)snprintf(text, room, "%s", "the mode with beta = 0");
  else if (dim > 1)
    WaveText(dim, assembled, wave, beta, room, text);
  else
    (void)snprintf(text, room, "%s of %.4g cells, beta = %.6g", assembled ? "a mode with waves" : "waves",
                   2 * PETSC_PI / beta[0], beta[0]);
}

static void PrintReason(PetscInt dim, const MpmRequest *request, const MpmCritical *c)
{
  char wave[256];

  if (isinf(c->unstable_at)) return;
  if (!isnan(c->fading) && !isnan(c->courant))
    MpmPrint("  no threshold: growth fades like the Courant number to the power %.2g, tolerance %.6g sets the limit\n",
             c->fading, request->tolerance);
  MpmReportWave(dim, c->assembled, c->wave, c->beta, sizeof wave, wave);
  MpmPrint("  limited by   %s", wave);
  if (!isnan(c->null_share)) MpmPrint("; share in the null space of P2G %.2g", c->null_share);
  MpmPrint("\n");
  if (request->verbose && c->closed > 0 && isfinite(c->closed))
    MpmPrint("  there        alpha = %.6g (P2G G2P), kappa = %.6g (DIV GRAD), mu = %.4g%+.4gi (P2G GRAD), f = %.4g "
             "(transfer)\n",
             c->cell.alpha, c->cell.kappa, creal(c->cell.mu), cimag(c->cell.mu), c->cell.filter);
}

static void PrintMoving(const MpmCritical *c, PetscReal growth, PetscReal tolerance)
{
  if (isinf(growth))
    MpmPrint("beyond that range");
  else
    MpmPrint("%.9g%s", growth, growth > 1 + tolerance && c->asked.growth <= 1 + tolerance ? ", it rings" : "");
}

/* Prints growth and verdict at the scene's own Courant number. */
static void PrintAsked(const MpmScene *s, PetscReal tolerance, const MpmCritical *c)
{
  MpmPrint("\nat Courant number %.6g: growth ", s->step.courant);
  if (isinf(c->asked.growth))
    MpmPrint("beyond the range of doubles");
  else if (isnan(c->asked.growth))
    MpmPrint("is not known");
  else
    MpmPrint("%.9g per step", c->asked.growth);
  if (isfinite(c->asked.growth) && !isnan(c->moving[0])) {
    MpmPrint("; if particles drift by 1/%d cell per step%s: ", MPM_CRITICAL_DRIFT, s->layout.dim > 1 ? " along x" : "");
    PrintMoving(c, c->moving[0], tolerance);
    if (s->layout.dim > 1) {
      MpmPrint(", along the diagonal: ");
      PrintMoving(c, c->moving[1], tolerance);
    }
  }
  MpmPrint("\n");
}

static void PrintSearch(const MpmScene *s, const MpmCritical *c)
{
  if (c->too_large) return;
  if (c->leftmost)
    MpmPrint(
        "searched: where an eigenvalue of the nodes first reaches -1, and the leftmost eigenvalue at %" PetscInt64_FMT
        " Courant numbers, each by a Krylov space\n",
        c->evaluations);
  else if (c->assembled)
    MpmPrint("searched: all eigenvalues of %" PetscInt_FMT " unknowns%s at %" PetscInt64_FMT " Courant numbers%s\n",
             c->nodal ? c->nodal : c->order, c->nodal ? ", the nodes' own," : "", c->evaluations,
             c->pencil ? ", and where they first reach -1, from one factorisation" : "");
  else if (c->phases)
    MpmPrint("searched: %s%" PetscInt_FMT " phases in (0, pi] of each direction and uphill from the largest growths, "
             "%" PetscInt64_FMT " amplification matrices of order %" PetscInt_FMT "\n",
             MpmSceneDrifts(s) || isnan(c->closed) ? "all phases along the axes, and "
                                                   : "the closed form at all phases, and ",
             c->phases, c->evaluations, c->order);
  else
    MpmPrint("searched: all phases, %" PetscInt64_FMT " amplification matrices of order %" PetscInt_FMT "\n",
             c->evaluations, c->order);
}

/* A particle, with its place in the unit of length. */
static void Decider(json_t *result, const MpmScene *s, const char format[], const MpmDecider *at)
{
  char      place[MPM_VECTOR_TEXT];
  PetscReal x[MPM_MAX_DIM];

  for (PetscInt a = 0; a < s->layout.dim; a++) x[a] = at->place[a] * s->cell_width;
  MpmResultNumbers(result, "place", s->layout.dim, x);
  MpmResultSay(result, format, at->id);
  MpmPrint("%s", MpmVectorText(s->layout.dim, x, 6, place));
}

/* A bound, what it is, and the particle that decides, with its place in the unit of length. */
static void Bound(json_t *bounds, const MpmScene *s, const char name[], PetscReal courant, const char text[],
                  const MpmDecider *at)
{
  char key[32];

  if (bounds) MpmResultPut(bounds, name, json_real(courant));
  MpmPrint("    %-10s %-11.6g", name, courant);
  if (MpmSceneIsPhysical(s)) MpmPrint(" dt %-11.6g", MpmSceneTimeStep(s, courant));
  MpmPrint(" %s", text);
  (void)snprintf(key, sizeof key, "%s_decided_by", name);
  if (at) Decider(MpmResultIn(bounds, key), s, "; particle %" PetscInt64_FMT "{id} at ", at);
  if (at) MpmPrint(" decides");
  MpmPrint("\n");
}

static void Bounds(json_t *result, const MpmScene *s, const MpmCritical *c)
{
  const MpmStepBounds *b = &c->bounds;
  json_t              *bounds;
  char                 text[128];

  if (!c->bounded) return;
  if (b->why_not) {
    MpmPrint("  bounds       none of this layout: %s (docs/theory.md, section 4)\n", b->why_not);
    return;
  }
  bounds = MpmResultIn(result, "bounds");
  MpmPrint("  of this layout, with these particles at rest%s:\n",
           c->too_large ? ", its limit is above" : ", bounds from below, and the limit");
  Bound(bounds, s, "lone", b->lone, "proved: as if each were alone", &b->lone_at);
  Bound(bounds, s, "particle", b->particle, "proved: masses split by slopes", &b->particle_at);
  (void)snprintf(text, sizeof text, "proved: the same after %" PetscInt_FMT " sweeps", b->sweeps);
  if (b->sweeps) Bound(bounds, s, "swept", b->swept, text, NULL);
  (void)snprintf(text, sizeof text, "certified by %" PetscInt_FMT " products, but for a chance of %.3g", b->products,
                 b->chance);
  Bound(bounds, s, "lanczos", b->lanczos, text, NULL);
  MpmResultKeep(bounds, "%g{chance}", b->chance);
  if (!c->too_large && isfinite(c->courant))
    Bound(NULL, s, "limit", c->courant, c->leftmost ? "leftmost eigenvalue" : "all eigenvalues", NULL);
}

/* What JSON alone has of the bulk. Another neighbourhood may have the least limit. */
static void Bulk(json_t *result, PetscInt dim, const MpmCritical *c)
{
  if (isfinite(c->beta[0])) MpmResultVector(result, "limited_by_beta", dim, c->beta);
  if (dim > 1 && c->wave != MPM_WAVE_NONE) MpmResultKeep(result, "%s{limited_by_wave}", MpmWaveTypeNames[c->wave]);
  if (dim > 1 && c->phases) MpmResultKeep(result, "%" PetscInt_FMT "{phases}", c->phases);
  MpmResultKeep(result, "%g{stable_at} %g{unstable_at} %g{fading}", c->stable_at, c->unstable_at, c->fading);
  MpmResultKeep(result, "%g{growth_when_drifting} %g{growth_when_drifting_diagonally}", c->moving[0], c->moving[1]);
  MpmResultKeep(result, "%d{threshold?} %" PetscInt64_FMT "{evaluations} %g{seconds}", c->threshold, c->evaluations,
                c->seconds);
}

PetscErrorCode MpmCriticalReport(const MpmScene *s, const MpmRequest *request, const MpmCritical *c,
                                 const MpmNeighbourhoods *all, const MpmStepTable *table, PetscReal wall_s)
{
  const MpmFinding *finding = all ? &all->finding : &c->asked;
  const PetscReal   courant = all ? all->courant : c->courant;
  PetscReal         seconds = (c ? c->seconds : 0) + (table ? table->seconds : 0);
  char              lattice[MPM_COUNTS_TEXT];
  json_t           *result, *critical;

  PetscFunctionBegin;
  PetscCall(MpmResultOfScene(s, request, &result));
  critical = MpmResultIn(result, "critical");
  MpmResultKeep(critical, "%g{critical_courant}", courant);
  if (MpmSceneIsPhysical(s)) MpmResultKeep(critical, "%g{critical_dt}", MpmSceneTimeStep(s, courant));
  if (c) {
    MpmPrint("\n");
    PetscCall(Limit(critical, s, request, c));
    Bulk(critical, s->layout.dim, c);
    Bounds(critical, s, c);
    PrintReason(s->layout.dim, request, c);
    if (c->mode_at.id != MPM_NONE) {
      Decider(MpmResultIn(critical, "mode_fastest"), s,
              "               in it particle %" PetscInt64_FMT "{id} is the fastest, at ", &c->mode_at);
      MpmPrint("\n");
    }
    if (MpmSceneHasStep(s)) PrintAsked(s, request->tolerance, c);
  }
  if (MpmSceneHasStep(s)) MpmResultFinding(result, finding);
  if (all)
    MpmNeighbourhoodsReport(critical, s, request, PETSC_TRUE, table ? PETSC_TRUE : PETSC_FALSE, all);
  else if (MpmSceneHasStep(s))
    PetscCall(MpmReportFinding(result, s, request, finding, NAN));
  if (c) PrintSearch(s, c);
  PetscCall(MpmReportLayout(s, request, sizeof lattice, lattice));
  if (table) MpmStepTableReport(critical, s, request, lattice, table);
  if (request->no_table) MpmPrint("no table of largest steps by layout: %s\n", request->no_table);
  for (PetscInt i = 0; all && i < all->n; i++)
    if (all->of[i].kind != MPM_IN_BULK) seconds += all->of[i].seconds;
  MpmPrint("time: %.3g s\n", seconds);
  MpmReportLimit(s, request->tolerance, courant, finding->growth,
                 all ? MpmNeighbourhoodsHaveWindows(all) : (PetscBool)(c->windows.n > 0),
                 all && all->least != MPM_NONE ? MpmNeighbourhoodSubject(all->of[all->least].kind) : lattice);
  PetscCall(MpmResultEnd(request, wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In more than one dimension a row begins with these fields; one with several values has them in quotes. */
static const char *const fields[] = {"dim", "gradient", "poisson", "ppc", "offset", "jitter", "drift", "boundary"};

static PetscErrorCode CsvOpen(const char path[], PetscInt dim, PetscBool table, MpmTextFile *csv)
{
  const char *const more = table ? ",disordered_5,edge,lone,worst,any_layout,recommended" : "";

  PetscFunctionBegin;
  PetscCall(MpmTextFileOpen(path, csv));
  if (!csv->stream) PetscFunctionReturn(PETSC_SUCCESS);
  if (dim == 1) {
    fprintf(csv->stream,
            "formulation,basis,transfer,ppc,offset,jitter,drift,boundary_left,boundary_right,"
            "critical_courant,closed_form,limited_by_beta%s\n",
            more);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  fprintf(csv->stream, "formulation,basis,transfer");
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(fields); i++) fprintf(csv->stream, ",%s", fields[i]);
  fprintf(csv->stream, ",critical_courant,closed_form");
  for (PetscInt a = 0; a < dim; a++) fprintf(csv->stream, ",limited_by_beta_%c", "xyz"[a]);
  fprintf(csv->stream, ",limited_by_wave%s\n", more);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The fields of a scene in more than one dimension. */
static PetscErrorCode CsvScene(MpmTextFile *csv, const MpmScene *scene)
{
  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(fields); i++) {
    char        text[MPM_COUNTS_TEXT];
    const char *quote;

    PetscCall(FieldText(scene, fields[i], PETSC_FALSE, sizeof text, text));
    quote = strchr(text, ',') ? "\"" : "";
    fprintf(csv->stream, ",%s%s%s", quote, text, quote);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CsvRow(MpmTextFile *csv, const MpmScene *scene, const MpmScheme *scheme, const MpmCritical *c,
                             const MpmStepTable *table)
{
  const MpmLayout *l = &scene->layout;

  PetscFunctionBegin;
  if (!csv->stream) PetscFunctionReturn(PETSC_SUCCESS);
  fprintf(csv->stream, "%s,%s,%s", scheme->formulation->name, scheme->basis->name, scheme->transfer->name);
  if (l->dim > 1)
    PetscCall(CsvScene(csv, scene));
  else
    fprintf(csv->stream, ",%" PetscInt_FMT ",%.17g,%.17g,%.17g,%s,%s", l->ppc[0], l->offset[0].value, l->jitter,
            scene->step.drift[0].value, MpmEndNames[l->grid[0].ends[0]], MpmEndNames[l->grid[0].ends[1]]);
  MpmTextFileCell(csv, c->courant);
  MpmTextFileCell(csv, c->closed);
  for (PetscInt a = 0; a < l->dim; a++) MpmTextFileCell(csv, c->beta[a]);
  if (l->dim > 1) fprintf(csv->stream, ",%s", MpmWaveTypeNames[c->wave]);
  for (PetscInt i = 1; table && i < MPM_TABLE_ROWS; i++) MpmTextFileCell(csv, table->limit[i]);
  if (table) MpmTextFileCell(csv, table->bound > 0 ? table->bound : NAN);
  if (table) MpmTextFileCell(csv, table->advised);
  fprintf(csv->stream, "\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalWriteCsv(const char path[], const MpmScene *scene, const MpmCritical *critical,
                                   const MpmStepTable *table)
{
  MpmTextFile csv;

  PetscFunctionBegin;
  PetscCall(CsvOpen(path, scene->layout.dim, table ? PETSC_TRUE : PETSC_FALSE, &csv));
  PetscCall(CsvRow(&csv, scene, &scene->scheme, critical, table));
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The particles of a layout as CSV that -layout reads, with their bounds and the mode that grows first. */
PetscErrorCode MpmCriticalWriteLayout(const char path[], const MpmScene *scene, const MpmCritical *c)
{
  static const char *const property[MPM_PROPERTIES] = {[MPM_VOLUME]    = "volume",
                                                       [MPM_MASS]      = "mass",
                                                       [MPM_STIFFNESS] = "young",
                                                       [MPM_LAMBDA]    = "poisson",
                                                       [MPM_MOBILITY]  = "fixed"};
  const MpmLayout         *l                        = &scene->layout;
  PetscReal                x[MPM_MAX_DIM], unit[MPM_PROPERTIES];
  MpmTextFile              csv;

  PetscFunctionBegin;
  MpmMaterialUnits(scene, unit);
  PetscCall(MpmTextFileOpen(path, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "%.*s", (int)(2 * l->dim - 1), "x,y,z");
    for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
      if (l->varies[w] && property[w]) fprintf(csv.stream, ",%s", property[w]);
    fprintf(csv.stream, ",lone,particle");
    for (PetscInt a = 0; a < l->dim; a++) fprintf(csv.stream, ",mode_%c", "xyz"[a]);
  }
  for (PetscInt64 id = 0; csv.stream && id < l->particles; id++) {
    MpmLayoutRest(l, id, x);
    for (PetscInt a = 0; a < l->dim; a++)
      fprintf(csv.stream, "%s%.17g", a ? "," : "\n", PetscMin(x[a] * scene->cell_width, scene->length[a]));
    for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
      if (l->varies[w] && property[w]) fprintf(csv.stream, ",%.17g", MpmMaterialColumn(scene, unit, w, id));
    for (PetscInt row = 0; row < 2 + l->dim; row++) MpmTextFileCell(&csv, c->each[row * l->particles + id]);
  }
  if (csv.stream) fprintf(csv.stream, "\n");
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A table of limits with a row for each formulation and transfer. Each number is printed as soon as it is found. */
typedef struct {
  const MpmScene   *scene;
  const MpmRequest *request;
  MpmTextFile       csv;
  PetscBool         undecided;
} Survey;

static PetscErrorCode PrintCell(void *context, const MpmScheme *scheme, const MpmCritical *c)
{
  Survey *survey = (Survey *)context;

  PetscFunctionBegin;
  if (scheme->basis == MpmBases[0]) MpmPrint("\n%-8s %-10s", scheme->formulation->name, scheme->transfer->name);
  if (isnan(c->courant)) {
    MpmPrint("  %9s", "?");
    survey->undecided = PETSC_TRUE;
  } else if (isinf(c->courant))
    MpmPrint("  %9s", "none");
  else if (c->courant == 0)
    MpmPrint("  %9s", "0");
  else if (c->courant < 1e-3)
    MpmPrint("  %9.1e", c->courant);
  else
    MpmPrint("  %9.4f", c->courant);
  fflush(stdout);
  if (survey->request->csv[0]) PetscCall(CsvRow(&survey->csv, survey->scene, scheme, c, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintHeading(const MpmScene *s)
{
  const char *const what = MpmSceneDrifts(s) ? "bounded (growth within tolerance)" : "stable";

  PetscFunctionBegin;
  if (s->layout.dim == 1)
    MpmPrint("largest %s Courant number c dt / h: ppc %" PetscInt_FMT ", offset %.6g, drift %.6g", what,
             s->layout.ppc[0], s->layout.offset[0].value, s->step.drift[0].value);
  else {
    static const char *const said[] = {"ppc", "offset", "drift", "poisson", "gradient"};

    MpmPrint("largest %s Courant number c dt / h in %" PetscInt_FMT " dimensions:", what, s->layout.dim);
    for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(said); i++) {
      char text[MPM_COUNTS_TEXT];

      PetscCall(FieldText(s, said[i], PETSC_TRUE, sizeof text, text));
      MpmPrint("%s %s %s", i ? "," : "", said[i], text);
    }
  }
  MpmPrint(", xpic_order %" PetscInt_FMT ", blend_ratio %.6g, aflip_ratio %.6g\nscheme   transfer  ",
           s->scheme.numbers.order, s->scheme.numbers.ratio, s->scheme.numbers.affine_ratio);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalPrintSurvey(const MpmScene *scene, const MpmRequest *request)
{
  const MpmCriticalCase of     = MpmCriticalCaseOf(scene, request->tolerance);
  Survey                survey = {.scene = scene, .request = request};

  PetscFunctionBegin;
  if (request->csv[0]) PetscCall(CsvOpen(request->csv, scene->layout.dim, PETSC_FALSE, &survey.csv));
  PetscCall(MpmReportUnits(scene, request));
  PetscCall(PrintHeading(scene));
  for (PetscInt b = 0; MpmBases[b]; b++) MpmPrint("  %9s", MpmBases[b]->name);
  PetscCall(MpmCriticalSurvey(&of, PrintCell, &survey));
  MpmPrint("\n0: grows at every Courant number; none: no limit up to %.6g%s\n", MPM_CRITICAL_TO,
           survey.undecided ? "; ?: undecided, 'mpmstab critical' with that scheme says why" : "");
  if (request->csv[0]) PetscCall(MpmTextFileClose(&survey.csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}
