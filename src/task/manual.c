/* The man page, from the lists of tasks and options. Source of the macros: man(7). */
#include "scene/fields.h"
#include "task/task.h"
#include <string.h>

/* Text as roff takes it: a backslash begins an escape, a dash is a minus, and a dot or a quote begins a request. */
static void Put(const char text[])
{
  if (text[0] == '.' || text[0] == '\'') MpmPrint("\\&");
  for (const char *c = text; *c; c++) {
    if (*c == '\\')
      MpmPrint("\\e");
    else if (*c == '-')
      MpmPrint("\\-");
    else
      MpmPrint("%c", *c);
  }
}

static void PutOption(const MpmField *o)
{
  MpmPrint(".TP\n\\fB\\-%s\\fR", o->name);
  if (o->kind != MPM_SWITCH) MpmPrint(" \\fIvalue\\fR");
  if (o->fallback) {
    MpmPrint(" (default ");
    Put(o->fallback);
    MpmPrint(")");
  }
  MpmPrint("\n");
  Put(o->help);
  if (o->tasks) MpmPrint(". Tasks: %s", o->tasks);
  MpmPrint(".\n");
  if (!MpmFieldWord(o, 0)) return;
  MpmPrint("Words:");
  for (PetscInt i = 0; MpmFieldWord(o, i); i++) {
    MpmPrint(i ? ", " : " ");
    Put(MpmFieldWord(o, i));
  }
  MpmPrint(".\n");
}

void MpmPrintManual(void)
{
  MpmPrint(
      ".TH MPMSTAB 1 \"\" \"mpmstab %s\" \"User commands\"\n"
      ".SH NAME\nmpmstab \\- stability and accuracy of the material point method\n"
      ".SH SYNOPSIS\n[\\fBmpirun \\-n\\fR \\fIranks\\fR] \\fBmpmstab\\fR \\fItask\\fR [\\fIscene.yaml\\fR] "
      "[\\fB\\-option\\fR \\fIvalue\\fR]...\n"
      ".SH DESCRIPTION\nmpmstab answers whether a scheme of the material point method is stable, for which time "
      "step, how accurate it is, and why.\nA scene is a file of options, one \\fIkey: value\\fR a line; options of "
      "the command line take the place of its own.\n"
      ".SH TASKS\n",
      MPMSTAB_VERSION);
  for (const MpmTask *task = MpmTasks; task->name; task++) {
    MpmPrint(".TP\n\\fB%s\\fR\n", task->name);
    Put(task->summary);
    MpmPrint(".\nExample: \\fBmpmstab ");
    Put(task->example);
    MpmPrint("\\fR\n");
  }
  MpmPrint(".SH OPTIONS\n");
  for (const MpmField *o = MpmOptions; o->name; o++) PutOption(o);
  MpmPrint(".SH EXIT STATUS\n"
           "0: done. 1: an error that is not the user's. 2: bad input; one line says which option or file, and what is "
           "allowed. 3: done, but something came out that the scene does not expect. 143: a signal ended the work.\n"
           ".SH MPI\nAs root, Open MPI's mpirun wants OMPI_ALLOW_RUN_AS_ROOT=1 and OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 in "
           "the environment; with more ranks than cores it wants \\-\\-oversubscribe.\n");
}
