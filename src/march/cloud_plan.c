/* Compiles a pass for clouds: sorts the node fields into bundles, and the maps by bundle, product and lane. */
#include "march/clouds.h"

/* The bundle of a node field that is summed or read, and its lane there. The last bundle grows while it has room. */
static PetscInt Place(MpmCloudPlan *plan, PetscInt node, PetscBool sums, PetscInt *lane)
{
  PetscInt last = MPM_NONE;

  for (PetscInt b = 0; b < plan->nbundles; b++) {
    const MpmCloudBundle *bundle = &plan->bundle[b];

    if (bundle->sums != sums) continue;
    last = b;
    for (*lane = 0; *lane < bundle->n; ++*lane)
      if (bundle->node[*lane] == node) return b;
  }
  if (last == MPM_NONE || plan->bundle[last].n == MPM_BUNDLE) {
    last               = plan->nbundles++;
    plan->bundle[last] = (MpmCloudBundle){.sums = sums};
  }
  *lane                          = plan->bundle[last].n++;
  plan->bundle[last].node[*lane] = node;
  return last;
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
    PetscInt lane;

    if (Place(plan, l->node, spreads, &lane) != bundle) continue;
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
  PetscInt lane;

  *plan = (MpmCloudPlan){.nparts = 0};
  for (const MpmRowStep *step = rows->step; step < rows->step + rows->nsteps; step++)
    for (PetscInt l = step->begin; l < step->end; l++)
      (void)Place(plan, rows->line[l].node, step->kind == MPM_ROW_SPREAD ? PETSC_TRUE : PETSC_FALSE, &lane);
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
    for (MpmCloudPart *part = plan->part + plan->first[s]; part < plan->part + plan->nparts; part++)
      part->run = MpmBundleMapFind(plan->bundle[part->bundle].sums, dim, basis->nodes, PetscMax(part->nkinds, 1),
                                   plan->bundle[part->bundle].width);
  }
  plan->first[rows->nsteps] = plan->nparts;
}
