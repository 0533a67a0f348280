/* The table of fields: each field does what its entry says. */
#include "check.h"
#include "scene/fields.h"
#include "scene/settings.h"
#include "task/task.h"

/* For every field of a checkpoint, an option whose value is not the default. */
static const char *const other[][2] = {
    {"formulation", "-formulation musl"},
    {"scheme", "-scheme test_fields_scheme.yaml"},
    {"parameters", "-scheme test_fields_scheme.yaml -factor 2"},
    {"basis", "-basis quadratic"},
    {"transfer", "-transfer pic"},
    {"xpic_order", "-transfer xpic -xpic_order 3"},
    {"blend_ratio", "-transfer blend -blend_ratio 0.5"},
    {"spline_ends", "-basis quadratic -boundary fixed -spline_ends open"},
    {"aflip_ratio", "-formulation usl -transfer aflip -aflip_ratio 0.5"},
    {"pic_filter", "-formulation elastic -transfer pic -pic_filter before"},
    {"boundary", "-boundary fixed,free"},
    {"share", "-formulation verlet -share 0.75"},
    {"rk", "-formulation rk -rk kg5"},
    {"theta", "-formulation implicit -theta 0.75"},
    {"rk_on", "-formulation rk -rk_on nodes"},
    {"rk_places", "-formulation rk -kinematics finite -rk_places stages"},
    {"rk_relax", "-formulation rk -kinematics finite -rk_relax"},
    {"move_share", "-formulation verlet -kinematics finite -move_share 0.75"},
    {"cells", "-cells 9"},
    {"dim", "-dim 2"},
    {"gradient", "-gradient mls"},
    {"poisson", "-dim 2 -poisson 0.2"},
    {"counts", "-counts 1,2"},
    {"offset", "-offset 1/4"},
    {"jitter", "-jitter 0.25"},
    {"seed", "-initial random -seed 2"},
    {"cluster", "-cluster 0,0.5"},
    {"first", "-fill 2,8"},
    {"particles", "-fill 0,4"},
    {"material", "-material graded"},
    {"stretch", "-material svk -stretch 2"},
    {"lame_ratio", "-material neo -stretch 2 -lame_ratio 1"},
    {"exponent", "-material tait -stretch 2 -exponent 5"},
    {"yield", "-kinematics finite -material mises -yield 0.01"},
    {"hardening", "-kinematics finite -material mises -hardening 0.01"},
    {"saturation", "-kinematics finite -material mises -saturation 0.01"},
    {"saturation_rate", "-kinematics finite -material mises -saturation_rate 5"},
    {"compression_limit", "-kinematics finite -material snow -compression_limit 0.01"},
    {"stretch_limit", "-kinematics finite -material snow -stretch_limit 0.01"},
    {"friction_angle", "-kinematics finite -material sand -friction_angle 30"},
    {"consistency", "-kinematics finite -material herschel_bulkley -shear_viscosity 1 -consistency 0.01"},
    {"flow_index", "-kinematics finite -material herschel_bulkley -shear_viscosity 1 -flow_index 0.5"},
    {"prestress", "-prestress 0.25"},
    {"move", "-formulation musl -basis cubic -prestress 0.25 -move projected"},
    {"kinematics", "-kinematics finite"},
    {"shape", "-kinematics finite -dim 2 -shape discs"},
    {"gravity", "-kinematics finite -gravity 0.5"},
    {"grid_damping", "-grid_damping 0.5"},
    {"local_damping", "-local_damping 0.5"},
    {"viscosity", "-viscosity 0.5"},
    {"bulk_viscosity", "-bulk_viscosity 0.5"},
    {"shear_viscosity", "-shear_viscosity 0.5"},
    {"artificial_linear", "-kinematics finite -artificial_linear 0.2"},
    {"artificial_quadratic", "-kinematics finite -artificial_quadratic 2"},
    {"density_ratio", "-material two -density_ratio 2"},
    {"stiffness_ratio", "-material two -stiffness_ratio 2"},
    {"inclusion", "-material two -inclusion 1,2"},
    {"length", "-cell_width 0.25"},
    {"wave_speed", "-young 4 -density 1"},
    {"courant", "-courant 0.25"},
    {"safety", "-kinematics finite -courant auto"},
    {"step_bound", "-kinematics finite -courant auto -step_bound lone"},
    {"drift", "-drift 1/7"},
    {"initial", "-initial pulse"},
    {"mode", "-mode 2"},
    {"polarisation", "-dim 2 -polarisation s"},
    {"amplitude", "-amplitude 2"},
    {"stagger", "-stagger"},
    {"balance", "-balance cells"},
    {"ranks", "-ranks 1"},
    {"layout", "-layout random"},
    {"bodies", "-formulation usl -kinematics finite -bodies {\"shape\":box,\"center\":0.5,\"size\":0.5}"},
    {"colliders", "-formulation usl -colliders {\"shape\":plane,\"point\":0.5,\"normal\":1,\"contact\":slip}"},
};

