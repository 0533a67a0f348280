/*
   The maps of a basis whose particles see NODES nodes in a row. A basis includes this after it has defined NODES and

     static inline PetscInt First(PetscReal xi);                                      the first of them, from the cell's
                                                                                      left node
     static inline void Values(PetscReal xi, PetscReal width, PetscReal phi[NODES]);
     static inline void Slopes(PetscReal xi, PetscReal width, PetscReal slope[NODES]);    h dphi/dx

   Particles are taken in chunks. Where all cells of a chunk have as many particles, as in every uniform layout, moving
   or not, a loop over cells has no branch and no gather, and the compiler makes vectors of it. Elsewhere sums stay in
   registers while particles see the same nodes, and all but the first are carried on when they see the next ones: a sum
   in memory would wait for the one before it to be stored.
*/
#pragma once
#include <mpmstab/basis.h>

static inline PetscInt First(PetscReal xi);
static inline void     Values(PetscReal xi, PetscReal width, PetscReal phi[NODES]);
static inline void     Slopes(PetscReal xi, PetscReal width, PetscReal slope[NODES]);

/* Weights of a particle's nodes; returns what a gather divides by. */
typedef PetscReal (*Weights)(PetscReal xi, PetscReal width, PetscReal weight[NODES]);

static inline PetscReal Phi(PetscReal xi, PetscReal width, PetscReal weight[NODES])
{
  Values(xi, width, weight);
  return 1;
}

static inline PetscReal Gradient(PetscReal xi, PetscReal width, PetscReal weight[NODES])
{
  Slopes(xi, width, weight);
  return 1;
}

/* phi (x_i - x_p) / h; returns sum_i phi (x_i - x_p)^2 / h^2. */
static inline PetscReal Moment(PetscReal xi, PetscReal width, PetscReal weight[NODES])
{
  PetscReal sum = 0;

  Values(xi, width, weight);
  for (int d = 0; d < NODES; d++) {
    const PetscReal distance = First(xi) + d - xi;

    weight[d] *= distance;
    sum += weight[d] * distance;
  }
  return sum;
}

#define CHUNK 128
#define LONGEST 16 /* run that is looked for */
#define MARGIN (LONGEST * (NODES - 1))
#define ROOM (CHUNK + 2 * MARGIN)

/* Where the loop over particles must know which weights it takes: a call in it would leave it one by one. */
#define INLINE static inline __attribute__((always_inline))

/* Particles [begin, end) of a chunk come in runs of one length, each of which sees the nodes one further on. */
typedef struct {
  PetscInt begin, end, length, count;
} Runs;

/* None (begin = end = n) if the runs are not alike, or too long. */
static inline Runs FindRuns(PetscInt n, const PetscInt first[CHUNK])
{
  const Runs none   = {n, n, 0, 0};
  PetscInt   unlike = 0, begin = 0, length = 0;

  while (begin < n && first[begin] == first[0]) begin++;
  while (begin + length < n && first[begin + length] == first[begin]) length++;
  if (length == 0 || length > LONGEST) return none;
  for (PetscInt p = begin; p < n - length; p++) unlike |= first[p + length] - first[p] - 1;
  if (begin == length && first[begin] == first[0] + 1) begin = 0; /* the first run is a whole one too */
  return unlike ? none : (Runs){begin, n - (n - begin) % length, length, (n - begin) / length};
}

/*
   Adds what the particles of runs give to their nodes, given[d] to the d-th, node by node: the run that sees it first,
   the one before that, and so on, with nothing beyond the ends. The compiler knows the length.
*/
static inline void SumRuns(const PetscInt length, const Runs *runs, PetscInt at, PetscReal given[NODES][ROOM],
                           PetscReal *restrict node)
{
  for (int d = 0; d < NODES; d++) {
    for (PetscInt i = 0; i < (NODES - 1) * length; i++) {
      given[d][MARGIN + runs->begin - 1 - i] = 0;
      given[d][MARGIN + runs->end + i]       = 0;
    }
  }
  for (PetscInt j = 0; j < runs->count + NODES - 1; j++) {
    PetscReal sum = 0;

    for (int d = 0; d < NODES; d++)
      for (PetscInt i = 0; i < length; i++) sum += given[d][MARGIN + runs->begin + length * (j - d) + i];
    node[at + j] += sum;
  }
}

/* What the particles of runs see of their nodes, seen[d] of the d-th. */
static inline void SeeRuns(const PetscInt length, PetscInt count, PetscInt at, const PetscReal *restrict node,
                           PetscInt begin, PetscReal seen[NODES][CHUNK])
{
  for (int d = 0; d < NODES; d++) {
    PetscReal *restrict s = seen[d] + begin;

    for (PetscInt j = 0; j < count; j++)
      for (PetscInt i = 0; i < length; i++) s[length * j + i] = node[at + j + d];
  }
}

/* Gives what has been summed for nodes at, at + 1, ... to the nodes that are not among those from next on. */
static inline void Carry(PetscInt at, PetscInt next, PetscReal sum[NODES], PetscReal *restrict node)
{
  if (next == at + 1) {
    node[at] += sum[0];
    for (int d = 0; d < NODES - 1; d++) sum[d] = sum[d + 1];
    sum[NODES - 1] = 0;
  } else {
    for (int d = 0; d < NODES; d++) {
      node[at + d] += sum[d];
      sum[d] = 0;
    }
  }
}

