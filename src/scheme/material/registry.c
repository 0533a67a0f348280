/*
   The list of the laws, and what a material does, of one law or of several.

   Several materials in one run: runs of particles of one material go through its law. The last internal variable of a
   particle is the number of its material. So it goes wherever the particle goes, to other ranks and into files, and
   needs nothing of its own.
*/
#include "scheme/material/laws.h"
#include "scheme/material/plastic.h"
#include <math.h>
#include <string.h>

const MpmLaw *const MpmLaws[] = {&MpmLawLinear,          &MpmLawNeo,   &MpmLawSvk,  &MpmLawTait, &MpmLawGas,
                                 &MpmLawPolytropic,      &MpmLawMises, &MpmLawSnow, &MpmLawSand, &MpmLawClay,
                                 &MpmLawHerschelBulkley, NULL};

void MpmMaterialStress(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, const PetscReal *const F[],
                       PetscReal *const tau[])
{
  material->law->stress(material, dim, n, F, tau);
}

void MpmMaterialTangent(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, const PetscReal *const F[],
                        const PetscReal *const dF[], PetscReal *const dtau[])
{
  material->law->tangent(material, dim, n, F, dF, dtau);
}

void MpmMaterialEnergy(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, const PetscReal *const F[],
                       PetscReal psi[])
{
  material->law->energy(material, dim, n, F, psi);
}

PetscInt MpmMaterialComponents(const MpmMaterialNumbers *material, PetscInt dim)
{
  const MpmMaterials *all = material->several;

  return all ? dim * dim + all->ninternal + (all->outside && dim < 3) + 1 : MpmLawComponents(material->law, dim);
}

const char *MpmMaterialInternal(const MpmMaterialNumbers *material, PetscInt dim, PetscInt i, PetscReal *start)
{
  const MpmMaterials *all = material->several;
  const MpmLaw       *law = !all ? material->law : i < all->ninternal ? all->internal[i] : NULL;
  const PetscBool     own = law && law->plastic->internal && (all || i == 0) ? PETSC_TRUE : PETSC_FALSE;

  *start = own ? law->plastic->start : 0;
  if (all && i == MpmMaterialComponents(material, dim) - dim * dim - 1) return "material";
  return own ? law->plastic->internal : "e_out";
}

PetscBool MpmMaterialFlows(const MpmMaterialNumbers *material)
{
  const MpmMaterials *all = material->several;

  for (PetscInt i = 0; all && i < all->n; i++)
    if (all->of[i].law->plastic) return PETSC_TRUE;
  return material->law->plastic ? PETSC_TRUE : PETSC_FALSE;
}

/* ---- several materials ---- */

