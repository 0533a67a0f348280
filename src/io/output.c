/*
   XDMF for ParaView: particles are points, nodes are a uniform grid. A 2DCoRectMesh has its extents in the order y x, a
   3DCoRectMesh in the order z y x. In one dimension points have three coordinates, and nodes are a 3DCoRectMesh.
*/
#include "base/textfile.h"
#include "io/datafile.h"
#include "io/output.h"
#include "scene/material.h"
#include "scheme/deform.h"
#include <math.h>
#include <string.h>
#include <unistd.h>

/* One set of fields: where it is, and its extents as text. */
typedef struct {
  FILE           *xmf;
  const MpmScene *scene;
  const char     *file, *group, *place;
  char            extents[64];
} Fields;

static void Item(const Fields *f, const char name[])
{
  fprintf(f->xmf,
          "<DataItem Dimensions=\"%s\" NumberType=\"Float\" Precision=\"8\" Format=\"HDF\">%s:%s/%s/%s</DataItem>",
          f->extents, f->file, f->group, f->place, name);
}

/* The vector whose first component is register r. */
static void Vector(const Fields *f, PetscInt r)
{
  const MpmTable *table = f->scene->scheme.table;

  fprintf(f->xmf,
          "<Attribute Name=\"%s\" AttributeType=\"Vector\" Center=\"Node\">"
          "<DataItem ItemType=\"Function\" Dimensions=\"%s 3\" Function=\"JOIN($0, $1, %s)\">",
          f->scene->scheme.formulation->particle_fields[table->field[r]], f->extents, table->dim == 2 ? "0*$0" : "$2");
  for (PetscInt a = 0; a < table->dim; a++) Item(f, table->fields[r + a]);
  fprintf(f->xmf, "</DataItem></Attribute>\n");
}

static void Describe(const Fields *f)
{
  const MpmTable *table = f->scene->scheme.table;

  for (PetscInt r = 0; r < table->nstate; r++) {
    const PetscInt field = table->field[r];

    if (table->dim > 1 && field >= 0 && f->scene->scheme.formulation->particle_ranks[field] == MPM_VECTOR) {
      if (table->component[r] == 0) Vector(f, r);
      continue;
    }
    fprintf(f->xmf, "<Attribute Name=\"%s\" AttributeType=\"Scalar\" Center=\"Node\">", table->fields[r]);
    Item(f, table->fields[r]);
    fprintf(f->xmf, "</Attribute>\n");
  }
}

static void Particles(Fields *f)
{
  const PetscInt columns = f->scene->layout.dim == 2 ? 2 : 3;

  f->place = "particles";
  snprintf(f->extents, sizeof f->extents, "%" PetscInt64_FMT, f->scene->layout.particles);
  fprintf(f->xmf,
          "<Grid Name=\"particles\" GridType=\"Uniform\">\n"
          "<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%s\"/>\n"
          "<Geometry GeometryType=\"%s\"><DataItem Dimensions=\"%s %" PetscInt_FMT
          "\" NumberType=\"Float\" Precision=\"8\" Format=\"HDF\">%s:%s/particles/coordinates</DataItem></Geometry>\n",
          f->extents, columns == 2 ? "XY" : "XYZ", f->extents, columns, f->file, f->group);
  Describe(f);
  fprintf(f->xmf, "</Grid>\n");
}