static inline void SumEach(PetscInt begin, PetscInt end, const PetscInt *restrict first, PetscReal given[NODES][ROOM],
                           PetscReal *restrict node)
{
  PetscReal sum[NODES] = {0};

  for (PetscInt p = begin; p < end; p++) {
    if (p > begin && first[p] != first[p - 1]) Carry(first[p - 1], first[p], sum, node);
    for (int d = 0; d < NODES; d++) sum[d] += given[d][MARGIN + p];
  }
  for (int d = 0; d < NODES && begin < end; d++) node[first[end - 1] + d] += sum[d];
}

static inline void Sum(PetscInt n, const PetscInt first[CHUNK], const Runs *runs, PetscReal given[NODES][ROOM],
                       PetscReal *restrict node)
{
  SumEach(0, runs->begin, first, given, node);
  SumEach(runs->end, n, first, given, node);
  if (runs->length == 1) SumRuns(1, runs, first[runs->begin], given, node);
  if (runs->length == 2) SumRuns(2, runs, first[runs->begin], given, node);
  if (runs->length == 3) SumRuns(3, runs, first[runs->begin], given, node);
  if (runs->length == 4) SumRuns(4, runs, first[runs->begin], given, node);
  if (runs->length > 4) SumRuns(runs->length, runs, first[runs->begin], given, node);
}

static inline void SeeEach(PetscInt begin, PetscInt end, const PetscInt *restrict first, const PetscReal *restrict node,
                           PetscReal seen[NODES][CHUNK])
{
  for (int d = 0; d < NODES; d++)
    for (PetscInt p = begin; p < end; p++) seen[d][p] = node[first[p] + d];
}

/* The chunk that begins at particle p, its first nodes and its runs. */
static inline PetscInt Chunk(PetscInt p, PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                             PetscInt first[CHUNK], Runs *runs)
{
  const PetscInt size = PetscMin(CHUNK, n - p);

  for (PetscInt i = 0; i < size; i++) first[i] = cell[p + i] + First(xi[p + i]);
  *runs = FindRuns(size, first);
  return size;
}

/* mass: of the nodes, summed too unless NULL. */
INLINE void Scatter(Weights weights, PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                    PetscReal width, PetscReal a, const PetscReal *restrict particle, PetscReal *restrict node,
                    PetscReal *restrict mass)
{
  for (PetscInt p = 0, size; p < n; p += size) {
    PetscInt  first[CHUNK];
    PetscReal given[NODES][ROOM], given_mass[NODES][ROOM];
    Runs      runs;

    size = Chunk(p, n, cell, xi, first, &runs);
    for (PetscInt i = 0; i < size; i++) {
      PetscReal weight[NODES];

      (void)weights(xi[p + i], width, weight);
      for (int d = 0; d < NODES; d++) {
        given[d][MARGIN + i] = weight[d] * (a * particle[p + i]);
        if (mass) given_mass[d][MARGIN + i] = weight[d];
      }
    }
    Sum(size, first, &runs, given, node);
    if (mass) Sum(size, first, &runs, given_mass, mass);
  }
}

INLINE void Gather(Weights weights, PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                   PetscReal width, PetscReal a, PetscReal *restrict particle, const PetscReal *restrict node)
{
  for (PetscInt p = 0, size; p < n; p += size) {
    PetscInt  first[CHUNK];
    PetscReal seen[NODES][CHUNK];
    Runs      runs;

    size = Chunk(p, n, cell, xi, first, &runs);
    SeeEach(0, runs.begin, first, node, seen);
    if (runs.length == 1) SeeRuns(1, runs.count, first[runs.begin], node, runs.begin, seen);
    if (runs.length == 2) SeeRuns(2, runs.count, first[runs.begin], node, runs.begin, seen);
    if (runs.length == 3) SeeRuns(3, runs.count, first[runs.begin], node, runs.begin, seen);
    if (runs.length == 4) SeeRuns(4, runs.count, first[runs.begin], node, runs.begin, seen);
    if (runs.length > 4) SeeRuns(runs.length, runs.count, first[runs.begin], node, runs.begin, seen);
    SeeEach(runs.end, size, first, node, seen);
    for (PetscInt i = 0; i < size; i++) {
      PetscReal       weight[NODES], sum = 0;
      const PetscReal divisor = weights(xi[p + i], width, weight);

      for (int d = 0; d < NODES; d++) sum += weight[d] * seen[d][i];
      particle[p + i] += a / divisor * sum;
    }
  }
}

static void P2G_(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                 PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Phi, n, cell, xi, width, a, particle, node, NULL);
}

static void P2GAffine(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                      PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Moment, n, cell, xi, width, a, particle, node, NULL);
}

static void Div(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Gradient, n, cell, xi, width, a, particle, node, NULL);
}

static void G2P_(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                 PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Phi, n, cell, xi, width, a, particle, node);
}

static void Grad(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                 PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Gradient, n, cell, xi, width, a, particle, node);
}

static void G2PAffine(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                      PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Moment, n, cell, xi, width, a, particle, node);
}
static void P2GMass(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                    const PetscReal *restrict particle, PetscReal *restrict node, PetscReal *restrict mass)
{
  Scatter(Phi, n, cell, xi, width, 1, particle, node, mass);
}

#define KERNELS                                                                                                        \
  .p2g_mass = P2GMass, .kernel = {[MPM_P2G] = P2G_, [MPM_P2G_AFFINE] = P2GAffine, [MPM_DIV] = Div,                     \
                                  [MPM_G2P] = G2P_, [MPM_G2P_AFFINE] = G2PAffine, [MPM_GRAD] = Grad}
