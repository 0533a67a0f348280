/*
   The limit of a patch.

   A momentum scheme at rest leaves the unit circle at -1: of usl with apic an eigenvector's nodal velocity w has

     G^2 - G (1 + f - s) + f = 0,    f = <w, F w> / <w, w>, s = <w, S w> / <w, w> = k^2 <w, K w> / <w, w>

   with F = P2G G2P and S = k^2 DIV STRESS GRAD symmetric in the nodal masses, 0 <= f <= 1 (docs/theory.md, section 4).
   This is stable iff s <= 2 (1 + f), with equality at G = -1, and so at all smaller k. Of usl with flip the same holds
   with 4 S^-1 >= 2 - P2G G2P. So the limit of a spot is the least k with an eigenvalue -1, one eigenvalue problem
   without a search. That this is the limit is then checked by growth at smaller and larger k. Where that does not bear
   it out, as for a gas, growth decides at a row of k and by bisection.
*/
#include "analysis/neighbourhood.h"
#include "analysis/search.h"
#include "analysis/patch_search.h"
#include "base/farm.h"
#include <math.h>

#define STEADY 1e-9 /* relative change of a limit with depth that is none */
#define DEEPEST 80  /* cells behind one surface */
#define DEEP_TWO 32 /* behind two */
#define MOVED 0.01  /* relative change with depth of a limit by rows that is no longer the same */
#define JUST 1e-3   /* relative distance from a limit at which growth is looked at */
#define CHECKS 240  /* the most spots of the grid at which growth is looked at */
#define AWAY 0.02   /* they are so far from the ends of their panels */
#define FEW 8       /* spots of the grid that are looked at for a limit of 0 */
#define FROM 1e-2   /* the least k of a row */
#define RATIO 1.25  /* of one to the next */
#define PRECISION 1e-7
#define NEARER 16   /* so many times nearer to a face a limit is looked at again */
#define FALLS 0.5   /* it goes to 0 if it is less than this then */
#define A_JUMP 1e-3 /* relative; from the margin of a panel to its end values that are continuous change less */
#define SAME 1e-6   /* relative difference of values that are the same but for rounding */
#define OF_OTHER_END                                                                                                   \
  1e-5 /* relative; so much less than that of waves inside is the limit of the other end's own mode */
#define SETS (1 << MPM_MAX_DIM)

/* What is sought on one lattice. slow: by rows of Courant numbers. */
typedef struct {
  MpmPatchLattice lattice;
  MpmPatchSearch  search;
  PetscBool       slow;
  PetscInt        surfaces, shallow;  /* shallow: the depth at which growth is looked at first */
  PetscReal       courant, tolerance; /* courant: at which growth is sought or checked */
  PetscReal       worst;              /* growth below a limit */
  PetscReal      *face;               /* values on faces, by spot of the grid */
} Patch;

/* Whether it is an edge in one dimension, where deep lattices cost little. */
static PetscBool OnBar(const Patch *p)
{
  return p->surfaces == 1 && p->lattice.plan->dim == 1 ? PETSC_TRUE : PETSC_FALSE;
}

/* ---- the limit and the growth of a spot ---- */

typedef struct {
  Patch              *patch;
  const MpmPatchSpot *spot;
} OneSpot;