/* Whether a material's law has the internal variable of its name, or e_out. */
static PetscBool HasInternal(const MpmLaw *law)
{
  return law->plastic && law->plastic->internal ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool IsSame(const MpmMaterialNumbers *a, const MpmMaterialNumbers *b)
{
  for (PetscInt i = 0; i < MPM_PLASTIC_NUMBERS; i++)
    if (a->plastic[i] != b->plastic[i]) return PETSC_FALSE;
  return a->law == b->law && a->mu == b->mu && a->lambda == b->lambda && a->exponent == b->exponent ? PETSC_TRUE
                                                                                                    : PETSC_FALSE;
}

PetscInt MpmMaterialsAdd(MpmMaterials *all, const MpmMaterialNumbers *material)
{
  PetscInt i = 0, slot = 0;

  while (i < all->n && !IsSame(&all->of[i], material)) i++;
  if (i < all->n || i == MPM_MOST_MATERIALS) return i;
  if (HasInternal(material->law)) {
    while (slot < all->ninternal && strcmp(all->internal[slot]->plastic->internal, material->law->plastic->internal))
      slot++;
    if (slot == MPM_MOST_INTERNAL) return MPM_MOST_MATERIALS;
    if (slot == all->ninternal) all->internal[all->ninternal++] = material->law;
  }
  if (material->law->plastic && material->law->plastic->outside) all->outside = PETSC_TRUE;
  all->slot[i] = slot;
  all->of[i]   = *material;
  return all->n++;
}

/* Which component of all is component c of material i. */
static PetscInt ComponentOf(const MpmMaterials *all, PetscInt i, PetscInt dim, PetscInt c)
{
  if (c < TENSOR(dim)) return c;
  return TENSOR(dim) + (c == TENSOR(dim) && HasInternal(all->of[i].law) ? all->slot[i] : all->ninternal);
}

/*
   The number of the material of a particle, the last of its components. A checkpoint that was made by hand may hold
   any.
*/
static PetscInt NumberOf(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal *const F[], PetscInt p)
{
  const PetscReal number = F[MpmMaterialComponents(m, dim) - 1][p];

  return number >= 0.5 ? (PetscInt)PetscMin(number + 0.5, m->several->n - 1) : 0;
}

const MpmMaterialNumbers *MpmMaterialAt(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal *const F[],
                                        PetscInt p)
{
  return m->several ? &m->several->of[NumberOf(m, dim, F, p)] : m;
}

/* What is done with particles begin to end, which are of one material, on the arrays of its own components. */
typedef enum { STRESS, TANGENT, ENERGY, RETURN, RETURN_TANGENT } Kind;
typedef struct {
  const MpmMaterialNumbers *m;
  PetscInt                  i, begin, end;
} Run;

static PetscBool NextRun(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[], Run *run)
{
  run->begin = run->end;
  if (run->begin == n) return PETSC_FALSE;
  run->i = NumberOf(m, dim, F, run->begin);
  run->m = &m->several->of[run->i];
  while (run->end < n && NumberOf(m, dim, F, run->end) == run->i) run->end++;
  return PETSC_TRUE;
}

static void Own(const MpmMaterialNumbers *m, const Run *run, PetscInt dim, PetscReal *const all[], PetscReal *own[])
{
  for (PetscInt c = 0; c < MpmLawComponents(run->m->law, dim); c++)
    own[c] = all[ComponentOf(m->several, run->i, dim, c)] + run->begin;
}

/*
   The arrays of F and dF are only read; those of out are F's for a return. Returns what MpmMaterialReturnTangent does.
*/
static PetscInt EachRun(Kind kind, const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, MpmBranch branch,
                        const PetscReal *const F[], const PetscReal *const dF[], PetscReal *const out[])
{
  PetscInt on_surface = 0;

  for (Run run = {.end = 0}; NextRun(m, dim, n, F, &run);) {
    const PetscInt          count = run.end - run.begin;
    PetscReal              *f[MPM_MOST_STRETCH], *df[MPM_MOST_STRETCH], *to[MPM_MOST_STRETCH];
    const PetscReal *const *from = (const PetscReal *const *)f, *const *along = (const PetscReal *const *)df;

    if (kind >= RETURN && !run.m->law->plastic) continue;
    Own(m, &run, dim, (PetscReal *const *)F, f);
    if (dF) Own(m, &run, dim, (PetscReal *const *)dF, df);
    if (kind >= RETURN) Own(m, &run, dim, out, to);
    for (PetscInt c = 0; c < (kind < ENERGY ? SYMMETRIC(dim) : kind == ENERGY); c++) to[c] = out[c] + run.begin;
    if (kind == STRESS) MpmMaterialStress(run.m, dim, count, from, to);
    if (kind == TANGENT) MpmMaterialTangent(run.m, dim, count, from, along, to);
    if (kind == ENERGY) MpmMaterialEnergy(run.m, dim, count, from, to[0]);
    if (kind == RETURN) MpmMaterialReturn(run.m, dim, count, to);
    if (kind == RETURN_TANGENT) on_surface += MpmMaterialReturnTangent(run.m, dim, count, branch, from, along, to);
  }
  return on_surface;
}

static void Stress(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                   PetscReal *const tau[])
{
  (void)EachRun(STRESS, m, dim, n, MPM_BRANCH_OWN, F, NULL, tau);
}

static void Tangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                    const PetscReal *const dF[], PetscReal *const dtau[])
{
  (void)EachRun(TANGENT, m, dim, n, MPM_BRANCH_OWN, F, dF, dtau);
}

