/* Writes particle and node fields as HDF5, in the order of global ids, and an XDMF file that describes them. */
#include "io/datafile.h"
#include "io/output.h"
#include "base/textfile.h"
#include <math.h>
#include <string.h>
#include <unistd.h>

struct MpmOutput_ {
  const MpmScene *scene;
  MpmDataFile     file;
  Vec             by_id, coordinates, local, global;
  MpmTextFile     xmf;
};

PetscErrorCode MpmOutputCreate(const MpmMarch *march, const MpmRequest *request, MpmOutput **output)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)march->grid->da);
  const PetscInt n    = (PetscInt)march->layout->particles;
  MpmOutput     *o;

  PetscFunctionBegin;
  PetscCall(PetscNew(output));
  o        = *output;
  o->scene = march->scene;
  PetscCall(VecCreateMPI(comm, PETSC_DECIDE, n, &o->by_id));
  PetscCall(VecCreate(comm, &o->coordinates));
  PetscCall(VecSetBlockSize(o->coordinates, 3));
  PetscCall(VecSetSizes(o->coordinates, PETSC_DECIDE, 3 * n));
  PetscCall(VecSetType(o->coordinates, VECSTANDARD));
  PetscCall(DMCreateLocalVector(march->grid->da, &o->local));
  PetscCall(VecCreateMPI(comm, march->grid->axis[0].nodes, march->layout->grid[0].nodes, &o->global));
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

