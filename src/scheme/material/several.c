/*
   Several materials in one run: runs of particles of one material go through its law. The last internal variable of a
   particle is the number of its material. So it goes wherever the particle goes, to other ranks and into files, and
   needs nothing of its own.
*/
#include "scheme/material/laws.h"
#include "scheme/material/several.h"
#include <string.h>

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

/* Particles begin to end, which are of one material, and the arrays of its own components from begin on. */
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

static void Own(const MpmMaterialNumbers *m, const Run *run, PetscInt dim, const PetscReal *const all[],
                const PetscReal *own[])
{
  for (PetscInt c = 0; c < MpmLawComponents(run->m->law, dim); c++)
    own[c] = all[ComponentOf(m->several, run->i, dim, c)] + run->begin;
}

static void OwnWritten(const MpmMaterialNumbers *m, const Run *run, PetscInt dim, PetscReal *const all[],
                       PetscReal *own[])
{
  for (PetscInt c = 0; c < MpmLawComponents(run->m->law, dim); c++)
    own[c] = all[ComponentOf(m->several, run->i, dim, c)] + run->begin;
}

static void Stress(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                   PetscReal *const tau[])
{
  for (Run run = {.end = 0}; NextRun(m, dim, n, F, &run);) {
    const PetscReal *from[MPM_MOST_STRETCH];
    PetscReal       *to[6];

    Own(m, &run, dim, F, from);
    EACH (c, SYMMETRIC(dim)) to[c] = tau[c] + run.begin;
    MpmMaterialStress(run.m, dim, run.end - run.begin, from, to);
  }
}

static void Tangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                    const PetscReal *const dF[], PetscReal *const dtau[])
{
  for (Run run = {.end = 0}; NextRun(m, dim, n, F, &run);) {
    const PetscReal *from[MPM_MOST_STRETCH], *along[MPM_MOST_STRETCH];
    PetscReal       *to[6];

    Own(m, &run, dim, F, from);
    Own(m, &run, dim, dF, along);
    EACH (c, SYMMETRIC(dim)) to[c] = dtau[c] + run.begin;
    MpmMaterialTangent(run.m, dim, run.end - run.begin, from, along, to);
  }
}

static void Energy(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[], PetscReal psi[])
{
  for (Run run = {.end = 0}; NextRun(m, dim, n, F, &run);) {
    const PetscReal *from[MPM_MOST_STRETCH];

    Own(m, &run, dim, F, from);
    MpmMaterialEnergy(run.m, dim, run.end - run.begin, from, psi + run.begin);
  }
}

PetscReal MpmSeveralModulus(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[])
{
  const PetscReal *at[MPM_MOST_STRETCH];
  PetscReal        own[MPM_MOST_STRETCH];
  Run              run = {.end = 0};

  for (PetscInt c = 0; c < MpmMaterialComponents(m, dim); c++) at[c] = &F[c];
  (void)NextRun(m, dim, 1, at, &run);
  for (PetscInt c = 0; c < MpmLawComponents(run.m->law, dim); c++) own[c] = F[ComponentOf(m->several, run.i, dim, c)];
  return MpmMaterialModulus(run.m, dim, own);
}

void MpmSeveralReturn(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, PetscReal *const F[])
{
  for (Run run = {.end = 0}; NextRun(m, dim, n, (const PetscReal *const *)F, &run);) {
    PetscReal *own[MPM_MOST_STRETCH];

    if (!run.m->law->plastic) continue;
    OwnWritten(m, &run, dim, F, own);
    MpmMaterialReturn(run.m, dim, run.end - run.begin, own);
  }
}

PetscInt MpmSeveralReturnTangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, MpmBranch branch,
                                 const PetscReal *const F[], const PetscReal *const dF[], PetscReal *const after[])
{
  PetscInt on_surface = 0;

  for (PetscInt c = 0; c < MpmMaterialComponents(m, dim); c++)
    for (PetscInt p = 0; p < n; p++) after[c][p] = dF[c][p];
  for (Run run = {.end = 0}; NextRun(m, dim, n, F, &run);) {
    const PetscReal *from[MPM_MOST_STRETCH], *along[MPM_MOST_STRETCH];
    PetscReal       *to[MPM_MOST_STRETCH];

    if (!run.m->law->plastic) continue;
    Own(m, &run, dim, F, from);
    Own(m, &run, dim, dF, along);
    OwnWritten(m, &run, dim, after, to);
    on_surface += MpmMaterialReturnTangent(run.m, dim, run.end - run.begin, branch, from, along, to);
  }
  return on_surface;
}

const MpmLaw MpmLawSeveral = {
    .name = "several", .solid = PETSC_TRUE, .stress = Stress, .tangent = Tangent, .energy = Energy};
