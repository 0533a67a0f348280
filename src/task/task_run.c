/*
   The task run: mpmstab run [SCENE.yaml] [-option value]... Keys of JSON are a contract; one that is absent was not
   computed.
*/
#include "analysis/run.h"
#include "march/partition.h"
#include "report/report.h"
#include "symbol/predict.h"
#include "task/task.h"
#include <mpmstab/errors.h>
#include <math.h>

static void Tangents(json_t *run, const MpmTangents *t)
{
  json_t *result;

  if (!t) return;
  result = MpmResultIn(run, "tangent");
  MpmResultKeep(result, "%" PetscInt64_FMT "{steps} %" PetscInt_FMT "{window} %g{bytes} %g{least_distance}", t->steps,
                t->window, t->bytes, t->room);
  MpmResultKeep(result, "%" PetscInt_FMT "{warnings}", t->warned);
  (void)MpmResultList(result, "growth");
  (void)MpmResultList(result, "windows");
  for (PetscInt w = 0; w < t->nwindows; w++)
    MpmResultKeep(MpmResultNext(result, "windows"),
                  "%" PetscInt64_FMT "{step} %" PetscInt_FMT "{steps} %g{growth} %g{waves}", t->at[w].step,
                  t->at[w].steps, t->at[w].norm, t->at[w].waves);
  if (!t->steps) return;
  MpmPrint("\ntangent: small perturbations beside %" PetscInt64_FMT " steps, in x / h, v / c and F / F0\n", t->steps);
  MpmPrint("  growth per step, each orthogonal to those before it:");
  for (PetscInt i = 0; i < t->exponents; i++) {
    const PetscReal growth = exp(t->log_growth[i] / t->steps);

    MpmPrint(" %.6g", growth);
    (void)json_array_append_new(MpmResultList(result, "growth"), json_real(growth));
  }
  MpmPrint("\n");
  if (t->nwindows)
    MpmPrint("  most that any can grow: %.4g times in %" PetscInt_FMT " steps up to step %" PetscInt64_FMT
             ", which is %.3g times 1 + c t / h\n",
             t->largest.norm, t->largest.steps, t->largest.step, t->excess);
  if (t->warned)
    MpmResultSay(result,
                 "  warnings: %" PetscInt_FMT ", the first at step %" PetscInt64_FMT
                 "{warned_at_step}, the last at step %" PetscInt64_FMT "\n",
                 t->warned, t->first, t->last);
  else if (t->nwindows)
    MpmPrint("  warnings: none (of growth above %g times 1 + c t / h)\n", t->warn_above);
  if (isfinite(t->room))
    MpmPrint("  least distance of a particle to a place where the weights have no %s: %.3g cells\n",
             t->space.sizes.scheme->basis->hat ? "slope, which perturbations must not reach" : "curvature", t->room);
  if (t->on_surface > 0)
    MpmResultSay(result,
                 "  on the yield surface: %" PetscInt64_FMT
                 "{on_surface} steps of single particles; their derivative is that without flow\n",
                 t->on_surface);
  MpmPrint("  memory: %.3g MB for the tangents of a window\n", 1e-6 * t->bytes);
}

/* Prints a number. One that is out of range is described as such, not printed as inf. */
static void PrintNumber(PetscReal value)
{
  if (isfinite(value))
    MpmPrint("  %11.4e", value);
  else
    MpmPrint("  %11s", "off range");
}

/* Which share of the steps stood under the bound, and would have if they had been longer. */
static void Under(json_t *result, const char name[], const MpmPaceHeld *h)
{
  if (h->steps == 0) return;
  MpmPrint("  %-10s %.4g %% of %" PetscInt64_FMT " steps were under it", name, 100 * h->under[0] / h->steps,
           (PetscInt64)h->steps);
  for (PetscInt f = 0; f < MPM_PACE_FACTORS; f++) {
    MpmResultKeep(MpmResultNext(result, "under"), "%g{times} %g{share}", MpmPaceFactors[f], h->under[f] / h->steps);
    if (f > 0)
      MpmPrint("%s%.4g %% if %g times as long", f == 1 ? "; " : ", ", 100 * h->under[f] / h->steps, MpmPaceFactors[f]);
  }
  MpmPrint("\n");
}