/* Writes a vector as PLACE/NAME of the file, each block as a row. */
static PetscErrorCode WriteVector(MpmOutput *output, Vec vector, const char place[], const char name[])
{
  const PetscReal *values;
  PetscInt         n, columns;
  char             path[128];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(path, sizeof path, "%s/%s", place, name));
  PetscCall(VecGetLocalSize(vector, &n));
  PetscCall(VecGetBlockSize(vector, &columns));
  PetscCall(VecGetArrayRead(vector, &values));
  PetscCall(MpmHdf5Write(&output->file.hdf5, path, H5T_NATIVE_DOUBLE, n / columns, columns, values));
  PetscCall(VecRestoreArrayRead(vector, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteCoordinates(MpmOutput *output, const char place[], const MpmMarch *march)
{
  const MpmParticles *particles = march->particles;
  const PetscReal    *xi;
  const PetscInt     *cell;
  PetscReal          *x;
  PetscInt            whole, zero = 0;
  PetscReal           part;

  PetscFunctionBegin;
  PetscCall(MpmParticlesWhere(particles, 0, particles->step, &whole, &part));
  PetscCall(MpmParticlesGet(particles, MpmFieldCell[0], &cell));
  PetscCall(MpmParticlesGet(particles, MpmFieldXi[0], &xi));
  PetscCall(PetscCalloc1(3 * particles->count, &x));
  for (PetscInt p = 0; p < particles->count; p++) {
    PetscInt  now;
    PetscReal place;

    MpmPlaceBlock(1, &zero, &xi[p], 0, part, &now, &place);
    now = (PetscInt)(((PetscInt64)march->grid->axis[0].first + cell[p] + whole + now) % march->grid->axis[0].cells);
    x[3 * p] = output->scene->cell_width * ((now < 0 ? now + march->grid->axis[0].cells : now) + place);
  }
  PetscCall(SetById(march, 3, x, output->coordinates));
  PetscCall(PetscFree(x));
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi[0], &xi));
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell[0], &cell));
  PetscCall(WriteVector(output, output->coordinates, place, "coordinates"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteParticles(MpmOutput *output, const char group[], const MpmMarch *march)
{
  char place[80];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(place, sizeof place, "%s/particles", group));
  PetscCall(WriteCoordinates(output, place, march));
  for (PetscInt f = 0; output->scene->scheme.table->fields[f]; f++) {
    const char      *name = output->scene->scheme.table->fields[f];
    const PetscReal *q;

    PetscCall(MpmParticlesGet(march->particles, name, &q));
    PetscCall(SetById(march, 1, q, output->by_id));
    PetscCall(MpmParticlesRestore(march->particles, name, &q));
    PetscCall(VecScale(output->by_id, scalbn(1, (int)march->exponent)));
    PetscCall(WriteVector(output, output->by_id, place, name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNodes(MpmOutput *output, const char group[], MpmMarch *march)
{
  char place[80];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(place, sizeof place, "%s/nodes", group));
  for (PetscInt f = 0; output->scene->scheme.table->fields[f]; f++) {
    PetscReal *from, *to;

    PetscCall(MpmMarchProject(march, f, output->local));
    PetscCall(MpmGridGetArray(march->grid, output->local, &from));
    PetscCall(VecGetArray(output->global, &to));
    for (PetscInt i = 0; i < march->grid->axis[0].nodes; i++) to[i] = scalbn(from[i], (int)march->exponent);
    PetscCall(VecRestoreArray(output->global, &to));
    PetscCall(MpmGridRestoreArray(march->grid, output->local, &from));
    PetscCall(WriteVector(output, output->global, place, output->scene->scheme.table->fields[f]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Describes one particle or node field, stored in the HDF5 file, as an XDMF attribute. */
static void DescribeField(FILE *xmf, const char file[], const char group[], const char place[], const char name[],
                          const char dimensions[])
{
  fprintf(xmf,
          "<Attribute Name=\"%s\" AttributeType=\"Scalar\" Center=\"Node\">"
          "<DataItem Dimensions=\"%s\" NumberType=\"Float\" Precision=\"8\" Format=\"HDF\">%s:%s/%s/%s</DataItem>"
          "</Attribute>\n",
          name, dimensions, file, group, place, name);
}

static void DescribeStep(const MpmOutput *output, FILE *xmf, const char group[], PetscReal time)
{
  const MpmScene *s     = output->scene;
  const char     *slash = strrchr(output->file.path, '/'), *file = slash ? slash + 1 : output->file.path;
  char            particles[32], nodes[32];

  snprintf(particles, sizeof particles, "%" PetscInt64_FMT, s->layout.particles);
  snprintf(nodes, sizeof nodes, "1 1 %" PetscInt_FMT, s->layout.grid[0].nodes);
  fprintf(xmf,
          "<Grid Name=\"step\" GridType=\"Collection\" CollectionType=\"Spatial\">\n<Time Value=\"%.17g\"/>\n"
          "<Grid Name=\"particles\" GridType=\"Uniform\">\n"
          "<Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%s\"/>\n"
          "<Geometry GeometryType=\"XYZ\"><DataItem Dimensions=\"%s 3\" NumberType=\"Float\" Precision=\"8\" "
          "Format=\"HDF\">%s:%s/particles/coordinates</DataItem></Geometry>\n",
          time, particles, particles, file, group);
  for (PetscInt f = 0; s->scheme.table->fields[f]; f++)
    DescribeField(xmf, file, group, "particles", s->scheme.table->fields[f], particles);
  fprintf(xmf,
          "</Grid>\n<Grid Name=\"nodes\" GridType=\"Uniform\">\n"
          "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"%s\"/>\n"
          "<Geometry GeometryType=\"ORIGIN_DXDYDZ\"><DataItem Dimensions=\"3\" Format=\"XML\">0 0 0</DataItem>"
          "<DataItem Dimensions=\"3\" Format=\"XML\">1 1 %.17g</DataItem></Geometry>\n",
          nodes, s->cell_width);
  for (PetscInt f = 0; s->scheme.table->fields[f]; f++)
    DescribeField(xmf, file, group, "nodes", s->scheme.table->fields[f], nodes);
  fprintf(xmf, "</Grid>\n</Grid>\n");
}

static PetscErrorCode NameGroup(PetscInt64 step, size_t room, char group[])
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(group, room, "/step_%010" PetscInt64_FMT, step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOutputHasStep(const MpmRequest *request, PetscInt64 step, PetscBool *has)
{
  PetscMPIInt rank;
  char        group[64];

  PetscFunctionBegin;
  *has = PETSC_FALSE;
  PetscCall(NameGroup(step, sizeof group, group));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0 && !access(request->output, R_OK) && !access(request->xmf, R_OK)) {
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
  const PetscReal time = march->step * march->scene->dt, step = (PetscReal)march->step;
  char            group[64];

  PetscFunctionBegin;
  PetscCall(NameGroup(march->step, sizeof group, group));
  PetscCall(WriteParticles(output, group, march));
  PetscCall(WriteNodes(output, group, march));
  PetscCall(MpmHdf5WriteReal(&output->file.hdf5, group, "time", time));
  PetscCall(MpmHdf5WriteReal(&output->file.hdf5, group, "step", step));
  PetscCall(MpmDataFileCheck(&output->file));
  if (output->xmf.stream) DescribeStep(output, output->xmf.stream, group, time);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode NameFiles(MpmOutput *o)
{
  PetscFunctionBegin;
  PetscCall(MpmDataFileClose(&o->file));
  if (o->xmf.stream) fprintf(o->xmf.stream, "</Grid>\n</Domain>\n</Xdmf>\n");
  PetscCall(MpmTextFileClose(&o->xmf));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOutputDestroy(PetscBool keep, MpmOutput **output)
{
  MpmOutput *o = *output;

  PetscFunctionBegin;
  if (keep)
    PetscCall(NameFiles(o));
  else {
    PetscCall(MpmDataFileDrop(&o->file));
    MpmTextFileDrop(&o->xmf);
  }
  PetscCall(VecDestroy(&o->by_id));
  PetscCall(VecDestroy(&o->coordinates));
  PetscCall(VecDestroy(&o->local));
  PetscCall(VecDestroy(&o->global));
  PetscCall(PetscFree(*output));
  PetscFunctionReturn(PETSC_SUCCESS);
}
