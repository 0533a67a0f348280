/*
   The bounds of include/mpmstab_dt.h on random layouts in one to three dimensions, with walls, voids, periods and several
   materials. All are at least the largest eigenvalue of the dense M^-1 K (LAPACK); lone and particle are those of the small
   matrices V_p C^1/2 (sum_i B_i^T B_i / (m_i theta_ip)) C^1/2 in strains of Voigt; a certificate fails no more often than it
   may; and the step of MLS_MPM is at most that of the dense pencil (K, 1 + F). Weights here are those of Cox and de Boor.
*/
#include "check.h"
#include "base/hash.h"
#include <mpmstab_dt.h>
#include <petscblaslapack.h>

enum { MOST = 540, PARTICLES = 64, NODES = 216 };

typedef struct {
  float  volume;
  double mass, x[3], modulus[2];
} Point;

typedef struct {
  mpmstab_dt_layout at;
  Point             p[PARTICLES];
  unsigned char     fixed[NODES];
  double            S[PARTICLES][NODES], g[PARTICLES][NODES][3], mass[NODES];
  double            K[MOST * MOST], F[MOST * MOST], mode[3 * NODES];
  PetscInt          nodes, unknowns, number[3 * NODES];
} Layout;

static double Draw(PetscInt64 seed, PetscInt *count)
{
  return MpmHash(seed, (*count)++);
}

/* The B-spline of degree k and its derivative at a distance of t cells from its middle. */
static double Spline(int k, double t)
{
  const double half = (k + 1) / 2.;

  if (k == 0) return t >= -0.5 && t < 0.5;
  return ((half + t) * Spline(k - 1, t + 0.5) + (half - t) * Spline(k - 1, t - 0.5)) / k;
}

static double Slope(int k, double t)
{
  return Spline(k - 1, t + 0.5) - Spline(k - 1, t - 0.5);
}

/* A random layout. Basis, walls, periods, mls and materials are drawn as well. */
static void Fill(PetscInt64 seed, int dim, PetscInt most, Layout *l)
{
  PetscInt   count = 0;
  const int  basis = 2 + (int)(3 * Draw(seed, &count)), young = Draw(seed, &count) < 0.5;
  const long n[3]       = {basis + (long)(4 * Draw(seed, &count)), dim > 1 ? basis + (long)(2 * Draw(seed, &count)) : 1,
                     dim > 2 ? basis + (long)(1.3 * Draw(seed, &count)) : 1};
  mpmstab_dt_layout *at = &l->at;

  mpmstab_dt_init(at, dim, basis, 0.1, n[0], n[1], n[2]);
  at->mls       = Draw(seed, &count) < 0.4;
  at->particles = 1 + (long)((double)most * Draw(seed, &count));
  at->seed      = (unsigned long long)seed;
  l->nodes      = n[0] * n[1] * n[2];
  for (int a = 0; a < dim; a++) {
    at->h[a]        = 0.1 + Draw(seed, &count);
    at->origin[a]   = Draw(seed, &count) - 0.5;
    at->periodic[a] = n[a] > 4 && Draw(seed, &count) < 0.5;
  }
  for (long p = 0; p < at->particles; p++) {
    l->p[p].volume = (float)(0.1 + Draw(seed, &count));
    l->p[p].mass   = exp(4 * Draw(seed, &count));
    for (int a = 0; a < dim; a++) {
      const double low = at->periodic[a] ? -2 : basis / 2. - 1, width = at->periodic[a] ? 9 : (double)n[a] - basis + 1;

      l->p[p].x[a] = at->origin[a] + at->h[a] * (low + width * (0.001 + 0.998 * Draw(seed, &count)));
    }
    l->p[p].modulus[0] = exp(3 * Draw(seed, &count)) * (young ? 1 : Draw(seed, &count) - 0.4);
    l->p[p].modulus[1] = young ? 0.9 * Draw(seed, &count) - 0.42 : 1.5 * exp(3 * Draw(seed, &count));
    if (!young) l->p[p].modulus[0] = fmax(l->p[p].modulus[0], -0.6 * l->p[p].modulus[1]);
  }
  for (PetscInt i = 0; i < l->nodes; i++)
    l->fixed[i] = Draw(seed, &count) < 0.2 ? (unsigned char)(8 * Draw(seed, &count)) : 0;
  at->fixed   = l->fixed;
  at->x       = mpmstab_dt_numbers(l->p[0].x, sizeof(double), sizeof(Point));
  at->volume  = mpmstab_dt_numbers(&l->p[0].volume, sizeof(float), sizeof(Point));
  at->mass    = mpmstab_dt_numbers(&l->p[0].mass, sizeof(double), sizeof(Point));
  at->lambda  = mpmstab_dt_numbers(&l->p[0].modulus[0], sizeof(double), sizeof(Point));
  at->mu      = mpmstab_dt_numbers(&l->p[0].modulus[1], sizeof(double), sizeof(Point));
  at->young   = young ? at->lambda : at->young;
  at->poisson = at->mu;
}

