/*
   Rows of nodes to one line, and back; and runs of particles that are alike. The numbers of rows, of lines and of
   nodes, and the length of a run, are constants in each loop, but for wide bases. So are the weights of runs: a loop
   has no more than products and sums.
*/
#include "scheme/lines.h"

/* ---- rows of nodes ---- */

MpmOpKind MpmLineKind(const MpmBasis *basis, MpmOpKind kind)
{
  for (PetscInt k = 0; k < (PetscInt)kind; k++)
    if (basis->weights[k] == basis->weights[kind]) return (MpmOpKind)k;
  return kind;
}

#define INLINE static inline __attribute__((always_inline))

INLINE void Gather(const PetscInt rows, const PetscInt *restrict offset, const PetscReal *restrict weight, PetscInt n,
                   const PetscReal *restrict node, PetscReal *restrict line)
{
  for (PetscInt i = 0; i < n; i++) {
    PetscReal sum = 0;

    for (PetscInt r = 0; r < rows; r++) sum += weight[r] * node[offset[r] + i];
    line[i] = sum;
  }
}

void MpmLinesGather(PetscInt rows, const PetscInt *restrict offset, const PetscReal *restrict weight, PetscInt n,
                    const PetscReal *restrict node, PetscReal *restrict line)
{
  if (rows == 2)
    Gather(2, offset, weight, n, node, line);
  else if (rows == 3)
    Gather(3, offset, weight, n, node, line);
  else if (rows == 4)
    Gather(4, offset, weight, n, node, line);
  else if (rows == 9)
    Gather(9, offset, weight, n, node, line);
  else if (rows == 16)
    Gather(16, offset, weight, n, node, line);
  else
    Gather(rows, offset, weight, n, node, line);
}

/* Rows do not overlap, but the compiler cannot know it; so it does one after the other. */
INLINE void Spread(PetscInt rows, const PetscInt *restrict offset, const PetscInt lines,
                   const PetscReal weight[][MPM_MOST_ROWS], const PetscReal *const line[], PetscInt n,
                   PetscReal *restrict node)
{
  const PetscReal *restrict l0 = line[0], *restrict l1 = lines > 1 ? line[1] : NULL,
                            *restrict l2 = lines > 2 ? line[2] : NULL;

  for (PetscInt r = 0; r < rows; r++) {
    const PetscReal w0 = weight[0][r], w1 = lines > 1 ? weight[1][r] : 0, w2 = lines > 2 ? weight[2][r] : 0;
    PetscReal *restrict row = node + offset[r];

    for (PetscInt i = 0; i < n; i++) row[i] += w0 * l0[i] + (lines > 1 ? w1 * l1[i] : 0) + (lines > 2 ? w2 * l2[i] : 0);
  }
}

void MpmLinesSpread(PetscInt rows, const PetscInt *restrict offset, PetscInt lines,
                    const PetscReal weight[][MPM_MOST_ROWS], const PetscReal *const line[], PetscInt n,
                    PetscReal *restrict node)
{
  if (lines == 1) Spread(rows, offset, 1, weight, line, n, node);
  if (lines == 2) Spread(rows, offset, 2, weight, line, n, node);
  if (lines == 3) Spread(rows, offset, 3, weight, line, n, node);
}

/* ---- runs ---- */

PetscBool MpmRunsFind(const MpmBasis *basis, const MpmBlock *b, MpmRuns *runs)
{
  const PetscInt *first = b->first, n = b->n;
  PetscInt        unlike = 0, begin = 0, length = 0;

  if (MpmBasisIsAltered(basis) || basis->nodes < 2 || basis->nodes > MPM_MOST_RUN_NODES) return PETSC_FALSE;
  while (begin < n && begin <= MPM_LONGEST_RUN && first[begin] == first[0]) begin++;
  while (begin + length < n && length <= MPM_LONGEST_RUN && first[begin + length] == first[begin]) length++;
  if (length == 0 || length > MPM_LONGEST_RUN) return PETSC_FALSE;
  for (PetscInt p = length; p < n; p++) unlike |= (b->xi[p] != b->xi[p - length]) | (first[p] != first[p - length] + 1);
  if (unlike) return PETSC_FALSE;
  if (begin == length) begin = 0; /* the first run is whole too */
  *runs = (MpmRuns){.begin = begin, .end = n - (n - begin) % length, .length = length};
  return PETSC_TRUE;
}

void MpmRunsWeights(const MpmBasis *basis, MpmOpKind kind, const MpmBlock *b, const MpmRuns *runs, PetscReal weight[])
{
  MpmBlock run;

  run.n          = runs->length;
  run.xi         = b->xi + runs->begin;
  run.half_width = b->half_width;
  basis->weights[kind](&run, runs->length, weight);
}

/* The place of a particle in its run. Particles before the first whole run are the last ones of a run. */
static inline PetscInt InRun(const MpmRuns *r, PetscInt p)
{
  return (p - r->begin + r->length) % r->length;
}

