/* The closed forms of the formulations, at the phases beta = 2 pi m / cells of a grid. */
#include "linalg/small_eigen.h"
#include "scene/layout.h"
#include "symbol/predict.h"
#include <math.h>

/* With more phases than this in a direction the maximum has the same digits, but for the last in more dimensions. */
static const PetscInt MOST_PHASES[MPM_MAX_DIM] = {65536, 1024, 128};

/*
   Closed form and symbol agree to this, relative to growth. A defective pair has an error of 1e-8. In more dimensions a
   gas may have a defective triple at 1, with an error of 1e-5: where m.m is 0 and m is not (docs/theory.md, section 4).
*/
#define AGREE 1e-6
#define AGREE_IN_SPACE 1e-4
#define NOTHING 1e-24 /* rounding alone may make a symbol of P2G G2P this large */
#define REAL 1e-12    /* the largest imaginary part of theta that is rounding */

/*
   Along - the symbols of the maps along one direction, at a phase of that direction.

   alpha, kappa, mu, lap - those of MpmCellSymbols in one dimension
   chi   - the symbol of CURVE G2P, where particles are displaced and the slopes of the basis have slopes
   nu    - the symbol of P2G GRAD with the slopes of the basis; mu has those of the gradient
   theta - the symbol of P2G_AFFINE and the table's affine map after one another; it must be a real number (why_not)
*/
typedef struct {
  PetscReal      alpha, kappa, lap;
  double complex mu, nu, theta, chi;
} Along;

static const char *WhyNot(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts)
{
  if (drifts) return "the formulas are for particles at rest";
  if (!MpmLayoutIsPeriodic(layout)) return "the formulas are for a periodic domain";
  if (!MpmLayoutIsUniform(layout)) return "the formulas are for cells that are all alike";
  if (!scheme->transfer->filter_symbol) return "no closed form for this transfer";
  if (!MpmSpaceIsDamped(&scheme->space)) return NULL;
  if (scheme->space.local != 0) return "local damping is not linear";
  if (MpmSpaceIsPrestressed(&scheme->space))
    return "no closed form with damping or viscosity about a prestressed state";
  if (layout->dim > 1 && scheme->space.viscous[1] + scheme->space.viscous[0] != 0 && !scheme->space.proportional)
    return "no closed form with more than one dimension and a viscosity that is not in proportion to the stiffness";
  return NULL;
}

static const char *WhyNotPublished(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts)
{
  if (!scheme->formulation->published) return "the slides do not treat this formulation";
  if (layout->dim > 1) return "the slides treat one dimension";
  if (!scheme->basis->hat) return "the slides treat the linear basis";
  if (scheme->transfer->filter) return "the slides treat flip";
  return WhyNot(layout, scheme, drifts);
}

const char *MpmPredictionText(const MpmScheme *scheme)
{
  if (MpmSpaceIsDamped(&scheme->space)) return "with damping: docs/theory.md, section 13";
  return MpmSpaceIsPrestressed(&scheme->space) ? "with a prestress: docs/theory.md, section 9"
                                               : scheme->formulation->corrected_text;
}

/* The kind of a map with the weights of the space's gradient. */
static MpmOpKind Fitted(const MpmScheme *scheme, MpmOpKind kind)
{
  if (scheme->space.gradient != MPM_GRADIENT_MLS) return kind;
  return kind == MPM_GRAD ? MPM_GRAD_MLS : MPM_CURVE_MLS;
}

/* Whether displaced particles make forces by the second derivatives along one direction. */
static PetscBool IsCurved(const MpmScheme *scheme)
{
  return scheme->space.displaced && scheme->space.curved ? PETSC_TRUE : PETSC_FALSE;
}

