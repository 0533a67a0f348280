/* Exact fractions: their text, and n times a fraction without accumulated rounding. */
#include <mpmstab/fraction.h>
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>

__extension__ typedef __int128 Wide;

/* Numerator and denominator stay below this, so that n times the numerator fits 128 bits for every n. */
#define LARGEST_TERM ((PetscInt64)1000000000000000)

PetscInt64 MpmCommonDivisor(PetscInt64 a, PetscInt64 b)
{
  while (b) {
    const PetscInt64 r = a % b;
    a                  = b;
    b                  = r;
  }
  return a < 0 ? -a : a;
}

static PetscBool ParseInteger(const char text[], const char **end, PetscInt64 *value)
{
  char *stop;

  if (!isdigit((unsigned char)text[text[0] == '-' || text[0] == '+'])) return PETSC_FALSE;
  errno  = 0;
  *value = strtoll(text, &stop, 10);
  *end   = stop;
  return errno == 0 && *value <= LARGEST_TERM && *value >= -LARGEST_TERM ? PETSC_TRUE : PETSC_FALSE;
}

static void Reduce(MpmFraction *f, PetscInt64 num, PetscInt64 den)
{
  const PetscInt64 g = MpmCommonDivisor(num, den);

  f->num   = num / g;
  f->den   = den / g;
  f->value = (PetscReal)f->num / (PetscReal)f->den;
}

/* A decimal with few digits is read as the ratio that it spells: 0.3 is 3/10, not the double nearest to 0.3. */
static PetscBool ParseDecimal(const char text[], MpmFraction *f)
{
  PetscInt64  num = 0, den = 1;
  const char *s     = text;
  PetscBool   minus = PETSC_FALSE, point = PETSC_FALSE;

  if (*s == '-' || *s == '+') minus = *s++ == '-' ? PETSC_TRUE : PETSC_FALSE;
  for (; isdigit((unsigned char)*s) || (*s == '.' && !point); s++) {
    if (*s == '.') {
      point = PETSC_TRUE;
      continue;
    }
    num = 10 * num + (*s - '0');
    if (point) den *= 10;
    if (num > LARGEST_TERM || den > LARGEST_TERM) return PETSC_FALSE;
  }
  if (*s == 'e' || *s == 'E') {
    char *stop;
    long  exponent = PetscClipInterval(strtol(s + 1, &stop, 10), -20, 20); /* terms beyond are too large */

    for (; exponent > 0 && num <= LARGEST_TERM; exponent--) num *= 10;
    for (; exponent < 0 && den <= LARGEST_TERM; exponent++) den *= 10;
    if (num > LARGEST_TERM || den > LARGEST_TERM) return PETSC_FALSE;
    s = stop;
  }
  if (*s) return PETSC_FALSE;
  Reduce(f, minus ? -num : num, den);
  return PETSC_TRUE;
}

PetscBool MpmFractionParse(const char text[], MpmFraction *fraction)
{
  const char *end;
  char       *stop;
  PetscInt64  num, den;

  if (strchr(text, '/')) {
    if (!ParseInteger(text, &end, &num) || *end != '/') return PETSC_FALSE;
    if (!ParseInteger(end + 1, &end, &den) || *end || den <= 0) return PETSC_FALSE;
    Reduce(fraction, num, den);
    return PETSC_TRUE;
  }
  if (!*text || isspace((unsigned char)*text) || strpbrk(text, "xX")) return PETSC_FALSE;
  fraction->value = strtod(text, &stop);
  fraction->num = fraction->den = 0;
  if (*stop || !isfinite(fraction->value)) return PETSC_FALSE;
  (void)ParseDecimal(text, fraction);
  return PETSC_TRUE;
}

/* The ratio in its lowest terms; f where they are too large. */
static MpmFraction Ratio(Wide num, Wide den, MpmFraction f)
{
  Wide a = num < 0 ? -num : num, b = den;

  while (b) { /* Euclid's algorithm: a becomes the greatest common divisor */
    const Wide rest = a % b;

    a = b;
    b = rest;
  }
  num /= a;
  den /= a;
  if (den <= LARGEST_TERM && num <= LARGEST_TERM && num >= -LARGEST_TERM)
    f = (MpmFraction){.num = (PetscInt64)num, .den = (PetscInt64)den, .value = (PetscReal)num / (PetscReal)den};
  return f;
}