/* Weights and gradients of all nodes, by sums over all images of a period. */
static void Weigh(Layout *l)
{
  const mpmstab_dt_layout *at = &l->at;
  const int                k  = at->basis - 1;
  const double             D  = k == 2 ? 0.25 : 1. / 3;

  memset(l->mass, 0, sizeof l->mass);
  for (long p = 0; p < at->particles; p++)
    for (PetscInt i = 0; i < l->nodes; i++) {
      double     S[3] = {1, 1, 1}, g[3] = {0};
      const long of[3] = {i % at->nodes[0], i / at->nodes[0] % at->nodes[1], i / (at->nodes[0] * at->nodes[1])};

      for (int a = 0; a < at->dim; a++) {
        S[a] = 0;
        for (int image = at->periodic[a] ? -6 : 0; image <= (at->periodic[a] ? 6 : 0); image++) {
          const double t = (l->p[p].x[a] - at->origin[a]) / at->h[a] - (double)(of[a] + image * at->nodes[a]);

          S[a] += Spline(k, t);
          g[a] += (at->mls && k > 1 ? -Spline(k, t) * t / D : Slope(k, t)) / at->h[a];
        }
      }
      l->S[p][i]    = S[0] * S[1] * S[2];
      l->g[p][i][0] = g[0] * S[1] * S[2], l->g[p][i][1] = S[0] * g[1] * S[2], l->g[p][i][2] = S[0] * S[1] * g[2];
      l->mass[i] += l->p[p].mass * l->S[p][i];
    }
}

static void Lame(const Layout *l, long p, double *lambda, double *mu)
{
  const double *m = l->p[p].modulus;

  *lambda = l->at.young.first ? m[0] * m[1] / ((1 + m[1]) * (1 - 2 * m[1])) : m[0];
  *mu     = l->at.young.first ? m[0] / 2 / (1 + m[1]) : m[1];
}

/* The dense M^-1/2 K M^-1/2, and F, P2G of G2P with the affine part, for unknowns of nodes with mass and without wall. */
static void Assemble(Layout *l)
{
  const int d = l->at.dim;

  l->unknowns = 0;
  for (PetscInt i = 0; i < d * l->nodes; i++)
    l->number[i] = l->mass[i / d] > 0 && !(l->fixed[i / d] >> i % d & 1) ? l->unknowns++ : -1;
  memset(l->K, 0, sizeof l->K), memset(l->F, 0, sizeof l->F);
  for (long p = 0; p < l->at.particles; p++)
    for (PetscInt i = 0; i < d * l->nodes; i++)
      for (PetscInt j = 0; j < d * l->nodes; j++) {
        const PetscInt at = l->number[i] * l->unknowns + l->number[j], a = i % d, b = j % d;
        const double  *gi = l->g[p][i / d], *gj = l->g[p][j / d];
        double         lambda, mu, dot = 0, affine = 0;

        if (l->number[i] < 0 || l->number[j] < 0) continue;
        Lame(l, p, &lambda, &mu);
        for (int c = 0; c < d; c++) {
          dot += gi[c] * gj[c];
          affine += gi[c] * gj[c] * (l->at.basis == 3 ? 0.25 : 1. / 3) * l->at.h[c] * l->at.h[c];
        }
        l->K[at] += (double)l->p[p].volume * (lambda * gi[a] * gj[b] + mu * gi[b] * gj[a] + (a == b ? mu * dot : 0)) /
                    sqrt(l->mass[i / d] * l->mass[j / d]);
        if (a == b)
          l->F[at] += l->p[p].mass * (l->S[p][i / d] * l->S[p][j / d] + affine) / sqrt(l->mass[i / d] * l->mass[j / d]);
      }
}

