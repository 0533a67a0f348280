/* Prints the result of a run as a table for people. */
#include "report/report.h"
#include "report/results.h"
#include "march/partition.h"
#include "symbol/predict.h"
#include <math.h>

/* Prints a number. One that is out of range is described as such, not printed as inf. */
static void PrintNumber(PetscReal value)
{
  if (isfinite(value))
    MpmPrint("  %11.4e", value);
  else
    MpmPrint("  %11s", "off range");
}

/* How the steps of a run were chosen. */
static void PrintPace(const MpmRun *run)
{
  const MpmScene *s    = run->scene;
  const MpmPace  *pace = run->pace;

  if (MpmPaceHasChosen(pace))
    MpmPrint("dt from %.6g to %.6g, changed %" PetscInt64_FMT " times\n", MpmSceneTimeStep(s, pace->least),
             MpmSceneTimeStep(s, pace->largest), pace->changes);
  else
    MpmPrint("dt: every step is what is left to the end\n");
  MpmPrint("  %-10s %-9" PetscInt64_FMT
           " steps: %g of the largest stable step of particles at rest (%s), %.6g h / c, with the "
           "fastest waves' c\n",
           "by waves", pace->taken[MPM_PACE_WAVES], s->safety, MpmNeighbourhoodNames[pace->where], pace->limit);
  if (pace->taken[MPM_PACE_MOTION])
    MpmPrint("  %-10s %-9" PetscInt64_FMT " steps: the fastest particle may not go a cell in a step\n", "by motion",
             pace->taken[MPM_PACE_MOTION]);
  MpmPrint("\n");
}

