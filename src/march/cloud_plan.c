/* Compiles a pass for clouds: sorts the node fields into bundles, and the maps by bundle, product and lane. */
#include "march/clouds.h"

/* A node field that is summed or read, and a bit for each number of a kind of weights that some map of it has. */
typedef struct {
  PetscInt  node;
  PetscBool sums;
  unsigned  kinds;
} Field;

/* The bundle of a node field that is summed or read, and its lane there. */
static PetscInt Find(const MpmCloudPlan *plan, PetscInt node, PetscBool sums, PetscInt *lane)
{
  PetscInt b = 0;

  for (; b < plan->nbundles; b++) {
    const MpmCloudBundle *bundle = &plan->bundle[b];

    if (bundle->sums != sums) continue;
    for (*lane = 0; *lane < bundle->n; ++*lane)
      if (bundle->node[*lane] == node) return b;
  }
  return b;
}

/* The number of a kind of weights in a row plan, where phi_ip is 0. */
static PetscInt Number(const MpmRowPlan *rows, MpmOpKind kind)
{
  PetscInt number = 0;

  while (rows->kind[number] != kind) number++;
  return number;
}

/* The number of a kind among those of a part, where phi_ip is 0. */
static PetscInt KindOf(MpmCloudPart *part, PetscInt number)
{
  if (number == 0) return 0;
  for (PetscInt k = 0; k < part->nkinds; k++)
    if (part->kind[k] == number) return k + 1;
  part->kind[part->nkinds++] = number;
  return part->nkinds;
}

static PetscBool Precedes(const MpmCloudMap *a, const MpmCloudMap *b)
{
  return a->product < b->product || (a->product == b->product && a->lane < b->lane) ? PETSC_TRUE : PETSC_FALSE;
}

/* Adds a map to the part of its bundle, behind those that do not come after it. */
static void Insert(MpmCloudPlan *plan, MpmCloudPart *part, MpmCloudMap map)
{
  PetscInt i = part->end++;

  for (; i > part->begin && Precedes(&map, &plan->map[i - 1]); i--) plan->map[i] = plan->map[i - 1];
  plan->map[i] = map;
  plan->nmaps++;
}

/* The numbers of the kinds of a map's weights along the directions. Returns along how many of them it acts. */
static PetscInt KindsOf(const MpmRowPlan *rows, const MpmRowLine *l, const MpmRowMap *m, PetscInt kind[])
{
  kind[0] = Number(rows, m->weights);
  kind[1] = Number(rows, rows->across[l->across].y);
  kind[2] = Number(rows, rows->across[l->across].z);
  return (kind[0] > 0) + (kind[1] > 0) + (kind[2] > 0);
}

/* Finds the node fields of a plan, and the kinds of each. Those with most kinds come first, and equal ones together. */
static PetscInt FieldsOf(const MpmRowPlan *rows, Field field[])
{
  PetscInt n = 0;

  for (const MpmRowStep *step = rows->step; step < rows->step + rows->nsteps; step++)
    for (const MpmRowLine *l = rows->line + step->begin; l < rows->line + step->end; l++) {
      const PetscBool sums = step->kind == MPM_ROW_SPREAD ? PETSC_TRUE : PETSC_FALSE;
      PetscInt        f    = 0;

      while (f < n && (field[f].node != l->node || field[f].sums != sums)) f++;
      if (f == n) field[n++] = (Field){.node = l->node, .sums = sums};
      for (const MpmRowMap *m = rows->map + l->begin; m < rows->map + l->end; m++) {
        PetscInt kind[MPM_MAX_DIM];

        if (KindsOf(rows, l, m, kind) < 2) field[f].kinds |= (1U << (kind[0] + kind[1] + kind[2])) & ~1U;
      }
    }
  for (PetscInt f = 1; f < n; f++) {
    const Field moved = field[f];
    PetscInt    i     = f;

    for (; i > 0 && field[i - 1].kinds < moved.kinds; i--) field[i] = field[i - 1];
    field[i] = moved;
  }
  return n;
}

/*
   Sorts the node fields that are summed, or those that are read, into bundles. A map of a bundle works on all kinds of
   its fields. So fields of the same kinds come together, and with others only if all of them fit.
*/
static void FillBundles(const Field field[], PetscInt nfields, PetscBool sums, MpmCloudPlan *plan)
{
  const PetscInt  most   = MpmBundleWidth(MPM_BUNDLE);
  MpmCloudBundle *bundle = NULL;
  unsigned        kinds  = 0; /* of the field before */

  for (PetscInt f = 0; f < nfields; f++) {
    PetscInt alike = 0;

    if (field[f].sums != sums) continue;
    for (PetscInt i = f; i < nfields; i++) alike += field[i].sums == sums && field[i].kinds == field[f].kinds;
    if (!bundle || bundle->n == most || (field[f].kinds != kinds && bundle->n + alike > most)) {
      bundle  = &plan->bundle[plan->nbundles++];
      *bundle = (MpmCloudBundle){.sums = sums};
    }
    bundle->node[bundle->n++] = field[f].node;
    kinds                     = field[f].kinds;
  }
}

