/*
   mpmstab_dt: the largest stable time step of the particles that you have now, in C and in C++. This header is all that
   is needed. It uses math.h alone, allocates nothing and prints nothing.

     mpmstab_dt_layout at;

     mpmstab_dt_init(&at, 2, MPMSTAB_DT_QUADRATIC, h, nx, ny, 1);                nx x ny nodes, the first at at.origin
     at.x       = mpmstab_dt_numbers(p[0].x, sizeof(double), sizeof p[0]);       of the first particle; a number; a particle
     at.volume  = mpmstab_dt_numbers(&p[0].volume, sizeof(float), sizeof p[0]);
     at.mass    = mpmstab_dt_numbers(&mass, sizeof(double), 0);                  0: one number for all particles
     at.young   = mpmstab_dt_numbers(&young, sizeof(double), 0);                 or at.lambda
     at.poisson = mpmstab_dt_numbers(&poisson, sizeof(double), 0);               and at.mu
     at.factor  = MPMSTAB_DT_MUSL, at.particles = n;                             your scheme
     at.work    = malloc(mpmstab_dt_bytes(&at));                                 once, for the most particles that come

     dt = 0.95 * mpmstab_dt_step(&at, MPMSTAB_DT_LANCZOS);                       in your loop, with volumes and moduli of now

   K = sum_p V_p B_p^T C_p B_p is the stiffness of the nodes, M has their lumped masses, and omega2 is the largest
   eigenvalue of M^-1 K. The step is stable at rest while dt^2 omega2 <= factor. The bounds of omega2:
     MPMSTAB_DT_LONE      each particle as if it were alone; infinite where a particle meets a node on hats
     MPMSTAB_DT_PARTICLE  the mass of a node split between particles by V_p |grad S_ip|, and at.sweeps improvements
     MPMSTAB_DT_LANCZOS   a certificate from a random start and at.products (20) products with K. It is wrong with a chance of
                          at most at.chance (1e-6), and gives some nine tenths of the exact step
   In one dimension lambda + 2 mu counts. Stress of the order of the moduli, viscosity and contact are not in the
   bounds, nor is motion: let no particle cross a cell in a step. MPI: the least step of all ranks, each with its own
   particles, is stable for all, since the mass of a node can be split between ranks, too. OpenMP: passes are parallel
   where the compiler has it.
*/
#ifndef MPMSTAB_DT_H
#define MPMSTAB_DT_H
#include <math.h>
#include <stddef.h>

#ifdef _OPENMP
#define MPMSTAB_DT_OMP(text) _Pragma(text)
#else
#define MPMSTAB_DT_OMP(text)
#endif

/*
   The number of nodes in a direction; POINTERS: you give nodes, weights and gradients, of 64 nodes a particle at most.
*/
enum {
  MPMSTAB_DT_POINTERS  = 0,
  MPMSTAB_DT_HATS      = 2,
  MPMSTAB_DT_QUADRATIC = 3,
  MPMSTAB_DT_CUBIC     = 4,
  MPMSTAB_DT_MOST      = 64
};
enum { MPMSTAB_DT_LONE, MPMSTAB_DT_PARTICLE, MPMSTAB_DT_LANCZOS };
enum { MPMSTAB_DT_MASS, MPMSTAB_DT_SPLIT, MPMSTAB_DT_PRODUCT }; /* passes */

/*
   Factors. verlet: share 1/2 and flip. usf, musl, usavg and usl: flip, blend, pic, apic; usl has 2 (1 + f) /
   (1 + f - alpha) for a mode of which P2G of G2P leaves alpha and the transfer f. Runge-Kutta: the square of its edge.
   xpic and fmpm: unknown. MLS_MPM is usl with apic and at.mls = 1, for which sqrt(2 / omega2 + 2 / lone) is stable,
   lone being the bound of that name.
*/
enum { MPMSTAB_DT_USL = 2, MPMSTAB_DT_USF = 4, MPMSTAB_DT_MUSL = 4, MPMSTAB_DT_USAVG = 4, MPMSTAB_DT_VERLET = 4 };
enum { MPMSTAB_DT_MLS_MPM = 0, MPMSTAB_DT_RK3 = 3, MPMSTAB_DT_KG3 = 4, MPMSTAB_DT_RK4 = 8, MPMSTAB_DT_KG5 = 16 };