MpmFraction MpmFractionBetween(const MpmFraction *from, const MpmFraction *to, PetscInt j, PetscInt n)
{
  const PetscReal part = (PetscReal)j / (n - 1);
  MpmFraction     f    = {.value = (1 - part) * from->value + part * to->value};
  Wide            num, den, more;

  if (j == 0) return *from;
  if (j == n - 1) return *to;
  if (!from->den || !to->den) return f;
  if (__builtin_mul_overflow((Wide)from->den * to->den, n - 1, &den)) return f;
  if (__builtin_mul_overflow((Wide)from->num * to->den, n - 1 - j, &num)) return f;
  if (__builtin_mul_overflow((Wide)to->num * from->den, j, &more) || __builtin_add_overflow(num, more, &num)) return f;
  return Ratio(num, den, f);
}

MpmFraction MpmFractionProduct(PetscInt n, const MpmFraction factors[])
{
  MpmFraction f   = {.value = 1};
  Wide        num = 1, den = 1;

  for (PetscInt i = 0; i < n; i++) f.value *= factors[i].value;
  for (PetscInt i = 0; i < n; i++)
    if (!factors[i].den || __builtin_mul_overflow(num, factors[i].num, &num) ||
        __builtin_mul_overflow(den, factors[i].den, &den))
      return f;
  return Ratio(num, den, f);
}

static void Exchange(PetscInt64 pair[2])
{
  const PetscInt64 kept = pair[0];

  pair[0] = pair[1];
  pair[1] = kept;
}

/*
   The convergents of the continued fraction of abs(value) are the nearest fractions for their denominators. The nearest
   of all is the last convergent within most, or the largest fraction between it and the next one: with the terms
   (m p1 + p0) / (m q1 + q0), m as large as most allows.
*/
MpmFraction MpmFractionNearest(PetscReal value, PetscInt64 most)
{
  const PetscReal size   = PetscAbsReal(value);
  PetscReal       rest   = size;
  PetscInt64      num[2] = {0, 1}, den[2] = {1, 0}, m, whole; /* the last two convergents */
  MpmFraction     f;

  while (PETSC_TRUE) {
    whole = (PetscInt64)floor(rest);
    m     = den[1] ? (most - den[0]) / den[1] : whole;
    if (whole > m) break;
    num[0] += whole * num[1];
    den[0] += whole * den[1];
    Exchange(num);
    Exchange(den);
    if ((PetscReal)num[1] / (PetscReal)den[1] == size) break;
    rest = 1 / (rest - (PetscReal)whole);
    if (!(rest <= (PetscReal)LARGEST_TERM)) break;
  }
  f = (MpmFraction){num[1], den[1], (PetscReal)num[1] / (PetscReal)den[1]};
  m = (most - den[0]) / den[1];
  if (f.value != size && m > 0) {
    const MpmFraction between = {m * num[1] + num[0], m * den[1] + den[0],
                                 (PetscReal)(m * num[1] + num[0]) / (PetscReal)(m * den[1] + den[0])};

    if (PetscAbsReal(between.value - size) < PetscAbsReal(f.value - size)) Reduce(&f, between.num, between.den);
  }
  if (value < 0) Reduce(&f, -f.num, f.den);
  return f;
}

MpmFraction MpmFractionNear(PetscReal value, PetscInt64 most)
{
  MpmFraction f = {.den = 0, .value = value};

  if (PetscAbsReal(value) <= (PetscReal)(LARGEST_TERM / most)) f = MpmFractionNearest(value, most);
  return f.value == value ? f : (MpmFraction){.den = 0, .value = value};
}

void MpmFractionMultiple(const MpmFraction *f, PetscInt64 n, PetscInt64 *whole, PetscReal *part)
{
  if (f->den) {
    const Wide product = (Wide)f->num * n;
    Wide       rest    = product % f->den;

    if (rest < 0) rest += f->den;
    *whole = (PetscInt64)((product - rest) / f->den);
    *part  = (PetscReal)(PetscInt64)rest / (PetscReal)f->den;
  } else {
    const PetscReal product = f->value * (PetscReal)n, lost = fma(f->value, (PetscReal)n, -product);

    *part  = (product - floor(product)) + lost;
    *whole = (PetscInt64)floor(product);
    if (*part < 0) {
      *part += 1;
      *whole -= 1;
    }
    if (*part >= 1) {
      *part -= 1;
      *whole += 1;
    }
  }
}