INLINE void GatherEach(PetscInt begin, PetscInt end, PetscInt nodes, const MpmBlock *b, const MpmRuns *r,
                       const PetscReal *restrict weight, PetscReal a, PetscReal *restrict particle,
                       const PetscReal *restrict node)
{
  for (PetscInt p = begin; p < end; p++)
    for (PetscInt d = 0; d < nodes; d++) particle[p] += a * weight[d * r->length + InRun(r, p)] * node[b->first[p] + d];
}

INLINE void SpreadEach(PetscInt begin, PetscInt end, PetscInt nodes, const MpmBlock *b, const MpmRuns *r,
                       const PetscReal *restrict weight, PetscReal a, const PetscReal *restrict particle,
                       PetscReal *restrict node)
{
  for (PetscInt p = begin; p < end; p++)
    for (PetscInt d = 0; d < nodes; d++) node[b->first[p] + d] += a * weight[d * r->length + InRun(r, p)] * particle[p];
}

INLINE void GatherRuns(const PetscInt length, const PetscInt nodes, const MpmBlock *b, const MpmRuns *r,
                       const PetscReal *restrict weight, PetscReal a, PetscReal *restrict particle,
                       const PetscReal *restrict node)
{
  const PetscInt count           = (r->end - r->begin) / length;
  const PetscReal *restrict from = node + b->first[r->begin];
  PetscReal *restrict q          = particle + r->begin;
  PetscReal w[MPM_LONGEST_RUN * MPM_MOST_RUN_NODES];

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
   of[i] has what the i-th particles of all runs hold, between zeros. So what a node gets is one sum, and no sum in
   memory is added to twice.
*/
INLINE void SpreadRuns(const PetscInt length, const PetscInt nodes, const MpmBlock *b, const MpmRuns *r,
                       const PetscReal *restrict weight, PetscReal a, const PetscReal *restrict particle,
                       PetscReal *restrict node)
{
  const PetscInt count = (r->end - r->begin) / length, pad = MPM_MOST_RUN_NODES - 1;
  const PetscReal *restrict q = particle + r->begin;
  PetscReal *restrict to      = node + b->first[r->begin];
  PetscReal of[MPM_LONGEST_RUN][MPM_BLOCK + 2 * (MPM_MOST_RUN_NODES - 1)], w[MPM_LONGEST_RUN * MPM_MOST_RUN_NODES];

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
    if (nodes == 2) RUNS(length, 2, b, r, weight, a, particle, node);                                                  \
    if (nodes == 3) RUNS(length, 3, b, r, weight, a, particle, node);                                                  \
    if (nodes == 4) RUNS(length, 4, b, r, weight, a, particle, node);                                                  \
  } while (0)
#define OF_LENGTH(RUNS)                                                                                                \
  do {                                                                                                                 \
    if (r->length == 1) OF_NODES(RUNS, 1);                                                                             \
    if (r->length == 2) OF_NODES(RUNS, 2);                                                                             \
    if (r->length == 3) OF_NODES(RUNS, 3);                                                                             \
    if (r->length == 4) OF_NODES(RUNS, 4);                                                                             \
  } while (0)

static void GatherOne(const MpmBlock *b, const MpmRuns *r, PetscInt nodes, const PetscReal *restrict weight,
                      PetscReal a, PetscReal *restrict particle, const PetscReal *restrict node)
{
  GatherEach(0, r->begin, nodes, b, r, weight, a, particle, node);
  OF_LENGTH(GatherRuns);
  GatherEach(r->end, b->n, nodes, b, r, weight, a, particle, node);
}

void MpmRunsGather(const MpmBlock *b, const MpmRuns *r, PetscInt nodes, const PetscReal *restrict weight, PetscInt n,
                   const PetscReal a[], PetscReal *const particle[], const PetscReal *restrict node)
{
  PetscReal sum[MPM_BLOCK];

  if (n == 1) {
    GatherOne(b, r, nodes, weight, a[0], particle[0], node);
    return;
  }
  for (PetscInt p = 0; p < b->n; p++) sum[p] = 0;
  GatherOne(b, r, nodes, weight, 1, sum, node);
  for (PetscInt t = 0; t < n; t++) {
    PetscReal *restrict q = particle[t];

    for (PetscInt p = 0; p < b->n; p++) q[p] += a[t] * sum[p];
  }
}

void MpmRunsSpread(const MpmBlock *b, const MpmRuns *r, PetscInt nodes, const PetscReal *restrict weight, PetscReal a,
                   const PetscReal *restrict particle, PetscReal *restrict node)
{
  SpreadEach(0, r->begin, nodes, b, r, weight, a, particle, node);
  OF_LENGTH(SpreadRuns);
  SpreadEach(r->end, b->n, nodes, b, r, weight, a, particle, node);
}
