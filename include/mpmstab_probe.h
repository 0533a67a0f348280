/*
   mpmstab_probe: one call in your own time loop writes the matrix of your step. This header and mpmstab_scales.h beside
   it are all that is needed, in C and in C++:

     mpmstab_hook hook = {{0}};                                     periods of the grid: {{Lx, Ly, Lz}}, 0 where none

     mpmstab_place(&hook, "x", &p[0].x, MPMSTAB_DOUBLE, 2, sizeof p[0], n);
     mpmstab_field(&hook, "v", &p[0].v, MPMSTAB_DOUBLE, 2, sizeof p[0], n, 0);
     while (!mpmstab_probe(&hook, "A.mtx", h)) advance(dt);         h: the width of a cell

     mpmstab spectrum -matrix A.mtx
     mpmstab symbol -matrix_blocks A.mtx                            all waves, where all cells are alike

   Each call keeps the answer to the last perturbation, restores the state, perturbs other unknowns and lets your loop
   do its step. The last call writes the matrix, restores the state to the last bit, and returns 1; so do all later
   ones.

   All that a step changes and a later step reads has to be registered, and particles have to keep their order and their
   memory. The columns are central differences,

     A e_j = (F(q + s e_j) - F(q - s e_j)) / (2 s)    with F the step and q the state at the first call.

   A step reaches a few cells. So particles far enough apart are perturbed in one call, once a few calls have shown how
   far a particle reaches. Without a place, or when answers come from elsewhere, each column has calls of its own.

   Comments of the file say how far the matrix can be trusted; numbers are relative to the fields' scales. Numbers of a
   particle that no step reads back, such as places at rest, are left out, since no other eigenvalue feels them:
     moved       largest change of the state in a step: where it is not small, eigenvalues describe this one step
     repeat      difference of the same step early and late: other than 0 when something is not registered, or has switched
     two_steps   difference of two steps in a row from two of which the second begins anew from the state that is registered
     one_sided   largest difference between an entry from forward and from central differences, beyond what curvature
                 makes: switches at the state
     two_sizes   Frobenius norm of the change of the matrix with perturbations twice as large: rounding and curvature
     additivity  difference between the response to a random perturbation and A times it, relative to the larger
     unsettled   change of the scales that were found, in powers of 2, when they were looked for once more
*/
#ifndef MPMSTAB_PROBE_H
#define MPMSTAB_PROBE_H
#include "mpmstab_scales.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef MPMSTAB_PROBE_API /* empty: functions that other languages can call */
#define MPMSTAB_PROBE_API static inline
#endif