/* The largest eigenvalue of A x = lambda B x; B is the identity where it is NULL. */
static double Largest(PetscInt order, double *A, double *B)
{
  PetscBLASInt  n = (PetscBLASInt)order, room = 40 * MOST, type = 1, info = 0;
  static double value[MOST], work[40 * MOST];

  if (!n) return 0;
  if (B)
    LAPACKsygv_(&type, "N", "U", &n, A, &n, B, &n, value, work, &room, &info);
  else
    LAPACKsyev_("N", "U", &n, A, &n, value, work, &room, &info);
  CHECK(info == 0, "LAPACK: %d", (int)info);
  return value[n - 1];
}

/* The bound of a particle with the mass of a node that theta gives it, by strains of Voigt. */
static double Voigt(const Layout *l, long p, PetscBool lone)
{
  static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  const int        d = l->at.dim, all = (1 << d) - 1;
  double           N[36] = {0}, C[36] = {0}, product[36] = {0}, lambda, mu, most = 0;

  Lame(l, p, &lambda, &mu);
  for (int s = 0; s < 6; s++) {
    for (int t = 0; t < 3 && s < 3; t++) C[6 * s + t] = s < d && t < d ? lambda + (s == t ? 2 * mu : 0) : 0;
    if (s > 2) C[7 * s] = pair[s][1] < d ? mu : 0;
  }
  for (PetscInt i = 0; i < l->nodes; i++) {
    const double *g       = l->g[p][i];
    const double  size    = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    double        B[6][3] = {{0}}, part = 0;

    if (!(size > 0) || (l->fixed[i] & all) == all) continue;
    for (long q = 0; q < l->at.particles; q++)
      part += l->p[q].volume *
              sqrt(l->g[q][i][0] * l->g[q][i][0] + l->g[q][i][1] * l->g[q][i][1] + l->g[q][i][2] * l->g[q][i][2]);
    part = lone ? l->p[p].volume / l->p[p].mass / l->S[p][i] : part / size / l->mass[i];
    for (int s = 0; s < 6; s++) B[s][pair[s][0]] += g[pair[s][1]];
    for (int s = 3; s < 6; s++) B[s][pair[s][1]] += g[pair[s][0]];
    for (int s = 0; s < 36; s++)
      for (int a = 0; a < 3; a++) N[s] += part * B[s / 6][a] * B[s % 6][a];
  }
  { /* the eigenvalues of C N, by L^T N L with C = L L^T, where C may be singular: by those of C^1/2 N C^1/2 */
    PetscBLASInt n = 6, room = 300, info;
    double       value[6], work[300], root[36] = {0};

    LAPACKsyev_("V", "U", &n, C, &n, value, work, &room, &info);
    for (int k = 0; k < 6; k++)
      for (int s = 0; s < 36; s++) root[s] += sqrt(fmax(value[k], 0)) * C[6 * k + s / 6] * C[6 * k + s % 6];
    for (int s = 0; s < 36; s++)
      for (int t = 0; t < 36; t++) product[s] += root[6 * (s / 6) + t / 6] * N[t] * root[6 * (t % 6) + s % 6];
    LAPACKsyev_("N", "U", &n, product, &n, value, work, &room, &info);
    most = value[5];
  }
  return most;
}

