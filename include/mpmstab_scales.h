/*
   mpmstab_scales: sizes of fields that nobody has declared, found from the answers of a step; the fields that no other
   eigenvalue feels; and which particles are perturbed together. mpmstab and the hook (mpmstab_probe.h) use it; it needs
   nothing else.

   Perturbations are made, and errors are judged, in scales d[i] of the fields. Couplings B[i][j] say how much field i
   changes in a step when field j is changed, largest number by largest number; a good choice of scales makes B[i][j]
   d[j] / d[i] of order 1. Of fields that feel one another scales are balanced (Osborne 1960): what a field gives in
   scales is as much as what it gets,

     d[i]^2 = (sum over j of B[i][j] d[j]) / (sum over j of B[j][i] / d[j])

   This leaves one factor for each set of such fields. It is the least for which no scale is smaller than the field's
   largest value, which rounding asks for, and for which order 1 of the set is what order 1 of other fields makes of it.
   But order 1 moves particles by no more than a cell, and by no less than a thousandth of one.

   Couplings are measured with perturbations of size times the scale that is known so far. It begins with the largest
   value, or far below any where that is 0, and grows as long as answers are lost in rounding: a step is never asked for
   more than it can take. A field that is measured again with its final scale must lead to this scale.
*/
#ifndef MPMSTAB_SCALES_H
#define MPMSTAB_SCALES_H
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MPMSTAB_SCALES_MOST = 64, MPMSTAB_SCALES_PASSES = 60, MPMSTAB_SCALES_SWEEPS = 100 };

/*
   n fields, place: the one that is the place, or -1; cell: the width of a cell. size: of perturbations, in scales.
   value: the largest absolute value of a field; least: a change of it that is above rounding. given: the scale is
   declared; known: it has been found. at: the scale with which a field was perturbed last, 0 if never. lost: what
   couples would be of an answer that was below rounding, where the one before is kept; else 0. unsettled: the change of
   scales, in powers of 2, when they are measured once more; infinite: they were not found.
*/
typedef struct {
  int    n, place, passes;
  double cell, size, unsettled, value[MPMSTAB_SCALES_MOST], least[MPMSTAB_SCALES_MOST], scale[MPMSTAB_SCALES_MOST];
  double at[MPMSTAB_SCALES_MOST], couples[MPMSTAB_SCALES_MOST][MPMSTAB_SCALES_MOST];
  char   given[MPMSTAB_SCALES_MOST], known[MPMSTAB_SCALES_MOST];
  double lost[MPMSTAB_SCALES_MOST][MPMSTAB_SCALES_MOST];
  char   feels[MPMSTAB_SCALES_MOST][MPMSTAB_SCALES_MOST];
} mpmstab_scales;

/* What a change of order 1 means before anything is measured; given: what is declared, or 0. */
static inline void mpmstab_scales_add_(mpmstab_scales *s, double value, double given, double epsilon)
{
  const int f = s->n++;

  s->value[f] = value;
  s->least[f] = 100 * epsilon * value;
  s->given[f] = given > 0 || f == s->place;
  s->known[f] = s->given[f] || value > 0;
  s->scale[f] = given > 0 ? given : f == s->place ? s->cell : value > 0 ? value : 1e-12;
}

/* Adds to who feels whom, row by row of so many numbers, who does so through others (Warshall 1962). */
static inline void mpmstab_through_others_(int n, int row, char *feels)
{
  for (int k = 0; k < n; k++)
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n && feels[i * row + k]; j++)
        if (feels[k * row + j]) feels[i * row + j] = 1;
}

/*
   Sets numbers of a particle apart that do not feel themselves through others, and whose own eigenvalue does not grow.
   Where this would be all of them, none is. couples[i n + j]: the largest entry by which number i feels number j of a
   particle; own: the largest by which it feels itself. feels: memory for n n. Returns how many are left.
*/
static inline int mpmstab_set_apart_of_(int n, double noise, const double *couples, const double *own, char *feels,
                                        char *apart)
{
  int left = 0;

  for (int i = 0; i < n * n; i++) feels[i] = couples[i] > noise;
  mpmstab_through_others_(n, n, feels);
  for (int i = 0; i < n; i++) {
    apart[i] = (char)!(feels[i * n + i] || own[i] > 1 + noise);
    left += !apart[i];
  }
  for (int i = 0; i < n && !left; i++) apart[i] = 0;
  return left ? left : n;
}