/* What bounded the smallest step, so that a person can look. */
static void Decided(json_t *result, const MpmRun *run, const MpmPaceHeld *h, const char name[])
{
  const PetscInt dim = run->scene->layout.dim;
  PetscReal      x[MPM_MAX_DIM];
  char           place[MPM_VECTOR_TEXT];

  if (h->step == 0) return;
  for (PetscInt a = 0; a < dim; a++) x[a] = h->place[a] * run->scene->cell_width;
  MpmResultPut(result, "id", json_integer((PetscInt64)h->id));
  MpmResultNumbers(result, "place", dim, x);
  MpmResultSay(result,
               "  %-10s step %" PetscInt64_FMT
               "{step}: the particles as they stood had the least bound at particle %" PetscInt64_FMT
               ", at %s; its number is %.6g{number} h / c\n",
               name, (PetscInt64)h->step, (PetscInt64)h->id, MpmVectorText(dim, x, 6, place), h->number);
}

/* How the steps of a run were chosen. */
static void Pace(json_t *result, const MpmRun *run)
{
  const MpmScene    *s    = run->scene;
  const MpmPace     *pace = run->pace;
  const MpmPaceHeld *h    = &pace->held;

  if (MpmPaceHasChosen(pace))
    MpmResultSay(
        result, "dt from %.6g{dt_least} to %.6g{dt_largest}, mean %.6g{dt_mean}, changed %" PetscInt64_FMT " times\n",
        MpmSceneTimeStep(s, pace->least), MpmSceneTimeStep(s, pace->largest),
        MpmSceneTimeStep(s, pace->sum / (PetscReal)(pace->taken[MPM_PACE_WAVES] + pace->taken[MPM_PACE_MOTION])),
        pace->changes);
  else
    MpmPrint("dt: every step is what is left to the end\n");
  MpmResultKeep(result, "%" PetscInt64_FMT "{changes}", pace->changes);
  for (MpmPaceReason r = 0; r < MPM_PACE_REASONS; r++)
    MpmResultPut(MpmResultIn(result, "steps"), MpmPaceReasonNames[r], json_integer(pace->taken[r]));
  MpmResultSay(result, "  %-10s %-9" PetscInt64_FMT " steps: %g{safety} of ", "by waves", pace->taken[MPM_PACE_WAVES],
               s->safety);
  if (pace->why_not)
    MpmResultSay(result,
                 "%.6g{limit} h / c, the limit at rest of %s, with the fastest waves' c; no bound of these particles: "
                 "%s{no_bound}\n",
                 h->limit,
                 pace->where == MPM_ALONE     ? "a particle that is alone"
                 : pace->where == MPM_AT_EDGE ? "the edge of a lattice"
                                              : "a lattice",
                 pace->why_not);
  else
    MpmResultSay(
        result,
        "a bound for the particles as they stand (%s), last %.6g{limit} h / c with the fastest waves' c, first "
        "%.6g{first_limit}\n",
        MpmPaceLimitName(pace), h->limit, h->first);
  MpmResultKeep(result, "%s{limited_by}", MpmPaceLimitName(pace));
  if (!pace->why_not && s->step_bound == MPM_STEP_LANCZOS)
    MpmResultSay(result,
                 "  %-10s %-9" PetscInt64_FMT
                 "{certificates} made, each but for a chance of %g{chance}; bound particle was looked "
                 "at %" PetscInt64_FMT "{looks} times\n",
                 "certified", (PetscInt64)h->certificates, pace->chance, (PetscInt64)h->looks);
  if (pace->taken[MPM_PACE_MOTION])
    MpmPrint("  %-10s %-9" PetscInt64_FMT " steps: the fastest particle may not go a cell in a step\n", "by motion",
             pace->taken[MPM_PACE_MOTION]);
  if (!pace->why_not) Decided(MpmResultIn(result, "decided"), run, h, "smallest");
  Under(result, pace->why_not ? "limit" : "bound", h);
  MpmPrint("\n");
}

