/*
   Reads the numbers of an independent program (the oracle), a row at a time, and the options of the scene of each row.
*/
#pragma once
#include "check.h"

typedef PetscErrorCode (*OracleCheck)(const char row[], const char options[], PetscReal oracle);

/* Collective. Calls check for the rows of growth.csv whose turn it is, and fails when there are fewer than fewest rows. */
static inline PetscErrorCode OracleGrowth(const char path[], const char more[], int fewest, OracleCheck check)
{
  FILE     *file = fopen(path, "r");
  char      row[256], formulation[32], basis[32], drift[32], options[512];
  int       ppc, cells, rows = 0;
  double    courant, growth;
  PetscBool turn = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s cannot be read", path);
  while (fgets(row, sizeof row, file)) {
    if (sscanf(row, "%31[^,],%31[^,],%d,%d,%lf,%31[^,],%lf", formulation, basis, &ppc, &cells, &courant, drift,
               &growth) != 7)
      continue;
    row[strcspn(row, "\r\n")] = 0;
    PetscCall(PetscSNPrintf(options, sizeof options,
                            "-formulation %s -basis %s -ppc %d -cells %d -courant %.17g -drift %s %s", formulation,
                            basis, ppc, cells, courant, drift, more));
    PetscCall(CheckHasTurn(rows++, &turn));
    if (turn) PetscCall(check(row, options, growth));
  }
  fclose(file);
  CHECK(rows >= fewest, "only %d rows read", rows);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Collective. Does the same for radius.csv, which has jittered layouts. */
static inline PetscErrorCode OracleRadius(const char path[], int fewest, OracleCheck check)
{
  FILE  *file = fopen(path, "r");
  char   row[256], formulation[32], options[512];
  int    ppc, cells, seed, rows = 0;
  double courant, jitter, radius;

  PetscFunctionBegin;
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s cannot be read", path);
  while (fgets(row, sizeof row, file)) {
    if (sscanf(row, "%31[^,],%d,%d,%lf,%lf,%d,%lf", formulation, &cells, &ppc, &courant, &jitter, &seed, &radius) != 7)
      continue;
    row[strcspn(row, "\r\n")] = 0;
    PetscCall(PetscSNPrintf(options, sizeof options,
                            "-formulation %s -ppc %d -cells %d -courant %.17g -jitter %.17g -seed %d", formulation, ppc,
                            cells, courant, jitter, seed));
    PetscCall(check(row, options, radius));
    rows++;
  }
  fclose(file);
  CHECK(rows >= fewest, "only %d rows read", rows);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Collective. Does the same for critical.csv: the largest stable Courant number of periodic scenes at rest. */
static inline PetscErrorCode OracleCritical(const char path[], int fewest, OracleCheck check)
{
  FILE  *file = fopen(path, "r");
  char   row[256], formulation[32], basis[32], transfer[32], options[512];
  int    ppc, rows = 0;
  double courant;

  PetscFunctionBegin;
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s cannot be read", path);
  while (fgets(row, sizeof row, file)) {
    if (sscanf(row, "%31[^,],%31[^,],%31[^,],%d,%lf", formulation, basis, transfer, &ppc, &courant) != 5) continue;
    row[strcspn(row, "\r\n")] = 0;
    PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -basis %s -transfer %s -ppc %d", formulation,
                            basis, transfer, ppc));
    PetscCall(check(row, options, courant));
    rows++;
  }
  fclose(file);
  CHECK(rows >= fewest, "only %d rows read", rows);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Collective. Does the same for growth-nd.csv: growth in one, two and three dimensions, on grids with the same number of
   cells in each direction.
*/
static inline PetscErrorCode OracleGrowthNd(const char path[], int fewest, OracleCheck check)
{
  FILE  *file = fopen(path, "r");
  char   row[256], formulation[32], transfer[32], gradient[32], basis[32], offset[32], nu[32], drift[64], options[512];
  int    dim, ppc, cells, rows = 0;
  double courant, growth;

  PetscFunctionBegin;
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s cannot be read", path);
  while (fgets(row, sizeof row, file)) {
    const char *order = "", *poisson = "", *filter = "";

    if (sscanf(row, "%d,%31[^,],%31[^,],%31[^,],%31[^,],%d,%31[^,],%31[^,],%lf,%63[^,],%d,%lf", &dim, formulation,
               transfer, gradient, basis, &ppc, offset, nu, &courant, drift, &cells, &growth) != 12)
      continue;
    row[strcspn(row, "\r\n")] = 0;
    for (char *c = drift; *c; c++)
      if (*c == ' ') *c = ',';
    if (!strncmp(transfer, "xpic", 4)) {
      order       = transfer[4] == '3' ? "-xpic_order 3" : "-xpic_order 2";
      transfer[4] = 0;
    }
    if (strchr("eg", formulation[0]) && strcmp(transfer, "flip"))
      filter = "-pic_filter before";                                      /* the rows' convention */
    if (dim > 1 && strchr("muvri", formulation[0])) poisson = "-poisson"; /* momentum schemes */
    PetscCall(PetscSNPrintf(options, sizeof options,
                            "-dim %d -formulation %s -transfer %s %s -gradient %s -basis %s -ppc %d -offset %s "
                            "%s %s -courant %.17g -drift %s -cells %d %s",
                            dim, formulation, transfer, order, gradient, basis, ppc, offset, poisson,
                            *poisson ? nu : "", courant, drift, cells, filter));
    PetscCall(check(row, options, growth));
    rows++;
  }
  fclose(file);
  CHECK(rows >= fewest, "only %d rows read", rows);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Collective. Does the same for critical-nd.csv: one, two and three dimensions, with the gradient and Poisson's ratio. */
static inline PetscErrorCode OracleCriticalSpace(const char path[], int fewest, OracleCheck check)
{
  FILE  *file = fopen(path, "r");
  char   row[256], formulation[32], transfer[32], gradient[32], basis[32], options[512];
  int    dim, ppc, rows = 0;
  double offset, poisson, courant;

  PetscFunctionBegin;
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s cannot be read", path);
  while (fgets(row, sizeof row, file)) {
    if (sscanf(row, "%d,%31[^,],%31[^,],%31[^,],%31[^,],%d,%lf,%lf,%lf", &dim, formulation, transfer, gradient, basis,
               &ppc, &offset, &poisson, &courant) != 9)
      continue;
    row[strcspn(row, "\r\n")] = 0;
    PetscCall(PetscSNPrintf(options, sizeof options,
                            "-dim %d -formulation %s -transfer %s -gradient %s -basis %s -ppc %d -offset %.17g", dim,
                            formulation, transfer, gradient, basis, ppc, offset));
    if (dim > 1 && strpbrk(formulation, "um")) /* usl, usf, musl, usavg: the others have no stress */
      PetscCall(PetscSNPrintf(options + strlen(options), sizeof options - strlen(options), " -poisson %.17g", poisson));
    PetscCall(check(row, options, courant));
    rows++;
  }
  fclose(file);
  CHECK(rows >= fewest, "only %d rows read", rows);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Collective. Does the same for growth-nonlinear.csv: growth about stretched states, on rings of 16 cells. There an
   adiabat is a polytropic gas, and mls is apic with the gradient mls.
*/
static inline PetscErrorCode OracleGrowthNonlinear(const char path[], int fewest, OracleCheck check)
{
  FILE *file = fopen(path, "r");
  char  row[256], formulation[32], transfer[32], basis[32], material[32], numbers[64], drift[32], offset[32],
      options[512];
  int    ppc, cells, rows = 0;
  double stretch, courant, prestress, growth;

  PetscFunctionBegin;
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "%s cannot be read", path);
  while (fgets(row, sizeof row, file)) {
    double first = 1, second = 0;
    char   number[64] = "";

    if (sscanf(row, "%31[^,],%31[^,],%31[^,],%31[^,],%63[^,],%lf,%31[^,],%d,%31[^,],%lf,%d,%lf,%lf", formulation,
               transfer, basis, material, numbers, &stretch, drift, &ppc, offset, &courant, &cells, &prestress,
               &growth) != 13)
      continue;
    row[strcspn(row, "\r\n")] = 0;
    (void)sscanf(numbers, "%*[^=]=%lf;%*[^=]=%lf", &first, &second);
    if (!strcmp(material, "neo"))
      PetscCall(PetscSNPrintf(number, sizeof number, "-lame_ratio %.17g", second / first));
    else if (second != 0)
      PetscCall(PetscSNPrintf(number, sizeof number, "-exponent %.17g", second));
    PetscCall(PetscSNPrintf(
        options, sizeof options,
        "-formulation %s -transfer %s -gradient %s -basis %s -material %s -stretch %.17g %s -drift "
        "%s -ppc %d -offset %s -courant %.17g -cells %d",
        formulation, strcmp(transfer, "mls") ? transfer : "apic", strcmp(transfer, "mls") ? "basis" : "mls", basis,
        strcmp(material, "adiabat") ? material : "polytropic", stretch, number, drift, ppc, offset, courant, cells));
    PetscCall(check(row, options, growth));
    rows++;
  }
  fclose(file);
  CHECK(rows >= fewest, "only %d rows read", rows);
  PetscFunctionReturn(PETSC_SUCCESS);
}
