/*
   Particles whose places a file gives (layout FILE). A CSV file has a header with the names of the columns, then a line
   for each particle, whose id is the number of its line. The first rank reads the file line by line, twice: it counts
   the lines, and then fills arrays of that size, which all ranks get. Of an HDF5 file that -output has written, the
   arrays of the particles at the last step are the columns.

   The moduli of a particle count as its stiffness against a strain in one direction, over the scene's rho c^2: E for a
   bar, and E (1 - nu) / ((1 + nu) (1 - 2 nu)) in more dimensions.
*/
#include "base/hdf5.h"
#include "base/memory.h"
#include "base/textfile.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "scene/settings.h"
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define LONGEST 4096 /* bytes of a line */
#define MOST_COLUMNS 64
#define MOST_PARTICLES (PETSC_MAX_INT / 2)
#define PORTION (1 << 28) /* numbers in a message */
#define SAME_RATIO 1e-12

enum { IGNORED = -1, VOLUME = MPM_GIVEN_VOLUME, KNOWN = MPM_GIVEN_COLUMNS };

/* The columns, and what their numbers may be. */
static const struct {
  const char *name;
  PetscReal   lo, hi;
  PetscBool   open;
  const char *allowed;
} columns[KNOWN] = {{"x", -PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_FALSE, "a number"},
                    {"y", -PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_FALSE, "a number"},
                    {"z", -PETSC_MAX_REAL, PETSC_MAX_REAL, PETSC_FALSE, "a number"},
                    {"volume", 0, PETSC_MAX_REAL, PETSC_TRUE, "a number above 0"},
                    {"mass", 0, PETSC_MAX_REAL, PETSC_TRUE, "a number above 0"},
                    {"young", 0, PETSC_MAX_REAL, PETSC_TRUE, "a number above 0"},
                    {"poisson", 0, 0.5, PETSC_FALSE, "a number from 0 to 0.5"},
                    {"fixed", 0, 1, PETSC_FALSE, "1 for a particle that is held, else 0"}};

/* A file that is being read. why: what is wrong with it, after its name; empty: nothing. */
typedef struct {
  FILE      *stream;
  MpmHdf5    hdf5;
  char       group[64];
  PetscInt   dim, columns, of[MOST_COLUMNS];
  PetscInt64 line, particles;
  PetscReal *value[KNOWN];
  char       text[LONGEST + 2], why[512], unused[256];
} Reader;

#define Why(r, ...) (void)snprintf((r)->why, sizeof(r)->why, __VA_ARGS__)

/* ---- lines ---- */