/* How the steps of a run, which are all alike, compare with the bound. */
static void Watch(json_t *result, const MpmRun *run)
{
  const MpmPace     *pace = run->watch;
  const MpmPaceHeld *h    = &pace->held;

  if (h->steps == 0) return;
  MpmResultSay(result, "bound of the step: at least %.4g{least} of dt (%s{limited_by})", h->share,
               pace->why_not ? MpmPaceLimitName(pace) : MpmStepBoundNames[run->scene->step_bound]);
  if (pace->why_not) MpmResultSay(result, ", the limit of particles at rest in a lattice; %s{no_bound}", pace->why_not);
  MpmPrint("\n");
  Under(result, pace->why_not ? "limit" : "bound", h);
  if (h->above > 0)
    MpmResultSay(result, "  %-10s step %" PetscInt64_FMT "{first_above} was the first\n", "above it",
                 (PetscInt64)h->above);
  if (!pace->why_not) Decided(MpmResultIn(result, "decided"), run, h, "least");
  MpmPrint("\n");
}

static void Scene(json_t *result, const MpmRun *run)
{
  const MpmScene *s = run->scene;

  MpmPrint("initial data: %s", MpmInitialNames[s->initial]);
  for (PetscInt a = 0; a < s->layout.dim && s->initial == MPM_INITIAL_MODE; a++)
    MpmPrint("%s%" PetscInt_FMT, a ? "," : " ", s->mode[a]);
  if (s->initial == MPM_INITIAL_MODE && MpmSceneHasPoisson(s))
    MpmPrint(", polarisation %s", MpmPolarisationNames[s->polarisation]);
  if (s->initial == MPM_INITIAL_EIGENMODE) MpmPrint(" %" PetscInt_FMT " of %s", s->mode[0], run->request->mode_file);
  MpmResultSay(result, ", amplitude %.6g%s; %" PetscInt64_FMT "{steps} steps", s->amplitude,
               s->stagger ? ", staggered" : "", run->steps);
  if (!run->pace) MpmPrint(" of dt = %.6g", s->dt);
  MpmResultSay(result, " to time %.6g{time}\n\n", run->time);
  if (run->pace) Pace(MpmResultIn(result, "courant_auto"), run);
  if (run->watch) Watch(MpmResultIn(result, "step_watch"), run);
}

static void Prediction(json_t *result, const char key[], const char name[], PetscReal growth, const char formula[])
{
  MpmReportGrowth(result, key, name, growth, isnan(growth) ? "the formula does not cover this scene" : formula);
}

/* A motion that is not about a uniform state has no rate, however many steps it takes. */
static PetscBool HasGrowth(const MpmRun *run)
{
  return !run->scene->scheme.space.finite || run->scene->initial == MPM_INITIAL_RANDOM ? PETSC_TRUE : PETSC_FALSE;
}

static void Growth(json_t *result, const MpmRun *run)
{
  const MpmScene  *s         = run->scene;
  const MpmGrowth *growth    = &run->growth;
  json_t          *predicted = MpmResultIn(result, "predicted");

  MpmPrint("growth per step\n");
  Prediction(predicted, "published", "published", run->predictions.published, s->scheme.formulation->published_text);
  Prediction(predicted, "corrected", "corrected", run->predictions.corrected, MpmPredictionText(&s->scheme));
  if (s->initial == MPM_INITIAL_MODE)
    Prediction(predicted, "corrected_mode", "  this mode", run->predictions.corrected_mode,
               "corrected, at beta = 2 pi mode / cells");
  if (s->initial == MPM_INITIAL_EIGENMODE)
    MpmReportGrowth(predicted, "eigenmode", "  this mode", run->eigenmode, "abs of its eigenvalue");
  if (!growth->measured) {
    MpmPrint("  %-11s %-13s %s\n\n", "measured", "-",
             HasGrowth(run) ? "too few steps, or nothing left to measure"
                            : "a motion at finite deformation has no growth");
    return;
  }
  MpmResultSay(result, "  %-11s %-13.9g{growth} %s{run.growth_kind}, steps %" PetscInt64_FMT " to %" PetscInt64_FMT,
               "measured", growth->per_step, MpmGrowthKindNames[growth->kind], growth->from, growth->to);
  MpmResultKeep(result, "%g{run.growth_measured} %g{run.growth_error}", growth->per_step, growth->error);
  if (growth->kind == MPM_EXPONENTIAL && isfinite(growth->error)) MpmPrint(", standard error %.1e", growth->error);
  MpmPrint("\n\n");
}

