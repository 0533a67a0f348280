/*
   The task map: mpmstab map [SCENE.yaml | -program COMMAND | -plugin FILE] [-option value]... A stability map as a
   picture of letters, and as JSON, CSV and HDF5.
*/
#include "analysis/stability_map.h"
#include "base/textfile.h"
#include "io/datafile.h"
#include "report/report_program.h"
#include "task/task.h"
#include "base/progress.h"
#include "probe/program_growth.h"
#include "report/results.h"
#include <mpmstab/errors.h>
#include <math.h>

/* The largest number of rows and columns printed; others are left out. */
#define MOST_ROWS 25
#define MOST_COLUMNS 65

static char Letter(const MpmStabilityMap *map, PetscInt point)
{
  const PetscReal excess = map->growth[point] - 1;

  if (map->verdict[point] == MPM_UNDECIDED) return '?';
  if (map->verdict[point] == MPM_STABLE) return '.';
  return excess < 1e-3 ? '-' : excess < 1e-2 ? '+' : excess < 1e-1 ? 'x' : '#';
}

/* The first axis points up, the second to the right. */
static void PrintPicture(const MpmStabilityMap *map)
{
  const PetscInt rows = map->points[0], columns = map->points[1];
  const PetscInt down = (rows - 1) / MOST_ROWS + 1, right = (columns - 1) / MOST_COLUMNS + 1;

  MpmPrint("\n%s\n", map->request->axes[0].name);
  for (PetscInt i = (rows - 1) / down * down; i >= 0; i -= down) {
    char     line[MOST_COLUMNS + 1];
    PetscInt n = 0;

    for (PetscInt j = 0; j < columns; j += right) line[n++] = Letter(map, i * columns + j);
    line[n] = '\0';
    MpmPrint("%8.5g  %s\n", map->at[0][i], line);
  }
  MpmPrint("%8s  %s %.6g to %.6g\n", "", map->request->axes[1].name, map->at[1][0], map->at[1][columns - 1]);
  MpmPrint(". stable   growth - 1 per step: - below 0.001, + below 0.01, x below 0.1, # beyond   ? undecided\n");
}

/* How many points a certificate fails at, and one of them. */
static void PrintFaults(const MpmStabilityMap *map)
{
  const MpmAxis *axes = map->request->axes;

  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++) {
    PetscInt count = 0, first = 0;

    for (PetscInt i = map->points[0] * map->points[1] - 1; i >= 0; i--) {
      if (map->fault[i] != (PetscInt)c) continue;
      first = i;
      count++;
    }
    if (count)
      MpmPrint("  %s fails at %" PetscInt_FMT " points, first at %s %.6g, %s %.6g: %s\n", MpmCertificateNames[c], count,
               axes[0].name, map->at[0][first / map->points[1]], axes[1].name, map->at[1][first % map->points[1]],
               MpmCertificateFaults[c]);
  }
}