/* Adds a map along at most one axis to a part, if its kind is of the part's share. */
static void AddMap(MpmCloudPlan *plan, MpmCloudPart *part, const PetscInt number[], PetscInt share, PetscInt dim,
                   PetscInt lane, const MpmRowMap *m)
{
  const PetscInt axis = number[2] ? 2 : number[1] ? 1 : 0;
  PetscInt       kind;

  if (PetscMax(number[axis] - 1, 0) / MPM_BUNDLE_KINDS != share) return;
  kind = KindOf(part, number[axis]);
  Insert(plan, part,
         (MpmCloudMap){.product  = kind ? MPM_PRODUCTS(dim, kind - 1) + axis : 0,
                       .lane     = lane,
                       .particle = m->particle,
                       .a        = m->a,
                       .weight   = m->weight});
}

/*
   Makes a part of a step, of one bundle and the share of the kinds that one map can have. Every kind has products of its
   own, in all directions.
*/
static void AddPart(const MpmRowPlan *rows, const MpmRowStep *step, PetscInt bundle, PetscInt share, PetscInt dim,
                    MpmCloudPlan *plan)
{
  const PetscBool spreads = step->kind == MPM_ROW_SPREAD ? PETSC_TRUE : PETSC_FALSE;
  MpmCloudPart   *part    = &plan->part[plan->nparts];

  *part = (MpmCloudPart){.bundle = bundle, .begin = plan->nmaps, .end = plan->nmaps, .first_cross = plan->ncrosses};
  for (const MpmRowLine *l = rows->line + step->begin; l < rows->line + step->end; l++) {
    PetscInt lane = 0;

    if (Find(plan, l->node, spreads, &lane) != bundle) continue;
    for (const MpmRowMap *m = rows->map + l->begin; m < rows->map + l->end; m++) {
      MpmCloudCross cross = {.lane = lane, .particle = m->particle, .a = m->a, .weight = m->weight};

      if (KindsOf(rows, l, m, cross.kind) < 2)
        AddMap(plan, part, cross.kind, share, dim, lane, m);
      else if (share == 0)
        plan->cross[plan->ncrosses++] = cross;
    }
  }
  part->end_cross = plan->ncrosses;
  if (part->end > part->begin || part->end_cross > part->first_cross) plan->nparts++;
}

void MpmCloudPlanCompile(const MpmRowPlan *rows, const MpmBasis *basis, PetscInt dim, MpmCloudPlan *plan)
{
  Field          field[2 * (MPM_MAX_FIELDS + 1)];
  const PetscInt nfields = FieldsOf(rows, field);

  *plan = (MpmCloudPlan){.nparts = 0};
  FillBundles(field, nfields, PETSC_FALSE, plan);
  FillBundles(field, nfields, PETSC_TRUE, plan);
  for (PetscInt b = 0; b < plan->nbundles; b++) {
    plan->bundle[b].width = MpmBundleWidth(plan->bundle[b].n);
    plan->bundle[b].begin = plan->width;
    plan->width += plan->bundle[b].width;
  }
  for (PetscInt s = 0; s < rows->nsteps; s++) {
    const MpmRowStep *step = &rows->step[s];

    plan->first[s] = plan->nparts;
    for (PetscInt b = 0; b < plan->nbundles && step->begin < step->end; b++)
      for (PetscInt share = 0; share <= rows->nkinds / MPM_BUNDLE_KINDS; share++)
        AddPart(rows, step, b, share, dim, plan);
    for (MpmCloudPart *part = plan->part + plan->first[s]; part < plan->part + plan->nparts; part++) {
      const PetscInt width = plan->bundle[part->bundle].width;

      part->run   = MpmBundleMapFind(plan->bundle[part->bundle].sums, dim, basis->nodes, part->nkinds, width);
      part->given = plan->given;
      if (step->kind == MPM_ROW_SPREAD) plan->given += width * MPM_CLOUD * MPM_PRODUCTS(dim, part->nkinds);
    }
  }
  plan->first[rows->nsteps] = plan->nparts;
}
