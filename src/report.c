/* The result as a table for people. */
#include <mpmstab/run.h>
#include <math.h>

#define Print(...) PetscCall(PetscPrintf(PETSC_COMM_WORLD, __VA_ARGS__))

/* A number that may be out of range is said to be so, not printed as inf. */
static PetscErrorCode PrintNumber(PetscReal value)
{
  PetscFunctionBegin;
  if (isfinite(value))
    Print("  %11.4e", value);
  else
    Print("  %11s", "off range");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintScene(const MpmRun *run)
{
  const MpmScene *s = run->scene;

  PetscFunctionBegin;
  Print("mpmstab %s run: %s, %s basis, %s transfer, %s\n", MPMSTAB_VERSION, s->formulation->name, s->basis->name,
        s->transfer, s->boundary);
  Print("%" PetscInt_FMT " cells x %" PetscInt_FMT
        " particles (%s, offset %.6g, jitter %.6g), Courant number %.6g, drift ",
        s->cells, s->ppc, s->layout, s->offset.value, s->jitter, s->courant);
  if (s->drift.den > 1)
    Print("%" PetscInt64_FMT "/%" PetscInt64_FMT, s->drift.num, s->drift.den);
  else
    Print("%.6g", s->drift.value);
  Print(" cells per step, %d rank%s\n", run->ranks, run->ranks == 1 ? "" : "s");
  Print("initial data: %s", MpmInitialNames[s->initial]);
  if (s->initial == MPM_INITIAL_MODE) Print(" %" PetscInt_FMT, s->mode);
  Print(", amplitude %.6g%s; %" PetscInt64_FMT " steps of dt = %.6g to time %.6g\n\n", s->amplitude,
        s->stagger ? ", staggered" : "", run->steps, s->dt, run->steps * s->dt);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintPrediction(const char name[], PetscReal growth, const char formula[])
{
  PetscFunctionBegin;
  if (isnan(growth))
    Print("  %-11s %-13s the formula does not cover this scene\n", name, "-");
  else if (isinf(growth))
    Print("  %-11s %-13s %s\n", name, "off range", formula);
  else
    Print("  %-11s %-13.9g %s\n", name, growth, formula);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintGrowth(const MpmRun *run)
{
  const MpmScene *s = run->scene;

  PetscFunctionBegin;
  Print("growth per step\n");
  PetscCall(PrintPrediction("published", run->predictions.published, s->formulation->published_text));
  PetscCall(PrintPrediction("corrected", run->predictions.corrected, s->formulation->corrected_text));
  if (s->initial == MPM_INITIAL_MODE)
    PetscCall(
        PrintPrediction("  this mode", run->predictions.corrected_mode, "corrected, at beta = 2 pi mode / cells"));
  if (run->growth.measured)
    Print("  %-11s %-13.9g %s, steps %" PetscInt64_FMT " to %" PetscInt64_FMT "\n\n", "measured", run->growth.per_step,
          MpmGrowthKindNames[run->growth.kind], run->growth.from, run->growth.to);
  else
    Print("  %-11s %-13s too few steps, or nothing left to measure\n\n", "measured", "-");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintErrors(const MpmRun *run)
{
  PetscFunctionBegin;
  if (run->has_errors) {
    Print("error against the exact solution of %s\n  %-5s  %11s  %11s  %11s   relative to its amplitude\n",
          run->scene->formulation->wave->equations, "field", "l1", "l2", "linf");
    for (PetscInt f = 0; run->scene->formulation->particle_fields[f]; f++) {
      Print("  %-5s", run->scene->formulation->particle_fields[f]);
      PetscCall(PrintNumber(run->error[f].l1));
      PetscCall(PrintNumber(run->error[f].l2));
      PetscCall(PrintNumber(run->error[f].linf));
      Print("\n");
    }
  } else
    Print("error: none, random data have no exact solution\n");
  Print("energy");
  PetscCall(PrintNumber(run->energy_initial));
  Print(" first");
  PetscCall(PrintNumber(run->energy_final));
  Print(" last\n");
  if (run->blew_up_at_step != MPM_NEVER)
    Print("the state left the range of double precision by step %" PetscInt64_FMT "%s\n", run->blew_up_at_step,
          run->lost ? "; the run stopped there" : "; it was followed by rescaling");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintVerdict(const MpmRun *run)
{
  const MpmGrowth *growth = &run->growth;

  PetscFunctionBegin;
  Print("\nverdict: %s", MpmVerdictNames[run->verdict]);
  if (run->lost)
    Print(", one step takes the state beyond the range of double precision\n");
  else if (!growth->measured)
    Print(", the growth could not be measured\n");
  else if (!growth->decided)
    Print(", the growth has not settled into a kind; run more steps\n");
  else if (run->verdict == MPM_UNSTABLE)
    Print(", the state grows exponentially\n");
  else if (growth->kind == MPM_LINEAR)
    Print(", the state grows no faster than linearly (a defective eigenvalue 1)\n");
  else
    Print(", the state stays bounded%s\n",
          run->scene->initial == MPM_INITIAL_RANDOM ? "" : " (from smooth data; random data excite every mode)");
  Print("time: %.3g s in the loop, %.3g ns per particle and step, %.3g s in all\n", run->loop_s,
        1e9 * run->loop_s / ((PetscReal)run->steps * (PetscReal)run->scene->particles), run->wall_s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunPrint(const MpmRun *run)
{
  PetscFunctionBegin;
  PetscCall(PrintScene(run));
  PetscCall(PrintGrowth(run));
  PetscCall(PrintErrors(run));
  PetscCall(PrintVerdict(run));
  PetscFunctionReturn(PETSC_SUCCESS);
}
