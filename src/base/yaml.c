/* Reads YAML files and texts, and says where one is not YAML. */
#include "base/yaml.h"
#include <mpmstab/errors.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LARGEST (1 << 14) /* bytes; libyaml's time goes with the square of the brackets that stay open */
#define PATIENCE 2000     /* ms for someone to open the other end of a pipe */

static PetscBool IsSameFile(int file, int other)
{
  struct stat a, b;

  return !fstat(file, &a) && !fstat(other, &b) && a.st_ino == b.st_ino && a.st_dev == b.st_dev ? PETSC_TRUE
                                                                                               : PETSC_FALSE;
}

/*
   Whether a file is the pipe or terminal that takes this program's report or messages, and nothing else: nothing would
   ever come from it.
*/
static PetscBool IsOwnOutput(int file)
{
  struct stat is;

  if (fstat(file, &is) || !(S_ISFIFO(is.st_mode) || isatty(file)) || IsSameFile(file, STDIN_FILENO)) return PETSC_FALSE;
  return IsSameFile(file, STDOUT_FILENO) || IsSameFile(file, STDERR_FILENO) ? PETSC_TRUE : PETSC_FALSE;
}

/*
   To open a pipe waits for the program that writes it. This function finds the pipe empty when no such program comes.
*/
static FILE *Open(const char path[])
{
  struct pollfd file = {.fd = open(path, O_RDONLY | O_NONBLOCK), .events = POLLIN};

  if (file.fd < 0) return NULL;
  if (IsOwnOutput(file.fd)) {
    (void)close(file.fd);
    errno = EDEADLK;
    return NULL;
  }
  (void)poll(&file, 1, PATIENCE);
  if (fcntl(file.fd, F_SETFL, 0)) {
    (void)close(file.fd);
    return NULL;
  }
  return fdopen(file.fd, "rb");
}

/* Rank 0 reads and every rank gets the same bytes, so that all of them refuse the same thing. */
static PetscErrorCode ReadBytes(const char what[], const char path[], char bytes[], PetscInt *size)
{
  int answer[2] = {0, 0}; /* size, errno */

  PetscFunctionBegin;
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) {
    FILE *file = Open(path);

    if (file) {
      answer[0] = (int)fread(bytes, 1, LARGEST + 1, file);
      if (ferror(file)) answer[1] = errno ? errno : EIO;
      fclose(file);
    } else
      answer[1] = errno;
  }
  PetscCallMPI(MPI_Bcast(answer, 2, MPI_INT, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!answer[1], "%s %s: %s; allowed: a YAML file", what, path, strerror(answer[1]));
  MpmCheckInput(answer[0] <= LARGEST, "%s %s: larger than 16 KiB; allowed: a YAML file of options", what, path);
  *size = answer[0];
  PetscCallMPI(MPI_Bcast(bytes, *size, MPI_CHAR, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The line and column of an error. Of a byte that is no character libyaml tells the offset, but not the line.
*/
static void FindProblem(const yaml_parser_t *parser, int *line, int *column)
{
  const unsigned char *text = parser->input.string.start;

  *line   = (int)parser->problem_mark.line + 1;
  *column = (int)parser->problem_mark.column + 1;
  if (parser->error != YAML_READER_ERROR) return;
  *line = *column = 1;
  for (size_t i = 0; i < parser->problem_offset && text + i < parser->input.string.end; i++) {
    ++*column;
    if (text[i] != '\n') continue;
    ++*line;
    *column = 1;
  }
}

static PetscErrorCode ReadDocument(const char what[], const char name[], yaml_parser_t *parser, MpmYamlUse use,
                                   void *context)
{
  yaml_document_t    document;
  const yaml_node_t *root;
  PetscErrorCode     ierr = PETSC_SUCCESS;
  PetscBool          more;
  int                line, column;

  PetscFunctionBegin;
  if (!yaml_parser_load(parser, &document)) {
    FindProblem(parser, &line, &column);
    MpmRefuse("%s:%d: not YAML: %s, in column %d; allowed: lines of the form key: value", name, line,
              parser->problem ? parser->problem : "unreadable", column);
  }
  root = yaml_document_get_root_node(&document);
  more = root && root->type == YAML_MAPPING_NODE ? PETSC_TRUE : PETSC_FALSE;
  if (more) ierr = use(context, &document, root);
  yaml_document_delete(&document);
  PetscCall(ierr);
  MpmCheckInput(more, "%s %s: allowed: lines of the form key: value", what, name);
  more = !yaml_parser_load(parser, &document) || yaml_document_get_root_node(&document) ? PETSC_TRUE : PETSC_FALSE;
  yaml_document_delete(&document);
  MpmCheckInput(!more, "%s %s: something follows the %s; allowed: one YAML document", what, name, what);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadYaml(const char what[], const char name[], const char yaml[], size_t size, MpmYamlUse use,
                               void *context)
{
  yaml_parser_t  parser;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCheck(yaml_parser_initialize(&parser), PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for the YAML parser");
  yaml_parser_set_input_string(&parser, (const unsigned char *)yaml, size);
  ierr = ReadDocument(what, name, &parser, use, context);
  yaml_parser_delete(&parser);
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmYamlReadFile(const char what[], const char path[], MpmYamlUse use, void *context)
{
  char          *bytes;
  PetscInt       size = 0;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(LARGEST + 1, &bytes));
  ierr = ReadBytes(what, path, bytes, &size);
  if (!ierr) ierr = ReadYaml(what, path, bytes, (size_t)size, use, context);
  PetscCall(PetscFree(bytes));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmYamlReadText(const char what[], const char name[], const char yaml[], MpmYamlUse use, void *context)
{
  PetscFunctionBegin;
  MpmCheckInput(strlen(yaml) <= LARGEST, "%s text: larger than 16 KiB; allowed: YAML of options", what);
  PetscCall(ReadYaml(what, name, yaml, strlen(yaml), use, context));
  PetscFunctionReturn(PETSC_SUCCESS);
}