typedef struct {
  const void *first;
  size_t      size, stride;
} mpmstab_dt_array;

/*
   nodes: node (i, j, k) has the number i + nx (j + ny k). mls: 1: gradients are S (x_i - x_p) / D (quadratic, cubic).
   fixed: NULL, or a number for each node whose bit a is set where a wall sets component a of the velocity. POINTERS:
   node and weight have width numbers of each particle, gradient dim times as many; nodes[0] counts the nodes. seed: of
   the next certificate; it grows by 1 with each. mode: NULL, or memory for dim numbers a node: LANCZOS then finds its
   mode and the particle with the most energy in it, in twice the time. Answers: omega2 from above, omega2_least from
   below (LANCZOS), the particle that decides or -1, and error: what is wrong with this particle, or NULL. Where
   something is wrong the step is 0.
*/
typedef struct {
  int                  dim, basis, mls, sweeps, products, periodic[3];
  double               h[3], origin[3], factor, chance, omega2, omega2_least;
  long                 nodes[3], particles, width, particle;
  unsigned long long   seed;
  const unsigned char *fixed;
  mpmstab_dt_array     x, volume, mass, young, poisson, lambda, mu;
  const long          *node;
  const double        *weight, *gradient;
  double              *mode;
  void                *work;
  const char          *error;
  /* parts of work: 1 / sqrt(mass) and three vectors of nodes; numbers of particles; coefficients of Lanczos */
  long    unknowns;
  double *root, *v, *before, *w, *share, *own, *alpha, *beta;
} mpmstab_dt_layout;

typedef struct {
  long   n, node[MPMSTAB_DT_MOST];
  double S[MPMSTAB_DT_MOST], g[MPMSTAB_DT_MOST][3], lambda, mu, volume, mass;
} mpmstab_dt_particle;

static inline mpmstab_dt_array mpmstab_dt_numbers(const void *first, size_t size, size_t stride)
{
  const mpmstab_dt_array numbers = {first, size, stride};
  return numbers;
}

static inline void mpmstab_dt_init(mpmstab_dt_layout *at, int dim, int basis, double h, long nx, long ny, long nz)
{
  static mpmstab_dt_layout none;
  *at     = none;
  at->dim = dim, at->basis = basis, at->h[0] = at->h[1] = at->h[2] = h;
  at->nodes[0] = nx, at->nodes[1] = dim > 1 ? ny : 1, at->nodes[2] = dim > 2 ? nz : 1;
  at->factor = MPMSTAB_DT_USL, at->products = 20, at->chance = 1e-6, at->seed = 1;
}

/* mpmstab_dt_bytes - how much memory at.work needs for at.particles, at.products and the grid. */
static inline size_t mpmstab_dt_bytes(const mpmstab_dt_layout *at)
{
  const long numbers = 4 * at->dim * at->nodes[0] * at->nodes[1] * at->nodes[2] + 2 * (at->particles + at->products);
  return sizeof(double) * (size_t)numbers;
}

static inline double mpmstab_dt_get(mpmstab_dt_array of, long p, int a)
{
  const void *number = (const char *)of.first + (size_t)p * of.stride + (size_t)a * of.size;
  return of.size == sizeof(float) ? (double)*(const float *)number : *(const double *)number;
}

/*
   Weights and gradients in one direction of a particle at t cells from the first node; returns the first of its nodes.
*/
static inline double mpmstab_dt_line(const mpmstab_dt_layout *at, double t, double h, double *S, double *g)
{
  const double first = floor(at->basis == MPMSTAB_DT_QUADRATIC ? t - 0.5 : t), f = t - first, e = 1 - f;
  if (at->basis == MPMSTAB_DT_HATS) {
    S[0] = e, S[1] = f, g[0] = -1, g[1] = 1;
  } else if (at->basis == MPMSTAB_DT_QUADRATIC) {
    S[0] = (1.5 - f) * (1.5 - f) / 2, S[1] = 0.75 - e * e, S[2] = (f - 0.5) * (f - 0.5) / 2;
    g[0] = f - 1.5, g[1] = 2 * e, g[2] = f - 0.5;
  } else {
    S[0] = e * e * e / 6, S[1] = (4 - 3 * (2 - f) * f * f) / 6, S[2] = (4 - 3 * (2 - e) * e * e) / 6,
    S[3] = f * f * f / 6;
    g[0] = -e * e / 2, g[1] = 1.5 * f * f - 2 * f, g[2] = 2 * e - 1.5 * e * e, g[3] = f * f / 2;
  }
  for (int i = 0; i < at->basis; i++)
    g[i] = (!at->mls || at->basis == 2 ? g[i] : at->basis == 3 ? 4 * S[i] * (i - f) : 3 * S[i] * (i - 1 - f)) / h;
  return at->basis == MPMSTAB_DT_CUBIC ? first - 1 : first;
}

