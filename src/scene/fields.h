/*
   Fields: what a scene and a request consist of, one line each in one table. A line says how a field is given (its
   option, default, range and meaning), where its value is kept, and which records show the value. The command line, the
   keys of a scene file, 'mpmstab list options', headings, JSON, the attributes of HDF5 files, and what checkpoints and
   mode files are compared by are all made from the table.
*/
#pragma once
#include "scene/request.h"

/* How an option is given. Span: two fractions; ends: two words; list: whole numbers with commas between them;
   words: any of its words with commas between them; blocks: a block {key: value, ...} of YAML, or a list of them. */
typedef enum {
  MPM_WORD,
  MPM_INTEGER,
  MPM_REAL,
  MPM_FRACTION,
  MPM_SWITCH,
  MPM_PATH,
  MPM_RANGE,
  MPM_SPAN,
  MPM_ENDS,
  MPM_LIST,
  MPM_WORDS,
  MPM_BLOCKS
} MpmOptionKind;

/*
   How a value is kept: text; a whole number (count: PetscInt, long: PetscInt64); a double; a fraction; two doubles; a
   PetscBool; an enum, whose value is the place of the word among the option's; two such places, each a PetscInt; the
   numbers of particles in cells.
*/
typedef enum {
  MPM_NO_VALUE,
  MPM_AS_TEXT,
  MPM_AS_COUNT,
  MPM_AS_LONG,
  MPM_AS_REAL,
  MPM_AS_FRACTION,
  MPM_AS_RANGE,
  MPM_AS_SWITCH,
  MPM_AS_WORD,
  MPM_AS_ENDS,
  MPM_AS_COUNTS
} MpmValueKind;

/* What the value is a part of. */
typedef enum { MPM_OF_SCENE, MPM_OF_REQUEST } MpmOwner;

/* The records that show values: HDF5 attributes, JSON, a checkpoint's text, and what a mode file is compared by. */
typedef enum { MPM_IN_FILE, MPM_IN_JSON, MPM_IN_CHECKPOINT, MPM_IN_MODE_FILE, MPM_RECORDS } MpmRecord;

/* What is done with the file that an option names: nothing (it names none), or it is read, or written. */
typedef enum { MPM_FILE_NONE, MPM_FILE_READ, MPM_FILE_WRITTEN } MpmFileUse;

/*S
   MpmField - one field of a scene or of a request.
S*/
typedef struct MpmField_ {
  const char   *name;            /* of the option, which is also the key in a scene file, and of the value in records */
  MpmOptionKind kind;            /* how the option is given */
  const char   *fallback, *help; /* its default as text, NULL: none; its meaning, as 'mpmstab list options' prints it */
  PetscReal     lo, hi;          /* bounds of a number; lo itself is out when lo_open */
  PetscBool     lo_open;
  const char *const *words;        /* that are allowed, NULL after the last */
  const char *(*word)(PetscInt i); /* the same as a function */
  const char  *also;  /* a word in the place of a number, or NULL; where a number is needed, it is the default then */
  const char  *rival; /* an option that says the same in another way, so that giving both is an error; or several */
  const char  *tasks; /* those that read it (NULL: all); the others refuse it on the command line */
  const char  *with;  /* the sources that it needs one of, as in "program or plugin"; NULL: it stands without them */
  MpmValueKind value; /* how its value is kept, MPM_NO_VALUE if other fields follow from it */
  MpmOwner     owner; /* where it is kept: the offset in its owner */
  size_t at, each;    /* each: bytes from the place of one direction's value to the next one's; 0: there is one value */
  PetscInt (*numbers)(const MpmScene *scene); /* how many, if not one for each direction: the components of a stress */
  PetscBool by_hand;   /* it is not read from the option as it stands, but by the code that makes its owner */
  PetscBool real;      /* records have the whole number as a double, as they have all numbers of transfers */
  PetscBool of_matrix; /* it is also read where a matrix from a file takes the place of the scene */
  const char *(*text)(const MpmScene *scene); /* a text is what this function says, or is at its place itself */
  int place[MPM_RECORDS]; /* for each record its place among those that are shown there, from 1; 0: it is not shown */
  PetscBool (*shown)(const MpmScene *scene, MpmRecord record,
                     const struct MpmField_ *field); /* whether a record shows it (NULL: always) */
  const char *json;    /* its key there when that is not its name; 'object.key' is a key inside an object */
  PetscBool   exact;   /* headings show the fraction as such */
  PetscBool   no_key;  /* it stands on the command line only */
  MpmFileUse  file;    /* what is done with the file that it names */
  const char *endings; /* of one that is written, what its name may end in, as in ".h5 or .hdf5" */
} MpmField;