/* Which fields feel which others, through others, too. Places are an anchor, and in no set. */
static inline void mpmstab_scales_connect_(mpmstab_scales *s)
{
  for (int i = 0; i < s->n; i++)
    for (int j = 0; j < s->n; j++)
      s->feels[i][j] = (char)(i == j || (i != s->place && j != s->place && s->couples[i][j] > 0));
  mpmstab_through_others_(s->n, MPMSTAB_SCALES_MOST, s->feels[0]);
}

static inline int mpmstab_scales_same_(const mpmstab_scales *s, int i, int j)
{
  return s->feels[i][j] && s->feels[j][i];
}

/* Balances the fields of the set of field f. */
static inline void mpmstab_scales_balance_(mpmstab_scales *s, int f)
{
  for (int sweep = 0; sweep < MPMSTAB_SCALES_SWEEPS; sweep++) {
    for (int i = 0; i < s->n; i++) {
      double gets = 0, gives = 0;

      for (int j = 0; j < s->n; j++) {
        if (j == i || !mpmstab_scales_same_(s, f, j)) continue;
        gets += s->couples[i][j] * s->scale[j];
        gives += s->couples[j][i] / s->scale[j];
      }
      if (mpmstab_scales_same_(s, f, i) && !s->given[i] && gets > 0 && gives > 0) s->scale[i] = sqrt(gets / gives);
    }
  }
}

/*
   The factor of the set of field f. old, known: of the scales before. A set that nothing shows the size of gets larger,
   up to a geometric mean of 1e10 (of 1 for a field by itself), and has a mean of 1 if that is in vain.
*/
static inline double mpmstab_scales_factor_(mpmstab_scales *s, int f, const double *old, const char *known)
{
  double in = 0, out = 0, moves = 0, mean = 0, factor;
  int    members = 0;

  for (int i = 0; i < s->n; i++) {
    if (!mpmstab_scales_same_(s, f, i)) continue;
    if (s->given[i]) return 1;
    members++;
    mean += log(s->scale[i]);
    in = fmax(in, s->value[i] / s->scale[i]);
    if (s->place >= 0) moves = fmax(moves, s->couples[s->place][i] * s->scale[i] / s->cell);
    for (int j = 0; j < s->n; j++) {
      if (!known[j] || mpmstab_scales_same_(s, f, j)) continue;
      in = fmax(in, s->couples[i][j] * old[j] / s->scale[i]);
      if (j != s->place) out = fmax(out, s->couples[j][i] * s->scale[i] / old[j]);
    }
  }
  factor = moves > 0 ? fmin(fmax(in, 1e-3 / moves), 1 / moves) : in > 0 ? in : out > 0 ? 1 / out : 0;
  mean   = exp(mean / members);
  if (factor > 0 || known[f] || mean >= (members > 1 ? 1e10 : 1)) {
    for (int i = 0; i < s->n; i++)
      if (mpmstab_scales_same_(s, f, i)) s->known[i] = 1;
    return factor > 0 ? factor : 1 / mean;
  }
  factor = s->size < 1e-3 ? 1e8 : 1e3; /* floats have fewer digits between what is lost and what is too large */
  return members > 1 ? factor : fmin(factor, 1 / mean);
}

/*
   A field that hardly any other reads is balanced with a scale beyond its values, as a deformation gradient that a weak
   prestress reads. Its scale is at most its value, or a thousand times what others of order 1 make of it.
*/
static inline void mpmstab_scales_limit_(mpmstab_scales *s)
{
  for (int i = 0; i < s->n; i++) {
    double gets = 0;

    for (int j = 0; j < s->n; j++)
      if (j != i) gets = fmax(gets, s->couples[i][j] * s->scale[j]);
    gets = fmax(s->value[i], 1e3 * gets);
    if (!s->given[i] && s->known[i] && gets > 0) s->scale[i] = fmin(s->scale[i], gets);
  }
}