static void Nodes(Fields *f)
{
  const MpmDirection *grid = f->scene->layout.grid;
  const PetscInt      dim  = f->scene->layout.dim;
  const PetscReal     h    = f->scene->cell_width;

  f->place = "nodes";
  if (dim == 2)
    snprintf(f->extents, sizeof f->extents, "%" PetscInt_FMT " %" PetscInt_FMT, grid[1].nodes, grid[0].nodes);
  else
    snprintf(f->extents, sizeof f->extents, "%" PetscInt_FMT " %" PetscInt_FMT " %" PetscInt_FMT,
             dim == 3 ? grid[2].nodes : 1, dim == 3 ? grid[1].nodes : 1, grid[0].nodes);
  fprintf(f->xmf,
          "<Grid Name=\"nodes\" GridType=\"Uniform\">\n"
          "<Topology TopologyType=\"%s\" Dimensions=\"%s\"/>\n",
          dim == 2 ? "2DCoRectMesh" : "3DCoRectMesh", f->extents);
  if (dim == 2)
    fprintf(f->xmf,
            "<Geometry GeometryType=\"ORIGIN_DXDY\"><DataItem Dimensions=\"2\" Format=\"XML\">0 0</DataItem>"
            "<DataItem Dimensions=\"2\" Format=\"XML\">%.17g %.17g</DataItem></Geometry>\n",
            h, h);
  else
    fprintf(f->xmf,
            "<Geometry GeometryType=\"ORIGIN_DXDYDZ\"><DataItem Dimensions=\"3\" Format=\"XML\">0 0 0</DataItem>"
            "<DataItem Dimensions=\"3\" Format=\"XML\">%.17g %.17g %.17g</DataItem></Geometry>\n",
            dim == 3 ? h : 1, dim == 3 ? h : 1, h);
  Describe(f);
  fprintf(f->xmf, "</Grid>\n");
}

static void DescribeStep(FILE *xmf, const MpmScene *scene, const char file[], const char group[], PetscReal time)
{
  Fields fields = {.xmf = xmf, .scene = scene, .file = file, .group = group};

  fprintf(xmf, "<Grid Name=\"step\" GridType=\"Collection\" CollectionType=\"Spatial\">\n<Time Value=\"%.17g\"/>\n",
          time);
  Particles(&fields);
  if (scene->scheme.basis->spline_ends != MPM_SPLINES_OPEN) Nodes(&fields);
  fprintf(xmf, "</Grid>\n");
}

/* ---- particle and node fields as HDF5, in the order of global ids ---- */

/*
   by_id, coordinates - numbers of particles in the order of global ids, and dim of them in a row (3 in one dimension)
   by_number          - numbers of nodes, x fastest; each rank has whole rows, or planes in three dimensions
   local              - a node field of the march
*/
struct MpmOutput_ {
  const MpmScene *scene;
  MpmDataFile     file;
  Vec             by_id, coordinates, by_number, local;
  MpmTextFile     xmf;
};

