/*
   Runs of particles that are alike (scheme/lines.h). The length of a run and the number of nodes are constants in each
   loop, and so are its weights: a loop has no more than products and sums.
*/
#include "scheme/lines.h"

#define INLINE static inline __attribute__((always_inline))

PetscBool MpmRunsFind(const MpmBasis *basis, const MpmBlock *b)
{
  PetscInt unlike = 0;

  if (b->length == 0 || MpmBasisIsAltered(basis)) return PETSC_FALSE;
  for (PetscInt p = b->length; p < b->n; p++)
    unlike |= (b->xi[p] != b->xi[p - b->length]) | (b->first[p] != b->first[p - b->length] + 1);
  return unlike ? PETSC_FALSE : PETSC_TRUE;
}

void MpmRunsWeights(const MpmBasis *basis, MpmOpKind kind, const MpmBlock *b, PetscReal weight[])
{
  MpmBlock run;

  run.n          = b->length;
  run.xi         = b->xi + b->begin;
  run.half_width = b->half_width;
  basis->weights[kind](&run, b->length, weight);
}

/* The place of a particle in its run. Particles before the first whole run are the last ones of a run. */
static inline PetscInt InRun(const MpmBlock *b, PetscInt p)
{
  return (p - b->begin + b->length) % b->length;
}

INLINE void GatherEach(PetscInt begin, PetscInt end, PetscInt nodes, const MpmBlock *b,
                       const PetscReal *restrict weight, PetscReal a, PetscReal *restrict particle,
                       const PetscReal *restrict node)
{
  for (PetscInt p = begin; p < end; p++)
    for (PetscInt d = 0; d < nodes; d++) particle[p] += a * weight[d * b->length + InRun(b, p)] * node[b->first[p] + d];
}

INLINE void SpreadEach(PetscInt begin, PetscInt end, PetscInt nodes, const MpmBlock *b,
                       const PetscReal *restrict weight, PetscReal a, const PetscReal *restrict particle,
                       PetscReal *restrict node)
{
  for (PetscInt p = begin; p < end; p++)
    for (PetscInt d = 0; d < nodes; d++) node[b->first[p] + d] += a * weight[d * b->length + InRun(b, p)] * particle[p];
}

INLINE void GatherRuns(const PetscInt length, const PetscInt nodes, const MpmBlock *b, const PetscReal *restrict weight,
                       PetscReal a, PetscReal *restrict particle, const PetscReal *restrict node)
{
  const PetscInt count           = (b->end - b->begin) / length;
  const PetscReal *restrict from = node + b->first[b->begin];
  PetscReal *restrict q          = particle + b->begin;
  PetscReal w[MPM_LONGEST_RUN * MPM_MOST_NODES];

  for (PetscInt i = 0; i < length * nodes; i++) w[i] = a * weight[i];
  for (PetscInt j = 0; j < count; j++) {
    for (PetscInt i = 0; i < length; i++) {
      PetscReal sum = 0;

      for (PetscInt d = 0; d < nodes; d++) sum += w[d * length + i] * from[j + d];
      q[length * j + i] += sum;
    }
  }
}

/*
   of[i] has what the i-th particles of all runs hold, between zeros. So what a node gets is one sum, and no sum in memory
   is added to twice.
*/
INLINE void SpreadRuns(const PetscInt length, const PetscInt nodes, const MpmBlock *b, const PetscReal *restrict weight,
                       PetscReal a, const PetscReal *restrict particle, PetscReal *restrict node)
{
  const PetscInt count = (b->end - b->begin) / length, pad = MPM_MOST_NODES - 1;
  const PetscReal *restrict q = particle + b->begin;
  PetscReal *restrict to      = node + b->first[b->begin];
  PetscReal of[MPM_LONGEST_RUN][MPM_BLOCK + 2 * (MPM_MOST_NODES - 1)], w[MPM_LONGEST_RUN * MPM_MOST_NODES];

  for (PetscInt i = 0; i < length * nodes; i++) w[i] = a * weight[i];
  for (PetscInt i = 0; i < length; i++)
    for (PetscInt z = 0; z < pad; z++) of[i][z] = of[i][pad + count + z] = 0;
  for (PetscInt j = 0; j < count; j++)
    for (PetscInt i = 0; i < length; i++) of[i][pad + j] = q[length * j + i];
  for (PetscInt j = 0; j < count + nodes - 1; j++) {
    PetscReal sum = 0;

    for (PetscInt i = 0; i < length; i++)
      for (PetscInt d = 0; d < nodes; d++) sum += w[d * length + i] * of[i][pad + j - d];
    to[j] += sum;
  }
}

/* Calls RUNS with the length of the runs and the number of nodes as constants. */
#define OF_NODES(RUNS, length)                                                                                         \
  do {                                                                                                                 \
    if (nodes == 2) RUNS(length, 2, b, weight, a, particle, node);                                                     \
    if (nodes == 3) RUNS(length, 3, b, weight, a, particle, node);                                                     \
    if (nodes == 4) RUNS(length, 4, b, weight, a, particle, node);                                                     \
  } while (0)
#define OF_LENGTH(RUNS)                                                                                                \
  do {                                                                                                                 \
    if (b->length == 1) OF_NODES(RUNS, 1);                                                                             \
    if (b->length == 2) OF_NODES(RUNS, 2);                                                                             \
    if (b->length == 3) OF_NODES(RUNS, 3);                                                                             \
    if (b->length == 4) OF_NODES(RUNS, 4);                                                                             \
  } while (0)

void MpmRunsGather(const MpmBlock *b, PetscInt nodes, const PetscReal *restrict weight, PetscReal a,
                   PetscReal *restrict particle, const PetscReal *restrict node)
{
  GatherEach(0, b->begin, nodes, b, weight, a, particle, node);
  OF_LENGTH(GatherRuns);
  GatherEach(b->end, b->n, nodes, b, weight, a, particle, node);
}

void MpmRunsSpread(const MpmBlock *b, PetscInt nodes, const PetscReal *restrict weight, PetscReal a,
                   const PetscReal *restrict particle, PetscReal *restrict node)
{
  SpreadEach(0, b->begin, nodes, b, weight, a, particle, node);
  OF_LENGTH(SpreadRuns);
  SpreadEach(b->end, b->n, nodes, b, weight, a, particle, node);
}
