/* A scheme as a string: prints its critical Courant number, and its growth at the scene's own. */
#include <mpmstab/mpmstab.h>

static const char text[] = "courant: 0.5\n"
                           "scheme:\n"
                           "  name: musl-ahead\n"
                           "  particles: {v: vector, s: stress}\n"
                           "  nodes: {v_i: vector, a_i: vector, w_i: vector}\n"
                           "  parameters: {mix: -1/2}\n"
                           "  step:\n"
                           "    - v_i = P2G v\n"
                           "    - a_i = -k DIV s\n"
                           "    - v += G2P a_i\n"
                           "    - w_i = P2G v\n"
                           "    - w_i = (1 - mix) w_i + mix v_i\n"
                           "    - s += k STRESS GRAD w_i\n"
                           "    - DRIFT\n";

static PetscErrorCode PrintLimitAndGrowth(void)
{
  const MpmSymbolWish wish = {.phases = {256}, .tolerance = 1e-6};
  MpmScene           *scene;
  MpmCriticalCase     of;
  MpmCritical         limit;
  MpmSymbol          *symbol;

  PetscFunctionBeginUser;
  PetscCall(MpmSceneFromText(text, &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &limit));
  MpmPrint("critical Courant number %.6g\n", (double)limit.courant);
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &wish, &symbol));
  MpmPrint("largest of %d amplification factors at each of 256 phases: %.6g\n", (int)symbol->size,
           (double)symbol->growth);
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  if (MpmInitialize(&argc, &argv)) return MPM_EXIT_REFUSED;
  return MpmFinalize(PrintLimitAndGrowth(), MPM_EXIT_DONE);
}