/* Growth, or 1 where it is not more than rounding may make. */
static PetscErrorCode Visible(MpmPatchLattice *l, const MpmPatchSpot *spot, PetscReal courant, PetscReal *growth)
{
  PetscReal rounding;

  PetscFunctionBegin;
  PetscCall(MpmPatchGrowth(l, spot, courant, growth, &rounding));
  if (*growth <= 1 + rounding) *growth = PetscMin(*growth, 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GrowthOfSpot(void *context, PetscReal courant, PetscReal *growth)
{
  OneSpot *one = (OneSpot *)context;

  PetscFunctionBegin;
  PetscCall(Visible(&one->patch->lattice, one->spot, courant, growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LimitOfSpot(void *context, const MpmPatchSpot *spot, PetscReal *limit)
{
  const MpmSearchSteps steps = {.from = FROM, .to = MPM_CRITICAL_TO, .ratio = RATIO, .width = MPM_CRITICAL_TO};
  Patch               *p     = (Patch *)context;
  OneSpot              one   = {.patch = p, .spot = spot};
  MpmCritical          c     = {.threshold = PETSC_TRUE};
  PetscReal            bracket[2];

  PetscFunctionBegin;
  if (!p->slow) {
    PetscCall(MpmPatchCrossing(&p->lattice, spot, limit));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSearchFirst(GrowthOfSpot, &one, p->tolerance, &steps, PRECISION, bracket));
  c.stable_at   = bracket[0];
  c.unstable_at = bracket[1];
  *limit        = bracket[0];
  if (isfinite(bracket[1])) {
    PetscCall(MpmSearchThreshold(GrowthOfSpot, &one, p->tolerance, 0, &c));
    if (!c.threshold) *limit = 0;
  } else
    *limit = INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Largest growth is sought as the least of its negative. */
static PetscErrorCode MinusGrowth(void *context, const MpmPatchSpot *spot, PetscReal *value)
{
  Patch *p = (Patch *)context;

  PetscFunctionBegin;
  PetscCall(Visible(&p->lattice, spot, p->courant, value));
  *value = -*value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GrowthThere(void *context, const MpmPatchSpot *spot, PetscReal *growth)
{
  Patch *p = (Patch *)context;

  PetscFunctionBegin;
  PetscCall(Visible(&p->lattice, spot, p->courant, growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first rank computes a value and sends it to all. */
static PetscErrorCode Once(Patch *p, MpmPatchFunction f, const MpmPatchSpot *spot, PetscReal *value)
{
  PetscFunctionBegin;
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) PetscCall(f(p, spot, value));
  PetscCallMPI(MPI_Bcast(value, 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what is next to a face of a cell ---- */

/* Moves a place that the search has left at the margin of its panel: to so many times nearer, or with 0 to its end. */
static PetscReal Nearer(PetscReal t, PetscReal times)
{
  const PetscReal end = round(2 * t) / 2; /* panels are half a spacing */

  if (fabs(t - end) > MPM_PATCH_MARGIN) return t;
  return times > 0 ? end + (t - end) / times : end;
}

static PetscBool AtMargin(const MpmPatchLattice *l, const MpmPatchSpot *spot)
{
  for (PetscInt a = 0; a < l->plan->dim; a++)
    if (Nearer(spot->t[a], 0) != spot->t[a]) return PETSC_TRUE;
  return PETSC_FALSE;
}

static MpmPatchSpot Move(const MpmPatchLattice *l, const MpmPatchSpot *spot, PetscReal times)
{
  MpmPatchSpot near = *spot;

  for (PetscInt a = 0; a < l->plan->dim; a++) {
    near.t[a] = Nearer(spot->t[a], times);
    if (near.t[a] < 1) continue;
    near.t[a] = 0; /* the first place of the next spacing, or of the next cell */
    near.j[a] = (near.j[a] + 1) % l->of->layout->ppc[a];
  }
  return near;
}

/*
   A limit that was found next to the end of a panel: its limit there, from this side, and whether the end itself has
   it.
*/
static PetscErrorCode AtFace(Patch *p, const MpmPatchSpot *spot, PetscReal *limit, PetscBool *approached)
{
  const MpmPatchSpot near = Move(&p->lattice, spot, NEARER), end = Move(&p->lattice, spot, 0);
  PetscReal          nearer, there;

  PetscFunctionBegin;
  PetscCall(Once(p, LimitOfSpot, &near, &nearer));
  PetscCall(Once(p, LimitOfSpot, &end, &there));
  if (nearer < FALLS * *limit) {
    *limit      = 0;
    *approached = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *limit      = nearer + (nearer - *limit) / (NEARER - 1);
  *approached = fabs(there - *limit) > SAME * *limit ? PETSC_TRUE : PETSC_FALSE;
  if (!*approached) *limit = there;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A spot of the grid next to a face has one exactly on it, where a node may be without mass that had some. */
static PetscErrorCode FacePart(void *context, PetscInt i)
{
  Patch       *p = (Patch *)context;
  MpmPatchSpot spot;

  PetscFunctionBegin;
  p->face[i] = INFINITY;
  if (!MpmPatchGridSpot(&p->search, i, &spot) || !AtMargin(&p->lattice, &spot)) PetscFunctionReturn(PETSC_SUCCESS);
  spot = Move(&p->lattice, &spot, 0);
  PetscCall(p->search.f(p, &spot, &p->face[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least value over all places: the search's, which leaves faces out, or that of places exactly on faces. */
static PetscErrorCode Least(Patch *p, MpmPatchSpot *spot, PetscReal *value)
{
  const PetscInt size = MpmPatchGridSize(&p->search);
  MpmPatchSpot   face;
  PetscReal      least = INFINITY, there;
  PetscInt       at    = size;

  PetscFunctionBegin;
  PetscCall(MpmPatchLeast(&p->search, spot, value));
  p->lattice.depth = p->search.coarse;
  PetscCall(PetscCalloc1(size, &p->face));
  PetscCall(MpmFarm("place", size, FacePart, p));
  PetscCall(MpmFarmSumReals(size, p->face));
  for (PetscInt i = 0; i < size; i++) {
    if (!(p->face[i] < least)) continue;
    least = p->face[i];
    at    = i;
  }
  PetscCall(PetscFree(p->face));
  p->lattice.depth = p->search.fine;
  if (at == size) PetscFunctionReturn(PETSC_SUCCESS);
  (void)MpmPatchGridSpot(&p->search, at, &face);
  face = Move(&p->lattice, &face, 0);
  PetscCall(Once(p, p->search.f, &face, &there));
  if (there < *value - (isfinite(*value) ? A_JUMP * fabs(*value) : 0)) {
    *value = there;
    *spot  = face;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- whether the limit is one ---- */

static MpmPatchSpot Inner(const MpmPatchSpot *spot)
{
  MpmPatchSpot in = *spot;

  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) {
    const PetscReal low = floor(2 * in.t[a]) / 2;

    in.t[a] = PetscMin(PetscMax(in.t[a], low + AWAY), low + 0.5 - AWAY);
  }
  return in;
}

/* Growth at a Courant number. That of a shallow lattice may come of its other end: then deeper ones are looked at. */
static PetscErrorCode CheckAt(Patch *p, const MpmPatchSpot *spot, PetscReal courant)
{
  const PetscInt depth[] = {p->shallow, p->search.deep, OnBar(p) ? DEEPEST : p->search.deep};
  PetscReal      growth;

  PetscFunctionBegin;
  if (p->worst > 1 + p->tolerance) PetscFunctionReturn(PETSC_SUCCESS); /* it does not hold anyway */
  for (int i = 0; i < 3; i++) {
    p->lattice.depth = depth[i];
    PetscCall(Visible(&p->lattice, spot, courant, &growth));
    if (growth <= 1 + p->tolerance || p->surfaces == 0 || (i > 0 && depth[i] == depth[2])) break;
  }
  p->worst = PetscMax(p->worst, growth);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth just below the limit, and at one other Courant number below it, which differs from spot to spot. */
static PetscErrorCode CheckPart(void *context, PetscInt i)
{
  static const PetscReal shares[] = {0.9, 0.7, 0.5, 0.3, 0.1, 0.03};
  Patch                 *p        = (Patch *)context;
  const PetscInt         size = MpmPatchGridSize(&p->search), stride = PetscMax(1, size / CHECKS);
  const PetscReal        share = shares[i % (PetscInt)PETSC_STATIC_ARRAY_LENGTH(shares)];
  MpmPatchSpot           spot;

  PetscFunctionBegin;
  if (!MpmPatchGridSpot(&p->search, i * stride, &spot)) PetscFunctionReturn(PETSC_SUCCESS);
  spot = Inner(&spot);
  PetscCall(CheckAt(p, &spot, p->courant * (1 - JUST)));
  PetscCall(CheckAt(p, &spot, p->courant * share));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Whether growth is none below a limit, over the grid of spots, and some above it, at the worst spot if it is its own.
*/
static PetscErrorCode Check(Patch *p, const MpmPatchSpot *spot, PetscReal limit, PetscBool own, PetscBool *holds)
{
  const PetscInt size = MpmPatchGridSize(&p->search), n = size / PetscMax(1, size / CHECKS);
  PetscReal      below, above;

  PetscFunctionBegin;
  p->courant = limit;
  p->worst   = 0;
  PetscCall(MpmFarm("place", n, CheckPart, p));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &p->worst, 1, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  p->lattice.depth = p->search.deep;
  *holds           = p->worst <= 1 + p->tolerance ? PETSC_TRUE : PETSC_FALSE;
  if (!*holds || !own || AtMargin(&p->lattice, spot)) PetscFunctionReturn(PETSC_SUCCESS);
  p->courant = limit * (1 - JUST);
  PetscCall(Once(p, GrowthThere, spot, &below));
  p->courant = limit * (1 + JUST);
  PetscCall(Once(p, GrowthThere, spot, &above));
  *holds = below <= 1 + p->tolerance && above > 1 + p->tolerance ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- one lattice ---- */

/*
   Deepens the lattice until its limit moves no more. It need not come from above: see MpmPatchCluster. A limit by rows
   that is another one on a deep lattice is none.
*/
static PetscErrorCode Deepen(Patch *p, const MpmPatchSpot *spot, PetscReal *limit)
{
  const PetscInt  deepest = p->surfaces > 1 ? DEEP_TWO : DEEPEST;
  const PetscReal first   = *limit;

  PetscFunctionBegin;
  while (2 * p->lattice.depth <= deepest) {
    const PetscReal before = *limit;

    p->lattice.depth *= 2;
    PetscCall(Once(p, LimitOfSpot, spot, limit));
    if (!p->slow && fabs(*limit - before) <= STEADY * before) break;
  }
  if (p->slow && fabs(*limit - first) > MOVED * first) *limit = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the other end of the lattice has a mode of its own that is as bad, and worse than known. */
static PetscErrorCode OtherEnd(Patch *p, const MpmPatchSpot *spot, PetscReal known, PetscReal *limit)
{
  PetscReal other;

  PetscFunctionBegin;
  p->lattice.held = PETSC_TRUE;
  PetscCall(Once(p, LimitOfSpot, spot, &other));
  p->lattice.held = PETSC_FALSE;
  if (other < known * (1 - OF_OTHER_END) && other < *limit * (1 + JUST)) *limit = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The depths of a search. In one dimension deep lattices cost little. Where limits are sought by rows of Courant
   numbers they cost much.
*/
static void SetDepths(Patch *p)
{
  const PetscInt  n    = p->surfaces;
  const PetscBool bars = p->lattice.plan->dim == 1 && !p->slow ? PETSC_TRUE : PETSC_FALSE;

  p->shallow       = n == 2 ? 4 : bars ? 7 : 5;
  p->search.coarse = bars ? 12 : p->shallow;
  p->search.fine   = n == 2 ? 7 : bars ? 20 : 10;
  p->search.deep   = n == 2 ? 7 : bars ? 40 : p->slow ? 10 : 20;
}

/* Whether some spots of the grid have the limit 0: no limit is less. */
static PetscErrorCode FindNone(Patch *p, MpmPatchSpot *spot, PetscReal *limit)
{
  const PetscInt size = MpmPatchGridSize(&p->search), stride = PetscMax(1, size / FEW);

  PetscFunctionBegin;
  *limit = INFINITY;
  for (PetscInt i = 0; i < size; i += stride) {
    if (!MpmPatchGridSpot(&p->search, i, spot)) continue;
    for (p->lattice.depth = p->search.coarse;; p->lattice.depth = DEEP_TWO) {
      PetscCall(Once(p, LimitOfSpot, spot, limit));
      if (*limit > 0 || !OnBar(p) || p->lattice.depth == DEEP_TWO) break;
    }
    if (*limit == 0) break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The limit of a lattice. known: that of the lattices with fewer surfaces. */
static PetscErrorCode Find(Patch *p, PetscReal known, MpmPatchSpot *spot, PetscReal *limit, PetscBool *approached)
{
  PetscBool holds = PETSC_FALSE;

  PetscFunctionBegin;
  *approached = PETSC_FALSE;
  for (p->slow = PETSC_FALSE;; p->slow = PETSC_TRUE) {
    SetDepths(p);
    p->search.f       = LimitOfSpot;
    p->search.context = p;
    if (p->slow) PetscCall(FindNone(p, spot, limit));
    if (p->slow && *limit > 0 && p->lattice.plan->dim > (p->lattice.end[0] == MPM_PATCH_SINGLE ? 2 : 1))
      *limit = NAN; /* rows of Courant numbers would take minutes */
    if (p->slow && !(*limit > 0)) break;
    PetscCall(Least(p, spot, limit));
    if (p->slow) break;
    if (!isfinite(*limit)) continue;
    p->lattice.depth = p->search.deep;
    if (p->surfaces > 0) PetscCall(Once(p, LimitOfSpot, spot, limit));
    PetscCall(Check(p, spot, PetscMin(*limit, known), *limit <= known ? PETSC_TRUE : PETSC_FALSE, &holds));
    if (holds) break;
  }
  if (!isfinite(*limit) || (*limit == 0 && !(p->slow && OnBar(p)))) PetscFunctionReturn(PETSC_SUCCESS);
  p->lattice.depth = p->slow ? p->search.fine : p->search.deep;
  if (p->surfaces > 0) PetscCall(Deepen(p, spot, limit));
  if (p->surfaces > 0 && *limit < known) PetscCall(OtherEnd(p, spot, known, limit));
  if (!(*limit > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  if (AtMargin(&p->lattice, spot)) PetscCall(AtFace(p, spot, limit, approached));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Largest growth at the case's own Courant number. Beyond the limit it is sought over all spots, of which the best of a
   shallow lattice and that of the limit are looked at on a deep one.
*/
static PetscErrorCode Growth(Patch *p, PetscReal courant, PetscReal limit, const MpmPatchSpot *worst, PetscReal *growth)
{
  const PetscInt deep = p->slow && OnBar(p) ? DEEPEST : p->search.deep;
  MpmPatchSpot   spot = *worst, near;
  PetscReal      found, nearer;

  PetscFunctionBegin;
  p->courant       = courant;
  p->search.f      = MinusGrowth;
  p->lattice.depth = deep;
  *growth          = NAN;
  if (isnan(limit)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Once(p, GrowthThere, &spot, growth));
  if (courant <= limit) PetscFunctionReturn(PETSC_SUCCESS);
  p->search.coarse = p->search.fine = p->shallow;
  PetscCall(Least(p, &spot, &found));
  p->lattice.depth = deep;
  PetscCall(Once(p, GrowthThere, &spot, &found));
  *growth = PetscMax(*growth, found);
  if (AtMargin(&p->lattice, &spot)) {
    near = Move(&p->lattice, &spot, NEARER);
    PetscCall(Once(p, GrowthThere, &near, &nearer));
    *growth = nearer > *growth / FALLS ? INFINITY : PetscMax(*growth, nearer);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- kinds ---- */

static PetscBool Alike(const MpmLayout *layout)
{
  for (PetscInt a = 1; a < layout->dim; a++)
    if (layout->ppc[a] != layout->ppc[0] || layout->half_width[a] != layout->half_width[0]) return PETSC_FALSE;
  return PETSC_TRUE;
}

static PetscInt Bits(PetscInt set)
{
  PetscInt n = 0;

  for (; set; set >>= 1) n += set & 1;
  return n;
}

/* Keeps the limit of a lattice if it is less than what is known. */
static void Keep(const Patch *p, const MpmPatchSpot *spot, PetscReal limit, PetscBool approached, PetscBool inside,
                 MpmNeighbourhood *out)
{
  const MpmLayout *layout = p->lattice.of->layout;

  if (limit >= out->courant * (1 - STEADY) || isnan(out->courant)) return;
  out->courant    = limit;
  out->approached = approached;
  out->inside     = inside;
  for (PetscInt a = 0; a < layout->dim; a++) {
    out->place[a] = ((PetscReal)spot->j[a] + Nearer(spot->t[a], 0)) / (PetscReal)layout->ppc[a];
    out->beta[a]  = p->lattice.end[a] == MPM_PATCH_ENDLESS ? spot->beta[a] : NAN;
  }
}

/* The worst spot of each lattice with fewer surfaces, by the set of its surfaces. */
typedef struct {
  MpmPatchSpot worst[SETS];
  PetscBool    known[SETS];
} Fewer;

/*
   A mode that fades slowly is nearly a wave of the lattice with one surface less. So it has that wave's place in a
   spacing, or by reflection the one opposite. In which particle the surface cuts the lattice is open.
*/
static void StartFrom(const Fewer *fewer, PetscInt set, MpmPatchSearch *search)
{
  for (PetscInt a = 0; a < search->lattice->plan->dim; a++)
    for (PetscInt i = 0; i < 2 * search->lattice->of->layout->ppc[a]; i++) {
      const PetscInt parent = set & ~(1 << a);
      MpmPatchSpot   spot   = fewer->worst[parent];

      if (parent == set || !fewer->known[parent] || search->nmore == MPM_PATCH_MORE) continue;
      spot.j[a] = i / 2;
      if (i % 2) spot.t[a] = 1 - spot.t[a];
      search->more[search->nmore++] = spot;
    }
}

/* The limit of the lattice that has ends in the directions of a set of bits. */
static PetscErrorCode FindEnds(const MpmCriticalCase *of, const MpmNodalPlan *plan, MpmPatchEnd end, PetscInt set,
                               PetscInt wanted, Fewer *fewer, MpmNeighbourhood *out)
{
  Patch        p = {.lattice = {.of = of, .plan = plan}, .tolerance = of->tolerance};
  PetscBool    approached;
  MpmPatchSpot spot;
  PetscReal    limit, growth;
  PetscInt64   count;

  PetscFunctionBegin;
  p.search = (MpmPatchSearch){.lattice = &p.lattice, .alike = Alike(of->layout)};
  for (PetscInt a = 0; a < plan->dim; a++) p.lattice.end[a] = set >> a & 1 ? end : MPM_PATCH_ENDLESS;
  p.surfaces = end == MPM_PATCH_SINGLE ? 0 : Bits(set);
  if (p.surfaces > 0) StartFrom(fewer, set, &p.search);
  PetscCall(Find(&p, out->courant, &spot, &limit, &approached));
  if (Bits(set) == wanted) {
    out->places += MpmPatchGridSize(&p.search);
    out->depth = p.search.deep;
  }
  fewer->worst[set] = spot;
  fewer->known[set] = isfinite(limit);
  Keep(&p, &spot, limit, approached, Bits(set) < wanted ? PETSC_TRUE : PETSC_FALSE, out);
  if (Bits(set) == wanted || !(limit > 0)) {
    PetscCall(Growth(&p, of->step.courant, limit, &spot, &growth));
    out->growth = isnan(growth) ? growth : PetscMax(out->growth, growth);
  }
  count = p.lattice.count;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPIU_INT64, MPI_SUM, PETSC_COMM_WORLD));
  out->evaluations += count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPatchFind(const MpmCriticalCase *of, MpmNeighbourhoodKind kind, MpmNeighbourhood *out)
{
  const PetscInt dim = of->layout->dim, all = (1 << dim) - 1;
  const PetscInt wanted = kind == MPM_ALONE ? dim : PetscMin(dim, kind == MPM_AT_CORNER ? 2 : 1);
  MpmNodalPlan  *plan;
  Fewer          fewer = {.known = {PETSC_FALSE}};

  PetscFunctionBegin;
  MpmCheckInput(!MpmTableSolves(of->scheme->table),
                "transfer %s: limits of edges, corners and lone particles are not known for a transfer that solves for "
                "the values of nodes; allowed: all others",
                of->scheme->transfer->name);
  *out         = MpmNeighbourhoodOf(kind);
  out->courant = INFINITY;
  out->growth  = 0;
  PetscCall(MpmNodalPlanCreate(of->scheme->table, NULL, &plan));
  if (kind == MPM_ALONE)
    PetscCall(FindEnds(of, plan, MPM_PATCH_SINGLE, all, wanted, &fewer, out));
  else
    for (PetscInt n = 0; n <= wanted && out->courant > 0; n++) /* no limit is less than 0 */
      for (PetscInt set = 0; set <= all; set++) {
        if (Bits(set) != n) continue;
        PetscCall(FindEnds(of, plan, MPM_PATCH_SURFACE, set, wanted, &fewer, out));
        if (Alike(of->layout)) break;
      }
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}
