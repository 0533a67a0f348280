/*
   XDMF for ParaView: particles are points, nodes are a uniform grid. A 2DCoRectMesh has its extents in the order y x, a
   3DCoRectMesh in the order z y x. In one dimension points have three coordinates, and nodes are a 3DCoRectMesh.
*/
#include "io/xdmf.h"

/* One set of fields: where it is, and its extents as text. */
typedef struct {
  FILE           *xmf;
  const MpmScene *scene;
  const char     *file, *group, *place;
  char            extents[64];
} Fields;

void MpmXdmfBegin(FILE *xmf)
{
  fprintf(xmf, "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
               "<Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n");
}

void MpmXdmfEnd(FILE *xmf)
{
  fprintf(xmf, "</Grid>\n</Domain>\n</Xdmf>\n");
}

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

void MpmXdmfStep(FILE *xmf, const MpmScene *scene, const char file[], const char group[], PetscReal time)
{
  Fields fields = {.xmf = xmf, .scene = scene, .file = file, .group = group};

  fprintf(xmf, "<Grid Name=\"step\" GridType=\"Collection\" CollectionType=\"Spatial\">\n<Time Value=\"%.17g\"/>\n",
          time);
  Particles(&fields);
  if (scene->scheme.basis->spline_ends != MPM_SPLINES_OPEN) Nodes(&fields);
  fprintf(xmf, "</Grid>\n");
}