/* Whether they make forces by those along two directions. */
static PetscBool HasSlopes(const MpmScheme *scheme)
{
  return scheme->space.displaced && scheme->space.dim > 1 ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool HasStress(const MpmPredictor *p)
{
  return MpmFormulationHas(p->scheme->formulation, MPM_DIV);
}

/* A stress of as many numbers as its particles have resists as many motions at most. */
static PetscInt Problems(const MpmPredictor *p)
{
  const PetscInt dim = p->layout->dim, numbers = MpmSpaceIsFluid(&p->scheme->space) ? 1 : dim * (dim + 1) / 2;

  if (dim > 1 && MpmSpaceIsPrestressed(&p->scheme->space)) return dim;
  return HasStress(p) ? PetscMin(dim, numbers * MpmLayoutPpc(p->layout)) : 1;
}

/* The symbols along the directions can be kept, and taken together for many phases. */
static Along AlongOf(const MpmPredictor *p, PetscInt axis, PetscReal beta)
{
  const MpmTies *ties  = &p->ties[axis];
  Along          along = {.lap = 4 * PetscSqr(sin(beta / 2))};
  double complex wave[MPM_MOST_SEEN];

  MpmTiesWave(ties, beta, wave);
  for (PetscInt j = 0; j < ties->n; j++) {
    const double complex value = MpmTie(ties, p->at, MPM_P2G, j, wave);
    const double complex slope = MpmTie(ties, p->at, Fitted(p->scheme, MPM_GRAD), j, wave);

    along.alpha += creal(conj(value) * value) / ties->n;
    along.kappa += creal(conj(slope) * slope) / ties->n;
    along.mu += conj(value) * slope / ties->n;
    if (IsCurved(p->scheme))
      along.chi += conj(MpmTie(ties, p->at, Fitted(p->scheme, MPM_CURVE), j, wave)) * value / ties->n;
    if (HasSlopes(p->scheme)) along.nu += conj(value) * MpmTie(ties, p->at, MPM_GRAD, j, wave) / ties->n;
    if (p->scheme->table->affine != MPM_NONE)
      along.theta += conj(MpmTie(ties, p->at, MPM_P2G_AFFINE, j, wave)) *
                     MpmTie(ties, p->at, p->scheme->table->affine_map, j, wave) / ties->n;
  }
  if (along.alpha < NOTHING) along.alpha = 0;
  return along;
}

static void AllAlong(const MpmPredictor *p, const PetscReal beta[], Along along[MPM_MAX_DIM])
{
  for (PetscInt a = 0; a < p->layout->dim; a++) along[a] = AlongOf(p, a, beta[a]);
}

/*
   With an affine part that is not a fit, theta is a real number where the particles of a cell are their own mirror
   image. A sum of few waves that is real at three phases is real at all.
*/
static PetscBool ThetaIsReal(const MpmPredictor *p)
{
  for (PetscInt a = 0; a < p->layout->dim; a++)
    for (int beta = 1; beta <= 3; beta++)
      if (fabs(cimag(AlongOf(p, a, beta).theta)) > REAL) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Whether the closed form asks for the sum of kappa and chi alone. In more dimensions these are matrices. */
static PetscBool HasSum(const MpmScheme *scheme)
{
  return scheme->formulation->corrected && (scheme->formulation->sums_chi || scheme->space.move == MPM_MOVES_PROJECTED)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

PetscErrorCode MpmPredictorCreate(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts,
                                  const MpmFraction frozen[], MpmPredictor *p)
{
  const MpmFraction rest[MPM_MAX_DIM] = {{.den = 1}, {.den = 1}, {.den = 1}}, *drift = frozen ? frozen : rest;
  PetscBool         used[MPM_OP_KINDS] = {PETSC_FALSE};
  PetscReal         mean               = 0;

  PetscFunctionBegin;
  *p                   = (MpmPredictor){.layout            = layout,
                                        .scheme            = scheme,
                                        .why_not           = WhyNot(layout, scheme, drifts),
                                        .why_not_published = WhyNotPublished(layout, scheme, drifts)};
  p->why_not_corrected = scheme->formulation->corrected ? p->why_not : "the formulation has no closed form";
  if (layout->dim > 1 && MpmSpaceIsPrestressed(&scheme->space))
    p->why_not_corrected = HasSum(scheme) ? p->why_not
                                          : "with a prestress in more dimensions usl has one, and others with move "
                                            "projected";
  if (p->why_not) PetscFunctionReturn(PETSC_SUCCESS);
  p->problems                    = Problems(p);
  used[MPM_P2G]                  = PETSC_TRUE;
  used[Fitted(scheme, MPM_GRAD)] = PETSC_TRUE;
  if (IsCurved(scheme)) used[Fitted(scheme, MPM_CURVE)] = PETSC_TRUE;
  if (HasSlopes(scheme)) used[MPM_GRAD] = PETSC_TRUE;
  if (scheme->table->affine != MPM_NONE) used[MPM_P2G_AFFINE] = used[scheme->table->affine_map] = PETSC_TRUE;
  for (PetscInt a = 0; a < layout->dim; a++) PetscCall(MpmTiesCreate(layout, scheme, a, &drift[a], used, &p->ties[a]));
  for (PetscInt j = 0; j < layout->ppc[0]; j++) {
    PetscInt  cell[MPM_MAX_DIM];
    PetscReal xi[MPM_MAX_DIM];

    MpmLayoutPlace(layout, j, cell, xi);
    mean += xi[0] / layout->ppc[0];
  }
  p->e = 2 * mean - 1;
  if (scheme->table->affine != MPM_NONE && !ThetaIsReal(p)) {
    p->why_not = "no closed form for this transfer where particles are not their own mirror image in a cell";
    if (!p->why_not_corrected) p->why_not_corrected = p->why_not;
    if (!p->why_not_published) p->why_not_published = p->why_not;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPredictorDestroy(MpmPredictor *p)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < p->layout->dim; a++) PetscCall(MpmTiesDestroy(&p->ties[a]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The product of alpha over the directions but a and b. */
static PetscReal Others(const MpmPredictor *p, const Along along[], PetscInt a, PetscInt b)
{
  PetscReal product = 1;

  for (PetscInt c = 0; c < p->layout->dim; c++)
    if (c != a && c != b) product *= along[c].alpha;
  return product;
}

/* The mean over a cell's particles of conj(symbol of DIV along a) times that of GRAD along b. */
static double complex Slopes(const MpmPredictor *p, const Along along[], PetscInt a, PetscInt b)
{
  return Others(p, along, a, b) * (a == b ? along[a].kappa : conj(along[a].mu) * along[b].mu);
}

/* The same of CURVE along a and b and of G2P. */
static double complex Curves(const MpmPredictor *p, const Along along[], PetscInt a, PetscInt b)
{
  return Others(p, along, a, b) * (a == b ? along[a].chi : conj(along[a].mu) * conj(along[b].nu));
}

/*
   K, the symbol of DIV STRESS GRAD + sigma0 CURVE G2P: the forces of strains, and with a prestress of displacements.
   Source: docs/theory.md, section 9.
*/
static void Forces(const MpmPredictor *p, const Along along[], double complex K[MPM_MAX_DIM][MPM_MAX_DIM])
{
  const PetscInt  dim   = p->layout->dim;
  const MpmSpace *space = &p->scheme->space;

  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt c = 0; c < dim; c++) {
      K[a][c] = 0;
      for (PetscInt b = 0; b < dim; b++) {
        for (PetscInt d = 0; d < dim; d++) {
          const PetscReal tangent = MpmSpaceTangent(space, a, b, c, d);

          if (tangent != 0) K[a][c] += tangent * Slopes(p, along, b, d);
        }
        if (HasSlopes(p->scheme)) K[a][c] += MpmSpacePrestress(space, a, b) * Curves(p, along, b, c);
      }
    }
}

/* The eigenvalues and vectors of K without a prestress. In one dimension K is kappa, whatever Poisson's ratio is. */
static void Stiffness(const MpmPredictor *p, const Along along[], PetscReal kappa[MPM_MAX_DIM],
                      double complex vector[MPM_MAX_DIM][MPM_MAX_DIM])
{
  double complex K[MPM_MAX_DIM][MPM_MAX_DIM];

  kappa[0]     = along[0].kappa;
  vector[0][0] = 1;
  if (p->layout->dim == 1) return;
  Forces(p, along, K);
  MpmHermitianSolve(p->layout->dim, K, kappa, vector);
}

/* The eigenvalues of K with a prestress, in more dimensions. */
static PetscBool Prestressed(const MpmPredictor *p, const Along along[], double complex value[MPM_MAX_DIM])
{
  const PetscInt dim = p->layout->dim;
  double complex K[MPM_MAX_DIM][MPM_MAX_DIM], columns[MPM_MAX_DIM * MPM_MAX_DIM];
  PetscBool      ok;

  Forces(p, along, K);
  for (PetscInt i = 0; i < dim * dim; i++) columns[i] = K[i % dim][i / dim];
  MpmSmallQr(dim, columns, value, &ok);
  return ok;
}

/* A motion that particles do not resist has a kappa of 0, of which rounding may make a little less. */
static PetscInt Together(const MpmPredictor *p, const Along along[], MpmCellSymbols cell[MPM_MAX_DIM])
{
  const PetscInt  dim   = p->layout->dim;
  const MpmSpace *space = &p->scheme->space;
  MpmCellSymbols  all   = {
         .alpha = Others(p, along, MPM_NONE, MPM_NONE), .transfer = p->scheme->transfer, .numbers = &p->scheme->numbers};
  PetscReal      kappa[MPM_MAX_DIM], sharp = 1;
  double complex vector[MPM_MAX_DIM][MPM_MAX_DIM], sums[MPM_MAX_DIM], square = 0;

  for (PetscInt a = 0; a < dim; a++) {
    const double complex m = along[a].mu * Others(p, along, a, a);

    square += m * m;
    all.mu = m;
    all.lap += along[a].lap;
  }
  if (dim > 1) all.mu = csqrt(square);
  if (p->scheme->table->affine != MPM_NONE)
    for (PetscInt a = 0; a < dim; a++) all.alpha += creal(along[a].theta) * Others(p, along, a, a);
  all.filter = p->scheme->transfer->filter_symbol(&p->scheme->numbers, all.alpha);
  all.taken  = p->scheme->space.filter == MPM_FILTERS_BEFORE ? all.filter : 1;
  if (p->scheme->transfer->sharp_symbol) sharp = p->scheme->transfer->sharp_symbol(&p->scheme->numbers, all.alpha);
  all.alpha *= sharp;
  all.mu *= sharp;
  if (dim > 1 && MpmSpaceIsPrestressed(space)) {
    PetscCheckAbort(Prestressed(p, along, sums), PETSC_COMM_SELF, PETSC_ERR_CONV_FAILED, "QR steps of a small matrix");
    for (PetscInt i = 0; i < dim; i++) {
      cell[i]           = all;
      cell[i].chi       = sharp * sums[i];
      cell[i].projected = space->move == MPM_MOVES_PROJECTED ? PETSC_TRUE : PETSC_FALSE;
    }
    return dim;
  }
  if (HasStress(p)) Stiffness(p, along, kappa, vector);
  for (PetscInt i = 0; i < p->problems; i++) {
    cell[i]       = all;
    cell[i].stiff = HasStress(p) ? fmax(0, kappa[i]) : along[0].kappa;
    cell[i].plain = cell[i].kappa = sharp * cell[i].stiff;
    cell[i].drag                  = MpmSpaceDrag(space, cell[i].plain);
    if (!MpmSpaceIsPrestressed(space)) continue;
    cell[i].kappa *= 1 + space->prestress[0];
    cell[i].chi       = sharp * space->prestress[0] * along[0].chi;
    cell[i].projected = space->move == MPM_MOVES_PROJECTED ? PETSC_TRUE : PETSC_FALSE;
  }
  return p->problems;
}

PetscInt MpmPredictorSymbols(const MpmPredictor *p, const PetscReal beta[], MpmCellSymbols cell[MPM_MAX_DIM])
{
  Along along[MPM_MAX_DIM];

  AllAlong(p, beta, along);
  return Together(p, along, cell);
}

void MpmPredictorPolarisation(const MpmPredictor *p, const PetscReal beta[], PetscInt i, double complex vector[])
{
  Along          along[MPM_MAX_DIM] = {{0}};
  PetscReal      kappa[MPM_MAX_DIM];
  double complex vectors[MPM_MAX_DIM][MPM_MAX_DIM];

  AllAlong(p, beta, along);
  Stiffness(p, along, kappa, vectors);
  for (PetscInt a = 0; a < p->layout->dim; a++) vector[a] = vectors[i][a];
}

PetscReal MpmPredictorPublished(const MpmPredictor *p, PetscReal courant, const PetscReal beta[])
{
  return p->why_not_published ? NAN : p->scheme->formulation->published(courant, beta[0]);
}

/* The largest abs(G) of the problems, and of motions without resistance, with given symbols along the directions. */
static PetscReal Largest(const MpmPredictor *p, PetscReal courant, const Along along[])
{
  MpmCellSymbols cell[MPM_MAX_DIM];
  const PetscInt n       = Together(p, along, cell);
  PetscReal      largest = p->scheme->formulation->corrected(&cell[0], courant);

  for (PetscInt i = 1; i < n; i++) largest = fmax(largest, p->scheme->formulation->corrected(&cell[i], courant));
  return HasStress(p) && n < p->layout->dim ? fmax(largest, fabs(cell[0].filter)) : largest;
}

PetscReal MpmPredictorCorrected(const MpmPredictor *p, PetscReal courant, const PetscReal beta[])
{
  Along along[MPM_MAX_DIM];

  if (p->why_not_corrected) return NAN;
  AllAlong(p, beta, along);
  return Largest(p, courant, along);
}

/* The numbers of phases of a scene's grid, and their product. */
static PetscInt Phases(const MpmLayout *layout, PetscInt phases[MPM_MAX_DIM])
{
  PetscInt all = 1;

  for (PetscInt a = 0; a < layout->dim; a++) {
    phases[a] = PetscMin(layout->grid[a].cells, MOST_PHASES[layout->dim - 1]);
    all *= phases[a];
  }
  return all;
}

/* The largest of the corrected formula over the phases of a grid. The symbols along the directions are made once. */
static PetscErrorCode LargestOfAll(const MpmPredictor *p, PetscReal courant, PetscReal *largest)
{
  PetscInt       phases[MPM_MAX_DIM];
  const PetscInt all = Phases(p->layout, phases), dim = p->layout->dim;
  Along         *along[MPM_MAX_DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++) {
    PetscCall(PetscMalloc1(phases[a], &along[a]));
    for (PetscInt m = 0; m < phases[a]; m++) along[a][m] = AlongOf(p, a, MpmSymbolPhase(m, phases[a]));
  }
  for (PetscInt m = 0; m < all; m++) {
    Along at[MPM_MAX_DIM];

    for (PetscInt a = 0, rest = m; a < dim; a++, rest /= phases[a - 1]) at[a] = along[a][rest % phases[a]];
    *largest = fmax(*largest, Largest(p, courant, at));
  }
  for (PetscInt a = 0; a < dim; a++) PetscCall(PetscFree(along[a]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The corrected formula for the problem whose nodal velocity is nearest to the velocity of the scene's mode. */
static PetscReal CorrectedMode(const MpmPredictor *p, const MpmScene *scene, const PetscReal beta[])
{
  const MpmProfile profile = MpmSceneProfile(scene, 1);
  MpmCellSymbols   cell[MPM_MAX_DIM];
  PetscReal        most    = -1;
  PetscInt         nearest = 0;

  if (p->why_not_corrected || !MpmSceneHasPoisson(scene)) return MpmPredictorCorrected(p, scene->step.courant, beta);
  (void)MpmPredictorSymbols(p, beta, cell);
  for (PetscInt i = 0; i < p->problems; i++) {
    double complex vector[MPM_MAX_DIM], along = 0;

    MpmPredictorPolarisation(p, beta, i, vector);
    for (PetscInt a = 0; a < scene->layout.dim; a++) along += profile.wave[0].direction[a] * vector[a];
    if (cabs(along) > most) {
      most    = cabs(along);
      nearest = i;
    }
  }
  return scene->scheme.formulation->corrected(&cell[nearest], scene->step.courant);
}

PetscErrorCode MpmPredict(const MpmScene *scene, MpmPredictions *predictions)
{
  const MpmLayout *layout = &scene->layout;
  MpmPredictor     predictor;
  PetscReal        beta[MPM_MAX_DIM];
  PetscInt         phases[MPM_MAX_DIM];

  PetscFunctionBegin;
  *predictions = (MpmPredictions){.published = NAN, .corrected = NAN, .corrected_mode = NAN};
  PetscCall(MpmPredictorCreate(layout, &scene->scheme, MpmSceneDrifts(scene), NULL, &predictor));
  for (PetscInt m = 0; !predictor.why_not_published && m < Phases(layout, phases); m++) {
    beta[0]                = MpmSymbolPhase(m, phases[0]);
    predictions->published = fmax(predictions->published, MpmPredictorPublished(&predictor, scene->step.courant, beta));
  }
  if (!predictor.why_not_corrected) PetscCall(LargestOfAll(&predictor, scene->step.courant, &predictions->corrected));
  for (PetscInt a = 0; a < layout->dim; a++) beta[a] = MpmSymbolPhase(scene->mode[a], layout->grid[a].cells);
  if (scene->initial == MPM_INITIAL_MODE && MpmSceneIsPeriodic(scene))
    predictions->corrected_mode = CorrectedMode(&predictor, scene, beta);
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A distance and the phase where it is. */
typedef struct {
  PetscReal distance, beta[MPM_MAX_DIM];
} Wide;

/* Keeps the larger of two distances. Of equal ones, but for rounding, it keeps the first. */
static void Widest(const Wide *one, Wide *widest)
{
  if (!isnan(one->distance) && one->distance > widest->distance + 1e-12) *widest = *one;
}

PetscErrorCode MpmPredictCompare(MPI_Comm comm, const MpmPredictor *p, const MpmSymbol *s, MpmComparison *comparison)
{
  const PetscInt width   = 2 * sizeof(Wide) / sizeof(PetscReal);
  Wide           mine[2] = {{-1, {NAN, NAN, NAN}}, {-1, {NAN, NAN, NAN}}}, one, *all;
  PetscMPIInt    size;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->count && s->without_null; i++) {
    MpmSymbolBeta(s, MpmSymbolPhaseOfClass(s, s->first + i), one.beta);
    one.distance = fabs(MpmPredictorPublished(p, s->step.courant, one.beta) - s->without_null[i]);
    Widest(&one, &mine[0]);
    one.distance = fabs(MpmPredictorCorrected(p, s->step.courant, one.beta) - s->without_null[i]);
    Widest(&one, &mine[1]);
  }
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(2 * size, &all));
  PetscCallMPI(MPI_Allgather(mine, width, MPIU_REAL, all, width, MPIU_REAL, comm));
  for (PetscMPIInt r = 0; r < size; r++)
    for (int of = 0; of < 2; of++) Widest(&all[2 * r + of], &mine[of]);
  PetscCall(PetscFree(all));
  *comparison = (MpmComparison){.published      = mine[0].distance < 0 ? NAN : mine[0].distance,
                                .published_beta = mine[0].beta[0],
                                .corrected      = mine[1].distance < 0 ? NAN : mine[1].distance,
                                .allowed        = s->dim > 1 ? AGREE_IN_SPACE : AGREE};
  PetscCall(PetscArraycpy(comparison->corrected_beta, mine[1].beta, MPM_MAX_DIM));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmPredictDisagrees(const MpmComparison *comparison, PetscReal growth)
{
  return comparison->corrected > comparison->allowed * PetscMax(1, growth) ? PETSC_TRUE : PETSC_FALSE;
}