/* A vector of rows; no row is on two ranks. */
static PetscErrorCode CreateRows(MPI_Comm comm, PetscInt rows, PetscInt width, Vec *vector)
{
  PetscFunctionBegin;
  PetscCall(VecCreate(comm, vector));
  PetscCall(VecSetBlockSize(*vector, width));
  PetscCall(VecSetSizes(*vector, PETSC_DECIDE, rows * width));
  PetscCall(VecSetType(*vector, VECSTANDARD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOutputCreate(const MpmMarch *march, const MpmRequest *request, MpmOutput **output)
{
  const MPI_Comm      comm = PetscObjectComm((PetscObject)march->grid->da);
  const MpmDirection *grid = march->layout->grid;
  const PetscInt      n = (PetscInt)march->layout->particles, dim = march->layout->dim;
  PetscInt            row = 1;
  MpmOutput          *o;

  PetscFunctionBegin;
  PetscCall(PetscNew(output));
  o        = *output;
  o->scene = march->scene;
  for (PetscInt a = 0; a + 1 < dim; a++) row *= grid[a].nodes;
  PetscCall(CreateRows(comm, n, 1, &o->by_id));
  PetscCall(CreateRows(comm, n, dim == 1 ? 3 : dim, &o->coordinates));
  PetscCall(CreateRows(comm, grid[dim - 1].nodes, row, &o->by_number));
  PetscCall(DMCreateLocalVector(march->grid->da, &o->local));
  PetscCall(MpmTextFileOpen(request->xmf, &o->xmf));
  if (o->xmf.stream)
    fprintf(o->xmf.stream, "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
                           "<Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n");
  PetscCall(MpmDataFileOpen(comm, o->scene, request, &o->file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Scatters values of local particles to the vector ordered by global id, block by block. */
static PetscErrorCode SetById(const MpmMarch *march, PetscInt width, const PetscReal values[], Vec vector)
{
  const PetscInt64 *id;
  PetscInt         *rows;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  PetscCall(PetscMalloc1(width * march->particles->count, &rows));
  for (PetscInt p = 0; p < march->particles->count; p++)
    for (PetscInt d = 0; d < width; d++) rows[width * p + d] = (PetscInt)(width * id[p] + d);
  PetscCall(VecSetValues(vector, width * march->particles->count, rows, values, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(vector));
  PetscCall(VecAssemblyEnd(vector));
  PetscCall(PetscFree(rows));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number that turns the values of a field in a march into the scene's units. */
static PetscReal UnitOf(const MpmMarch *march, PetscInt field)
{
  const MpmTable *table = march->scheme->table;

  if (MpmTableIsFinite(table)) return table->field[field] == MPM_STRETCHED ? 1 : march->scene->wave_speed;
  return scalbn(1, (int)march->exponent);
}

/* Writes a vector as PLACE/NAME of the file. A block is a row, of n dimensions; 0: a number. */
static PetscErrorCode WriteVector(MpmOutput *output, Vec vector, PetscInt n, const PetscInt row[], const char place[],
                                  const char name[])
{
  char path[128];

  PetscFunctionBegin;
  (void)snprintf(path, sizeof path, "%s/%s", place, name);
  PetscCall(MpmDataFileVector(&output->file, path, n, row, vector));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets column a of the rows x to the particles' places in that direction, wrapped into the domain. */
static PetscErrorCode SetPlaces(const MpmMarch *march, PetscInt a, PetscReal h, PetscInt width, PetscReal x[])
{
  const MpmParticles *particles = march->particles;
  const PetscInt      first = march->grid->axis[a].first, cells = march->grid->axis[a].cells;
  const PetscReal    *xi;
  const PetscInt     *cell;
  PetscInt            whole, zero = 0;
  PetscReal           part;

  PetscFunctionBegin;
  PetscCall(MpmParticlesWhere(particles, a, particles->step, &whole, &part));
  PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &cell));
  PetscCall(MpmParticlesGet(particles, MpmFieldXi[a], &xi));
  for (PetscInt p = 0; p < particles->count; p++) {
    PetscInt  now;
    PetscReal place;

    MpmPlaceBlock(1, &zero, &xi[p], 0, part, &now, &place);
    now              = (PetscInt)(((PetscInt64)first + cell[p] + whole + now) % cells);
    x[width * p + a] = h * ((now < 0 ? now + cells : now) + place);
  }
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi[a], &xi));
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell[a], &cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteCoordinates(MpmOutput *output, const char place[], const MpmMarch *march)
{
  PetscReal *x;
  PetscInt   width;

  PetscFunctionBegin;
  PetscCall(VecGetBlockSize(output->coordinates, &width));
  PetscCall(PetscCalloc1(width * march->particles->count, &x));
  for (PetscInt a = 0; a < march->layout->dim; a++) PetscCall(SetPlaces(march, a, output->scene->cell_width, width, x));
  PetscCall(SetById(march, width, x, output->coordinates));
  PetscCall(PetscFree(x));
  PetscCall(WriteVector(output, output->coordinates, 1, &width, place, "coordinates"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What layout FILE reads beside the places, in the scene's units: volumes of now, which go with det F, and masses,
   where they are not the domain's shares, and moduli. F of a material that flows is its elastic part, so that its
   volumes are not known.
*/
static PetscErrorCode WriteProperties(MpmOutput *output, const char place[], const MpmMarch *march)
{
  static const char *const names[MPM_PROPERTIES] = {
      [MPM_VOLUME] = "volume", [MPM_MASS] = "mass", [MPM_STIFFNESS] = "young", [MPM_LAMBDA] = "poisson"};
  const MpmTable   *t      = output->scene->scheme.table;
  const MpmLayout  *l      = march->layout;
  const PetscBool   finite = MpmTableIsFinite(t);
  const PetscInt    n = march->particles->count, components = finite ? l->dim * l->dim : 0;
  const PetscInt64 *id;
  PetscReal        *q, *F[MPM_MAX_DIM * MPM_MAX_DIM], at[MPM_MAX_DIM * MPM_MAX_DIM], unit[MPM_PROPERTIES];

  PetscFunctionBegin;
  if (finite && MpmMaterialFlows(&t->material)) PetscFunctionReturn(PETSC_SUCCESS);
  MpmMaterialUnits(output->scene, unit);
  PetscCall(PetscMalloc1(n, &q));
  for (PetscInt c = 0; c < components; c++)
    PetscCall(MpmParticlesGet(march->particles, t->fields[t->stretch + c], &F[c]));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++) {
    const PetscBool shares = MpmLayoutIsFull(l) && !l->varies[MPM_VOLUME] && !l->varies[MPM_MASS] && !finite;

    if (!names[w] || (w >= MPM_STIFFNESS ? !l->varies[w] : shares)) continue;
    PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
    for (PetscInt p = 0; p < n; p++) {
      for (PetscInt c = 0; c < components; c++) at[c] = F[c][p];
      q[p] = MpmMaterialColumn(output->scene, unit, w, id[p]) *
             (w == MPM_VOLUME && finite ? MpmDeterminant(l->dim, at) : 1);
    }
    PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
    PetscCall(SetById(march, 1, q, output->by_id));
    PetscCall(WriteVector(output, output->by_id, 0, NULL, place, names[w]));
  }
  for (PetscInt c = 0; c < components; c++)
    PetscCall(MpmParticlesRestore(march->particles, t->fields[t->stretch + c], &F[c]));
  PetscCall(PetscFree(q));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteParticles(MpmOutput *output, const char group[], const MpmMarch *march)
{
  char place[80];

  PetscFunctionBegin;
  (void)snprintf(place, sizeof place, "%s/particles", group);
  PetscCall(WriteCoordinates(output, place, march));
  for (PetscInt f = 0; output->scene->scheme.table->fields[f]; f++) {
    const char      *name = output->scene->scheme.table->fields[f];
    const PetscReal *q;

    PetscCall(MpmParticlesGet(march->particles, name, &q));
    PetscCall(SetById(march, 1, q, output->by_id));
    PetscCall(MpmParticlesRestore(march->particles, name, &q));
    PetscCall(VecScale(output->by_id, UnitOf(march, f)));
    PetscCall(WriteVector(output, output->by_id, 0, NULL, place, name));
  }
  PetscCall(WriteProperties(output, place, march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the vector by_number from a local array of this rank's nodes, in true size. */
static PetscErrorCode SetByNumber(const MpmMarch *march, PetscReal unit, const PetscReal local[], Vec by_number)
{
  const MpmGrid   *grid = march->grid;
  const MpmGridBox box  = MpmGridBoxOf(grid, 0);
  const PetscInt   nx   = box.hi[0];
  PetscReal       *values;
  PetscInt        *number;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(nx, &values, nx, &number));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscInt from = MpmGridRow(grid, &box, r), y = r % box.hi[1], z = r / box.hi[1];
    PetscInt       to = grid->axis[0].first;

    if (grid->dim > 1) to += march->layout->grid[0].nodes * (grid->axis[1].first + y);
    if (grid->dim > 2) to += march->layout->grid[0].nodes * march->layout->grid[1].nodes * (grid->axis[2].first + z);
    for (PetscInt i = 0; i < nx; i++) {
      values[i] = unit * local[from + i];
      number[i] = to + i;
    }
    PetscCall(VecSetValues(by_number, nx, number, values, INSERT_VALUES));
  }
  PetscCall(PetscFree2(values, number));
  PetscCall(VecAssemblyBegin(by_number));
  PetscCall(VecAssemblyEnd(by_number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNodes(MpmOutput *output, const char group[], MpmMarch *march)
{
  const MpmLayout *layout = march->layout;
  PetscInt         row[MPM_MAX_DIM];
  char             place[80];

  PetscFunctionBegin;
  (void)snprintf(place, sizeof place, "%s/nodes", group);
  for (PetscInt a = 0; a + 1 < layout->dim; a++) row[a] = layout->grid[layout->dim - 2 - a].nodes; /* x is the last */
  for (PetscInt f = 0; output->scene->scheme.table->fields[f]; f++) {
    PetscReal *local;

    PetscCall(MpmMarchProject(march, f, march->particles->step, NULL, output->local));
    PetscCall(MpmGridGetArray(march->grid, output->local, &local));
    PetscCall(SetByNumber(march, UnitOf(march, f), local, output->by_number));
    PetscCall(MpmGridRestoreArray(march->grid, output->local, &local));
    PetscCall(
        WriteVector(output, output->by_number, layout->dim - 1, row, place, output->scene->scheme.table->fields[f]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void NameGroup(PetscInt64 step, size_t room, char group[])
{
  (void)snprintf(group, room, "/step_%010" PetscInt64_FMT, step);
}

PetscErrorCode MpmOutputHasStep(const MpmRequest *request, PetscInt64 step, PetscBool *has)
{
  char group[64];

  PetscFunctionBegin;
  *has = PETSC_FALSE;
  NameGroup(step, sizeof group, group);
  if (MpmRankOf(PETSC_COMM_WORLD) == 0 && !access(request->output, R_OK) && !access(request->xmf, R_OK)) {
    PetscBool failed;
    MpmHdf5   file;

    PetscCall(MpmHdf5Open(PETSC_COMM_SELF, request->output, &file));
    *has = MpmHdf5Has(&file, group);
    PetscCall(MpmHdf5Close(&file, &failed));
  }
  PetscCallMPI(MPI_Bcast(has, 1, MPIU_BOOL, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOutputStep(MpmOutput *output, MpmMarch *march)
{
  const PetscReal time = MpmMarchTime(march, march->step), step = (PetscReal)march->step;
  const char     *slash = strrchr(output->file.path, '/');
  char            group[64];

  PetscFunctionBegin;
  NameGroup(march->step, sizeof group, group);
  PetscCall(WriteParticles(output, group, march));
  PetscCall(WriteNodes(output, group, march));
  MpmHdf5WriteReal(&output->file.hdf5, group, "time", time);
  MpmHdf5WriteReal(&output->file.hdf5, group, "step", step);
  PetscCall(MpmDataFileCheck(&output->file));
  if (output->xmf.stream)
    DescribeStep(output->xmf.stream, output->scene, slash ? slash + 1 : output->file.path, group, time);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOutputDestroy(PetscBool keep, MpmOutput **output)
{
  MpmOutput *o = *output;

  PetscFunctionBegin;
  if (keep) {
    PetscCall(MpmDataFileClose(&o->file));
    if (o->xmf.stream) fprintf(o->xmf.stream, "</Grid>\n</Domain>\n</Xdmf>\n");
    PetscCall(MpmTextFileClose(&o->xmf));
  } else {
    PetscCall(MpmDataFileDrop(&o->file));
    MpmTextFileDrop(&o->xmf);
  }
  PetscCall(VecDestroy(&o->by_id));
  PetscCall(VecDestroy(&o->coordinates));
  PetscCall(VecDestroy(&o->local));
  PetscCall(VecDestroy(&o->by_number));
  PetscCall(PetscFree(*output));
  PetscFunctionReturn(PETSC_SUCCESS);
}