static void Errors(json_t *result, const MpmRun *run)
{
  const char    *name[MPM_MOST_ERRORS];
  const PetscInt n = run->has_errors ? MpmSceneErrorFields(run->scene, name) : 0;

  if (run->has_errors) {
    MpmPrint("error against the exact solution of %s\n  %-5s  %11s  %11s  %11s   relative to its amplitude\n",
             MpmSceneEquations(run->scene), "field", "l1", "l2", "linf");
    for (PetscInt f = 0; f < n; f++) {
      const MpmError *e = &run->error[f];

      MpmPrint("  %-5s", name[f]);
      PrintNumber(e->l1);
      PrintNumber(e->l2);
      PrintNumber(e->linf);
      MpmPrint("\n");
      MpmResultKeep(MpmResultIn(MpmResultIn(result, "error"), name[f]), "%g{l1} %g{l2} %g{linf}", e->l1, e->l2,
                    e->linf);
    }
  } else
    MpmPrint("error: none, these data have no exact solution\n");
  MpmResultKeep(MpmResultIn(result, "energy"), "%g{initial} %g{final}", run->energy_initial, run->energy_final);
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
    MpmResultSay(MpmResultIn(result, "relaxed"),
                 "relaxed: %" PetscInt64_FMT "{steps} steps, their increments times %.9g{least_factor} or more\n",
                 run->relaxed, run->least_factor);
  if (run->blew_up_at_step != MPM_NEVER)
    MpmResultSay(result,
                 "the state left the range of double precision by step %" PetscInt64_FMT "{blew_up_at_step}%s\n",
                 run->blew_up_at_step, run->lost ? "; the run stopped there" : "; it was followed by rescaling");
}

static void Conserved(json_t *result, const MpmRun *run)
{
  MpmPrint("conserved: %" PetscInt64_FMT " particles", run->scene->layout.particles);
  if (!isnan(run->mass_change)) MpmResultSay(result, ", mass to %.1e{mass_change}", run->mass_change);
  if (!isnan(run->momentum_change))
    MpmResultSay(result, ", momentum to %.1e{momentum_change} of its size", run->momentum_change);
  MpmPrint("\n");
}

/* What the march took: load, iterations of the solver, and what JSON alone has. */
static void Cost(json_t *result, const MpmRun *run)
{
  const PetscReal steps = (PetscReal)(run->steps - run->from);

  if (run->from) MpmResultKeep(result, "%" PetscInt64_FMT "{restarted_at_step}", run->from);
  MpmResultKeep(result, "%g{loop_s} %g{bytes_per_particle_step} %g{load}", run->loop_s, run->bytes, run->load);
  if (run->load > MPM_BALANCE_BOUND)
    MpmPrint("load: the fullest rank had %.2f times the mean number of particles%s\n", run->load,
             run->scene->layout.balance == MPM_BALANCE_PARTICLES ? "" : "; see -balance");
  if (!run->scene->scheme.table->nstiff || steps == 0) return;
  MpmResultSay(result, "solver: %.3g{iterations_per_step} iterations a step", (PetscReal)run->iterations / steps);
  if (run->scene->scheme.space.finite)
    MpmResultSay(result, " in %.3g{newton_per_step} of Newton's method", (PetscReal)run->newton / steps);
  MpmPrint("\n");
  if (run->halved)
    MpmResultSay(MpmResultIn(result, "halved"),
                 "halved: %" PetscInt64_FMT "{steps} steps, taken in up to %" PetscInt64_FMT "{parts} parts\n",
                 run->halved, run->parts);
}