/* Finds scales from the couplings that are known. Returns whether any has changed. */
static inline int mpmstab_scales_find_(mpmstab_scales *s)
{
  double old[MPMSTAB_SCALES_MOST];
  char   known[MPMSTAB_SCALES_MOST], done[MPMSTAB_SCALES_MOST] = {0};
  int    changed = 0;

  memcpy(old, s->scale, sizeof old);
  memcpy(known, s->known, sizeof known);
  mpmstab_scales_connect_(s);
  for (int f = 0; f < s->n; f++) {
    double factor;

    if (done[f] || f == s->place) continue;
    mpmstab_scales_balance_(s, f);
    factor = mpmstab_scales_factor_(s, f, old, known);
    for (int i = 0; i < s->n; i++) {
      if (!mpmstab_scales_same_(s, f, i)) continue;
      done[i] = 1;
      if (!s->given[i]) s->scale[i] *= factor;
    }
  }
  mpmstab_scales_limit_(s);
  for (int i = 0; i < s->n; i++) changed = changed || s->known[i] != known[i] || fabs(log(s->scale[i] / old[i])) > 0.01;
  return changed;
}

/* The change of the scales that are found, and whether two fields may feel one another by what is lost in rounding. */
static inline void mpmstab_scales_judge_(mpmstab_scales *s)
{
  s->unsettled = 0;
  for (int i = 0; i < s->n; i++) {
    s->unsettled = fmax(s->unsettled, fabs(log2(s->scale[i] / s->at[i])));
    for (int j = 0; j < s->n; j++)
      if (s->lost[i][j] * s->couples[j][i] > 1e-3) s->unsettled = HUGE_VAL;
    if (!s->given[i]) s->scale[i] = exp2(rint(log2(s->scale[i]))); /* as is usual: products with it are exact */
  }
}

/* The field that is to be perturbed next, by random amounts of up to size times its scale, or -1: scales are found. */
static inline int mpmstab_scales_next_(mpmstab_scales *s)
{
  while (!isinf(s->unsettled)) {
    for (int f = 0; f < s->n; f++)
      if (!(s->at[f] > 0) || fabs(log2(s->scale[f] / s->at[f])) > 1) {
        s->at[f] = s->scale[f];
        return f;
      }
    if (!mpmstab_scales_find_(s)) {
      mpmstab_scales_judge_(s);
      return -1;
    }
    if (s->passes++ == MPMSTAB_SCALES_PASSES) s->unsettled = HUGE_VAL;
  }
  return -1;
}

/* Takes the largest change of each field, of half the difference of the answers forward and backward. */
static inline void mpmstab_scales_take_(mpmstab_scales *s, int f, const double *change)
{
  for (int i = 0; i < s->n; i++) {
    const double couples = change[i] / (s->size * s->at[f]);

    s->lost[i][f] = change[i] < s->least[i] && i != f ? fmax(couples, s->least[i] / 100 / (s->size * s->at[f])) : 0;
    if (!(change[i] < s->least[i])) s->couples[i][f] = couples;
  }
}

/* Ends the search, as the code has no answer to what it was asked: scales are what they are without any. */
static inline void mpmstab_scales_fail_(mpmstab_scales *s)
{
  for (int f = 0; f < s->n; f++)
    if (!s->given[f]) s->scale[f] = s->value[f] > 0 ? s->value[f] : 1;
  s->unsettled = HUGE_VAL;
}

/* ---- particles that are perturbed together ---- */

/*
   A step reaches a few cells, so particles whose cells are far enough apart have one colour, and are perturbed in one
   call.

   bin: the cell of each particle, 3 numbers, from 0 to bins[a] - 1 in each of dim directions; wraps: the first is next
   to the last. reach: over so many cells a perturbation is felt; between: cells between what two particles of a colour
   reach. alone: each particle has a colour of its own, and reaches all others. colour_of: of each particle, colours of
   them; owner: of a colour the perturbed particle that a particle feels, or -1. Direction a repeats its colours every
   modulus[a] cells. What is left over at a period has colours of its own; lines[a] with these. bin, colour_of, owner
   (memory for particles) and grid (for all cells) are the caller's.
*/
typedef struct {
  int   dim, alone, between, wraps[3];
  long  particles, bins[3], reach[3], modulus[3], lines[3], colours;
  long *bin, *colour_of, *owner, *grid;
} mpmstab_colours;

