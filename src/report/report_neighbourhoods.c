/* Neighbourhoods: a line for each, and a sentence about the worst. */
#include "report/report.h"
#include "base/text.h"
#include "report/results.h"
#include <math.h>

#define ROOM 256  /* of a reason */
#define LONG 1e-6 /* the square of the phase of a wave that is taken for endless */

/* Whether some direction has a value. */
static PetscBool Has(PetscInt dim, const PetscReal values[])
{
  for (PetscInt a = 0; a < dim; a++)
    if (!isnan(values[a])) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Where the first particle stands, in the directions that count. */
static void PlaceText(PetscInt dim, const MpmNeighbourhood *one, size_t room, char text[])
{
  char part[32];

  text[0] = '\0';
  for (PetscInt a = 0; a < dim; a++) {
    if (isnan(one->place[a])) continue;
    (void)snprintf(part, sizeof part, "%s%.4g", text[0] ? ", " : dim > 1 ? "(" : "", one->place[a]);
    MpmTextJoin(text, part, room);
  }
  if (text[0] && dim > 1) MpmTextJoin(text, ")", room);
}

/* What limits a surface or a lone particle. */
static void StandsText(PetscInt dim, const MpmNeighbourhood *one, size_t room, char text[])
{
  const char *const who    = one->kind == MPM_ALONE ? "the particle" : "the first particle";
  PetscReal         length = 0;
  char              place[64];

  if (one->inside) {
    (void)snprintf(text, room, "%s",
                   one->kind == MPM_AT_CORNER ? "waves inside or at an edge: the corner makes nothing worse"
                                              : "waves inside: the surfaces make nothing worse");
    (void)snprintf(place, sizeof place, ", searched at %" PetscInt_FMT " places, %" PetscInt_FMT " cells deep",
                   one->places, one->depth);
    if (one->places > 0) MpmTextJoin(text, place, room);
    return;
  }
  PlaceText(dim, one, sizeof place, place);
  if (place[0])
    (void)snprintf(text, room, "when %s %s xi = %s", who, one->approached ? "comes near" : "is at", place);
  else
    (void)snprintf(text, room, "wherever %s stands in its cell", who);
  if (one->closed) MpmTextJoin(text, ", in closed form", room);
  for (PetscInt a = 0; a < dim; a++)
    if (!isnan(one->beta[a])) length += PetscSqr(one->beta[a]);
  if (length < LONG) return;
  (void)snprintf(place, sizeof place, ", waves of %.4g cells along it", 2 * PETSC_PI / sqrt(length));
  MpmTextJoin(text, place, room);
}

static void RandomText(const MpmScene *s, const MpmRequest *request, const MpmNeighbourhood *one, size_t room,
                       char text[])
{
  char grow[64];

  (void)snprintf(text, room, "the worst of %" PetscInt_FMT " layouts with %.4g%% voids (-seed %" PetscInt64_FMT ")",
                 one->layouts, 100 * request->voids, one->worst_seed);
  (void)snprintf(grow, sizeof grow, ", %" PetscInt_FMT " of them grow at %.6g", one->unstable, s->step.courant);
  if (MpmSceneHasStep(s)) MpmTextJoin(text, grow, room);
  if (one->fades) MpmTextJoin(text, ", growth only fades towards Courant number 0", room);
}

/* The quantiles, and what makes the worst of the layouts again. */
static void DisorderedText(const MpmScene *s, const MpmNeighbourhood *one, size_t room, char text[])
{
  const PetscBool scattered = (one->worst_seed - s->layout.seed) % 2 ? PETSC_TRUE : PETSC_FALSE;
  char            part[96]  = "";

  (void)snprintf(text, room, "of %" PetscInt_FMT " random layouts", one->layouts);
  for (PetscInt q = 0; q < MPM_QUANTILES && !isnan(one->quantile[0]); q++) {
    (void)snprintf(part, sizeof part, "%s number %" PetscInt_FMT " has %.4g", q ? "," : ", in order of their limits,",
                   MpmRankOfQuantile(q, one->layouts), one->quantile[q]);
    MpmTextJoin(text, part, room);
  }
  (void)snprintf(part, sizeof part, "%s the worst: -cells %" PetscInt_FMT, isnan(one->quantile[0]) ? "" : ";",
                 one->cells);
  MpmTextJoin(text, part, room);
  if (scattered)
    (void)snprintf(part, sizeof part, " -layout random -seed %" PetscInt64_FMT, one->worst_seed);
  else
    (void)snprintf(part, sizeof part, " -jitter %.4g -seed %" PetscInt64_FMT,
                   s->layout.jitter > 0 ? s->layout.jitter : 1, one->worst_seed);
  MpmTextJoin(text, part, room);
  (void)snprintf(part, sizeof part, "; %" PetscInt_FMT " grow at %.6g", one->unstable, s->step.courant);
  if (MpmSceneHasStep(s)) MpmTextJoin(text, part, room);
  if (one->cells % 2) MpmTextJoin(text, "; waves of 2 cells, which limit lattices, do not fit into 3 cells", room);
}

/* How many layouts were searched, and where the worst is. */
static void WorstText(const MpmRequest *request, const MpmNeighbourhood *one, size_t room, char text[])
{
  char part[128];

  (void)snprintf(text, room, "the least that moving and taking away particles found from %" PetscInt_FMT " layouts",
                 one->layouts);
  (void)snprintf(part, sizeof part, "; -cells %" PetscInt_FMT " -cell_width 1 -layout %.80s", one->cells,
                 request->write_layout);
  MpmTextJoin(text, request->write_layout[0] ? part : " (-write_layout FILE writes it)", room);
}

static void ReasonText(const MpmScene *s, const MpmRequest *request, const MpmNeighbourhood *one, size_t room,
                       char text[])
{
  const PetscInt dim = s->layout.dim;

  text[0] = '\0';
  if (one->why_not)
    (void)snprintf(text, room, "%s", one->why_not);
  else if (one->kind == MPM_AT_RANDOM)
    RandomText(s, request, one, room, text);
  else if (one->kind == MPM_AT_WORST)
    WorstText(request, one, room, text);
  else if (one->kind == MPM_DISORDERED)
    DisorderedText(s, one, room, text);
  else if (isinf(one->courant))
    (void)snprintf(text, room, "%s", "no Courant number is unstable");
  else if (one->kind != MPM_IN_BULK)
    StandsText(dim, one, room, text);
  else if (!isnan(one->beta[0]))
    MpmReportWave(dim, PETSC_FALSE, one->wave, one->beta, room, text);
}

static void NumberText(PetscReal value, const char infinite[], size_t room, char text[])
{
  if (isnan(value))
    (void)snprintf(text, room, "%s", "undecided");
  else if (isinf(value))
    (void)snprintf(text, room, "%s", infinite);
  else
    (void)snprintf(text, room, "%.6g", value);
}

/* Of the column of names. */
static int Width(const MpmRequest *request)
{
  return request->neighbourhood[MPM_DISORDERED] ? 10 : 8;
}

/* A line: the limit and the time step, or the growth; then the reason. */
static void PrintLine(const MpmScene *s, const MpmRequest *request, PetscBool limits, const MpmNeighbourhood *one)
{
  char number[24], reason[ROOM];

  MpmPrint("%-*s", Width(request), MpmNeighbourhoodNames[one->kind]);
  if (limits) {
    NumberText(one->courant, "none", sizeof number, number);
    MpmPrint(" %-11s", number);
    if (MpmSceneIsPhysical(s)) {
      NumberText(MpmSceneTimeStep(s, one->courant), "none", sizeof number, number);
      MpmPrint(" %-12s", number);
    }
  } else {
    NumberText(one->growth, "unbounded", sizeof number, number);
    MpmPrint(" %-11s", number);
  }
  ReasonText(s, request, one, sizeof reason, reason);
  MpmPrint("%s%s\n", reason[0] ? " " : "", reason);
}

const char *MpmNeighbourhoodSubject(MpmNeighbourhoodKind kind)
{
  static const char *const said[] = {[MPM_IN_BULK]    = "the bulk",
                                     [MPM_AT_EDGE]    = "an edge",
                                     [MPM_AT_CORNER]  = "a corner",
                                     [MPM_ALONE]      = "a lone particle",
                                     [MPM_AT_RANDOM]  = "a random layout with voids",
                                     [MPM_DISORDERED] = "a disordered layout",
                                     [MPM_AT_WORST]   = "the worst layout that was found"};

  return said[kind];
}

/*
   A limit of 0 is that of a place which particles may never come to. So the limit of the scene's own layout is said
   again.
*/
static void PrintAway(const MpmScene *s, const MpmNeighbourhoods *all)
{
  for (PetscInt i = 0; i < all->n; i++) {
    if (all->of[i].kind != MPM_IN_BULK || !(all->of[i].courant > 0) || isinf(all->of[i].courant)) continue;
    MpmPrint("in the scene's own layout the limit of the bulk holds: %.6g", all->of[i].courant);
    if (MpmSceneIsPhysical(s)) MpmPrint(", a time step of %.6g", MpmSceneTimeStep(s, all->of[i].courant));
    MpmPrint("; others may have a smaller one, even where no cell is empty\n");
  }
}

static void PrintLeast(const MpmScene *s, const MpmRequest *request, const MpmNeighbourhoods *all)
{
  const MpmNeighbourhood *least = all->least == MPM_NONE ? NULL : &all->of[all->least];
  char                    reason[ROOM];

  if (isnan(all->courant)) {
    MpmPrint("the worst of them: undecided");
    if (least) MpmPrint(", of those that are known %s has the least limit", MpmNeighbourhoodSubject(least->kind));
    MpmPrint("\n");
    return;
  }
  if (isinf(all->courant)) {
    MpmPrint("the worst of them: none limits the Courant number up to %.6g%s\n", MPM_CRITICAL_TO,
             MpmNeighbourhoodsHaveWindows(all) ? ", but for windows of growth" : "");
    return;
  }
  MpmPrint("the worst of them: %s limits the Courant number to %.6g", MpmNeighbourhoodSubject(least->kind),
           all->courant);
  if (MpmSceneIsPhysical(s)) MpmPrint(", the time step to %.6g", MpmSceneTimeStep(s, all->courant));
  ReasonText(s, request, least, sizeof reason, reason);
  MpmPrint(" (%s)%s\n", reason, MpmNeighbourhoodsHaveWindows(all) ? ", with windows of growth below it" : "");
  if (all->courant == 0) PrintAway(s, all);
}

static void PrintVerdict(const MpmScene *s, const MpmNeighbourhoods *all)
{
  const MpmFinding *f = &all->finding;

  MpmPrint("\nverdict: %s", MpmVerdictNames[f->verdict]);
  if (f->verdict == MPM_UNSTABLE && all->fastest != MPM_NONE) {
    MpmPrint(", at Courant number %.6g %s grows ", s->step.courant,
             MpmNeighbourhoodSubject(all->of[all->fastest].kind));
    if (isinf(f->growth))
      MpmPrint("without bound\n");
    else
      MpmPrint("by a factor of %.9g per step\n", f->growth);
  } else if (f->verdict == MPM_UNDECIDED)
    MpmPrint(", growth at Courant number %.6g is not known of all of them\n", s->step.courant);
  else
    MpmPrint(", none of them grows at Courant number %.6g beyond 1 + %.6g per step\n", s->step.courant, f->tolerance);
  MpmPrint("evidence: %s\n", f->evidence);
}

/* Growth is at the scene's own Courant number, which a critical in physical units need not have. */
static void Keep(json_t *result, const MpmScene *s, PetscBool limits, const MpmNeighbourhood *one)
{
  const PetscBool grows = !limits || MpmSceneHasStep(s) ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt  dim   = s->layout.dim;

  MpmResultKeep(result, "%g{critical_courant}", one->courant);
  if (MpmSceneIsPhysical(s)) MpmResultKeep(result, "%g{critical_dt}", MpmSceneTimeStep(s, one->courant));
  if (grows) MpmResultKeep(result, "%g{growth} %s{verdict}", one->growth, MpmVerdictNames[one->verdict]);
  if (Has(dim, one->place)) MpmResultNumbers(result, "place", dim, one->place);
  if (Has(dim, one->beta)) MpmResultNumbers(result, "limited_by_beta", dim, one->beta);
  if (one->kind != MPM_IN_BULK && !isnan(one->courant)) MpmResultKeep(result, "%d{approached?}", one->approached);
  if (one->why_not) MpmResultKeep(result, "%s{undecided}", one->why_not);
  if (one->layouts)
    MpmResultKeep(result, "%" PetscInt_FMT "{layouts} %" PetscInt64_FMT "{worst_seed}", one->layouts, one->worst_seed);
  if (!isnan(one->quantile[0]))
    MpmResultKeep(result, "%g{quantiles.5} %g{quantiles.50} %g{quantiles.95}", one->quantile[0], one->quantile[1],
                  one->quantile[2]);
  if (one->layouts && grows)
    MpmResultKeep(result, "%" PetscInt_FMT "{unstable} %g{share}", one->unstable,
                  (PetscReal)one->unstable / (PetscReal)one->layouts);
  MpmResultKeep(result, "%" PetscInt64_FMT "{evaluations} %g{seconds}", one->evaluations, one->seconds);
}

/* What xi means, where one of n lines has a place. */
static void PrintPlaces(PetscInt dim, PetscInt n, const MpmNeighbourhood of[])
{
  PetscInt i = 0;

  while (i < n && !Has(dim, of[i].place)) i++;
  if (i < n) MpmPrint("xi is the place in a cell, 0 on its left node and 1 on its right\n");
}

/* Whether the table of steps says all of it. */
static PetscBool IsInTable(const MpmNeighbourhood *one)
{
  return one->kind != MPM_AT_RANDOM && one->kind != MPM_AT_CORNER && !one->windows.looked ? PETSC_TRUE : PETSC_FALSE;
}

void MpmNeighbourhoodsReport(json_t *result, const MpmScene *s, const MpmRequest *request, PetscBool limits,
                             PetscBool table, const MpmNeighbourhoods *all)
{
  const PetscInt worst = !limits ? all->fastest : isnan(all->courant) ? MPM_NONE : all->least;
  PetscInt       lines = 0;

  for (PetscInt i = 0; i < all->n; i++) {
    const MpmNeighbourhood *one = &all->of[i];
    json_t                 *its = MpmResultIn(MpmResultIn(result, "neighbourhoods"), MpmNeighbourhoodNames[one->kind]);

    Keep(its, s, limits, one);
    if (table && IsInTable(one)) continue;
    if (!lines++)
      MpmPrint("\n%-*s %-11s%s reason\n", Width(request), "where", limits ? "limit" : "growth",
               limits && MpmSceneIsPhysical(s) ? " time step   " : "");
    PrintLine(s, request, limits, one);
    MpmReportWindows(its, Width(request) + 1, limits ? one->courant : 0, &one->windows);
  }
  if (worst != MPM_NONE)
    MpmResultPut(result, limits ? "limited_by_neighbourhood" : "worst_neighbourhood",
                 json_string(MpmNeighbourhoodNames[all->of[worst].kind]));
  if (!table) PrintPlaces(s->layout.dim, all->n, all->of);
  if (MpmSceneDrifts(s))
    MpmPrint(request->neighbourhood[MPM_IN_BULK]
                 ? "the bulk is under the scene's drift, the others are of particles at rest\n"
                 : "these are of particles at rest, whatever the scene's drift is\n");
  if (all->bound > 0) MpmResultKeep(result, "%g{any_layout}", all->bound);
  if (all->bound > 0 && !table)
    MpmPrint("no layout of such particles at rest grows up to the Courant number %.6g, so none is worse than that\n",
             all->bound);
  if (limits && !table) PrintLeast(s, request, all);
  if (MpmSceneHasStep(s) || !limits) PrintVerdict(s, all);
}

/* ---- the table of steps ---- */

static const char *const row_names[MPM_TABLE_ROWS] = {"lattice", "disordered", "edge", "lone", "worst"};

/* The layout of a row, and how its limit comes about. */
static void RowText(const MpmScene *s, const MpmRequest *request, const char lattice[], const MpmStepTable *t,
                    PetscInt i, size_t room, char text[])
{
  static const char *const layouts[MPM_TABLE_ROWS] = {"", "", "a half-space of the lattice, ", "one particle, ", ""};
  const MpmNeighbourhood  *row                     = &t->row[i];
  char                     reason[ROOM];

  ReasonText(s, request, row, sizeof reason, reason);
  if (t->left_out[i])
    (void)snprintf(text, room, "not computed, since it takes long%s: -neighbourhood %s",
                   s->scheme.formulation->quiet ? " with this formulation" : "", MpmNeighbourhoodNames[row->kind]);
  else if (row->kind == MPM_AT_WORST && !row->why_not && t->of != i)
    (void)snprintf(text, room, "%s; a short search came to %.4g, -neighbourhood worst searches longer",
                   row_names[t->of], row->courant);
  else if (row->kind == MPM_AT_WORST && !row->why_not)
    (void)snprintf(text, room, "found by a short search; -neighbourhood worst searches longer");
  else if (row->kind == MPM_IN_BULK)
    (void)snprintf(text, room, "%s%s%s", lattice + strlen("lattice, "), reason[0] ? ": " : "", reason);
  else
    (void)snprintf(text, room, "%s%s", row->why_not ? "" : layouts[i], reason);
}

/* A Courant number, in a scene with units a time step before it, and words. */
static void RowPrint(json_t *result, const MpmScene *s, const char name[], const char key[], PetscReal courant,
                     const char unknown[], const char text[])
{
  char number[24];

  MpmPrint("  %-11s", name);
  if (MpmSceneIsPhysical(s)) {
    NumberText(MpmSceneTimeStep(s, courant), "none", sizeof number, number);
    MpmPrint(" %-12s", isnan(courant) ? unknown : number);
    MpmResultKeep(result, "%g{dt}", MpmSceneTimeStep(s, courant));
  }
  NumberText(courant, "none", sizeof number, number);
  MpmPrint(" %-10s %s\n", isnan(courant) ? unknown : number, text);
  MpmResultKeep(result, "%g{courant}", courant);
  MpmResultPut(result, key, json_string(text));
}

/* Why a step is recommended, or none. */
static void AdviceText(const MpmStepTable *t, size_t room, char text[])
{
  if (t->never != MPM_NONE)
    (void)snprintf(text, room, "%s: there is growth at every Courant number", row_names[t->never]);
  else if (t->bound > 0)
    (void)snprintf(text, room, "at rest: the bound, proved for every layout of such particles");
  else if (t->least == MPM_NONE)
    (void)snprintf(text, room, "none of these layouts limits it");
  else
    (void)snprintf(text, room,
                   "of %s%s; no step is proved for all layouts at rest, and yours may have less: -layout FILE",
                   row_names[t->least], t->falls ? ", away from nodes" : "");
}

void MpmStepTableReport(json_t *result, const MpmScene *s, const MpmRequest *request, const char lattice[],
                        const MpmStepTable *t)
{
  char    text[2 * ROOM];
  json_t *row;

  MpmPrint("\nlargest stable steps by layout, particles at rest:\n  layout      %sc dt / h\n",
           MpmSceneIsPhysical(s) ? "dt           " : "");
  for (PetscInt i = 0; i < MPM_TABLE_ROWS; i++) {
    row = MpmResultNext(result, "layouts");
    MpmResultPut(row, "layout", json_string(row_names[i]));
    RowText(s, request, lattice, t, i, sizeof text, text);
    RowPrint(row, s, row_names[i], "how", t->limit[i], t->left_out[i] ? "-" : "undecided", text);
  }
  row = MpmResultNext(result, "layouts");
  MpmResultPut(row, "layout", json_string("bound"));
  RowPrint(row, s, "bound", "how", t->bound > 0 ? t->bound : NAN, "-",
           t->bound > 0 ? "proved: no layout of such particles grows up to it" : "none is known of all layouts");
  AdviceText(t, sizeof text, text);
  row = MpmResultIn(result, "recommended");
  RowPrint(row, s, t->bound > 0 || !isfinite(t->advised) ? "recommended" : "least found", "reason", t->advised, "none",
           text);
  if (!isnan(t->moving))
    MpmResultKeep(row, "%g{growth_when_drifting} %d{proved?}", t->moving, t->bound > 0 && t->never == MPM_NONE);
  if (t->moving > 1 + request->tolerance)
    MpmPrint(
        "  %-11s at this step the lattice grows by a factor of %.6g per step if it moves by 1/%d cell per step: it "
        "rings (docs/ringing.md)\n",
        "moving", t->moving, MPM_CRITICAL_DRIFT);
  PrintPlaces(s->layout.dim, MPM_TABLE_ROWS, t->row);
  if (t->falls)
    MpmPrint("limit 0: a particle without neighbours that comes close to a node gives it a force but almost no mass "
             "(chi = 0 "
             "on hats). Codes leave out nodes of little mass, use splines, or use musl\n");
}