/* The numbers of a particle, with its nodes; returns what is wrong with it, or NULL. */
static inline const char *mpmstab_dt_find(const mpmstab_dt_layout *at, long p, mpmstab_dt_particle *q)
{
  const int d = at->dim, b = at->basis;
  long      index[3][4] = {{0}}, to = 1;
  double    S[3][4] = {{1}, {1}, {1}}, g[3][4] = {{0}};
  q->volume = mpmstab_dt_get(at->volume, p, 0), q->mass = mpmstab_dt_get(at->mass, p, 0);
  q->mu     = mpmstab_dt_get(at->young.first ? at->young : at->mu, p, 0);
  q->lambda = mpmstab_dt_get(at->young.first ? at->poisson : at->lambda, p, 0);
  if (at->young.first) q->mu /= 2 * (1 + q->lambda), q->lambda *= 2 * q->mu / (1 - 2 * q->lambda);
  if (!(q->volume > 0 && q->mass > 0 && q->volume + q->mass < HUGE_VAL)) return "a volume or mass that is not above 0";
  if (!(q->mu >= 0 && d * q->lambda + 2 * q->mu >= 0 && q->lambda + q->mu < HUGE_VAL)) return "moduli of no solid";
  for (q->n = 0; !b && q->n < at->width; q->n++) {
    const long k = p * at->width + q->n;
    if (q->n == MPMSTAB_DT_MOST) return "more nodes than MPMSTAB_DT_MOST";
    if (at->node[k] < 0 || at->node[k] >= at->nodes[0]) return "a node that is not in the grid";
    q->node[q->n] = at->node[k], q->S[q->n] = at->weight[k];
    for (int a = 0; a < 3; a++) q->g[q->n][a] = a < d ? at->gradient[k * d + a] : 0;
  }
  for (int a = 0; b && a < d; to *= at->nodes[a++]) {
    const double t = (mpmstab_dt_get(at->x, p, a) - at->origin[a]) / at->h[a], n = (double)at->nodes[a];
    const double first = mpmstab_dt_line(at, t, at->h[a], S[a], g[a]);
    const int    in    = fabs(t) < 1e15 && (at->periodic[a] || (first >= 0 && first + b <= n));
    if (!in) return "a place that is not in the grid";
    for (int i = 0; i < b; i++) index[a][i] = to * (long)(first + i - n * floor((first + i) / n));
  }
  for (long n = !b ? 0 : d == 1 ? b : d == 2 ? b * b : b * b * b; q->n < n; q->n++) {
    const long   i = q->n % b, j = q->n / b % b, k = q->n / (b * b);
    const double of[3] = {g[0][i] * S[1][j] * S[2][k], S[0][i] * g[1][j] * S[2][k], S[0][i] * S[1][j] * g[2][k]};
    q->node[q->n] = index[0][i] + index[1][j] + index[2][k], q->S[q->n] = S[0][i] * S[1][j] * S[2][k];
    for (int a = 0; a < 3; a++) q->g[q->n][a] = of[a];
  }
  return NULL;
}