static void CheckBounds(PetscInt64 seed, Layout *l)
{
  mpmstab_dt_layout *at = &l->at;
  double             exact, lone = 0, particle = 0, step;

  Fill(seed, 1 + (int)(seed % 3), seed % 3 == 2 ? 12 : 40, l);
  Weigh(l);
  Assemble(l);
  at->work = malloc(mpmstab_dt_bytes(at));
  for (long p = 0; p < at->particles; p++)
    lone = fmax(lone, Voigt(l, p, PETSC_TRUE)), particle = fmax(particle, Voigt(l, p, PETSC_FALSE));
  if (at->mls && at->basis > 2) { /* usl with apic: stable for K <= 2 (1 + F) */
    static double K[MOST * MOST], one[MOST * MOST];

    for (PetscInt i = 0; i < l->unknowns * l->unknowns; i++)
      K[i] = l->K[i], one[i] = l->F[i] + (i % (l->unknowns + 1) ? 0 : 1);
    exact      = sqrt(2 / Largest(l->unknowns, K, one));
    at->factor = MPMSTAB_DT_MLS_MPM, at->chance = 1e-12;
    for (int bound = MPMSTAB_DT_LONE; bound <= MPMSTAB_DT_LANCZOS; bound++) {
      step = mpmstab_dt_step(at, bound);
      CHECK(step <= exact * (1 + 1e-9), "layout %d, MLS_MPM, bound %d: step %g, exact %g", (int)seed, bound, step,
            exact);
    }
    at->factor = MPMSTAB_DT_USL;
  }
  exact = Largest(l->unknowns, l->K, NULL);
  step  = mpmstab_dt_step(at, MPMSTAB_DT_LONE);
  CHECK(!at->error, "layout %d: particle %ld has %s", (int)seed, at->particle, at->error);
  CHECK_NEAR(at->omega2, lone, 1e-12 * lone);
  CHECK(at->omega2 >= exact * (1 - 1e-12), "layout %d: lone %.17g below %.17g", (int)seed, at->omega2, exact);
  CHECK_NEAR(step, sqrt(2 / lone), 1e-12 * step);
  for (at->sweeps = 0; at->sweeps <= 3; at->sweeps += 3) {
    mpmstab_dt_step(at, MPMSTAB_DT_PARTICLE);
    if (!at->sweeps) CHECK_NEAR(at->omega2, particle, 1e-12 * particle);
    CHECK(at->omega2 <= particle * (1 + 1e-12), "layout %d: sweeps make it worse", (int)seed);
    CHECK(at->omega2 >= exact * (1 - 1e-12), "layout %d, %d sweeps: %.17g below %.17g", (int)seed, at->sweeps,
          at->omega2, exact);
  }
  at->chance = 1e-12, at->mode = l->mode;
  mpmstab_dt_step(at, MPMSTAB_DT_LANCZOS);
  CHECK(at->omega2 >= exact * (1 - 1e-12), "layout %d: certificate %.17g below %.17g", (int)seed, at->omega2, exact);
  CHECK(at->omega2_least <= exact * (1 + 1e-12), "layout %d: %.17g above %.17g", (int)seed, at->omega2_least, exact);
  CHECK(at->particle >= 0 && at->particle < at->particles, "layout %d: particle %ld", (int)seed, at->particle);
  free(at->work);
}

/* Certificates of chance 1e-2 after some products, over many tiny layouts. */
static void CheckChance(Layout *l)
{
  const int many  = 6000;
  int       wrong = 0, sharp = 0;

  for (PetscInt64 seed = 1; seed <= many; seed++) {
    double exact;

    Fill(-seed, 1 + (int)(seed % 2), 12, l);
    Weigh(l);
    Assemble(l);
    exact        = Largest(l->unknowns, l->K, NULL);
    l->at.work   = malloc(mpmstab_dt_bytes(&l->at));
    l->at.chance = 1e-2, l->at.products = 1 + (int)(seed % 6);
    mpmstab_dt_step(&l->at, MPMSTAB_DT_LANCZOS);
    wrong += l->at.omega2 < exact * (1 - 1e-12);
    sharp += l->at.omega2 < 4 * exact;
    free(l->at.work);
  }
  CHECK(wrong <= many / 100, "%d of %d certificates of chance 1e-2 are wrong", wrong, many);
  CHECK(wrong > 0, "no certificate is wrong: the bound is not what it says");
  CHECK(sharp > many / 4, "only %d of %d certificates are within a factor of 4", sharp, many);
}

/* The random start: moments of normal numbers, and numbers of other seeds and unknowns are others. */
static void CheckNormal(void)
{
  const long many      = 200000;
  double     moment[5] = {0}, beside = 0;

  for (long i = 0; i < many; i++) {
    const double x = mpmstab_dt_normal(7, i);

    for (int k = 1; k < 5; k++) moment[k] += pow(x, k) / (double)many;
    beside += x * (mpmstab_dt_normal(7, i + 1) + mpmstab_dt_normal(8, i)) / (double)many;
  }
  CHECK_NEAR(moment[1], 0, 0.01);
  CHECK_NEAR(moment[2], 1, 0.02);
  CHECK_NEAR(moment[3], 0, 0.05);
  CHECK_NEAR(moment[4], 3, 0.1);
  CHECK_NEAR(beside, 0, 0.02);
}