/* The axes, and the limits of the closed forms, which JSON alone has. */
static PetscErrorCode Axes(json_t *result, MpmStabilityMap *map)
{
  const int other = map->request->axes[0].kind == MPM_AXIS_COURANT ? 1 : 0;

  PetscFunctionBegin;
  for (int a = 0; a < 2; a++) {
    const char *name = map->request->axes[a].name;

    (void)json_array_append_new(MpmResultList(result, "axes"), json_string(name));
    (void)json_array_append_new(MpmResultList(result, "shape"), json_integer(map->points[a]));
    MpmResultNumbers(result, name, map->points[a], map->at[a]);
  }
  if (map->waves) MpmResultKeep(result, "%" PetscInt64_FMT "{phases}", MpmStabilityMapPhases(map));
  if (map->request->refine) MpmResultKeep(result, "%d{refined?}", 1);
  MpmResultKeep(result, "%g{seconds}", map->seconds);
  if (map->scene && map->request->json[0]) PetscCall(MpmStabilityMapLimits(map));
  if (!map->limits) PetscFunctionReturn(PETSC_SUCCESS);
  MpmResultKeep(result, "%g{published_limit!}", map->published_limit);
  MpmResultNumbers(result, "corrected_limit", map->points[other], map->limits);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Report(MpmStabilityMap *map, PetscReal wall_s)
{
  const MpmRequest *request = map->request;
  const MpmAxis    *axes    = request->axes;
  const MpmFinding *f       = &map->finding;
  const PetscInt    n       = map->points[0] * map->points[1];
  json_t           *result, *found;
  char              layout[MPM_COUNTS_TEXT] = "";

  PetscFunctionBegin;
  if (map->scene) PetscCall(MpmReportLayout(map->scene, request, sizeof layout, layout));
  PetscCall(map->scene ? MpmResultOfScene(map->scene, request, &result) : MpmResultOfFile(request, NULL, &result));
  found = MpmResultIn(result, "map");
  MpmResultFinding(result, f);
  PetscCall(Axes(found, map));
  if (map->program) {
    MpmReportProgram(map->program);
    MpmPrint("at each of the points; certificates are of the one that grows fastest\n");
    MpmReportProbed(result, map->program);
  }
  PrintPicture(map);
  MpmPrint("\npoints     %" PetscInt_FMT " x %" PetscInt_FMT, map->points[0], map->points[1]);
  if (map->waves) MpmPrint(", %" PetscInt64_FMT " phases", MpmStabilityMapPhases(map));
  if (map->scene && !request->refine) MpmPrint(" (growth between them is not seen: -refine looks for it)");
  MpmResultSay(found, "\nunstable   %" PetscInt_FMT "{unstable} (%.4g%%)\nundecided  %" PetscInt_FMT "{undecided}\n",
               map->unstable, 100.0 * map->unstable / n, map->undecided);
  if (map->program) PrintFaults(map);
  MpmPrint("growth     per step, largest: %.9g at %s %.6g, %s %.6g%s%s\n", f->growth, axes[0].name,
           map->at[0][map->worst / map->points[1]], axes[1].name, map->at[1][map->worst % map->points[1]],
           map->scene ? "; " : "", layout);
  if (!isnan(map->published_limit))
    MpmPrint("published  stable up to Courant number %.6g (particles at rest)\n", map->published_limit);
  MpmPrint("\nverdict: %s, growth beyond 1 + %.6g at %" PetscInt_FMT " of %" PetscInt_FMT " points%s%s\nevidence: %s\n",
           MpmVerdictNames[f->verdict], f->tolerance, map->unstable, n, map->scene ? "; " : "", layout, f->evidence);
  MpmPrint("time: %.3g s\n", map->seconds);
  PetscCall(MpmResultEnd(request, wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name of a column of numbers for each direction. */
static const char *NameOf(const MpmStabilityMap *map, const char what[], PetscInt a, char name[16])
{
  (void)snprintf(name, 16, map->waves == 1 ? "%s" : "%s_%c", what, "xyz"[a]);
  return name;
}

static PetscErrorCode WriteCsv(const MpmStabilityMap *map)
{
  const PetscInt dim = map->waves;
  MpmTextFile    csv;
  char           name[16];

  PetscFunctionBegin;
  PetscCall(MpmTextFileOpen(map->request->csv, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "%s,%s,growth", map->request->axes[0].name, map->request->axes[1].name);
    for (PetscInt a = 0; a < dim; a++) fprintf(csv.stream, ",%s", NameOf(map, "beta", a, name));
    for (PetscInt a = 0; a < dim && map->drift[a]; a++) fprintf(csv.stream, ",%s", NameOf(map, "drift", a, name));
    fprintf(csv.stream, ",verdict%s\n", map->fault ? ",fails" : "");
    for (PetscInt i = 0; i < map->points[0] * map->points[1]; i++) {
      fprintf(csv.stream, "%.17g", map->at[0][i / map->points[1]]);
      MpmTextFileCell(&csv, map->at[1][i % map->points[1]]);
      MpmTextFileCell(&csv, map->growth[i]);
      for (PetscInt a = 0; a < dim; a++) MpmTextFileCell(&csv, map->beta[a][i]);
      for (PetscInt a = 0; a < dim && map->drift[a]; a++) MpmTextFileCell(&csv, map->drift[a][i]);
      fprintf(csv.stream, ",%s", MpmVerdictNames[map->verdict[i]]);
      if (map->fault)
        fprintf(csv.stream, ",%s", map->fault[i] < MPM_CERTIFICATES ? MpmCertificateNames[map->fault[i]] : "");
      fprintf(csv.stream, "\n");
    }
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteOutput(const MpmStabilityMap *map)
{
  MpmDataFile file;
  char        name[16];

  PetscFunctionBegin;
  PetscCall(MpmDataFileOpen(PETSC_COMM_WORLD, map->scene, map->request, &file));
  for (int a = 0; a < 2; a++)
    PetscCall(MpmDataFileArray(&file, "/map", map->request->axes[a].name, map->points[a], 1, map->at[a]));
  PetscCall(MpmDataFileArray(&file, "/map", "growth", map->points[0], map->points[1], map->growth));
  for (PetscInt a = 0; a < map->waves; a++)
    PetscCall(
        MpmDataFileArray(&file, "/map", NameOf(map, "beta", a, name), map->points[0], map->points[1], map->beta[a]));
  for (PetscInt a = 0; a < map->waves && map->drift[a]; a++)
    PetscCall(
        MpmDataFileArray(&file, "/map", NameOf(map, "drift", a, name), map->points[0], map->points[1], map->drift[a]));
  PetscCall(MpmDataFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- of a code: at each point two of its parameters are set, and its operator is probed and judged ---- */

static PetscErrorCode CheckAxes(const MpmStabilityMap *map)
{
  const MpmStepper *s     = map->program->stepper;
  MpmText           names = {NULL, 0};
  PetscErrorCode    ierr  = PETSC_SUCCESS;

  PetscFunctionBegin;
  PetscCall(MpmStepperParameterNames(s, &names));
  for (int a = 0; a < 2 && !ierr; a++) {
    PetscBool found;
    PetscReal value;

    MpmStepperParameterOf(s, map->request->axes[a].name, &value, &found);
    if (!found)
      ierr = MpmRefusal("-map_axes %s: %s has no such parameter; allowed: %s", map->request->axes[a].name, s->where,
                        names.text);
  }
  MpmTextFree(&names);
  PetscFunctionReturn(ierr);
}

static PetscErrorCode GoTo(MpmStabilityMap *m, PetscInt i)
{
  PetscFunctionBegin;
  PetscCall(MpmStepperSet(m->program->stepper, m->request->axes[0].name, m->at[0][i / m->points[1]]));
  PetscCall(MpmStepperSet(m->program->stepper, m->request->axes[1].name, m->at[1][i % m->points[1]]));
  PetscCall(MpmProgramPrepare(m->program));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Judge(MpmStabilityMap *m, PetscReal beta[], MpmFinding *f)
{
  MpmCarriers carriers;

  PetscFunctionBegin;
  if (m->waves)
    PetscCall(MpmProgramJudgeWaves(m->program, m->phases, beta, f));
  else
    PetscCall(MpmProgramJudgeParticles(m->program, MPI_Wtime(), f, &carriers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A growth that is not known is kept as NaN, and the point is undecided. */
static PetscErrorCode Solve(MpmStabilityMap *m)
{
  const PetscInt n = m->points[0] * m->points[1];
  MpmProgress    progress;

  PetscFunctionBegin;
  PetscCall(MpmProgressBegin("points", &progress));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal  beta[MPM_MAX_DIM] = {0};
    MpmFinding f;

    PetscCall(GoTo(m, i));
    PetscCall(Judge(m, beta, &f));
    m->growth[i]  = f.growth;
    m->verdict[i] = f.verdict;
    m->fault[i]   = (PetscInt)MpmCertificatesFault(&m->program->certificates);
    for (PetscInt a = 0; a < m->waves; a++) m->beta[a][i] = beta[a];
    PetscCall(MpmProgramForget(m->program));
    PetscCall(MpmProgressUpdate(&progress, i + 1, n));
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Probes a code at each point, where two of its parameters have the point's numbers. The program must have been opened
   and not be prepared; afterwards it is prepared for the point that grows fastest, and must outlive the map.
*/
static PetscErrorCode MapOfProgram(MpmProgram *p, MpmStabilityMap **map)
{
  const PetscReal  begin = MPI_Wtime();
  MpmStabilityMap *m;
  PetscInt         n;
  PetscReal        beta[MPM_MAX_DIM];
  MpmFinding       worst;

  PetscFunctionBegin;
  PetscCall(MpmStabilityMapBegin(p->request, map));
  m          = *map;
  m->program = p;
  n          = m->points[0] * m->points[1];
  PetscCall(CheckAxes(m));
  PetscCall(GoTo(m, 0));
  m->waves = p->kind == MPM_PROBE_BLOCH ? p->stepper->dim : 0;
  PetscCall(MpmProgramForget(p));
  MpmCheckInput(m->waves || !p->request->given_phases,
                "-phases: the operator of all particles is probed, which has no phases; allowed: with a code whose "
                "cells are alike");
  PetscCall(MpmRequestPhases(p->request, p->stepper->dim, m->phases));
  for (PetscInt a = 0; a < m->waves; a++) PetscCall(PetscCalloc1(n, &m->beta[a]));
  PetscCall(PetscMalloc1(n, &m->fault));
  PetscCall(Solve(m));
  PetscCall(MpmStabilityMapSum(m));
  m->finding.tolerance = p->tolerance;
  (void)snprintf(m->finding.evidence, sizeof m->finding.evidence,
                 m->waves ? "the symbol of the interior at each of %" PetscInt_FMT " points, sought over all waves"
                          : "the operator of all particles at each of %" PetscInt_FMT " points",
                 n);
  PetscCall(GoTo(m, m->worst));
  PetscCall(Judge(m, beta, &worst));
  m->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskMap(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmProgram       program;
  MpmStabilityMap *map;

  PetscFunctionBegin;
  if (scene)
    PetscCall(MpmStabilityMapCreate(scene, request, &map));
  else {
    PetscCall(MpmProgramOpen(request, &program));
    PetscCall(MapOfProgram(&program, &map));
  }
  if (request->csv[0]) PetscCall(WriteCsv(map));
  if (request->output[0]) PetscCall(WriteOutput(map));
  PetscCall(Report(map, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&request->expect, map->finding.verdict, NAN, missed));
  PetscCall(MpmStabilityMapDestroy(&map));
  if (!scene) PetscCall(MpmProgramClose(&program));
  PetscFunctionReturn(PETSC_SUCCESS);
}