/*
   What a particle gives to nodes: mass, the split V_p |grad S_ip|, or K root v, with twice its strain energy to itself.
*/
static inline void mpmstab_dt_give(mpmstab_dt_layout *at, int pass, long p)
{
  const int           d = at->dim, product = pass == MPMSTAB_DT_PRODUCT;
  double              L[3][3] = {{0}}, f[3][3] = {{0}}, of = 0;
  mpmstab_dt_particle q;
  mpmstab_dt_find(at, p, &q);
  for (long j = 0, i = 0; j < q.n && product; j++)
    for (int k = 0; k < d * d; k++)
      i = q.node[j] * d + k / d, L[k / d][k % d] += at->v[i] * at->root[i] * q.g[j][k % d];
  for (int k = 0; k < d * d && product; k++) {
    const int a = k / d, b = k % d;
    f[a][b]    = q.volume * (q.mu * (L[a][b] + L[b][a]) + (a == b ? q.lambda * (L[0][0] + L[1][1] + L[2][2]) : 0));
    at->own[p] = (k ? at->own[p] : 0) + f[a][b] * L[a][b];
  }
  for (long j = 0; j < q.n; j++)
    for (int a = 0; a < (product ? d : 1); a++) {
      const double *g = q.g[j];
      if (pass == MPMSTAB_DT_MASS) of = q.mass * q.S[j];
      if (pass == MPMSTAB_DT_SPLIT) of = q.volume * at->share[p] * sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
      if (product) of = f[a][0] * g[0] + f[a][1] * g[1] + f[a][2] * g[2];
      MPMSTAB_DT_OMP("omp atomic")
      at->w[q.node[j] * d + a] += of;
    }
}

static inline void mpmstab_dt_pass(mpmstab_dt_layout *at, int pass)
{
  for (long i = 0; i < at->unknowns; i++) at->w[i] = 0;
  MPMSTAB_DT_OMP("omp parallel for")
  for (long p = 0; p < at->particles; p++) mpmstab_dt_give(at, pass, p);
}

/* root of each unknown of the nodes, 0 where a wall or the lack of mass leaves none. Returns how many there are. */
static inline long mpmstab_dt_masses(mpmstab_dt_layout *at)
{
  long n = 0;
  mpmstab_dt_pass(at, MPMSTAB_DT_MASS);
  for (long i = 0; i < at->unknowns; i++) {
    const double m = at->w[i / at->dim * at->dim];
    at->root[i]    = m > 0 && !(at->fixed && at->fixed[i / at->dim] >> i % at->dim & 1) ? 1 / sqrt(m) : 0;
    n += at->root[i] > 0;
  }
  return n;
}

/* Makes a symmetric matrix diagonal by Jacobi's rotations, and returns its largest eigenvalue, or 0. */
static inline double mpmstab_dt_eigenvalues(double A[3][3])
{
  for (int turn = 0; turn < 30; turn++) {
    const int    p = turn % 3 / 2, q = turn % 3 ? 2 : 1; /* (0, 1), (0, 2), (1, 2) */
    const double x = (A[q][q] - A[p][p]) / 2, y = A[p][q], size = fabs(x) + sqrt(x * x + y * y);
    if (!(fabs(y) > 1e-16 * (fabs(A[p][p]) + fabs(A[q][q])))) continue;
    const double t = (x < 0 ? -y : y) / size, c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 6; k++) { /* columns, and then rows */
      double      *one = k < 3 ? &A[k][p] : &A[p][k - 3], *other = k < 3 ? &A[k][q] : &A[q][k - 3];
      const double was = *one;
      *one = c * was - s * *other, *other = s * was + c * *other;
    }
  }
  return fmax(fmax(A[0][0], A[1][1]), fmax(A[2][2], 0));
}

/*
   The bound of a particle: the largest eigenvalue of C sym(. G), G = V_p sum_i g g^T / m, m its part of the mass of a
   node. In the axes of G strains along them have the matrix 2 mu G + lambda sqrt(G) sqrt(G)^T. A shear has mu
   (G_a + G_b), which is no more: (sqrt(G_a), - sqrt(G_b)) has that much of the matrix if lambda >= - mu, as all solids
   have.
*/
static inline double mpmstab_dt_bound(const mpmstab_dt_layout *at, long p, int lone)
{
  const int           all     = (1 << at->dim) - 1;
  double              G[3][3] = {{0}}, T[3][3];
  mpmstab_dt_particle q;
  mpmstab_dt_find(at, p, &q);
  for (long j = 0; j < q.n; j++) {
    const double *g = q.g[j], g2 = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
    double        part = 0; /* V_p / m */
    if (!(g2 > 0) || (lone < 2 && at->fixed && (at->fixed[q.node[j]] & all) == all)) continue;
    if (lone && !(q.S[j] > 0)) return HUGE_VAL;
    for (int a = 0; a < at->dim && !lone; a++) part = fmax(part, at->root[q.node[j] * at->dim + a]);
    part = lone ? q.volume / (q.mass * q.S[j]) : part * part * at->w[q.node[j] * at->dim] / (sqrt(g2) * at->share[p]);
    for (int k = 0; k < 9; k++) G[k / 3][k % 3] += part * g[k / 3] * g[k % 3];
  }
  mpmstab_dt_eigenvalues(G);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      T[a][b] = q.lambda * sqrt(fmax(G[a][a], 0) * fmax(G[b][b], 0)) + (a == b ? 2 * q.mu * G[a][a] : 0);
  return mpmstab_dt_eigenvalues(T);
}

