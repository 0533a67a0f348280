/* Reads a scene: a YAML mapping of option names to values, and an 'expect' block. */
#include "scene/settings.h"
#include "base/suggest.h"
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <yaml.h>

#define LARGEST_SCENE (1 << 14) /* bytes; libyaml's time goes with the square of the brackets that stay open */
#define PATIENCE 2000           /* ms for someone to open the other end of a pipe */

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
static PetscErrorCode ReadBytes(const char path[], char bytes[], PetscInt *size)
{
  PetscMPIInt rank;
  int         answer[2] = {0, 0}; /* size, errno */

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) {
    FILE *file = Open(path);

    if (file) {
      answer[0] = (int)fread(bytes, 1, LARGEST_SCENE + 1, file);
      if (ferror(file)) answer[1] = errno ? errno : EIO;
      fclose(file);
    } else
      answer[1] = errno;
  }
  PetscCallMPI(MPI_Bcast(answer, 2, MPI_INT, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!answer[1], "scene %s: %s; allowed: a YAML file", path, strerror(answer[1]));
  MpmCheckInput(answer[0] <= LARGEST_SCENE, "scene %s: larger than 16 KiB; allowed: a YAML file of options", path);
  *size = answer[0];
  PetscCallMPI(MPI_Bcast(bytes, *size, MPI_CHAR, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int Line(const yaml_node_t *node)
{
  return (int)node->start_mark.line + 1;
}

/* The text of a scalar. NULL: the node is none, or has a zero byte inside, where a C string would end. */
static const char *Scalar(const yaml_node_t *node)
{
  const char *text = node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;

  return text && strlen(text) == node->data.scalar.length ? text : NULL;
}

static PetscErrorCode FindKey(const MpmSettings *settings, const char key[], int line, PetscInt *option)
{
  const char *names[MPM_MAX_OPTIONS], *near;
  PetscInt    n = 0;

  PetscFunctionBegin;
  *option = MpmOptionIndex(key);
  if (*option != MPM_NOT_AN_OPTION) PetscFunctionReturn(PETSC_SUCCESS);
  for (; MpmOptions[n].name; n++) names[n] = MpmOptions[n].name;
  near = MpmSuggest(key, n, names);
  if (near) MpmRefuse("%s:%d: unknown key '%s'; did you mean '%s'?", settings->scene, line, key, near);
  MpmRefuse("%s:%d: unknown key '%s'; 'mpmstab list options' shows those there are", settings->scene, line, key);
}

/* What a key's value may look like, for a message about a key without one. */
static const char *AllowedFor(const MpmField *option)
{
  switch (option->kind) {
  case MPM_INTEGER:
    return "a whole number";
  case MPM_REAL:
    return "a number";
  case MPM_FRACTION:
    return "a number or a fraction such as 1/8";
  case MPM_SWITCH:
    return "true or false";
  case MPM_PATH:
    return "the name of a file";
  case MPM_RANGE:
  case MPM_SPAN:
    return "two numbers [lo, hi]";
  case MPM_LIST:
    return "a list of whole numbers";
  case MPM_WORDS:
    return "one or more of its words";
  default:
    return "one of its words";
  }
}

static PetscErrorCode SetOnce(MpmSettings *settings, const char key[], PetscInt option, const char text[], int line)
{
  PetscFunctionBegin;
  MpmCheckInput(settings->source[option] == MPM_FROM_DEFAULT, "%s:%d: key '%s' is given a second time; allowed: once",
                settings->scene, line, key);
  MpmCheckInput(*text && strcmp(text, "~") && strcmp(text, "null"),
                "%s:%d: key '%s' has no value; allowed: %s, or no such line", settings->scene, line, key,
                AllowedFor(&MpmOptions[option]));
  PetscCall(MpmSettingsSet(settings, option, text, MPM_FROM_SCENE, line));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A value as text: that of a scalar, or 'a,b,c' for a sequence where the option takes two values or a list. */
static PetscErrorCode ValueText(MpmSettings *settings, yaml_document_t *document, PetscInt option,
                                const yaml_node_t *value, char text[], size_t size)
{
  const MpmOptionKind     kind = MpmOptions[option].kind;
  const char             *key = MpmOptions[option].name, *part = Scalar(value);
  const yaml_node_item_t *item = NULL, *end = NULL;
  PetscBool               first = PETSC_TRUE;
  const PetscBool         two   = kind == MPM_RANGE || kind == MPM_SPAN || kind == MPM_ENDS ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool         many =
      kind == MPM_LIST || kind == MPM_WORDS || MpmOptions[option].each || kind == MPM_ENDS ? PETSC_TRUE : PETSC_FALSE;
  size_t used = 0;

  PetscFunctionBegin;
  MpmCheckInput(value->type != YAML_MAPPING_NODE, "%s:%d: key '%s' holds a block; allowed: a value", settings->scene,
                Line(value), key);
  if (value->type == YAML_SEQUENCE_NODE) {
    item = value->data.sequence.items.start;
    end  = value->data.sequence.items.top;
    MpmCheckInput(many ? end > item : two && end - item == 2, "%s:%d: key '%s': allowed: one value%s", settings->scene,
                  Line(value), key,
                  many  ? ", or several [a, b, c]"
                  : two ? ", or two [lo, hi]"
                        : "");
  }
  text[0] = '\0';
  do {
    const yaml_node_t *one = item < end ? yaml_document_get_node(document, *item++) : value;

    part = Scalar(one);
    MpmCheckInput(one->type == YAML_SCALAR_NODE, "%s:%d: key '%s': allowed: numbers or words in a list",
                  settings->scene, Line(value), key);
    MpmCheckInput(part, "%s:%d: key '%s': a zero byte in its value; allowed: text", settings->scene, Line(value), key);
    MpmCheckInput(used + strlen(part) + 2 < size, "%s:%d: key '%s': its value is too long", settings->scene,
                  Line(value), key);
    PetscCall(PetscSNPrintf(text + used, size - used, "%s%s", first ? "" : ",", part));
    used  = strlen(text);
    first = PETSC_FALSE;
  } while (item < end);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadMapping(MpmSettings *settings, yaml_document_t *document, const yaml_node_t *mapping,
                                  PetscBool inside_expect);

/*
   Reads an 'expect' block. SetOnce refuses a key that is there twice; here a second block, or a verdict beside it, is.
*/
static PetscErrorCode ReadExpect(MpmSettings *settings, yaml_document_t *document, const yaml_node_t *mapping,
                                 const yaml_node_pair_t *pair)
{
  const yaml_node_t *mine = yaml_document_get_node(document, pair->value);

  PetscFunctionBegin;
  for (const yaml_node_pair_t *other = mapping->data.mapping.pairs.start; other < mapping->data.mapping.pairs.top;
       other++) {
    const char *key = Scalar(yaml_document_get_node(document, other->key));

    MpmCheckInput(other == pair || !key || strcmp(key, "expect"),
                  "%s:%d: key 'expect' is given a second time; allowed: once", settings->scene,
                  Line(yaml_document_get_node(document, PetscMax(pair, other)->key)));
  }
  MpmCheckInput(mine->data.mapping.pairs.top > mine->data.mapping.pairs.start,
                "%s:%d: key 'expect' has no value; allowed: a verdict, or a block of expectations", settings->scene,
                Line(mine));
  PetscCall(ReadMapping(settings, document, mine, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keys of the 'expect' block become expect_KEY; 'verdict' is the option expect itself. */
static PetscErrorCode ReadMapping(MpmSettings *settings, yaml_document_t *document, const yaml_node_t *mapping,
                                  PetscBool inside_expect)
{
  const yaml_node_pair_t *end = mapping->data.mapping.pairs.top;

  PetscFunctionBegin;
  for (const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start; pair < end; pair++) {
    const yaml_node_t *node  = yaml_document_get_node(document, pair->key);
    const yaml_node_t *value = yaml_document_get_node(document, pair->value);
    const char        *key   = Scalar(node);
    char               name[128], text[PETSC_MAX_PATH_LEN];
    PetscInt           option;

    MpmCheckInput(key && strlen(key) < 100, "%s:%d: allowed: lines of the form key: value", settings->scene,
                  Line(node));
    if (!inside_expect && !strcmp(key, "expect") && value->type == YAML_MAPPING_NODE) {
      PetscCall(ReadExpect(settings, document, mapping, pair));
      continue;
    }
    if (inside_expect && !strcmp(key, "verdict"))
      PetscCall(PetscStrncpy(name, "expect", sizeof name));
    else
      PetscCall(PetscSNPrintf(name, sizeof name, "%s%s", inside_expect ? "expect_" : "", key));
    MpmCheckInput(
        !inside_expect || MpmOptionIndex(name) != MPM_NOT_AN_OPTION,
        "%s:%d: unknown key '%s' in expect; allowed: verdict, kind, growth, spectrum, critical, share, error or energy",
        settings->scene, Line(node), key);
    PetscCall(FindKey(settings, name, Line(node), &option));
    PetscCall(ValueText(settings, document, option, value, text, sizeof text));
    PetscCall(SetOnce(settings, key, option, text, Line(node)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadRoot(MpmSettings *settings, yaml_document_t *document)
{
  const yaml_node_t *root = yaml_document_get_root_node(document);

  PetscFunctionBegin;
  MpmCheckInput(root && root->type == YAML_MAPPING_NODE, "scene %s: allowed: lines of the form key: value",
                settings->scene);
  PetscCall(ReadMapping(settings, document, root, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The line of an error. Of a byte that is no character libyaml tells the offset, but not the line. */
static int ProblemLine(const yaml_parser_t *parser)
{
  const unsigned char *text = parser->input.string.start;
  int                  line = 1;

  if (parser->error != YAML_READER_ERROR) return (int)parser->problem_mark.line + 1;
  for (size_t i = 0; i < parser->problem_offset && text + i < parser->input.string.end; i++) line += text[i] == '\n';
  return line;
}

static PetscErrorCode ReadDocument(MpmSettings *settings, yaml_parser_t *parser)
{
  yaml_document_t document;
  PetscErrorCode  ierr;
  PetscBool       more;

  PetscFunctionBegin;
  MpmCheckInput(yaml_parser_load(parser, &document), "%s:%d: not YAML: %s; allowed: lines of the form key: value",
                settings->scene, ProblemLine(parser), parser->problem ? parser->problem : "unreadable");
  ierr = ReadRoot(settings, &document);
  yaml_document_delete(&document);
  PetscCall(ierr);
  more = !yaml_parser_load(parser, &document) || yaml_document_get_root_node(&document) ? PETSC_TRUE : PETSC_FALSE;
  yaml_document_delete(&document);
  MpmCheckInput(!more, "scene %s: something follows the scene; allowed: one YAML document", settings->scene);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads YAML text; settings->scene is the name that messages have for it. */
static PetscErrorCode ReadYaml(MpmSettings *settings, const char yaml[], size_t size)
{
  yaml_parser_t  parser;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCheck(yaml_parser_initialize(&parser), PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for the YAML parser");
  yaml_parser_set_input_string(&parser, (const unsigned char *)yaml, size);
  ierr = ReadDocument(settings, &parser);
  yaml_parser_delete(&parser);
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadScene(MpmSettings *settings, const char path[])
{
  char          *bytes;
  PetscInt       size = 0;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(settings->scene, path, sizeof settings->scene));
  PetscCall(PetscMalloc1(LARGEST_SCENE + 1, &bytes));
  ierr = ReadBytes(path, bytes, &size);
  if (!ierr) ierr = ReadYaml(settings, bytes, (size_t)size);
  PetscCall(PetscFree(bytes));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadText(MpmSettings *settings, const char yaml[])
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(settings->scene, "text", sizeof settings->scene));
  MpmCheckInput(strlen(yaml) <= LARGEST_SCENE, "scene text: larger than 16 KiB; allowed: YAML of options");
  PetscCall(ReadYaml(settings, yaml, strlen(yaml)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