/* Finds the text of a field in the checkpoint of a scene; it is empty when there is none. */
static PetscErrorCode KeyText(const MpmScene *scene, const char name[], size_t room, char text[])
{
  MpmValue values[MPM_MAX_VALUES];
  PetscInt n;

  PetscFunctionBegin;
  text[0] = '\0';
  PetscCall(MpmValuesIn(MPM_IN_CHECKPOINT, scene, NULL, &n, values));
  for (PetscInt i = 0; i < n; i++)
    if (!strcmp(values[i].field->name, name)) PetscCall(MpmValueText(&values[i], room, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks that a field by which checkpoints are compared has another text in a scene where it has another value. */
static PetscErrorCode CheckCheckpoint(const MpmField *field)
{
  const char *options = NULL;
  char        text[2][MPM_COUNTS_TEXT], all[256];
  MpmScene   *scene;

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(other); i++)
    if (!strcmp(other[i][0], field->name)) options = other[i][1];
  CHECK(options, "%s: no other value in this test", field->name);
  if (!options) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckScene("-cells 8 -formulation usl", &scene));
  PetscCall(KeyText(scene, field->name, sizeof text[0], text[0]));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(PetscSNPrintf(all, sizeof all, "%s%s %s", strstr(options, "-cells") ? "" : "-cells 8 ",
                          strstr(options, "-formulation") || strstr(options, "-scheme") ? "" : "-formulation usl",
                          options));
  PetscCall(CheckScene(all, &scene));
  PetscCall(KeyText(scene, field->name, sizeof text[1], text[1]));
  CHECK(text[1][0] && strcmp(text[0], text[1]), "%s: '%s' and '%s'", field->name, text[0], text[1]);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Quietly(const char task[], const char options[], MpmScene **scene, MpmRequest *request,
                              PetscErrorCode *error)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscOptionsInsertString(NULL, options));
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  *error = MpmSceneCreate(task, NULL, scene, request);
  PetscCall(PetscPopErrorHandler());
  PetscCall(PetscOptionsClear(NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that some task reads an option: it refuses a value that makes no sense, or its request has the file name
   given.
*/
static PetscErrorCode CheckRead(const MpmField *field)
{
  const PetscBool path = field->kind == MPM_PATH ? PETSC_TRUE : PETSC_FALSE;
  PetscBool       read = PETSC_FALSE, known = PETSC_FALSE;

  PetscFunctionBegin;
  for (const MpmTask *task = MpmTasks; task->name; task++) {
    static MpmRequest request;
    MpmScene         *scene;
    char              options[128];
    PetscErrorCode    error = PETSC_SUCCESS;

    if (!strcmp(task->name, "list") || (field->tasks && !strstr(field->tasks, task->name))) continue;
    known = PETSC_TRUE;
    PetscCall(PetscSNPrintf(options, sizeof options, "-%s %s", field->name, path ? "named_by_a_test" : "nonsense"));
    PetscCall(Quietly(task->name, options, &scene, &request, &error));
    CHECK(!error || error == PETSC_ERR_USER_INPUT, "%s: error %d", options, (int)error);
    if (error || !strcmp(request.output, "named_by_a_test") || !strcmp(request.json, "named_by_a_test") ||
        !strcmp(request.csv, "named_by_a_test") || !strcmp(request.checkpoint, "named_by_a_test") ||
        !strcmp(request.restart, "named_by_a_test") || !strcmp(request.matrix, "named_by_a_test") ||
        !strcmp(request.matrix_blocks, "named_by_a_test") || !strcmp(request.program, "named_by_a_test") ||
        !strcmp(request.plugin, "named_by_a_test"))
      read = PETSC_TRUE;
    if (!error) PetscCall(MpmSceneDestroy(&scene));
  }
  CHECK(known, "%s: no such task: %s", field->name, field->tasks);
  CHECK(read, "%s: nothing reads it", field->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that the places of fields in each record are different, and that only the record of files has fields of the
   request, and JSON the names of its files.
*/
static PetscErrorCode CheckPlaces(void)
{
  const MpmField *const tables[] = {MpmOptions, MpmDerived};

  PetscFunctionBegin;
  for (int record = 0; record < MPM_RECORDS; record++) {
    int taken[MPM_MAX_VALUES + 1] = {0};

    for (int t = 0; t < 2; t++) {
      for (const MpmField *f = tables[t]; f->name; f++) {
        const int place = f->place[record];

        if (!place) continue;
        CHECK(place <= MPM_MAX_VALUES && f->value != MPM_NO_VALUE, "%s: place %d in record %d", f->name, place, record);
        CHECK(!taken[place]++, "%s: place %d in record %d is another's", f->name, place, record);
        CHECK(f->owner == MPM_OF_SCENE || record == MPM_IN_FILE ||
                  (record == MPM_IN_JSON && f->value == MPM_AS_TEXT && f->kind == MPM_PATH),
              "%s of a request in record %d", f->name, record);
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that a drift which was written as a number agrees with the fraction that it is now, and that no other text
   does.
*/
static PetscErrorCode CheckAgrees(void)
{
  static const char *const texts[] = {"1/8", "0.125", "0.12500000000000003", "2/8"};
  MpmScene                *scene;
  MpmValue                 value;
  PetscBool                agrees;

  PetscFunctionBegin;
  PetscCall(CheckScene("-cells 8 -velocity 0.25", &scene));
  PetscCall(MpmValueOf("drift", scene, NULL, &value));
  CHECK(scene->step.drift[0].num == 1 && scene->step.drift[0].den == 8, "drift %g", scene->step.drift[0].value);
  for (int i = 0; i < 4; i++) {
    PetscCall(MpmValueAgrees(&value, texts[i], &agrees));
    CHECK(agrees == (i < 2), "1/8 and %s", texts[i]);
  }
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks a scene from text: it equals the one from the same options, it leaves the command line alone, and it tells
   what is wrong.
*/
static PetscErrorCode CheckText(void)
{
  MpmScene      *scene = NULL;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscOptionsInsertString(NULL, "-cells 12"));
  PetscCall(MpmSceneFromText("{formulation: usl, cells: 16, drift: 1/8, steps: 7, boundary: periodic}", &scene));
  PetscCall(PetscOptionsClear(NULL));
  CHECK(scene->layout.grid[0].cells == 16 && scene->step.drift[0].den == 8 &&
            !strcmp(scene->scheme.formulation->name, "usl"),
        "not what was said");
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  error = MpmSceneFromText("cells: 0\n", &scene);
  PetscCall(PetscPopErrorHandler());
  CHECK(error == PETSC_ERR_USER_INPUT && !scene, "error %d", (int)error);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A scheme as text, for the fields that only scenes with one have. */
static PetscErrorCode WriteScheme(void)
{
  FILE *file = fopen("test_fields_scheme.yaml", "w");

  PetscFunctionBegin;
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "test_fields_scheme.yaml");
  fprintf(file, "name: fields\nparticles: {v: vector}\nnodes: {v_i: vector}\nparameters: {factor: 1}\n"
                "step:\n- v_i = P2G v\n- v = factor G2P v_i\n- DRIFT\n");
  PetscCheck(!fclose(file), PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "test_fields_scheme.yaml");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(WriteScheme());
  for (const MpmField *f = MpmOptions; f->name; f++) {
    PetscCall(CheckRead(f));
    if (f->place[MPM_IN_CHECKPOINT]) PetscCall(CheckCheckpoint(f));
  }
  for (const MpmField *f = MpmDerived; f->name; f++) {
    CHECK(MpmOptionIndex(f->name) == MPM_NOT_AN_OPTION, "%s is an option and is derived", f->name);
    if (f->place[MPM_IN_CHECKPOINT]) PetscCall(CheckCheckpoint(f));
  }
  PetscCall(CheckPlaces());
  PetscCall(CheckAgrees());
  PetscCall(CheckText());
  PetscCheck(!remove("test_fields_scheme.yaml"), PETSC_COMM_SELF, PETSC_ERR_FILE_WRITE, "test_fields_scheme.yaml");
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