static PetscBool IsText(const char line[])
{
  for (; *line; line++)
    if (iscntrl((unsigned char)*line) && !strchr("\r\n\t", *line)) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Takes the next line without its end; false at the end of the file, or where something is wrong with the line. */
static PetscBool NextLine(Reader *r)
{
  size_t length;

  if (!fgets(r->text, sizeof r->text, r->stream)) return PETSC_FALSE;
  r->line++;
  length = strlen(r->text);
  if (length == 0 || (r->text[length - 1] != '\n' && !feof(r->stream)) || (r->line == 1 && !IsText(r->text))) {
    Why(r, "line %" PetscInt64_FMT ": not text, or longer than %d characters; allowed: a CSV file", r->line, LONGEST);
    return PETSC_FALSE;
  }
  while (length && strchr("\r\n \t", r->text[length - 1])) r->text[--length] = '\0';
  return PETSC_TRUE;
}

/* Cuts the cell before the next comma off a line; NULL: there is none. */
static char *NextCell(char **line)
{
  char *cell = *line, *comma = cell ? strchr(cell, ',') : NULL;

  if (comma) *comma = '\0';
  *line = comma ? comma + 1 : NULL;
  return cell;
}

/* Counts the lines with particles: all but the header, up to the last that is not empty. */
static void Count(Reader *r)
{
  PetscInt64 last = 0;

  while (NextLine(r))
    if (r->text[0]) last = r->line;
  r->particles = PetscMax(0, last - 1);
  if (!r->why[0] && last == 0)
    Why(r, "it is empty; allowed: a header such as x,y,volume and a line for each particle");
  else if (!r->why[0] && !r->particles)
    Why(r, "it has a header and no particle; allowed: at least one line more");
  else if (!r->why[0] && r->particles > MOST_PARTICLES)
    Why(r, "it has %" PetscInt64_FMT " particles; allowed: at most %d", r->particles, (int)MOST_PARTICLES);
  rewind(r->stream);
  r->line = 0;
}

/* Reads the header. Columns of other names are passed over. */
static void ReadHeader(Reader *r)
{
  PetscBool has[KNOWN] = {PETSC_FALSE};
  char     *next       = r->text, *name;

  if (!NextLine(r)) return;
  if (*next == '#') next++; /* as numpy.savetxt writes it */
  while ((name = NextCell(&next)) && !r->why[0]) {
    PetscInt column = KNOWN - 1;

    name += strspn(name, " \t\"");
    name[strcspn(name, " \t\"")] = '\0';
    while (column != IGNORED && strcasecmp(name, columns[column].name)) column--;
    if (column == MPM_GIVEN_POISSON && r->dim == 1) column = IGNORED; /* young is the stiffness of a bar */
    if (r->columns == MOST_COLUMNS || (column != IGNORED && has[column])) {
      Why(r, "line 1: %s; allowed: each column once, at most %d",
          r->columns == MOST_COLUMNS ? "too many columns" : "a column twice", MOST_COLUMNS);
      return;
    }
    r->of[r->columns++] = column;
    if (column != IGNORED)
      has[column] = PETSC_TRUE;
    else
      (void)snprintf(r->unused + strlen(r->unused), sizeof r->unused - strlen(r->unused), "%s%.32s",
                     r->unused[0] ? ", " : "", name);
  }
  for (PetscInt a = 0; a < MPM_MAX_DIM && !r->why[0]; a++) {
    if (has[a] == (a < r->dim)) continue;
    Why(r,
        a < r->dim ? "line 1: there is no column %s; allowed: a header with x%s, and of volume, mass, young "
                     "and poisson what there is"
                   : "line 1: there is a column %s%.0s, and -dim is less; allowed: -dim with the columns that "
                     "there are",
        columns[a].name,
        r->dim > 2   ? ",y,z"
        : r->dim > 1 ? ",y"
                     : "");
  }
}

static PetscBool IsAllowed(PetscInt of, PetscReal x)
{
  if (!isfinite(x) || x > columns[of].hi || (of == MPM_GIVEN_FIXED && x != rint(x))) return PETSC_FALSE;
  return x > columns[of].lo || (x == columns[of].lo && !columns[of].open) ? PETSC_TRUE : PETSC_FALSE;
}

/* Reads the numbers of a particle. */
static void ReadParticle(Reader *r, PetscInt64 id)
{
  char *next = r->text, *cell, *end;

  for (PetscInt c = 0; c < r->columns; c++) {
    const PetscInt of = r->of[c];
    PetscReal      value;

    cell = NextCell(&next);
    if (!cell || (c == r->columns - 1 && next)) {
      Why(r, "line %" PetscInt64_FMT ": %s numbers than columns; allowed: %" PetscInt_FMT, r->line,
          cell ? "more" : "fewer", r->columns);
      return;
    }
    if (of == IGNORED) continue;
    value = strtod(cell, &end);
    if (end != cell) end += strspn(end, " \t");
    if (end == cell || *end || !IsAllowed(of, value)) {
      Why(r, "line %" PetscInt64_FMT ": %s '%.40s'; allowed: %s", r->line, columns[of].name, cell, columns[of].allowed);
      return;
    }
    r->value[of][id] = value;
  }
}

/* ---- HDF5 ---- */

/* Finds the group of the last step, whose particles' arrays are the columns. */
static void ReadGroups(Reader *r)
{
  PetscInt64 shape[2] = {0};
  int        dims;
  char       name[64], path[128];

  for (PetscInt i = 0; MpmHdf5Group(&r->hdf5, i, sizeof name, name); i++)
    if (!strncmp(name, "step_", 5) && strcmp(name, r->group) > 0) (void)snprintf(r->group, sizeof r->group, "%s", name);
  (void)snprintf(path, sizeof path, "/%s/particles/coordinates", r->group);
  if (!r->group[0] || !MpmHdf5Array(&r->hdf5, path, 2, &dims, shape) || dims != 2 || shape[0] < 1 ||
      shape[1] != (r->dim == 1 ? 3 : r->dim)) {
    Why(r,
        "no particles of a step with -dim %" PetscInt_FMT " are in it; allowed: CSV, or what run -output has "
        "written (run -restart FILE -output OUT.h5 makes that of a checkpoint)",
        r->dim);
    return;
  }
  r->particles = shape[0];
  for (PetscInt a = 0; a < r->dim; a++) r->of[r->columns++] = a;
  for (PetscInt c = VOLUME; c < KNOWN; c++) {
    (void)snprintf(path, sizeof path, "/%s/particles/%s", r->group, columns[c].name);
    if (MpmHdf5Array(&r->hdf5, path, 1, &dims, shape) && dims == 1 && shape[0] == r->particles) r->of[r->columns++] = c;
  }
}

static PetscErrorCode ReadArrays(Reader *r)
{
  const PetscInt width = r->dim == 1 ? 3 : r->dim;
  PetscReal     *x;
  char           path[128];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(width * r->particles, &x));
  (void)snprintf(path, sizeof path, "/%s/particles/coordinates", r->group);
  MpmHdf5ReadArray(&r->hdf5, path, x);
  for (PetscInt c = 0; c < r->columns && !r->why[0]; c++) {
    PetscReal *value = r->value[r->of[c]];

    (void)snprintf(path, sizeof path, "/%s/particles/%s", r->group, columns[r->of[c]].name);
    if (r->of[c] >= VOLUME) MpmHdf5ReadArray(&r->hdf5, path, value);
    for (PetscInt64 id = 0; id < r->particles && !r->hdf5.failed && !r->why[0]; id++) {
      if (r->of[c] < VOLUME) value[id] = x[width * id + r->of[c]];
      if (!IsAllowed(r->of[c], value[id]))
        Why(r, "particle %" PetscInt64_FMT ": %s %g; allowed: %s", id, columns[r->of[c]].name, value[id],
            columns[r->of[c]].allowed);
    }
  }
  if (r->hdf5.failed) Why(r, "HDF5 cannot read it; allowed: a whole file");
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the file ---- */

static PetscErrorCode Open(const char path[], const char others[], Reader *r)
{
  PetscBool is    = PETSC_FALSE;
  int       error = 0;

  PetscFunctionBegin;
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) {
    r->stream = MpmFileOpen(path, &error);
    if (!r->stream) Why(r, "%s; allowed: %sa CSV or HDF5 file of particles", MpmFileReason(error), others);
    if (r->stream) PetscCall(MpmHdf5Is(path, &is));
    if (is) {
      PetscCall(MpmHdf5Open(PETSC_COMM_SELF, path, &r->hdf5));
      ReadGroups(r);
    } else if (r->stream) {
      Count(r);
      if (!r->why[0]) ReadHeader(r);
    }
  }
  PetscCallMPI(MPI_Bcast(r->why, sizeof r->why, MPI_CHAR, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(&r->particles, 1, MPIU_INT64, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(&r->columns, 1, MPIU_INT, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(r->of, MOST_COLUMNS, MPIU_INT, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(r->group, sizeof r->group, MPI_CHAR, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(r->unused, sizeof r->unused, MPI_CHAR, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGivenRead(const char where[], const char others[], const char path[], PetscInt dim, MpmGiven **made)
{
  Reader    r     = {.dim = dim, .hdf5 = {.file = -1}};
  MpmGiven *given = NULL;
  PetscBool failed;

  PetscFunctionBegin;
  PetscCall(Open(path, others, &r));
  if (!r.why[0]) {
    PetscCall(MpmMemoryCheck(PETSC_COMM_WORLD, path,
                             (PetscReal)r.particles * (PetscReal)sizeof(PetscReal) * (2 * r.columns + 2) *
                                 MpmRanksOf(PETSC_COMM_WORLD),
                             "a copy of the particles on each rank"));
    PetscCall(PetscNew(&given));
    *made = given;
    for (PetscInt c = 0; c < r.columns; c++)
      if (r.of[c] != IGNORED) PetscCall(PetscMalloc1(r.particles, &given->column[r.of[c]]));
    PetscCall(PetscArraycpy(r.value, given->column, KNOWN));
    if (r.hdf5.file >= 0) PetscCall(ReadArrays(&r));
    for (PetscInt64 id = 0; r.stream && r.hdf5.file < 0 && id < r.particles && !r.why[0]; id++)
      if (NextLine(&r)) ReadParticle(&r, id);
    PetscCallMPI(MPI_Bcast(r.why, sizeof r.why, MPI_CHAR, 0, PETSC_COMM_WORLD));
    for (PetscInt c = 0; c < KNOWN && !r.why[0]; c++)
      for (PetscInt64 i = 0; r.value[c] && i < r.particles; i += PORTION)
        PetscCallMPI(
            MPI_Bcast(r.value[c] + i, (PetscMPIInt)PetscMin(PORTION, r.particles - i), MPIU_REAL, 0, PETSC_COMM_WORLD));
    given->of_steps = r.group[0] ? PETSC_TRUE : PETSC_FALSE;
  }
  if (r.hdf5.file >= 0) PetscCall(MpmHdf5Close(&r.hdf5, &failed));
  if (r.stream) (void)fclose(r.stream);
  MpmCheckInput(!r.why[0], "%s %s: %s", where, path, r.why);
  (void)snprintf(given->path, sizeof given->path, "%s", path);
  (void)snprintf(given->unused, sizeof given->unused, "%s", r.unused);
  given->particles = r.particles;
  for (int i = 0; i < MPM_GIVEN_SAID; i++) given->has[i] = given->column[VOLUME + i] ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadGiven(const MpmSettings *settings, MpmScene *scene)
{
  const char *path = MpmSettingsText(settings, "layout");
  MpmGiven   *given;

  PetscFunctionBegin;
  scene->layout.name = "uniform";
  if (!strcasecmp(path, scene->layout.name)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!strcasecmp(path, MPM_LAYOUT_RANDOM)) { /* they are placed when it is known how many there are */
    PetscCall(MpmGivenCreateRandom(&scene->layout));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmSettingsRefuseIf(!*path || strlen(path) >= sizeof given->path, settings, "layout",
                      "allowed: uniform, random, or the name of a CSV or HDF5 file of particles");
  PetscCall(MpmGivenRead("layout", "uniform, random, or ", path, scene->layout.dim, &scene->layout.given));
  given              = scene->layout.given;
  scene->layout.name = given->path;
  if (given->column[MPM_GIVEN_POISSON] && scene->layout.dim > 1 &&
      MpmSettingsSource(settings, "poisson") == MPM_FROM_DEFAULT)
    scene->scheme.space.poisson = given->column[MPM_GIVEN_POISSON][0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGivenDestroy(MpmGiven **given)
{
  PetscFunctionBegin;
  if (!*given) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < KNOWN; c++) PetscCall(PetscFree((*given)->column[c]));
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) {
    PetscCall(PetscFree((*given)->before[a]));
    PetscCall(PetscFree((*given)->velocity[a]));
  }
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++) PetscCall(PetscFree((*given)->property[w]));
  PetscCall(PetscFree((*given)->material));
  PetscCall(PetscFree((*given)->materials));
  PetscCall(PetscFree(*given));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- in the scene's grid ---- */

/* The particles before each cell of a direction. Places are in cells. */
static PetscErrorCode CountAlong(const MpmLayout *layout, PetscInt a)
{
  const PetscInt cells  = layout->grid[a].cells;
  PetscInt64    *before = NULL;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(cells + 1, &before));
  for (PetscInt64 id = 0; id < layout->given->particles; id++)
    before[PetscMin((PetscInt)layout->given->column[a][id], cells - 1) + 1]++;
  for (PetscInt c = 0; c < cells; c++) before[c + 1] += before[c];
  layout->given->before[a] = before;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGivenCreateRandom(MpmLayout *layout)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(&layout->given));
  layout->given->random = PETSC_TRUE;
  PetscCall(PetscStrncpy(layout->given->path, MPM_LAYOUT_RANDOM, sizeof layout->given->path));
  layout->name = layout->given->path;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGivenScatter(MpmLayout *layout)
{
  MpmGiven *given = layout->given;

  PetscFunctionBegin;
  given->particles = layout->sites;
  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscCall(PetscMalloc1(given->particles, &given->column[a]));
    for (PetscInt64 id = 0; id < given->particles; id++)
      given->column[a][id] = layout->grid[a].cells * MpmHash(MpmLayoutSeed(layout, a), id);
    PetscCall(CountAlong(layout, a));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where a particle stands in its file: text of WHERE characters. */
#define WHERE 40
static const char *Where(const MpmGiven *given, PetscInt64 id, char text[WHERE])
{
  (void)snprintf(text, WHERE, "%s %" PetscInt64_FMT, given->of_steps ? "particle" : "line",
                 given->of_steps ? id : id + 2);
  return text;
}

/* Turns the places of a file along a direction into cells. */
static PetscErrorCode PlaceAlong(const MpmScene *scene, PetscInt a)
{
  MpmGiven       *given = scene->layout.given;
  const PetscInt  cells = scene->layout.grid[a].cells;
  const PetscReal width = scene->cell_width;
  char            where[WHERE];

  PetscFunctionBegin;
  for (PetscInt64 id = 0; id < given->particles; id++) {
    const PetscReal x = given->column[a][id] / width;

    MpmCheckInput(
        x >= 0 && x <= cells,
        "layout %s: %s: %s %.17g is outside of the domain; allowed: from 0 to %.17g (-length, -cell_width and "
        "-cells say how long the domain is)",
        given->path, Where(given, id, where), columns[a].name, given->column[a][id], scene->length[a]);
    given->column[a][id] = x;
  }
  PetscCall(CountAlong(&scene->layout, a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns E and Poisson's ratio of a particle into lambda + 2 mu, lambda and mu, over the scene's lambda + 2 mu. */
static void SetLames(const MpmScene *scene, PetscReal *const p[], PetscInt64 id)
{
  const PetscInt  dim = scene->layout.dim;
  const PetscReal nu  = p[MPM_LAMBDA][id];

  p[MPM_STIFFNESS][id] *= MpmMaterialStiffness(dim, nu) / MpmMaterialStiffness(dim, scene->scheme.space.poisson);
  p[MPM_LAMBDA][id] = p[MPM_STIFFNESS][id] * nu / (1 - nu);
  p[MPM_SHEAR][id]  = p[MPM_STIFFNESS][id] * (1 - 2 * nu) / (2 * (1 - nu));
}

static const PetscInt from[MPM_PROPERTIES] = {[MPM_VOLUME]    = VOLUME,
                                              [MPM_MASS]      = MPM_GIVEN_MASS,
                                              [MPM_STIFFNESS] = MPM_GIVEN_YOUNG,
                                              [MPM_LAMBDA]    = MPM_GIVEN_POISSON,
                                              [MPM_SHEAR]     = MPM_GIVEN_POISSON,
                                              [MPM_MOBILITY]  = MPM_GIVEN_FIXED};

/* Properties in units of a particle of the scene's material that fills 1 / ppc of a cell. */
static PetscErrorCode Weigh(MpmScene *scene)
{
  MpmLayout *l      = &scene->layout;
  MpmGiven  *given  = l->given;
  PetscReal  domain = 1, unit[MPM_PROPERTIES];
  char       where[WHERE];

  PetscFunctionBegin;
  MpmMaterialUnits(scene, unit);
  for (PetscInt a = 0; a < l->dim; a++) domain *= scene->length[a];
  for (PetscInt w = MPM_NO_PROPERTY + 1; w < MPM_PROPERTIES; w++) {
    if (!given->column[from[w]] && w != MPM_VOLUME && w != MPM_MASS) continue;
    if (from[w] == MPM_GIVEN_POISSON && !scene->scheme.space.lames) continue;
    PetscCall(PetscMalloc1(given->particles, &given->property[w]));
    l->varies[w] = PETSC_TRUE;
    for (PetscInt64 id = 0; id < given->particles; id++)
      given->property[w][id] = given->column[from[w]] ? given->column[from[w]][id] / unit[w] : NAN;
  }
  for (PetscInt64 id = 0; id < given->particles; id++) {
    PetscReal *const *p = given->property;

    if (!given->column[VOLUME]) p[MPM_VOLUME][id] = domain / (PetscReal)given->particles / unit[MPM_VOLUME];
    if (!given->column[MPM_GIVEN_MASS]) p[MPM_MASS][id] = p[MPM_VOLUME][id];
    if (p[MPM_MOBILITY]) p[MPM_MOBILITY][id] = 1 - p[MPM_MOBILITY][id];
    if (p[MPM_LAMBDA]) SetLames(scene, p, id);
    MpmCheckInput(
        isnormal(p[MPM_VOLUME][id]) && isnormal(p[MPM_MASS][id]) &&
            (!p[MPM_STIFFNESS] || isnormal(p[MPM_STIFFNESS][id])),
        "layout %s: %s: mass, volume or young is out of range beside the scene's density, cells and wave speed",
        given->path, Where(given, id, where));
  }
  given->density[0] = INFINITY;
  for (PetscInt64 id = 0; id < given->particles; id++) {
    const PetscReal density = given->property[MPM_MASS][id] / given->property[MPM_VOLUME][id];

    given->density[0] = fmin(given->density[0], density);
    given->density[1] = fmax(given->density[1], density);
  }
  for (PetscInt c = VOLUME; c < KNOWN; c++) PetscCall(PetscFree(given->column[c]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where Poisson's ratio varies lambda and mu are those of each particle. */
static PetscErrorCode CheckPoisson(MpmScene *scene)
{
  const MpmGiven *given = scene->layout.given;
  const PetscReal nu    = scene->scheme.space.poisson;
  char            where[WHERE];

  PetscFunctionBegin;
  for (PetscInt64 id = 0; given->column[MPM_GIVEN_POISSON] && scene->layout.dim > 1 && id < given->particles; id++) {
    const PetscReal own = given->column[MPM_GIVEN_POISSON][id];

    if (fabs(own - nu) <= SAME_RATIO) continue;
    scene->scheme.space.lames = PETSC_TRUE;
    MpmCheckInput(
        own < 0.5 && nu < 0.5 && given->column[MPM_GIVEN_YOUNG],
        "layout %s: %s: poisson %.17g where another particle, or -poisson, has %.17g; allowed: different ones "
        "below 0.5, with a column young",
        given->path, Where(given, id, where), own, nu);
  }
  MpmCheckInput(
      !scene->scheme.space.lames || scene->viscosity == 0,
      "layout %s: poisson differs from particle to particle, where viscosity %.6g would need one for all; allowed: "
      "shear_viscosity and bulk_viscosity",
      given->path, scene->viscosity);
  MpmCheckInput(
      !given->column[MPM_GIVEN_YOUNG] || scene->layout.dim == 1 || nu < 0.5,
      "layout %s: young with poisson 0.5 has no finite stiffness; allowed: poisson below 0.5, or no column young",
      given->path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsPlaceGiven(const MpmSettings *settings, MpmScene *scene)
{
  MpmLayout *l     = &scene->layout;
  MpmGiven  *given = l->given;

  PetscFunctionBegin;
  if (!given) PetscFunctionReturn(PETSC_SUCCESS);
  STANDS("counts,offset,cluster,fill,shape,density_ratio,stiffness_ratio,inclusion",
         given->of_bodies ? "bodies" : "layout", PETSC_TRUE,
         given->of_bodies ? "the particles are those of the option bodies; allowed: without bodies"
                          : "the particles are those of the option layout; allowed: without layout");
  l->sites = l->particles = given->random ? l->sites : given->particles;
  if (given->of_bodies) {
    for (PetscInt a = 0; a < l->dim; a++) {
      PetscCall(CountAlong(l, a));
      l->row[a] = given->particles;
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  STANDS("ppc", "layout", !scene->scheme.basis->wide && !given->random,
         "the particles are those of the file layout; allowed: with basis gimp, where 1 / ppc is the width of a "
         "particle, or without layout");
  MpmCheckInput(
      !scene->scheme.space.finite,
      "layout %s: its particles are at rest and have no stretch; allowed: without kinematics finite, or as one "
      "of the bodies: -bodies '{shape: file, path: %s}'",
      given->path, given->path);
  PetscCall(CheckPoisson(scene));
  MpmCheckInput(!given->column[MPM_GIVEN_FIXED] || !MpmSceneDrifts(scene),
                "layout %s: a particle that is held does not drift; allowed: without drift, or without column fixed",
                given->path);
  if (given->random) {
    PetscCall(MpmLayoutCheckMemory(
        PETSC_COMM_WORLD, l, (PetscReal)l->sites * sizeof(PetscReal) * (l->dim + 2) * MpmRanksOf(PETSC_COMM_WORLD),
        "a copy of the particles on each rank"));
    PetscCall(MpmGivenScatter(l));
  }
  for (PetscInt a = 0; a < l->dim; a++) {
    if (!given->random) PetscCall(PlaceAlong(scene, a));
    l->row[a] = given->particles;
  }
  l->sites = l->particles = given->particles;
  PetscCall(Weigh(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- a particle ---- */

/* A place that jitter moves, and that goes round a periodic domain and comes back from a wall. */
static PetscReal Displaced(const MpmLayout *layout, PetscInt a, PetscInt64 id, PetscReal x)
{
  const PetscReal cells = layout->grid[a].cells;

  x += layout->jitter * (MpmHash(MpmLayoutSeed(layout, a), id) - 0.5) / layout->ppc[a];
  if (layout->grid[a].ends[0] == MPM_PERIODIC) return PetscMin(x - cells * floor(x / cells), nextafter(cells, 0));
  return x < 0 ? -x : x > cells ? 2 * cells - x : x;
}

void MpmGivenPlace(const MpmLayout *layout, PetscInt64 id, PetscInt cell[], PetscReal xi[])
{
  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscReal x = layout->given->column[a][id];

    if (layout->jitter != 0) x = Displaced(layout, a, id, x);
    cell[a] = (PetscInt)x;
    xi[a]   = x - cell[a];
    if (cell[a] < layout->grid[a].cells) continue;
    cell[a] = layout->grid[a].ends[0] == MPM_PERIODIC ? 0 : layout->grid[a].cells - 1;
    xi[a]   = layout->grid[a].ends[0] == MPM_PERIODIC ? 0 : nextafter(1, 0); /* the node at the right end */
  }
}

void MpmGivenText(const MpmGiven *given, size_t room, char text[])
{
  if (given->of_bodies)
    (void)snprintf(text, room, "%" PetscInt64_FMT " particles of %" PetscInt_FMT " bod%s", given->particles,
                   given->of_bodies, given->of_bodies > 1 ? "ies" : "y");
  else if (given->random)
    (void)snprintf(text, room, "%" PetscInt64_FMT " particles anywhere in the domain, by -seed", given->particles);
  else
    (void)snprintf(text, room, "%s; %s; %s%s%s%s",
                   given->has[0] ? "volumes of the file" : "volume of each: the domain's over the number of particles",
                   given->has[1] ? "masses of the file" : "mass: density times volume",
                   given->has[2]   ? given->has[3] ? "young and poisson of the file" : "young of the file"
                   : given->has[3] ? "poisson of the file"
                                   : "moduli of the options",
                   given->has[MPM_GIVEN_SAID - 1] ? "; particles are held where fixed is 1" : "",
                   given->unused[0] ? "; not used: " : "", given->unused);
}