static void Energy(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[], PetscReal psi[])
{
  (void)EachRun(ENERGY, m, dim, n, MPM_BRANCH_OWN, F, NULL, (PetscReal *const[]){psi});
}

void MpmMaterialReturn(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, PetscReal *const F[])
{
  if (material->several)
    (void)EachRun(RETURN, material, dim, n, MPM_BRANCH_OWN, (const PetscReal *const *)F, NULL, F);
  else
    MpmPlasticReturn(material, dim, n, F);
}

PetscInt MpmMaterialReturnTangent(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, MpmBranch branch,
                                  const PetscReal *const F[], const PetscReal *const dF[], PetscReal *const after[])
{
  if (!material->several) return MpmPlasticReturnTangent(material, dim, n, branch, F, dF, after);
  for (PetscInt c = 0; c < MpmMaterialComponents(material, dim); c++)
    for (PetscInt p = 0; p < n; p++) after[c][p] = dF[c][p];
  return EachRun(RETURN_TANGENT, material, dim, n, branch, F, dF, after);
}

const MpmLaw MpmLawSeveral = {
    .name = "several", .solid = PETSC_TRUE, .stress = Stress, .tangent = Tangent, .energy = Energy};

/* ---- the modulus ---- */

/*
   The largest eigenvalue of a symmetric tensor. With dim 3: O. K. Smith, Eigenvalues of a symmetric 3 x 3 matrix
   (1961).
*/
INLINE PetscReal LargestEigenvalue(PetscInt dim, const PetscReal s[])
{
  const PetscReal mean = Trace(dim, s) / dim;
  PetscReal       off[6], size, cosine;

  if (dim == 1) return s[0];
  Shifted(dim, 1, s, -mean, off);
  if (dim == 2) return mean + sqrt(off[0] * off[0] + off[1] * off[1]);
  size = sqrt(Contract(dim, off, off) / 6);
  if (size == 0) return mean;
  Shifted(dim, 1 / size, off, 0, off);
  cosine = off[0] * (off[3] * off[5] - off[4] * off[4]) - off[1] * (off[1] * off[5] - off[4] * off[2]) +
           off[2] * (off[1] * off[4] - off[3] * off[2]);
  return mean + 2 * size * cos(acos(PetscMin(1, PetscMax(-1, cosine / 2))) / 3);
}

INLINE PetscReal ModulusOf(const PetscInt dim, const MpmMaterialNumbers *material, const PetscReal F[])
{
  PetscReal B[6];

  LeftProduct(dim, F, B);
  return material->law->modulus(material, dim, LargestEigenvalue(dim, B), Trace(dim, B), Volume(dim, F));
}

static PetscReal ModulusOfSeveral(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[])
{
  const PetscReal *at[MPM_MOST_STRETCH];
  PetscReal        own[MPM_MOST_STRETCH];
  Run              run = {.end = 0};

  for (PetscInt c = 0; c < MpmMaterialComponents(m, dim); c++) at[c] = &F[c];
  (void)NextRun(m, dim, 1, at, &run);
  for (PetscInt c = 0; c < MpmLawComponents(run.m->law, dim); c++) own[c] = F[ComponentOf(m->several, run.i, dim, c)];
  return MpmMaterialModulus(run.m, dim, own);
}

PetscReal MpmMaterialModulus(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal F[])
{
  if (material->several) return ModulusOfSeveral(material, dim, F);
  if (material->law->plastic) return MpmPlasticModulus(material, dim, F);
  return dim == 1 ? ModulusOf(1, material, F) : dim == 2 ? ModulusOf(2, material, F) : ModulusOf(3, material, F);
}