/* How far the cells of two particles are apart in a direction, the shorter way round. */
static inline long mpmstab_cells_apart_(const mpmstab_colours *c, long i, long j, int axis)
{
  const long d = labs(c->bin[3 * i + axis] - c->bin[3 * j + axis]);

  return c->wraps[axis] && c->bins[axis] - d < d ? c->bins[axis] - d : d;
}

static inline long mpmstab_cells_(const mpmstab_colours *c)
{
  long all = 1;

  for (int a = 0; a < c->dim; a++) all *= c->bins[a];
  return all;
}

static inline void mpmstab_line_(mpmstab_colours *c, int axis)
{
  const long apart = 2 * c->reach[axis] + 1 + c->between, bins = c->bins[axis];
  long       fewest = bins, best = bins;

  for (long m = apart; m <= bins && c->wraps[axis]; m++)
    if (m + bins % m < fewest) fewest = m + bins % m, best = m;
  if (!c->wraps[axis] && apart < bins) fewest = best = apart;
  c->modulus[axis] = best, c->lines[axis] = fewest;
}

/* Numbers the colours that have particles. Returns whether there was memory for that. */
static inline int mpmstab_used_(mpmstab_colours *c, long colours)
{
  long *number = (long *)malloc(sizeof(long) * (size_t)(colours + 1));

  if (!number) return 0;
  c->colours = 0;
  for (long k = 0; k < colours; k++) number[k] = -1;
  for (long i = 0; i < c->particles; i++) {
    if (number[c->colour_of[i]] < 0) number[c->colour_of[i]] = c->colours++;
    c->colour_of[i] = number[c->colour_of[i]];
  }
  free(number);
  return 1;
}

/* Finds the colours. Returns whether there was memory for that. */
static inline int mpmstab_colour_(mpmstab_colours *c)
{
  long together = 0, lines = 1;

  c->colours = c->particles;
  for (long i = 0; i < c->particles; i++) c->colour_of[i] = i;
  if (c->alone) return 1;
  for (int a = 0; a < c->dim; a++) mpmstab_line_(c, a), lines *= c->lines[a];
  for (long b = 0; b < mpmstab_cells_(c); b++) c->grid[b] = 0;
  for (long i = 0; i < c->particles; i++) {
    long at = 0, colour = 0;

    for (int a = 0; a < c->dim; a++) {
      const long b = c->bin[3 * i + a], m = c->modulus[a], whole = c->wraps[a] ? c->bins[a] / m * m : c->bins[a];

      at     = at * c->bins[a] + b;
      colour = colour * c->lines[a] + (b < whole ? b % m : m + b - whole);
    }
    c->colour_of[i] = colour + lines * c->grid[at]++;
    if (c->grid[at] > together) together = c->grid[at];
  }
  return mpmstab_used_(c, lines * together);
}

/* Marks the cells round each particle of a colour, and gives each particle the mark of its cell. */
static inline void mpmstab_own_(mpmstab_colours *c, long colour)
{
  long box = 1;

  for (int a = 0; a < c->dim && !c->alone; a++) box *= 2 * c->reach[a] + 1;
  for (long b = 0; b < mpmstab_cells_(c) && !c->alone; b++) c->grid[b] = -1;
  for (long j = 0; j < c->particles; j++) {
    for (long k = 0; k < box && !c->alone && c->colour_of[j] == colour; k++) {
      long at = 0, rest = k, inside = 1;

      for (int a = 0; a < c->dim; a++) {
        long b = c->bin[3 * j + a] + rest % (2 * c->reach[a] + 1) - c->reach[a];

        rest /= 2 * c->reach[a] + 1;
        if (c->wraps[a]) b = (b % c->bins[a] + c->bins[a]) % c->bins[a];
        inside = inside && b >= 0 && b < c->bins[a];
        at     = at * c->bins[a] + b;
      }
      if (inside) c->grid[at] = j;
    }
  }
  for (long i = 0; i < c->particles; i++) {
    long at = 0;

    for (int a = 0; a < c->dim && !c->alone; a++) at = at * c->bins[a] + c->bin[3 * i + a];
    c->owner[i] = c->alone ? colour : c->grid[at];
  }
}
#endif
