/*
   Measures the memory bandwidth: a = b + s c over arrays that fit in no cache, the best of ten. It prints GB/s. Each
   line that is written is read first (32 bytes an element).
*/
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define N 10000000L

static double Now(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(void)
{
  double *restrict a = malloc(N * sizeof *a), *restrict b = malloc(N * sizeof *b), *restrict c = malloc(N * sizeof *c);
  double best = 1e30;

  if (!a || !b || !c) return 1;
  for (long i = 0; i < N; i++) {
    a[i] = 0;
    b[i] = 1;
    c[i] = (double)i;
  }
  for (int r = 0; r < 10; r++) {
    const double start = Now(), s = 1 + r;

    for (long i = 0; i < N; i++) a[i] = b[i] + s * c[i];
    const double seconds = Now() - start;

    if (seconds < best) best = seconds;
  }
  printf("%.4g %g\n", 32e-9 * N / best, a[N / 2]);
  return 0;
}