#ifdef __cplusplus
extern "C" {
#endif

enum { MPMSTAB_FLOAT = 4, MPMSTAB_DOUBLE = 8 };
enum {
  MPMSTAB_BEGIN,
  MPMSTAB_REST,
  MPMSTAB_SCALES,
  MPMSTAB_FIRST,
  MPMSTAB_REACH,
  MPMSTAB_COLUMNS,
  MPMSTAB_CHECK,
  MPMSTAB_LAST,
  MPMSTAB_DONE
};
enum { MPMSTAB_MOST_FIELDS = MPMSTAB_SCALES_MOST, MPMSTAB_MOST_BINS = 100000000, MPMSTAB_ASKED = 4 };

/* period: of the grid in each direction; 0: none. The rest belongs to the functions below. */
typedef struct {
  double               period[3];
  struct mpmstab_work *work;
} mpmstab_hook;

typedef struct {
  const char *name;
  char       *first;
  int         type, size, begin;
  size_t      stride;
  double      scale;
} mpmstab_registered;

/*
   at: which particles are perturbed together, by cells; reach: -1 where there are none. For each pair of numbers of a
   particle, couples has the largest entry, kinks and sizes what one_sided and two_sizes are made of; own: the largest
   entry on the diagonal. apart: numbers that no other eigenvalue feels.
*/
struct mpmstab_work {
  mpmstab_registered field[MPMSTAB_MOST_FIELDS];
  mpmstab_scales     scales;
  mpmstab_colours    at;
  int                nfields, width, place, stage, asked, number, reach, single;
  long               particles, colour, middle, calls;
  double  cell, period[3], *base, *rest, *first, *again, *scale, *answer[MPMSTAB_ASKED], *amount[MPMSTAB_ASKED];
  double  moved, repeat, two_steps, one_sided, two_sizes, additivity, leaks, *couples, *own, *kinks, *sizes;
  char   *apart;
  long    n, room, *row, *column;
  double *value;
};

static inline void *mpmstab_room_(void *old, size_t bytes)
{
  void *room = realloc(old, bytes ? bytes : 1);

  if (!room) {
    fprintf(stderr, "mpmstab_probe: no memory for %.0f bytes\n", (double)bytes);
    exit(1);
  }
  return room;
}

/*
   mpmstab_field - registers a field. first: of the first particle; type: MPMSTAB_FLOAT or MPMSTAB_DOUBLE; size: numbers
   of a particle, one after another; stride: bytes from one particle to the next; scale: what a change of order 1 means,
   or 0: it is found from a few steps.
*/
MPMSTAB_PROBE_API void mpmstab_field(mpmstab_hook *hook, const char *name, void *first, int type, int size,
                                     size_t stride, long particles, double scale)
{
  struct mpmstab_work *w = hook->work;
  mpmstab_registered  *f;

  if (!w) {
    w        = (struct mpmstab_work *)memset(mpmstab_room_(NULL, sizeof *w), 0, sizeof *w);
    w->place = -1, w->particles = particles, hook->work = w;
  }
  if (w->nfields == MPMSTAB_MOST_FIELDS || particles != w->particles || particles < 1 || size < 1 ||
      (type != MPMSTAB_FLOAT && type != MPMSTAB_DOUBLE)) {
    fprintf(stderr, "mpmstab_probe: field %s of %ld particles; allowed: up to 64 fields, all of as many particles\n",
            name, particles);
    exit(2);
  }
  f       = &w->field[w->nfields++];
  f->name = name, f->first = (char *)first, f->type = type, f->size = size, f->begin = w->width, f->stride = stride;
  f->scale = scale;
  w->width += size;
  if (type == MPMSTAB_FLOAT) w->single = 1;
}

/* mpmstab_place - registers the field that is the place of a particle, one number for each direction. */
MPMSTAB_PROBE_API void mpmstab_place(mpmstab_hook *hook, const char *name, void *first, int type, int size,
                                     size_t stride, long particles)
{
  mpmstab_field(hook, name, first, type, size, stride, particles, 0);
  hook->work->place = hook->work->nfields - 1;
}

/* ---- the state ---- */

/* Copies the state from the fields, or to them. */
static inline void mpmstab_copy_(struct mpmstab_work *w, double *state, int to_fields)
{
  for (int f = 0; f < w->nfields; f++) {
    const mpmstab_registered *of = &w->field[f];

    for (long i = 0; i < w->particles * of->size; i++) {
      double *number = &state[i / of->size * w->width + of->begin + i % of->size];
      char   *at     = of->first + (size_t)(i / of->size) * of->stride + (size_t)(i % of->size) * (size_t)of->type;

      if (of->type == MPMSTAB_DOUBLE && to_fields) *(double *)at = *number;
      if (of->type == MPMSTAB_FLOAT && to_fields) *(float *)at = (float)*number;
      if (!to_fields) *number = of->type == MPMSTAB_DOUBLE ? *(double *)at : (double)*(float *)at;
    }
  }
}

/* The direction of a number of a particle if it is one of its place, else -1. */
static inline int mpmstab_axis_(const struct mpmstab_work *w, int number)
{
  const int axis = w->place < 0 ? -1 : number - w->field[w->place].begin;

  return axis >= 0 && axis < w->field[w->place].size && axis < 3 ? axis : -1;
}

/* one - other of an unknown; a particle that has crossed a period is where it would be without. */
static inline double mpmstab_minus_(const struct mpmstab_work *w, long unknown, const double *one, const double *other)
{
  const int    axis = mpmstab_axis_(w, (int)(unknown % w->width));
  const double d    = one[unknown] - other[unknown];

  return axis >= 0 && w->period[axis] > 0 ? d - w->period[axis] * floor(d / w->period[axis] + 0.5) : d;
}

/* The largest difference of two states over the scales, of numbers that are not set apart. */
static inline double mpmstab_apart_(const struct mpmstab_work *w, const double *one, const double *other)
{
  double most = 0;

  for (long i = 0; i < w->particles * w->width; i++)
    if (!w->apart[i % w->width]) most = fmax(most, fabs(mpmstab_minus_(w, i, one, other)) / w->scale[i % w->width]);
  return most;
}

/* ---- colours ---- */

static inline int mpmstab_directions_(const struct mpmstab_work *w)
{
  const int size = w->place < 0 ? 0 : w->field[w->place].size;

  return size > 3 ? 3 : size;
}

/* Sorts the particles into bins, and finds the one nearest to the middle. A reach of -1: there are no bins. */
static inline void mpmstab_bins_(struct mpmstab_work *w, double h)
{
  const int dim     = mpmstab_directions_(w);
  double    nearest = HUGE_VAL, all = 1, low[3], high[3];

  w->reach = dim && h > 0 ? 0 : -1;
  for (int a = 0; a < dim && !w->reach; a++) {
    const double *x = w->base + w->field[w->place].begin + a;

    low[a] = high[a] = x[0];
    w->at.wraps[a]   = w->period[a] > 0;
    for (long i = 0; i < w->particles; i++) {
      low[a]  = fmin(low[a], x[i * w->width]);
      high[a] = fmax(high[a], x[i * w->width]);
    }
    all *= fmax((high[a] - low[a]) / h, w->period[a] / h) + 1;
    if (!(all < MPMSTAB_MOST_BINS)) w->reach = -1;
    w->at.bins[a] = w->reach           ? 0
                    : w->period[a] > 0 ? (long)ceil(w->period[a] / h - 1e-6)
                                       : (long)((high[a] - low[a]) / h) + 1;
  }
  for (long i = 0; i < w->particles && !w->reach; i++) {
    double far = 0;

    for (int a = 0; a < dim; a++) {
      const double x = w->base[i * w->width + w->field[w->place].begin + a], from = w->period[a] > 0 ? 0 : low[a];
      const double in = w->period[a] > 0 ? x - w->period[a] * floor(x / w->period[a]) : x - from;
      const long   b  = (long)(in / h);

      w->at.bin[3 * i + a] = b < w->at.bins[a] ? b : w->at.bins[a] - 1;
      far += fabs(x - (low[a] + high[a]) / 2);
    }
    if (far < nearest) nearest = far, w->middle = i;
  }
}

static inline void mpmstab_colours_(struct mpmstab_work *w)
{
  mpmstab_colours *c = &w->at;

  c->dim       = mpmstab_directions_(w);
  c->alone     = w->reach < 0;
  c->particles = w->particles;
  for (int a = 0; a < c->dim; a++) c->reach[a] = w->reach;
  if (!c->alone) c->grid = (long *)mpmstab_room_(c->grid, sizeof(long) * (size_t)mpmstab_cells_(c));
  if (mpmstab_colour_(c)) return;
  fprintf(stderr, "mpmstab_probe: no memory for the colours of %ld particles\n", w->particles);
  exit(1);
}

/* ---- what is asked, and what is made of the answers ---- */

static inline double mpmstab_size_(const struct mpmstab_work *w)
{
  return w->single ? 0.03125 : 7.62939453125e-06;
}

/*
   The perturbation: +s and -s of one number of the particles of a colour, +2s and -2s, or +-s at random of all numbers
   that are not set apart, or of a field, while scales are looked for. The first one is of all numbers, and so is the
   last. After the first the loop goes on, then begins at the base state, and then at the state after its first step.
*/
static inline void mpmstab_perturb_(struct mpmstab_work *w)
{
  const double  sign = w->asked % 2 ? -1 : 1, size = mpmstab_size_(w) * (w->asked / 2 + 1);
  double       *amount = w->amount[w->asked];
  unsigned long random = 1;

  for (long i = 0; i < w->particles * w->width; i++) {
    const int number = (int)(i % w->width), begin = w->field[w->number].begin;
    const int all = w->stage == MPMSTAB_SCALES  ? number >= begin && number < begin + w->field[w->number].size
                    : w->stage == MPMSTAB_CHECK ? !w->apart[number]
                                                : w->stage == MPMSTAB_LAST || (w->stage == MPMSTAB_FIRST && !w->asked);
    const int one = number == w->number && (w->stage == MPMSTAB_REACH     ? i / w->width == w->middle
                                            : w->stage == MPMSTAB_COLUMNS ? w->at.colour_of[i / w->width] == w->colour
                                                                          : 0);

    random    = (random * 1103515245UL + 12345UL) % 2147483648UL;
    amount[i] = w->base[i] + sign * size * w->scale[number] * (one ? 1 : all ? (double)random / 1073741824.0 - 1 : 0);
  }
  if (w->stage != MPMSTAB_FIRST || w->asked % 2 == 0) mpmstab_copy_(w, amount, 1);
  if (w->stage == MPMSTAB_FIRST && w->asked == 3) mpmstab_copy_(w, w->answer[0], 1);
  mpmstab_copy_(w, amount, 0); /* as the code's own numbers round it */
  for (long i = 0; i < w->particles * w->width; i++) amount[i] -= w->base[i];
  w->calls++;
}

static inline void mpmstab_entry_(struct mpmstab_work *w, long row, long column, double value)
{
  if (w->n == w->room) {
    w->room   = 2 * w->room + 1024;
    w->row    = (long *)mpmstab_room_(w->row, sizeof(long) * (size_t)w->room);
    w->column = (long *)mpmstab_room_(w->column, sizeof(long) * (size_t)w->room);
    w->value  = (double *)mpmstab_room_(w->value, sizeof(double) * (size_t)w->room);
  }
  w->row[w->n] = row, w->column[w->n] = column, w->value[w->n++] = value;
}

/* What rounding of a number may make of a difference quotient of two sizes, in scales. */
static inline double mpmstab_rounding_(const struct mpmstab_work *w, long unknown)
{
  const int number = (int)(unknown % w->width);
  int       f      = 0;

  while (f + 1 < w->nfields && w->field[f + 1].begin <= number) f++;
  return 4 * (w->field[f].type == MPMSTAB_FLOAT ? FLT_EPSILON : DBL_EPSILON) * fabs(w->base[unknown]) /
         w->scale[number] / mpmstab_size_(w);
}

static inline void mpmstab_take_columns_(struct mpmstab_work *w)
{
  double **f = w->answer, **d = w->amount;

  mpmstab_own_(&w->at, w->colour);
  for (long i = 0; i < w->particles * w->width; i++) {
    const long   owner = w->at.owner[i / w->width], j = owner * w->width + w->number;
    const double unit = w->scale[w->number] / w->scale[i % w->width], both = mpmstab_minus_(w, i, f[0], f[1]);
    const long   pair = i % w->width * w->width + w->number;

    if (owner < 0) {
      w->leaks = fmax(w->leaks, fabs(both) / w->scale[i % w->width] / (2 * mpmstab_size_(w)));
    } else {
      const double a = both / (d[0][j] - d[1][j]), b = mpmstab_minus_(w, i, f[2], f[3]) / (d[2][j] - d[3][j]);
      const double near_ = mpmstab_minus_(w, i, f[0], w->rest) / d[0][j] - a,
                   far_ = mpmstab_minus_(w, i, f[2], w->rest) / d[2][j] - b, kink = (2 * near_ - far_) * unit;
      double *most = i == j ? &w->own[w->number] : &w->couples[pair];

      *most          = fmax(*most, fabs(a) * unit);
      w->kinks[pair] = fmax(w->kinks[pair], fabs(kink) - mpmstab_rounding_(w, i));
      w->sizes[pair] += (b - a) * (b - a) * unit * unit;
      if (a != 0) mpmstab_entry_(w, i, j, a);
    }
  }
}

/* Sets numbers apart, and takes the certificates without them. */
static inline void mpmstab_set_apart_(struct mpmstab_work *w)
{
  const int n     = w->width;
  char     *feels = (char *)mpmstab_room_(NULL, (size_t)(n * n));

  (void)mpmstab_set_apart_of_(n, w->single ? 1e-5 : 1e-8, w->couples, w->own, feels, w->apart);
  free(feels);
  w->one_sided = w->two_sizes = 0;
  for (int i = 0; i < n * n; i++) {
    if (w->apart[i / n] || w->apart[i % n]) continue;
    w->one_sided = fmax(w->one_sided, w->kinks[i]);
    w->two_sizes += w->sizes[i];
  }
  w->moved  = mpmstab_apart_(w, w->rest, w->base);
  w->repeat = mpmstab_apart_(w, w->rest, w->again);
}

/* The response to a random perturbation of all unknowns, against the matrix. */
static inline void mpmstab_take_check_(struct mpmstab_work *w)
{
  double *y = w->answer[2], most = 0, off = 0;

  for (long i = 0; i < w->particles * w->width; i++) y[i] = 0;
  for (long k = 0; k < w->n; k++)
    y[w->row[k]] += w->value[k] * (w->amount[0][w->column[k]] - w->amount[1][w->column[k]]);
  for (long i = 0; i < w->particles * w->width; i++) {
    const double response = mpmstab_minus_(w, i, w->answer[0], w->answer[1]), unit = w->scale[i % w->width];

    if (w->apart[i % w->width]) continue;
    most = fmax(most, fmax(fabs(response), fabs(y[i])) / unit);
    off  = fmax(off, fabs(response - y[i]) / unit);
  }
  w->additivity = most > 0 ? off / most : off;
}

static inline void mpmstab_begin_columns_(struct mpmstab_work *w)
{
  mpmstab_colours_(w);
  w->stage  = MPMSTAB_COLUMNS;
  w->colour = w->number = 0;
  w->n = 0, w->leaks = 0;
  memset(w->apart, 0, (size_t)w->width);
  memset(w->own, 0, sizeof(double) * (size_t)(w->width * (3 * w->width + 1)));
}

/* The next field that is perturbed to find scales. When they are known, columns follow, or what a particle reaches. */
static inline void mpmstab_next_scale_(struct mpmstab_work *w)
{
  int declared = 1;

  for (int f = 0; f < w->nfields; f++) declared = declared && w->scales.given[f];
  w->number = declared ? -1 : mpmstab_scales_next_(&w->scales);
  w->stage  = MPMSTAB_SCALES;
  for (int f = 0; f < w->nfields; f++)
    for (int a = 0; a < w->field[f].size; a++) w->scale[w->field[f].begin + a] = w->scales.scale[f];
  if (w->number >= 0) return;
  w->number = 0;
  w->stage  = MPMSTAB_FIRST;
}

/*
   What the first perturbation gives is kept. A loop that goes on from there has all that the step has left, also what
   is not registered. One that begins there anew, after another step, has what is registered.
*/
static inline void mpmstab_take_first_(struct mpmstab_work *w)
{
  const size_t n = sizeof(double) * (size_t)(w->particles * w->width);

  if (!memcmp(w->answer[0], w->answer[1], n) && memcmp(w->answer[0], w->base, n)) {
    fprintf(stderr, "mpmstab_probe: no field moved in %ld steps: is a copy registered?\n", w->calls);
    exit(2);
  }
  memcpy(w->first, w->answer[0], n);
  memcpy(w->again, w->answer[2], n);
  w->two_steps = mpmstab_apart_(w, w->answer[1], w->answer[3]);
  w->repeat    = mpmstab_apart_(w, w->rest, w->again);
  w->stage     = MPMSTAB_REACH;
  if (w->reach < 0) mpmstab_begin_columns_(w);
}

/* Takes how much each field changes, half the difference of two answers. */
static inline void mpmstab_take_scale_(struct mpmstab_work *w)
{
  double change[MPMSTAB_MOST_FIELDS] = {0};

  for (int f = 0; f < w->nfields; f++)
    for (long i = 0; i < w->particles * w->field[f].size; i++) {
      const long unknown = i / w->field[f].size * w->width + w->field[f].begin + i % w->field[f].size;

      change[f] = fmax(change[f], fabs(mpmstab_minus_(w, unknown, w->answer[0], w->answer[1])) / 2);
    }
  mpmstab_scales_take_(&w->scales, w->number, change);
}

/* Takes one more answer, and says what comes next. */
static inline void mpmstab_take_(struct mpmstab_work *w)
{
  const int answers = w->stage == MPMSTAB_COLUMNS || w->stage == MPMSTAB_FIRST  ? 4
                      : w->stage == MPMSTAB_CHECK || w->stage == MPMSTAB_SCALES ? 2
                                                                                : 1;

  if (++w->asked < answers) return;
  w->asked = 0;
  if (w->stage == MPMSTAB_REST) {
    memcpy(w->rest, w->answer[0], sizeof(double) * (size_t)(w->particles * w->width));
    mpmstab_next_scale_(w);
  } else if (w->stage == MPMSTAB_SCALES) {
    mpmstab_take_scale_(w);
    mpmstab_next_scale_(w);
  } else if (w->stage == MPMSTAB_FIRST) {
    mpmstab_take_first_(w);
  } else if (w->stage == MPMSTAB_REACH) {
    for (long i = 0; i < w->particles * w->width; i++) {
      const double change = fabs(mpmstab_minus_(w, i, w->answer[0], w->rest)) / w->scale[i % w->width];

      for (int a = 0; a < mpmstab_directions_(w) && change > 10 * w->repeat; a++) {
        const long apart = mpmstab_cells_apart_(&w->at, i / w->width, w->middle, a);

        if (apart > w->reach) w->reach = (int)apart;
      }
    }
    if (++w->number == w->width) {
      w->reach++; /* particles elsewhere in a cell may reach one further */
      mpmstab_begin_columns_(w);
    }
  } else if (w->stage == MPMSTAB_COLUMNS) {
    mpmstab_take_columns_(w);
    if (++w->number == w->width) w->number = 0, w->colour++;
    if (w->colour < w->at.colours) return;
    mpmstab_set_apart_(w);
    w->stage = MPMSTAB_CHECK;
  } else if (w->stage == MPMSTAB_LAST) {
    w->repeat = fmax(w->repeat, mpmstab_apart_(w, w->first, w->answer[0]));
    w->stage  = MPMSTAB_DONE;
  } else {
    mpmstab_take_check_(w);
    w->stage = MPMSTAB_LAST;
    if (w->reach >= 0 && (w->leaks > (w->single ? 1e-3 : 1e-6) || w->additivity > (w->single ? 0.05 : 1e-3))) {
      w->reach = -1; /* some particle reaches further than was seen */
      mpmstab_begin_columns_(w);
    }
  }
}

/* ---- the call ---- */

static inline void mpmstab_begin_scales_(struct mpmstab_work *w, double h)
{
  w->scales.place = h > 0 ? w->place : -1;
  w->scales.cell  = h;
  w->scales.size  = mpmstab_size_(w);
  for (int f = 0; f < w->nfields; f++) {
    const mpmstab_registered *of   = &w->field[f];
    double                    most = 0;

    for (long i = 0; i < w->particles; i++)
      for (int a = 0; a < of->size; a++) most = fmax(most, fabs(w->base[i * w->width + of->begin + a]));
    mpmstab_scales_add_(&w->scales, most, of->scale, of->type == MPMSTAB_FLOAT ? FLT_EPSILON : DBL_EPSILON);
  }
}

static inline int mpmstab_finite_(const struct mpmstab_work *w, const double *state)
{
  for (long i = 0; i < w->particles * w->width; i++)
    if (!(fabs(state[i]) <= 1.7976931348623157e308)) return 0;
  return 1;
}

static inline void mpmstab_start_(mpmstab_hook *hook, double h)
{
  struct mpmstab_work *w = hook->work;
  const size_t         n = (size_t)(w->particles * w->width) * sizeof(double);

  for (int k = 0; k < MPMSTAB_ASKED; k++) {
    w->answer[k] = (double *)mpmstab_room_(NULL, n);
    w->amount[k] = (double *)mpmstab_room_(NULL, n);
  }
  w->base         = (double *)mpmstab_room_(NULL, n);
  w->rest         = (double *)mpmstab_room_(NULL, n);
  w->first        = (double *)mpmstab_room_(NULL, n);
  w->again        = (double *)mpmstab_room_(NULL, n);
  w->own          = (double *)mpmstab_room_(NULL, sizeof(double) * (size_t)(w->width * (3 * w->width + 1)));
  w->couples      = w->own + w->width;
  w->kinks        = w->couples + w->width * w->width;
  w->sizes        = w->kinks + w->width * w->width;
  w->apart        = (char *)memset(mpmstab_room_(NULL, (size_t)w->width), 0, (size_t)w->width);
  w->scale        = (double *)mpmstab_room_(NULL, sizeof(double) * (size_t)w->width);
  w->at.bin       = (long *)mpmstab_room_(NULL, 3 * sizeof(long) * (size_t)w->particles);
  w->at.colour_of = (long *)mpmstab_room_(NULL, sizeof(long) * (size_t)w->particles);
  w->at.owner     = (long *)mpmstab_room_(NULL, sizeof(long) * (size_t)w->particles);
  for (int i = 0; i < w->width; i++) w->scale[i] = 0; /* the first step is of the state itself */
  memcpy(w->period, hook->period, sizeof w->period);
  w->cell = h;
  mpmstab_copy_(w, w->base, 0);
  if (!mpmstab_finite_(w, w->base)) {
    fprintf(
        stderr,
        "mpmstab_probe: the state of the first call has a number that is not finite: is it a copy that has gone?\n");
    exit(2);
  }
  mpmstab_begin_scales_(w, h);
  mpmstab_bins_(w, h);
  w->stage = MPMSTAB_REST;
}

/* Comments from which mpmstab finds out whether all cells are alike. */
static inline void mpmstab_write_places_(const struct mpmstab_work *w, FILE *file)
{
  const int dim = mpmstab_directions_(w);

  fprintf(file, "%% numbers: %d\n", w->width);
  for (int i = 0; i < w->width; i++) fprintf(file, "%% scale: %.17g\n", w->scale[i]);
  for (int f = 0; f < w->nfields; f++) {
    const char *from = w->field[f].scale > 0      ? "declared"
                       : w->scales.given[f]       ? "cell_width"
                       : w->scales.unsettled <= 1 ? "found"
                                                  : "guessed";

    fprintf(file, "%% field_scale: %.17g %s %s\n", w->scales.scale[f], from, w->field[f].name);
  }
  if (w->scales.at[0] > 0) fprintf(file, "%% unsettled: %.3g\n", w->scales.unsettled);
  if (!dim || !(w->cell > 0)) return;
  fprintf(file, "%% cell_width: %.17g\n%% period:", w->cell);
  for (int a = 0; a < dim; a++) fprintf(file, " %.17g", w->period[a]);
  for (long i = 0; i < w->particles * dim; i++)
    fprintf(file, "%s%.17g",
            i % dim ? " " : "\n% at: ", w->base[i / dim * w->width + w->field[w->place].begin + i % dim]);
  fprintf(file, "\n");
}

/* Matrix Market; unknowns particle by particle, fields in the order in which they were registered. */
static inline void mpmstab_write_(const struct mpmstab_work *w, const char *path)
{
  const long order = w->particles * w->width;
  FILE      *file  = fopen(path, "w");
  int        bad   = !file;

  if (file) {
    fprintf(file, "%%%%MatrixMarket matrix coordinate real general\n%% steps: 1\n%% fields:");
    for (int f = 0; f < w->nfields; f++)
      fprintf(file, " %s %d%s", w->field[f].name, w->field[f].size, f == w->place ? " place" : "");
    fprintf(file, "\n%% calls: %ld\n%% moved: %.3g\n%% repeat: %.3g\n%% two_steps: %.3g\n%% one_sided: %.3g\n",
            w->calls, w->moved, w->repeat, w->two_steps, w->one_sided);
    fprintf(file, "%% two_sizes: %.3g\n%% additivity: %.3g\n%% size: %.3g\n%% single: %d\n", sqrt(w->two_sizes),
            w->additivity, mpmstab_size_(w), w->single);
    mpmstab_write_places_(w, file);
    fprintf(file, "%ld %ld %ld\n", order, order, w->n);
    for (long k = 0; k < w->n; k++) fprintf(file, "%ld %ld %.17g\n", w->row[k] + 1, w->column[k] + 1, w->value[k]);
    bad = ferror(file);
    bad = fclose(file) || bad;
  }
  if (bad)
    fprintf(stderr, "mpmstab_probe: %s cannot be written\n", path);
  else
    fprintf(stderr,
            "mpmstab_probe: %s has the matrix of your step, of order %ld, from %ld steps: moved %.3g, repeat %.3g, "
            "two_steps %.3g, one_sided %.3g, two_sizes %.3g, additivity %.3g\n",
            path, order, w->calls, w->moved, w->repeat, w->two_steps, w->one_sided, sqrt(w->two_sizes), w->additivity);
}

static inline void mpmstab_free_(struct mpmstab_work *w)
{
  for (int k = 0; k < MPMSTAB_ASKED; k++) free(w->answer[k]), free(w->amount[k]);
  free(w->base), free(w->rest), free(w->first), free(w->again), free(w->own), free(w->apart), free(w->scale),
      free(w->at.bin), free(w->at.colour_of), free(w->at.owner), free(w->at.grid);
  free(w->row), free(w->column), free(w->value);
}

/*
   mpmstab_probe - call it before each step of your loop. h: the width of a cell.

   Returns 0 when your loop has to do a step for it, and 1 when it is done and the state is your own again. A state that
   is not finite ends it without a file, with a message on standard error.
*/
MPMSTAB_PROBE_API int mpmstab_probe(mpmstab_hook *hook, const char *path, double h)
{
  struct mpmstab_work *w = hook->work;

  if (!w) {
    fprintf(stderr, "mpmstab_probe: no field was registered with mpmstab_field or mpmstab_place\n");
    exit(2);
  }
  if (w->stage == MPMSTAB_DONE) return 1;
  if (w->stage == MPMSTAB_BEGIN) {
    mpmstab_start_(hook, h);
  } else {
    mpmstab_copy_(w, w->answer[w->asked], 0);
    if (mpmstab_finite_(w, w->answer[w->asked])) {
      mpmstab_take_(w);
    } else if (w->stage == MPMSTAB_SCALES) {
      mpmstab_scales_fail_(&w->scales);
      w->asked = 0;
      mpmstab_next_scale_(w);
    } else {
      fprintf(stderr, "mpmstab_probe: the state after a step has a number that is not finite; %s is not written\n",
              path);
      w->stage = MPMSTAB_DONE, path = NULL;
    }
  }
  if (w->stage != MPMSTAB_DONE) {
    mpmstab_perturb_(w);
    return 0;
  }
  mpmstab_copy_(w, w->base, 1);
  if (path) mpmstab_write_(w, path);
  mpmstab_free_(w);
  return 1;
}

#ifdef __cplusplus
}
#endif
#endif
