/* Completion in a shell: tasks, options of the task, words of an option, files. */
#include "scene/fields.h"
#include "task/task.h"
#include <string.h>

static PetscBool TakesFile(const MpmField *o)
{
  return o->kind == MPM_PATH ? PETSC_TRUE : PETSC_FALSE;
}

static void PrintWords(const MpmField *o)
{
  for (PetscInt i = 0; MpmFieldWord(o, i); i++) MpmPrint("%s%s", i ? " " : "", MpmFieldWord(o, i));
}

static void PrintBash(void)
{
  MpmPrint("# bash completion for mpmstab; made by 'mpmstab list completion-bash'\n"
           "_mpmstab() {\n"
           "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} task=${COMP_WORDS[1]} options\n"
           "  COMPREPLY=()\n"
           "  if [ \"$COMP_CWORD\" -eq 1 ]; then COMPREPLY=($(compgen -W '");
  for (const MpmTask *task = MpmTasks; task->name; task++) MpmPrint("%s ", task->name);
  MpmPrint("help version' -- \"$cur\")); return; fi\n"
           "  case $prev in\n");
  for (const MpmField *o = MpmOptions; o->name; o++) {
    if (TakesFile(o)) MpmPrint("    -%s) COMPREPLY=($(compgen -f -- \"$cur\")); return ;;\n", o->name);
    if (!MpmFieldWord(o, 0)) continue;
    MpmPrint("    -%s) COMPREPLY=($(compgen -W '", o->name);
    PrintWords(o);
    MpmPrint("' -- \"$cur\")); return ;;\n");
  }
  MpmPrint("  esac\n"
           "  case $task in\n");
  for (const MpmTask *task = MpmTasks; task->name; task++) {
    MpmPrint("    %s) options='", task->name);
    for (const MpmField *o = MpmOptions; o->name; o++)
      if (!task->words && MpmFieldIsOf(o, task->name)) MpmPrint("-%s ", o->name);
    MpmPrint("' ;;\n");
  }
  MpmPrint("  esac\n"
           "  case $cur in\n"
           "    -*) COMPREPLY=($(compgen -W \"$options\" -- \"$cur\")) ;;\n"
           "    *) COMPREPLY=($(compgen -f -X '!*.y*ml' -- \"$cur\") $(compgen -d -- \"$cur\")) ;;\n"
           "  esac\n"
           "}\n"
           "complete -o filenames -F _mpmstab mpmstab\n");
}

/* In a pair of single quotes, inside brackets of _arguments. */
static void PrintHelpOf(const MpmField *o)
{
  for (const char *c = o->help; *c; c++) {
    if (*c == '\'')
      MpmPrint("'\\''");
    else
      MpmPrint(strchr("[]:", *c) ? "\\%c" : "%c", *c);
  }
}

static void PrintZsh(void)
{
  MpmPrint("#compdef mpmstab\n# made by 'mpmstab list completion-zsh'\n_arguments \\\n  '1:task:(");
  for (const MpmTask *task = MpmTasks; task->name; task++) MpmPrint("%s ", task->name);
  MpmPrint("help version)' \\\n");
  for (const MpmField *o = MpmOptions; o->name; o++) {
    MpmPrint("  '-%s[", o->name);
    PrintHelpOf(o);
    MpmPrint("]");
    if (TakesFile(o)) MpmPrint(":file:_files");
    if (MpmFieldWord(o, 0)) {
      MpmPrint(":word:(");
      PrintWords(o);
      MpmPrint(")");
    } else if (!TakesFile(o) && o->kind != MPM_SWITCH)
      MpmPrint(":value: ");
    MpmPrint("' \\\n");
  }
  MpmPrint("  '*:scene:_files -g \"*.y(a|)ml\"'\n");
}

void MpmPrintCompletion(PetscBool zsh)
{
  if (zsh)
    PrintZsh();
  else
    PrintBash();
}
