/*
   The exact solution of a scene. Its mode is a plane wave, or the sum of a plane wave and its mirror images.

   A mirror at the left end of direction a takes a velocity field v(X) to R v(R X), where R changes the sign of component
   a, and a scalar u(X) to u(R X), or to -u(R X) where it vanishes at the end. The continuous problem is the same on both
   sides. So the mean of a plane wave and of its images is a solution. It fulfils the conditions of symmetry, and for a
   scalar those of any ends. The conditions at the right end choose the wave number.
*/
#include <mpmstab/scene.h>
#include <math.h>

/* How a mode meets the ends. wave: the plane wave itself. */
typedef struct {
  const MpmScene *scene;
  PetscBool       vector;         /* its first field is a vector, with more than one dimension */
  PetscReal       K[MPM_MAX_DIM]; /* wave vector */
  PetscBool       ends[MPM_MAX_DIM], odd[MPM_MAX_DIM][2];
  PetscInt        directions, free; /* in how many it goes, and how many of these are periodic */
  MpmPlaneWave    wave;
} Mode;

static PetscBool IsAlong(const Mode *m, PetscInt a)
{
  return m->scene->mode[a] != 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* The length of the material, since a bar may end before its domain does. */
static PetscReal LengthOf(const MpmScene *scene, PetscInt a)
{
  return MpmLayoutIsPeriodic(&scene->layout) || scene->layout.given || scene->layout.particles == scene->layout.sites ||
                 scene->layout.dim > 1
             ? scene->length[a]
             : scene->cell_width * (PetscReal)scene->layout.particles / scene->layout.ppc[0];
}

/* The unit vector along which the material moves, when the wave goes along n. */
static void SetDirection(const MpmScene *scene, const PetscReal n[], PetscReal direction[])
{
  const PetscReal across = scene->layout.dim > 1 ? hypot(n[0], n[1]) : 0;

  for (PetscInt a = 0; a < scene->layout.dim; a++) direction[a] = n[a];
  if (scene->polarisation != MPM_S_WAVE) return;
  for (PetscInt a = 0; a < scene->layout.dim; a++) direction[a] = 0;
  direction[0] = across > 0 ? -n[1] / across : 1;
  direction[1] = across > 0 ? n[0] / across : 0;
}

/*
   The wave vector, and the signs at the ends. A velocity is odd about the ends of a direction that it has a component
   in, at others only where it must not slip. Half a wave more or less fits between ends that are not alike.
*/
static void SetWaveVector(Mode *m)
{
  const MpmScene *s       = m->scene;
  const PetscInt  dim     = s->layout.dim;
  PetscReal       squares = 0;

  for (PetscInt a = 0; a < dim; a++) {
    m->wave.normal[a] = s->mode[a] / s->length[a];
    squares += PetscSqr(m->wave.normal[a]);
  }
  for (PetscInt a = 0; a < dim; a++) m->wave.normal[a] /= sqrt(squares);
  SetDirection(s, m->wave.normal, m->wave.direction);
  for (PetscInt a = 0; a < dim; a++) {
    const PetscBool normal = dim == 1 || (m->vector && m->wave.direction[a] != 0) ? PETSC_TRUE : PETSC_FALSE;

    m->K[a]    = 2 * PETSC_PI * s->mode[a] / LengthOf(s, a);
    m->ends[a] = s->layout.grid[a].ends[0] != MPM_PERIODIC ? PETSC_TRUE : PETSC_FALSE;
    for (int e = 0; e < 2; e++)
      m->odd[a][e] = MpmEndIsOdd(s->layout.grid[a].ends[e], normal ? MPM_NORMAL : MPM_TANGENTIAL);
    if (m->ends[a])
      m->K[a] = (m->odd[a][0] == m->odd[a][1] ? s->mode[a] : s->mode[a] - 0.5) * PETSC_PI / LengthOf(s, a);
    m->directions += IsAlong(m, a);
    m->free += IsAlong(m, a) && !m->ends[a];
  }
}

/* Whether the mode fulfils the conditions at the ends of direction a. */
static PetscBool Fits(const Mode *m, PetscInt a)
{
  const MpmEnd   *ends     = m->scene->layout.grid[a].ends;
  const PetscBool symmetry = ends[0] == MPM_SYMMETRY && ends[1] == MPM_SYMMETRY ? PETSC_TRUE : PETSC_FALSE;

  if (!m->ends[a]) return PETSC_TRUE;
  if (!m->vector) return IsAlong(m, a) || (!m->odd[a][0] && !m->odd[a][1]) ? PETSC_TRUE : PETSC_FALSE;
  if (IsAlong(m, a)) return m->directions == 1 || symmetry ? PETSC_TRUE : PETSC_FALSE;
  return symmetry && m->wave.direction[a] == 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* The sine and cosine factors of the mode make a wave with this phase at X = 0. */
static PetscReal PhaseOf(const Mode *m)
{
  PetscInt sines = m->free > 0;

  for (PetscInt a = 0; a < m->scene->layout.dim; a++)
    if (m->ends[a] && IsAlong(m, a) && m->odd[a][0]) sines++;
  if (m->vector) sines = PetscMin(sines, 1); /* each component is odd in one direction at most */
  return (1 - sines) * (PETSC_PI / 2);
}

/* Adds the images of the waves that there are so far, in all directions with ends but the first that the mode goes in. */
static void AddImages(const Mode *m, MpmProfile *p)
{
  PetscBool first = m->free ? PETSC_FALSE : PETSC_TRUE;

  for (PetscInt a = 0; a < p->dim; a++) {
    const PetscInt n = p->nwaves;

    if (!m->ends[a] || !IsAlong(m, a)) continue;
    for (PetscInt w = 0; w < n && !first; w++) {
      p->wave[w].weight /= 2;
      p->wave[n + w] = p->wave[w];
      p->wave[n + w].normal[a] *= -1;
      p->wave[n + w].direction[a] *= -1;
      if (!m->vector && m->odd[a][0]) p->wave[n + w].weight *= -1;
      p->nwaves++;
    }
    first = PETSC_FALSE;
  }
}

static void SetMode(const MpmScene *scene, MpmProfile *p)
{
  const MpmSpace *space   = &scene->scheme.space;
  const PetscReal mu      = (1 - 2 * p->poisson) / (2 * (1 - p->poisson));
  PetscReal       squares = 0;
  Mode            m       = {.scene = scene, .wave = {.weight = 1}};

  m.vector =
      scene->layout.dim > 1 && scene->scheme.formulation->particle_ranks[0] == MPM_VECTOR ? PETSC_TRUE : PETSC_FALSE;
  SetWaveVector(&m);
  for (PetscInt a = 0; a < p->dim; a++) squares += PetscSqr(m.K[a]);
  p->wavenumber = sqrt(squares);
  p->speed      = scene->polarisation == MPM_S_WAVE ? p->wave_speed * sqrt(mu) : p->wave_speed;
  p->decay      = p->wave_speed / p->cell_width *
             (space->damping +
              (space->viscous[1] + (scene->polarisation == MPM_S_WAVE ? 0 : space->viscous[0] + space->viscous[1])) *
                  squares * PetscSqr(p->cell_width));
  p->phase = PhaseOf(&m);
  for (PetscInt a = 0; a < p->dim; a++) m.wave.normal[a] = m.K[a] / p->wavenumber;
  SetDirection(scene, m.wave.normal, m.wave.direction);
  for (PetscInt a = 0; a < p->dim; a++)
    if (!Fits(&m, a)) return;
  p->nwaves  = 1;
  p->wave[0] = m.wave;
  AddImages(&m, p);
}

MpmProfile MpmSceneProfile(const MpmScene *scene, PetscReal amplitude)
{
  MpmProfile profile = {.initial    = scene->initial,
                        .dim        = scene->layout.dim,
                        .length     = LengthOf(scene, 0),
                        .wave_speed = scene->wave_speed,
                        .cell_width = scene->cell_width,
                        .amplitude  = amplitude,
                        .poisson    = MpmSceneHasPoisson(scene) ? scene->scheme.space.poisson : 0.5};

  SetMode(scene, &profile);
  for (int end = 0; end < 2 && scene->layout.grid[0].ends[0] != MPM_PERIODIC; end++)
    profile.image[end] = MpmEndIsFixed(scene->layout.grid[0].ends[end]) ? -1 : 1;
  return profile;
}

PetscReal MpmSceneExact(const MpmScene *scene, const MpmProfile *profile, PetscInt r, const PetscReal X[], PetscReal t)
{
  const MpmTable *table = scene->scheme.table;
  const PetscInt  field = table->field[r];
  const PetscBool lags  = scene->stagger && field == scene->scheme.formulation->staggered ? PETSC_TRUE : PETSC_FALSE;

  return scene->scheme.formulation->wave->value(profile, field, table->component[r], X, lags ? t - scene->dt / 2 : t);
}
