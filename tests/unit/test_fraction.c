/* Fractions: how they are read, and that n delta is exact. */
#include "check.h"

static PetscErrorCode Reads(const char text[], PetscInt64 num, PetscInt64 den, PetscReal value)
{
  MpmFraction f;

  PetscFunctionBegin;
  CHECK(MpmFractionParse(text, &f), "'%s' is refused", text);
  CHECK(f.num == num && f.den == den, "'%s' is read as %lld/%lld", text, (long long)f.num, (long long)f.den);
  CHECK_NEAR(f.value, value, 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Multiple(const char text[], PetscInt64 n, PetscInt64 whole, PetscReal part)
{
  MpmFraction f;
  PetscInt64  w;
  PetscReal   p;

  PetscFunctionBegin;
  (void)MpmFractionParse(text, &f);
  MpmFractionMultiple(&f, n, &w, &p);
  CHECK(w == whole, "%lld times %s has whole part %lld", (long long)n, text, (long long)w);
  CHECK_NEAR(p, part, f.den ? 0 : 2e-11); /* the double nearest to a long decimal is 1e-17 off */
  CHECK(p >= 0 && p < 1, "part %.17g", p);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks point j of n from one fraction to another, which is num/den, or the double value when den is 0. */
static PetscErrorCode Between(const char from[], const char to[], PetscInt j, PetscInt n, PetscInt64 num,
                              PetscInt64 den, PetscReal value)
{
  MpmFraction a, b, f;

  PetscFunctionBegin;
  (void)MpmFractionParse(from, &a);
  (void)MpmFractionParse(to, &b);
  f = MpmFractionBetween(&a, &b, j, n);
  CHECK(f.num == num && f.den == den, "%s to %s, %d of %d: %lld/%lld", from, to, (int)j, (int)n, (long long)f.num,
        (long long)f.den);
  CHECK_NEAR(f.value, value, den ? 0 : 1e-15);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks the product of three numbers, which is num/den, or the double value when den is 0. */
static PetscErrorCode Product(const char a[], const char b[], const char c[], PetscInt64 num, PetscInt64 den,
                              PetscReal value)
{
  MpmFraction factors[3], f;

  PetscFunctionBegin;
  (void)MpmFractionParse(a, &factors[0]);
  (void)MpmFractionParse(b, &factors[1]);
  (void)MpmFractionParse(c, &factors[2]);
  f = MpmFractionProduct(3, factors);
  CHECK(f.num == num && f.den == den, "%s * %s * %s: %lld/%lld", a, b, c, (long long)f.num, (long long)f.den);
  CHECK_NEAR(f.value, value, den ? 0 : 1e-15 * fabs(value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks a double as a fraction with a denominator up to most; den is 0 when there is none. */
static PetscErrorCode Near(PetscReal value, PetscInt64 most, PetscInt64 num, PetscInt64 den)
{
  const MpmFraction f = MpmFractionNear(value, most);

  PetscFunctionBegin;
  CHECK(f.num == num && f.den == den && f.value == value, "%.17g: %lld/%lld", value, (long long)f.num,
        (long long)f.den);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks the nearest fraction against all that there are. */
static PetscErrorCode Nearest(PetscReal value, PetscInt64 most)
{
  const MpmFraction f = MpmFractionNearest(value, most);

  PetscFunctionBegin;
  CHECK(f.den > 0 && f.den <= most && f.value == (PetscReal)f.num / (PetscReal)f.den, "%.17g: %lld/%lld", value,
        (long long)f.num, (long long)f.den);
  for (PetscInt64 den = 1; den <= most; den++) {
    const PetscReal other = PetscAbsReal((PetscReal)llround(value * (PetscReal)den) / (PetscReal)den - value);

    CHECK(PetscAbsReal(f.value - value) <= other, "%.17g: %lld/%lld is farther than one over %lld", value,
          (long long)f.num, (long long)f.den, (long long)den);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  const char *const bad[] = {"",    "a",     "1/",   "/8", "1/0", "1/-8",  "1//8", "nan",
                             "inf", "1e999", "0x10", " 1", "1 ",  "1/2/3", "1e"};
  MpmFraction       f;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(Reads("1/8", 1, 8, 0.125));
  PetscCall(Reads("-2/16", -1, 8, -0.125));
  PetscCall(Reads("0.3", 3, 10, 0.3));
  PetscCall(Reads("-1.5e-1", -3, 20, -0.15));
  PetscCall(Reads("2e2", 200, 1, 200));
  PetscCall(Reads("0", 0, 1, 0));
  PetscCall(Reads("1e-300", 0, 0, 1e-300));
  PetscCall(Reads("0.1234567890123456789", 0, 0, 0.1234567890123456789));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(bad); i++)
    CHECK(!MpmFractionParse(bad[i], &f), "'%s' is read as %g", bad[i], f.value);
  PetscCall(Multiple("1/8", 17, 2, 0.125));
  PetscCall(Multiple("-1/8", 1, -1, 0.875));
  PetscCall(Multiple("-1/8", 8, -1, 0));
  PetscCall(Multiple("1/3", 3000000000000, 1000000000000, 0));
  PetscCall(Multiple("0.3", 10, 3, 0));
  PetscCall(Multiple("-1e-300", 5, 0, 0)); /* the part rounds to 1, which is a whole */
  PetscCall(Multiple("0.14142135623730950488", 1000000, 141421, 0.35623730950488)); /* rounded once */
  PetscCall(Between("0", "1/2", 3, 33, 3, 64, 3.0 / 64));
  PetscCall(Between("-1/3", "1/7", 2, 4, -1, 63, -1.0 / 63));
  PetscCall(Between("0.05", "2.5", 2, 50, 3, 20, 0.15));
  PetscCall(Between("1/3", "2/3", 1, 3, 1, 2, 0.5));
  PetscCall(Between("1/7", "5", 4, 5, 5, 1, 5));
  PetscCall(Between("1e-300", "1", 1, 3, 0, 0, 0.5));
  PetscCall(Between("1/999999999999999", "1/999999999999998", 1, 3, 0, 0, 1e-15));
  PetscCall(Product("0.25", "0.5", "1", 1, 8, 0.125));
  PetscCall(Product("-1/3", "3/1000000000", "1000000000", -1, 1, -1)); /* terms cancel before they become large */
  PetscCall(Product("0", "1e-9", "7", 0, 1, 0));
  PetscCall(Product("1e-300", "0.5", "2", 0, 0, 1e-300));
  PetscCall(Product("1/99999999977", "1/99999999947", "1", 0, 0, 1.0 / 99999999977.0 / 99999999947.0));
  PetscCall(Near(0.125, 10000, 1, 8));
  PetscCall(Near(-1.0 / 7, 10000, -1, 7));
  PetscCall(Near(3, 10000, 3, 1));
  PetscCall(Near(0, 10000, 0, 1));
  PetscCall(Near(4999.0 / 10000, 10000, 4999, 10000));
  PetscCall(Near(0.16666500000000001, 10000, 0, 0));
  PetscCall(Near(nextafter(0.125, 1), 10000, 0, 0));
  PetscCall(Near(1e300, 10000, 0, 0));
  for (int i = 0; i < 50; i++) PetscCall(Nearest(sin(1.0 + i) * (i % 5), 1 + 7 * i));
  PetscCall(Nearest(1.0 / 300, 240));
  PetscCall(Nearest(0.05 * (1 + 1e-15), 240));
  PetscCall(Nearest(0, 5));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