/*
   The largest own number of particles, at->particle: bounds (lone 2: walls left out), or with lone < 0 what they have.
*/
static inline double mpmstab_dt_largest(mpmstab_dt_layout *at, int lone)
{
  at->particle = 0;
  MPMSTAB_DT_OMP("omp parallel for")
  for (long p = 0; p < at->particles; p++) at->own[p] = lone < 0 ? at->own[p] : mpmstab_dt_bound(at, p, lone);
  for (long p = 1; p < at->particles; p++) at->particle = at->own[p] > at->own[at->particle] ? p : at->particle;
  return at->own[at->particle];
}

/* A sweep multiplies the share of a particle by its bound: a power iteration. Each split of masses is a bound. */
static inline double mpmstab_dt_split(mpmstab_dt_layout *at)
{
  double least = HUGE_VAL, most = 1;
  long   which = -1;
  mpmstab_dt_masses(at);
  for (int sweep = 0; sweep <= at->sweeps && most > 0; sweep++) {
    for (long p = 0; p < at->particles; p++) at->share[p] = sweep ? fmax(at->share[p] * at->own[p] / most, 1e-8) : 1;
    mpmstab_dt_pass(at, MPMSTAB_DT_SPLIT);
    most = mpmstab_dt_largest(at, 0);
    if (most < least) least = most, which = at->particle;
  }
  at->particle = which;
  return least;
}