/* A diagnostic of one field; '-' stands where there was nothing to divide by. */
static void PrintField(const char name[], const char when[], PetscReal value)
{
  if (isnan(value))
    MpmPrint("  %s %s -", name, when);
  else
    MpmPrint("  %s %s %.4e", name, when, value);
}

static void Transfer(json_t *result, const MpmRun *run)
{
  const MpmTransferDiagnosticsSample *first = &run->transfer_first, *last = &run->transfer_last,
                                     *most = &run->transfer_most;
  const MpmTable *table                    = run->scene->scheme.table;

  if (run->request->weights)
    MpmResultSay(MpmResultIn(result, "weights"), "weights: C1 from %.6g{c1_min} to %.6g{c1_max}, C2 = 1 - C1\n",
                 most->c1_min, most->c1_max);
  if (run->request->source_term) {
    MpmPrint("source term, relative to the nodes' field:");
    for (PetscInt f = 0; table->fields[f]; f++) {
      PrintField(table->fields[f], "up to", most->source[f]);
      MpmResultKeep(MpmResultIn(MpmResultIn(result, "source_term"), table->fields[f]), "%g{last} %g{largest}",
                    last->source[f], most->source[f]);
    }
    MpmPrint("\n");
  }
  if (run->request->ringing) {
    MpmPrint("ringing content, share of particle data in the null space of P2G:");
    for (PetscInt f = 0; table->fields[f]; f++) {
      PrintField(table->fields[f], "first", first->ringing[f]);
      PrintField("", "last", last->ringing[f]);
      MpmResultKeep(MpmResultIn(MpmResultIn(result, "ringing"), table->fields[f]), "%g{first} %g{last} %g{largest}",
                    first->ringing[f], last->ringing[f], most->ringing[f]);
    }
    MpmPrint("\n");
  }
}

static void Verdict(json_t *result, const MpmRun *run)
{
  const MpmGrowth *growth = &run->growth;

  MpmResultSay(result, "\nverdict: %s{verdict}", MpmVerdictNames[run->verdict]);
  if (run->lost)
    MpmResultSay(result,
                 ", the state leaves the range of double precision from one sample to the next: growth above "
                 "%.1e{run.growth_above} per step\n",
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
    if (run->scene->scheme.table->nstiff) MpmResultSay(result, " (%.3g{run.solver_s} s in the solver)", run->solve_s);
    MpmResultSay(result, ", %.3g{run.ns_per_particle_step} ns per particle and step, %.3g s in all\n",
                 1e9 * run->loop_s / ((PetscReal)(run->steps - run->from) * (PetscReal)run->scene->layout.particles),
                 run->wall_s);
  } else
    MpmPrint("time: %.3g s in all\n", run->wall_s);
}

static PetscErrorCode Report(const MpmRun *run)
{
  json_t *result, *found;

  PetscFunctionBegin;
  PetscCall(MpmResultOfScene(run->scene, run->request, &result));
  found = MpmResultIn(result, "run");
  Scene(found, run);
  Growth(result, run);
  Errors(found, run);
  Conserved(found, run);
  Cost(found, run);
  Transfer(found, run);
  Tangents(found, run->tangents);
  Verdict(result, run);
  PetscCall(MpmResultEnd(run->request, run->wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskRun(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmRun *run;

  PetscFunctionBegin;
  PetscCall(MpmRunFilesCreate(scene, request, started, &run));
  *missed = 0;
  if (run->failure[0]) {
    MpmPrintFailure(run->failure);
    *missed = MPM_WORK_FAILED;
  } else if (run->stopped) {
    MpmPrint("stopped at step %" PetscInt64_FMT, run->steps);
    if (request->end > 0)
      MpmPrint(", at time %.6g of %.6g", run->time, request->end);
    else
      MpmPrint(" of %" PetscInt64_FMT, request->steps);
    MpmPrint("; to go on: the same command with -restart %s\n", request->checkpoint);
  } else {
    PetscCall(Report(run));
    PetscCall(MpmExpectRun(run, missed));
  }
  PetscCall(MpmRunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}