/* Not collective. The fields that are options, and those that follow from others; each ended by one without a name. */
extern const MpmField MpmOptions[], MpmDerived[];

/* Not collective. Word i of an option; NULL after the last, and of an option without words. */
static inline const char *MpmFieldWord(const MpmField *field, PetscInt i)
{
  return field->words ? field->words[i] : field->word ? field->word(i) : NULL;
}

#define MPM_MAX_OPTIONS 160

/* Not collective. Index of an option in MpmOptions, or MPM_NOT_AN_OPTION. */
#define MPM_NOT_AN_OPTION -1
PetscInt MpmOptionIndex(const char name[]);

/* Not collective. Whether a task reads an option. */
PetscBool MpmFieldIsOf(const MpmField *option, const char task[]);

/* Not collective. The option that a misspelled name may mean, or NULL. */
const char *MpmOptionNear(const char name[]);

/*S
   MpmValue - a field's value in a scene, or its n values, one for each direction or component. Its kind says where they
   are: AS_COUNT, AS_LONG in whole; AS_REAL in number[i][0], AS_RANGE in number; AS_FRACTION in fraction; the others in
   text.
S*/
typedef struct {
  const MpmField *field;
  MpmValueKind    kind;
  PetscInt        n;
  PetscReal       number[MPM_MAX_STRESS][2];
  PetscInt64      whole[MPM_MAX_DIM];
  MpmFraction     fraction[MPM_MAX_DIM];
  char            text[MPM_COUNTS_TEXT];
} MpmValue;

#define MPM_MAX_VALUES 120

/*
   MpmValuesIn - the values that a record of a scene shows, in their order there.

   Not collective. scene NULL, request NULL: without the fields of scenes, or of requests.
*/
PetscErrorCode MpmValuesIn(MpmRecord record, const MpmScene *scene, const MpmRequest *request, PetscInt *n,
                           MpmValue values[MPM_MAX_VALUES]);

/* Not collective. The value of one field, by its name. */
PetscErrorCode MpmValueOf(const char name[], const MpmScene *scene, const MpmRequest *request, MpmValue *value);

/*S
   MpmAttribute - an attribute of a file: a whole number (AS_COUNT), a double (AS_REAL) or a text (AS_TEXT).
S*/
typedef struct {
  char         name[64];
  MpmValueKind kind;
  PetscInt     count;
  PetscReal    number;
  const char  *text;
} MpmAttribute;

/*
   Not collective. What value a is as attributes, one or the two ends of a range: the field's name, where there are
   several with _x, _y or _z, and of a stress with _xx, _xy and so on; the ends have _from and _to behind it.
*/
void MpmValueAttributes(const MpmValue *value, PetscInt a, PetscInt *n, MpmAttribute attributes[2]);

/* Not collective. The value of direction a with all its digits, as MpmValueText has it. */
PetscErrorCode MpmValueOneText(const MpmValue *value, PetscInt a, size_t room, char text[]);

/* Not collective. A value with all its digits, as a checkpoint has it; a fraction is exact. */
PetscErrorCode MpmValueText(const MpmValue *value, size_t room, char text[]);

/* Not collective. A value as headings have it: with six digits. */
PetscErrorCode MpmValueHeading(const MpmValue *value, size_t room, char text[]);

/*
   MpmValueAgrees - whether the text of a value in a file is that of a scene.

   Not collective. A fraction also agrees with the number that it is to all digits: drifts that follow from a velocity
   were once kept as numbers.
*/
PetscErrorCode MpmValueAgrees(const MpmValue *value, const char text[], PetscBool *agrees);