/* The normal number of an unknown, from two in [0, 1) by splitmix64 (Steele, Lea and Flood 2014). */
static inline double mpmstab_dt_normal(unsigned long long seed, long unknown)
{
  double u[2];
  for (int k = 0; k < 2; k++) {
    unsigned long long z = seed + (2 * (unsigned long long)unknown + (unsigned long long)k + 1) * 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL, z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    u[k] = (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
  }
  return sqrt(-2 * log(1 - u[0])) * cos(6.28318530717958648 * u[1]);
}

static inline double mpmstab_dt_dot(const double *a, const double *b, long n)
{
  double sum = 0;
  MPMSTAB_DT_OMP("omp parallel for reduction(+ : sum)")
  for (long i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* Makes v the next vector of Lanczos, and returns the length that it had. The first one is of normal numbers. */
static inline double mpmstab_dt_next(mpmstab_dt_layout *at, int j)
{
  double *old = at->before, length;
  if (j) mpmstab_dt_pass(at, MPMSTAB_DT_PRODUCT);
  for (long i = 0; i < at->unknowns; i++)
    at->w[i] = j ? at->w[i] * at->root[i] - (j > 1 ? at->beta[j - 2] * old[i] : 0)
                 : (at->root[i] > 0) * mpmstab_dt_normal(at->seed, i);
  if (j) at->alpha[j - 1] = mpmstab_dt_dot(at->w, at->v, at->unknowns);
  for (long i = 0; i < at->unknowns && j; i++) at->w[i] -= at->alpha[j - 1] * at->v[i];
  length     = sqrt(mpmstab_dt_dot(at->w, at->w, at->unknowns));
  at->before = at->v, at->v = at->w, at->w = old;
  for (long i = 0; i < at->unknowns && length > 0; i++) at->v[i] /= length;
  return length;
}

/*
   The largest t with log |p_k(t)| <= level, by the recurrence of p_k(A) v_1 = v_{k+1}, positive beyond the Ritz values.
*/
static inline double mpmstab_dt_root(const mpmstab_dt_layout *at, int k, double level, double high)
{
  double low = 0;
  for (int i = 0; i < 120; i++) {
    double t = low + (high - low) / 2, d = 1, sum = 0;
    for (int j = 0; j < k && d > 0; j++) {
      d = t - at->alpha[j] - (j ? at->beta[j - 1] * at->beta[j - 1] / d : 0);
      sum += d > 0 ? log(d / at->beta[j]) : 0;
    }
    high = d > 0 && sum > level ? t : high, low = d > 0 && sum > level ? low : t;
  }
  return high;
}

/* The vector of the largest Ritz value, into mode, and the particle with the most of its strain energy. */
static inline void mpmstab_dt_find_mode(mpmstab_dt_layout *at, int k)
{
  double s = 1, last = 0, next;
  for (int j = 0; j < k && fabs(s) > 1e-6; j++, last = s, s = next) { /* up to where s has faded: then it is rounding */
    mpmstab_dt_next(at, j);
    for (long i = 0; i < at->unknowns; i++) at->mode[i] = (j ? at->mode[i] : 0) + s * at->v[i];
    next = ((at->omega2_least - at->alpha[j]) * s - (j ? at->beta[j - 1] * last : 0)) / at->beta[j];
  }
  for (long i = 0; i < at->unknowns; i++) at->v[i] = at->mode[i], at->mode[i] *= at->root[i];
  mpmstab_dt_pass(at, MPMSTAB_DT_PRODUCT);
  mpmstab_dt_largest(at, -1);
}

/*
   v_{k+1} = p_k(A) v_1 has length 1, so the part of v_1 along the mode of omega2 is at most 1 / p_k(omega2). Of n
   normal numbers it is below d with a chance of at most d sqrt(2 n / pi). Source: van Dorsselaer, Hochstenbach, van der
   Vorst 2000.
*/
static inline double mpmstab_dt_certificate(mpmstab_dt_layout *at)
{
  const double n = (double)mpmstab_dt_masses(at), level = log(sqrt(2 * n / 3.14159265358979324) / at->chance);
  double       size = 0, most;
  int          k    = 0;
  if (n > 0) mpmstab_dt_next(at, 0);
  while (n > 0 && k < at->products && (!k || at->beta[k - 1] > 1e-14 * size)) {
    at->beta[k] = mpmstab_dt_next(at, k + 1);
    size        = fmax(size, at->alpha[k] + 2 * at->beta[k]), k++;
  }
  if (!(size > 0)) return 0;
  at->beta[k - 1]  = fmax(at->beta[k - 1], 1e-14 * size); /* below this, and nearer to least, is rounding */
  at->omega2_least = mpmstab_dt_root(at, k, -HUGE_VAL, size * 2);
  most             = fmax(mpmstab_dt_root(at, k, level, size * (2 + exp(level / k))), at->omega2_least * (1 + 1e-7));
  if (at->mode) mpmstab_dt_find_mode(at, k);
  at->seed++;
  return most;
}

/* mpmstab_dt_step - the largest step, by the bound LONE, PARTICLE or LANCZOS. HUGE_VAL where no node can move. */
static inline double mpmstab_dt_step(mpmstab_dt_layout *at, int bound)
{
  const int           mls_mpm = !(at->factor > 0);
  double              lone    = 0;
  mpmstab_dt_particle q;
  at->unknowns = at->dim * at->nodes[0] * at->nodes[1] * at->nodes[2], at->root = (double *)at->work;
  at->v = at->root + at->unknowns, at->before = at->v + at->unknowns, at->w = at->before + at->unknowns;
  at->share = at->w + at->unknowns, at->own = at->share + at->particles, at->alpha = at->own + at->particles;
  at->beta = at->alpha + at->products, at->omega2 = at->omega2_least = 0, at->error = NULL, at->particle = -1;
  for (long p = 0; p < at->particles && !at->error; p++) at->error = mpmstab_dt_find(at, at->particle = p, &q);
  if (mls_mpm && !(at->mls && at->basis > MPMSTAB_DT_HATS)) at->error = "MLS_MPM needs mls, QUADRATIC or CUBIC";
  if (at->products < 1 || !(at->chance > 0)) at->error = "products or a chance that are not above 0";
  if (at->error) return 0;
  if (!at->particles) return HUGE_VAL;
  if (bound == MPMSTAB_DT_LONE || mls_mpm) at->omega2 = lone = mpmstab_dt_largest(at, mls_mpm ? 2 : 1);
  if (bound == MPMSTAB_DT_PARTICLE) at->omega2 = mpmstab_dt_split(at);
  if (bound == MPMSTAB_DT_LANCZOS) at->particle = -1, at->omega2 = mpmstab_dt_certificate(at);
  return sqrt(mls_mpm ? 2 / at->omega2 + 2 / lone : at->factor / at->omega2);
}
#endif