static PetscErrorCode PrintScene(const MpmRun *run)
{
  const MpmScene *s = run->scene;

  PetscFunctionBegin;
  PetscCall(MpmReportScene(s, run->request));
  MpmPrint("initial data: %s", MpmInitialNames[s->initial]);
  for (PetscInt a = 0; a < s->layout.dim && s->initial == MPM_INITIAL_MODE; a++)
    MpmPrint("%s%" PetscInt_FMT, a ? "," : " ", s->mode[a]);
  if (s->initial == MPM_INITIAL_MODE && MpmSceneHasPoisson(s))
    MpmPrint(", polarisation %s", MpmPolarisationNames[s->polarisation]);
  if (s->initial == MPM_INITIAL_EIGENMODE) MpmPrint(" %" PetscInt_FMT " of %s", s->mode[0], run->request->mode_file);
  MpmPrint(", amplitude %.6g%s; %" PetscInt64_FMT " steps", s->amplitude, s->stagger ? ", staggered" : "", run->steps);
  if (!run->pace) MpmPrint(" of dt = %.6g", s->dt);
  MpmPrint(" to time %.6g\n\n", run->time);
  if (run->pace) PrintPace(run);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Prediction(const char name[], PetscReal growth, const char formula[])
{
  MpmReportGrowth(name, growth, isnan(growth) ? "the formula does not cover this scene" : formula);
}

/* A motion that is not about a uniform state has no rate, however many steps it takes. */
static PetscBool HasGrowth(const MpmRun *run)
{
  return !run->scene->scheme.space.finite || run->scene->initial == MPM_INITIAL_RANDOM ? PETSC_TRUE : PETSC_FALSE;
}

static void PrintGrowth(const MpmRun *run)
{
  const MpmScene *s = run->scene;

  MpmPrint("growth per step\n");
  Prediction("published", run->predictions.published, s->scheme.formulation->published_text);
  Prediction("corrected", run->predictions.corrected, MpmPredictionText(&s->scheme));
  if (s->initial == MPM_INITIAL_MODE)
    Prediction("  this mode", run->predictions.corrected_mode, "corrected, at beta = 2 pi mode / cells");
  if (s->initial == MPM_INITIAL_EIGENMODE) MpmReportGrowth("  this mode", run->eigenmode, "abs of its eigenvalue");
  if (run->growth.measured) {
    MpmPrint("  %-11s %-13.9g %s, steps %" PetscInt64_FMT " to %" PetscInt64_FMT, "measured", run->growth.per_step,
             MpmGrowthKindNames[run->growth.kind], run->growth.from, run->growth.to);
    if (run->growth.kind == MPM_EXPONENTIAL && isfinite(run->growth.error))
      MpmPrint(", standard error %.1e", run->growth.error);
    MpmPrint("\n\n");
  } else
    MpmPrint("  %-11s %-13s %s\n\n", "measured", "-",
             HasGrowth(run) ? "too few steps, or nothing left to measure"
                            : "a motion at finite deformation has no growth");
}

static void PrintErrors(const MpmRun *run)
{
  const char    *name[MPM_MOST_ERRORS];
  const PetscInt n = run->has_errors ? MpmSceneErrorFields(run->scene, name) : 0;

  if (run->has_errors) {
    MpmPrint("error against the exact solution of %s\n  %-5s  %11s  %11s  %11s   relative to its amplitude\n",
             MpmSceneEquations(run->scene), "field", "l1", "l2", "linf");
    for (PetscInt f = 0; f < n; f++) {
      MpmPrint("  %-5s", name[f]);
      PrintNumber(run->error[f].l1);
      PrintNumber(run->error[f].l2);
      PrintNumber(run->error[f].linf);
      MpmPrint("\n");
    }
  } else
    MpmPrint("error: none, these data have no exact solution\n");
  if (MpmSchemeEnergyTerms(&run->scene->scheme)) {
    MpmPrint("energy");
    PrintNumber(run->energy_initial);
    MpmPrint(" first");
    PrintNumber(run->energy_final);
    MpmPrint(" last\n");
  } else
    MpmPrint("energy: none, %s; growth is that of the norm of its fields\n",
             run->scene->scheme.formulation->nenergy ? "the stress about a prestressed state does not say it"
                                                     : "the formulation names none");
  if (run->relaxed)
    MpmPrint("relaxed: %" PetscInt64_FMT " steps, their increments times %.9g or more\n", run->relaxed,
             run->least_factor);
  if (run->blew_up_at_step != MPM_NEVER)
    MpmPrint("the state left the range of double precision by step %" PetscInt64_FMT "%s\n", run->blew_up_at_step,
             run->lost ? "; the run stopped there" : "; it was followed by rescaling");
}

static void PrintConserved(const MpmRun *run)
{
  MpmPrint("conserved: %" PetscInt64_FMT " particles", run->scene->layout.particles);
  if (!isnan(run->mass_change)) MpmPrint(", mass to %.1e", run->mass_change);
  if (!isnan(run->momentum_change)) MpmPrint(", momentum to %.1e of its size", run->momentum_change);
  MpmPrint("\n");
}

static void PrintSolver(const MpmRun *run)
{
  if (!run->scene->scheme.table->nstiff || run->steps == run->from) return;
  MpmPrint("solver: %.3g iterations a step\n", (PetscReal)run->iterations / (PetscReal)(run->steps - run->from));
}

static void PrintLoad(const MpmRun *run)
{
  if (run->load <= MPM_BALANCE_BOUND) return;
  MpmPrint("load: the fullest rank had %.2f times the mean number of particles%s\n", run->load,
           run->scene->layout.balance == MPM_BALANCE_PARTICLES ? "" : "; see -balance");
}

/* Prints a diagnostic of one field; '-' stands where there was nothing to divide by. */
static void PrintField(const char name[], const char when[], PetscReal value)
{
  if (isnan(value))
    MpmPrint("  %s %s -", name, when);
  else
    MpmPrint("  %s %s %.4e", name, when, value);
}

static void PrintTransfer(const MpmRun *run)
{
  const MpmTransferDiagnosticsSample *first = &run->transfer_first, *last = &run->transfer_last,
                                     *most = &run->transfer_most;
  const MpmTable *table                    = run->scene->scheme.table;

  if (run->request->weights) MpmPrint("weights: C1 from %.6g to %.6g, C2 = 1 - C1\n", most->c1_min, most->c1_max);
  if (run->request->source_term) {
    MpmPrint("source term, relative to the nodes' field:");
    for (PetscInt f = 0; table->fields[f]; f++) PrintField(table->fields[f], "up to", most->source[f]);
    MpmPrint("\n");
  }
  if (run->request->ringing) {
    MpmPrint("ringing content, share of particle data that P2G does not see:");
    for (PetscInt f = 0; table->fields[f]; f++) {
      PrintField(table->fields[f], "first", first->ringing[f]);
      PrintField("", "last", last->ringing[f]);
    }
    MpmPrint("\n");
  }
}

static void PrintVerdict(const MpmRun *run)
{
  const MpmGrowth *growth = &run->growth;

  MpmPrint("\nverdict: %s", MpmVerdictNames[run->verdict]);
  if (run->lost)
    MpmPrint(
        ", the state leaves the range of double precision from one sample to the next: growth above %.1e per step\n",
        run->growth_above);
  else if (!HasGrowth(run))
    MpmPrint(", a motion at finite deformation has no growth; -initial random measures that about a uniform state\n");
  else if (!growth->measured)
    MpmPrint(", the growth could not be measured\n");
  else if (!growth->decided)
    MpmPrint(", the growth has not settled into a kind; run more steps\n");
  else if (run->verdict == MPM_UNSTABLE)
    MpmPrint(", the state grows exponentially\n");
  else if (growth->kind == MPM_LINEAR)
    MpmPrint(", the state grows no faster than linearly (a defective eigenvalue of modulus 1)\n");
  else
    MpmPrint(", the state stays bounded%s\n",
             run->has_errors ? " (from smooth data; random data excite every mode)" : "");
  if (run->steps > run->from) {
    MpmPrint("time: %.3g s in the loop", run->loop_s);
    if (run->scene->scheme.table->nstiff) MpmPrint(" (%.3g s in the solver)", run->solve_s);
    MpmPrint(", %.3g ns per particle and step, %.3g s in all\n",
             1e9 * run->loop_s / ((PetscReal)(run->steps - run->from) * (PetscReal)run->scene->layout.particles),
             run->wall_s);
  } else
    MpmPrint("time: %.3g s in all\n", run->wall_s);
}

PetscErrorCode MpmRunPrint(const MpmRun *run)
{
  PetscFunctionBegin;
  PetscCall(PrintScene(run));
  PrintGrowth(run);
  PrintErrors(run);
  PrintConserved(run);
  PrintLoad(run);
  PrintSolver(run);
  PrintTransfer(run);
  MpmTangentsPrint(run->tangents);
  PrintVerdict(run);
  PetscFunctionReturn(PETSC_SUCCESS);
}
