/*
   log(1 + x) of many numbers, in a loop that works on several at once: a call of the C library in a loop takes them one
   after another. The error is below 1.5 units in the last place. Where 1 + x is not positive, there is no number.

   1 + x = 2^k (1 + f) with 1 + f between sqrt(1/2) and sqrt(2), and with s = f / (2 + f)

     log(1 + f) = 2 atanh s = f - f^2 / 2 + s (f^2 / 2 + R(s^2))

   The polynomial R and the two parts of log 2 are those of fdlibm (e_log.c, Sun Microsystems 1993). 1 + x is rounded,
   so the logarithm also has the rest over 1 + x.
*/
#pragma once
#include "scheme/material/tensors.h"
#include <math.h>
#include <stdint.h>
#include <string.h>

/* x = log(1 + x) for n numbers. */
static inline void LogarithmOfOnePlus(PetscInt n, PetscReal x[])
{
  const uint64_t  one = 0x3ff0000000000000, half_root = 0x3fe6a09e667f3bcd;            /* the bits of 1 and sqrt(1/2) */
  const uint64_t  large = 0x4330000000000000;                                          /* those of 2^52 */
  const PetscReal high = 6.93147180369123816490e-01, low = 1.90821492927058770002e-10; /* log 2 */

  INDEPENDENT for (PetscInt p = 0; p < n; p++)
  {
    const PetscReal sum = 1 + x[p], rest = x[p] - (sum - 1);
    uint64_t        bits, exponent;
    PetscReal       f, k, s, z, R, square;

    memcpy(&bits, &sum, sizeof bits);
    exponent = (bits + (one - half_root)) >> 52; /* k + 1023 */
    bits -= (exponent << 52) - one;
    memcpy(&f, &bits, sizeof f);
    f -= 1;
    exponent |= large; /* the bits of 2^52 + k + 1023 */
    memcpy(&k, &exponent, sizeof k);
    k -= 0x1p52 + 1023;
    s      = f / (2 + f);
    z      = s * s;
    square = f * f / 2;
    R      = 1.531383769920937332e-01 + z * 1.479819860511658591e-01;
    R      = 1.818357216161805012e-01 + z * R;
    R      = 2.222219843214978396e-01 + z * R;
    R      = 2.857142874366239149e-01 + z * R;
    R      = 3.999999999940941908e-01 + z * R;
    R      = z * (6.666666666666735130e-01 + z * R);
    f      = k * high - ((square - (s * (square + R) + (k * low + rest / sum))) - f);
    x[p]   = sum > 0 ? f : NAN;
  }
}