/* On hats in one dimension the best split is exact: signs of slopes alternate with the node. */
static void CheckSweeps(Layout *l)
{
  for (int seed = 0; seed < 20; seed++) {
    const double width = 0.1;

    Fill(seed, 1, 40, l);
    l->at.basis = MPMSTAB_DT_HATS, l->at.periodic[0] = 0, l->at.fixed = NULL, l->at.h[0] = width, l->at.origin[0] = 0;
    memset(l->fixed, 0, sizeof l->fixed);
    for (long p = 0; p < l->at.particles; p++)
      l->p[p].x[0] = width * (double)(l->nodes - 1) * (0.001 + 0.998 * MpmHash(seed, 1000 + p));
    Weigh(l);
    Assemble(l);
    l->at.work = malloc(mpmstab_dt_bytes(&l->at)), l->at.sweeps = 3000;
    mpmstab_dt_step(&l->at, MPMSTAB_DT_PARTICLE);
    CHECK_NEAR(l->at.omega2, Largest(l->unknowns, l->K, NULL), 1e-4 * l->at.omega2);
    free(l->at.work);
  }
}

/* Nodes, weights and gradients by pointer, with one number for all particles, give what the name of a basis gives. */
static void CheckPointers(Layout *l)
{
  static long   node[PARTICLES * NODES];
  static double weight[PARTICLES * NODES], gradient[3 * PARTICLES * NODES];
  double        step[2][3];

  for (int seed = 0; seed < 60; seed++) {
    mpmstab_dt_layout *at = &l->at;

    Fill(seed, 1 + seed % 3, 12, l);
    if (l->nodes > MPMSTAB_DT_MOST) continue;
    Weigh(l);
    at->mass.stride = at->volume.stride = at->young.stride = at->poisson.stride = at->lambda.stride = 0;
    at->mu.stride                                                                                   = 0;
    for (long k = 0; k < at->particles * l->nodes; k++) {
      node[k] = k % l->nodes, weight[k] = l->S[k / l->nodes][k % l->nodes];
      for (int a = 0; a < at->dim; a++) gradient[k * at->dim + a] = l->g[k / l->nodes][k % l->nodes][a];
    }
    at->work = malloc(mpmstab_dt_bytes(at));
    for (int way = 0; way < 2; way++) {
      for (int bound = MPMSTAB_DT_LONE; bound <= MPMSTAB_DT_LANCZOS; bound++)
        at->seed = 5, step[way][bound] = mpmstab_dt_step(at, bound);
      at->basis = MPMSTAB_DT_POINTERS, at->width = l->nodes, at->node = node, at->weight = weight,
      at->gradient = gradient;
      at->nodes[0] = l->nodes, at->nodes[1] = at->nodes[2] = 1, at->mls = 0;
    }
    for (int bound = 0; bound < 3; bound++) CHECK_NEAR(step[0][bound], step[1][bound], 1e-9 * step[0][bound]);
    free(at->work);
  }
}

/* What is wrong is said, with the particle, and the step is 0. */
static void CheckFaults(Layout *l)
{
  const char *of[5];

  for (int fault = 0; fault < 5; fault++) {
    Fill(3, 1, 40, l);
    l->at.periodic[0] = 0;
    for (long p = 0; p < l->at.particles; p++) l->p[p].x[0] = l->at.origin[0] + 1.1 * l->at.h[0];
    l->p[2].volume     = fault == 0 ? -1 : fault == 1 ? NAN : l->p[2].volume;
    l->p[2].mass       = fault == 2 ? 0 : l->p[2].mass;
    l->p[2].modulus[0] = fault == 3 ? -1e9 : l->p[2].modulus[0];
    l->p[2].x[0]       = fault == 4 ? NAN : l->p[2].x[0];
    l->at.work         = malloc(mpmstab_dt_bytes(&l->at));
    CHECK(mpmstab_dt_step(&l->at, MPMSTAB_DT_LONE) == 0 && l->at.particle == 2, "fault %d: particle %ld", fault,
          l->at.particle);
    of[fault] = l->at.error;
    free(l->at.work);
  }
  CHECK(of[0] == of[1] && of[0] == of[2] && of[3] != of[4] && of[3] != of[0],
        "faults have other words than those that they need");
}

static PetscErrorCode Check(int argc, char **argv)
{
  static Layout layout;

  PetscFunctionBegin;
  (void)argc, (void)argv;
  for (PetscInt64 seed = 1; seed <= 900; seed++) CheckBounds(seed, &layout);
  CheckChance(&layout);
  CheckNormal();
  CheckSweeps(&layout);
  CheckPointers(&layout);
  CheckFaults(&layout);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Check)
