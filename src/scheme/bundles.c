/*
   The maps of a bundle. The numbers of directions, of nodes, of kinds and of fields are constants in each loop, so that
   the values of a node are one register and the sums stay in registers. Bases of 1 node or of more than 4 have loops
   that read these numbers from the cloud. Without AVX-512 a bundle has at most four fields: no register holds eight,
   and GCC would then keep them in memory.
*/
#include "scheme/bundles.h"

#define INLINE static inline __attribute__((always_inline))
#define MOST_KINDS (1 + MPM_BUNDLE_KINDS)

/* The values of a bundle at a node. They are aligned as single numbers are. */
typedef PetscReal Four __attribute__((vector_size(4 * sizeof(PetscReal)), aligned(sizeof(PetscReal)), may_alias));
#ifdef __AVX512F__
#define HAS_EIGHT /* a register holds eight numbers */
typedef PetscReal Eight __attribute__((vector_size(8 * sizeof(PetscReal)), aligned(sizeof(PetscReal)), may_alias));
#endif

/* The weights of particle p along x and y, each in all lanes of a register: every plane of nodes uses them again. */
#define LOAD(Values)                                                                                                   \
  for (int k = 0; k <= kinds; k++)                                                                                     \
    for (int d = 0; d < nodes; d++) {                                                                                  \
      wx[k][d] = cloud->weight[0][k][d * MPM_CLOUD + p] - (Values){0};                                                 \
      wy[k][d] = cloud->weight[1][k][d * MPM_CLOUD + p] - (Values){0};                                                 \
    }

/*
   First along x, then y, then z. row[k]: of a row of nodes, with kind k along x. plane[0]: of a plane, with phi_ip
   along x and y; plane[2 k - 1] and plane[2 k]: with kind k along x, along y.
*/
#define DEFINE_GATHER(Values)                                                                                          \
  INLINE void Gather##Values(const int dim, const int nodes, const int kinds, const MpmCloud *cloud,                   \
                             const PetscReal *restrict node, PetscReal *restrict product)                              \
  {                                                                                                                    \
    const Values  *at = (const Values *)node;                                                                          \
    Values        *to = (Values *)product;                                                                             \
    const PetscInt sy = cloud->stride[1], sz = dim > 2 ? cloud->stride[2] : 0;                                         \
                                                                                                                       \
    for (PetscInt p = 0; p < cloud->n; p++) {                                                                          \
      const Values *first = at + cloud->first[p];                                                                      \
      Values        sum[MPM_MOST_PRODUCTS], wx[MOST_KINDS][MPM_MOST_NODES], wy[MOST_KINDS][MPM_MOST_NODES];            \
                                                                                                                       \
      LOAD(Values)                                                                                                     \
      for (int c = 0; c < MPM_PRODUCTS(dim, kinds); c++) sum[c] = (Values){0};                                         \
      for (int z = 0; z < (dim > 2 ? nodes : 1); z++) {                                                                \
        Values plane[1 + 2 * MPM_BUNDLE_KINDS];                                                                        \
                                                                                                                       \
        for (int c = 0; c < 1 + 2 * kinds; c++) plane[c] = (Values){0};                                                \
        for (int y = 0; y < nodes; y++) {                                                                              \
          const Values *line = first + y * sy + z * sz;                                                                \
          Values        row[MOST_KINDS];                                                                               \
                                                                                                                       \
          for (int k = 0; k <= kinds; k++) row[k] = wx[k][0] * line[0];                                                \
          for (int x = 1; x < nodes; x++)                                                                              \
            for (int k = 0; k <= kinds; k++) row[k] += wx[k][x] * line[x];                                             \
          plane[0] += wy[0][y] * row[0];                                                                               \
          for (int k = 1; k <= kinds; k++) {                                                                           \
            plane[2 * k - 1] += wy[0][y] * row[k];                                                                     \
            plane[2 * k] += wy[k][y] * row[0];                                                                         \
          }                                                                                                            \
        }                                                                                                              \
        if (dim == 2) {                                                                                                \
          for (int c = 0; c < 1 + 2 * kinds; c++) sum[c] = plane[c];                                                   \
          continue;                                                                                                    \
        }                                                                                                              \
        sum[0] += cloud->weight[2][0][z * MPM_CLOUD + p] * plane[0];                                                   \
        for (int k = 1; k <= kinds; k++) {                                                                             \
          sum[3 * k - 2] += cloud->weight[2][0][z * MPM_CLOUD + p] * plane[2 * k - 1];                                 \
          sum[3 * k - 1] += cloud->weight[2][0][z * MPM_CLOUD + p] * plane[2 * k];                                     \
          sum[3 * k] += cloud->weight[2][k][z * MPM_CLOUD + p] * plane[0];                                             \
        }                                                                                                              \
      }                                                                                                                \
      for (int c = 0; c < MPM_PRODUCTS(dim, kinds); c++) to[MPM_CLOUD * c + p] = sum[c];                               \
    }                                                                                                                  \
  }

/* The same sums in the opposite order: what a particle gives to a plane, to a row and to a node. */
#define DEFINE_SPREAD(Values)                                                                                          \
  INLINE void Spread##Values(const int dim, const int nodes, const int kinds, const MpmCloud *cloud,                   \
                             PetscReal *restrict node, const PetscReal *restrict product)                              \
  {                                                                                                                    \
    Values        *at   = (Values *)node;                                                                              \
    const Values  *from = (const Values *)product;                                                                     \
    const PetscInt sy = cloud->stride[1], sz = dim > 2 ? cloud->stride[2] : 0;                                         \
                                                                                                                       \
    for (PetscInt p = 0; p < cloud->n; p++) {                                                                          \
      Values *first = at + cloud->first[p];                                                                            \
      Values  given[MPM_MOST_PRODUCTS], wx[MOST_KINDS][MPM_MOST_NODES], wy[MOST_KINDS][MPM_MOST_NODES];                \
                                                                                                                       \
      LOAD(Values)                                                                                                     \
      for (int c = 0; c < MPM_PRODUCTS(dim, kinds); c++) given[c] = from[MPM_CLOUD * c + p];                           \
      for (int z = 0; z < (dim > 2 ? nodes : 1); z++) {                                                                \
        Values plane[1 + 2 * MPM_BUNDLE_KINDS];                                                                        \
                                                                                                                       \
        if (dim == 2)                                                                                                  \
          for (int c = 0; c < 1 + 2 * kinds; c++) plane[c] = given[c];                                                 \
        else {                                                                                                         \
          plane[0] = cloud->weight[2][0][z * MPM_CLOUD + p] * given[0];                                                \
          for (int k = 1; k <= kinds; k++) {                                                                           \
            plane[0] += cloud->weight[2][k][z * MPM_CLOUD + p] * given[3 * k];                                         \
            plane[2 * k - 1] = cloud->weight[2][0][z * MPM_CLOUD + p] * given[3 * k - 2];                              \
            plane[2 * k]     = cloud->weight[2][0][z * MPM_CLOUD + p] * given[3 * k - 1];                              \
          }                                                                                                            \
        }                                                                                                              \
        for (int y = 0; y < nodes; y++) {                                                                              \
          Values *line = first + y * sy + z * sz;                                                                      \
          Values  row[MOST_KINDS];                                                                                     \
                                                                                                                       \
          row[0] = wy[0][y] * plane[0];                                                                                \
          for (int k = 1; k <= kinds; k++) {                                                                           \
            row[0] += wy[k][y] * plane[2 * k];                                                                         \
            row[k] = wy[0][y] * plane[2 * k - 1];                                                                      \
          }                                                                                                            \
          for (int x = 0; x < nodes; x++) {                                                                            \
            Values value = line[x];                                                                                    \
                                                                                                                       \
            for (int k = 0; k <= kinds; k++) value += wx[k][x] * row[k];                                               \
            line[x] = value;                                                                                           \
          }                                                                                                            \
        }                                                                                                              \
      }                                                                                                                \
    }                                                                                                                  \
  }

DEFINE_GATHER(Four)
DEFINE_SPREAD(Four)

/* One function for each number of directions, of nodes, of kinds and of fields. */
#define DEFINE(way, Values, dim, nodes, kinds)                                                                         \
  static void way##Values##dim##nodes##kinds(const MpmCloud *cloud, PetscReal node[], PetscReal product[])             \
  {                                                                                                                    \
    way##Values(dim, nodes, kinds, cloud, node, product);                                                              \
  }
#define DEFINE_KINDS(way, Values, dim, nodes)                                                                          \
  DEFINE(way, Values, dim, nodes, 0)                                                                                   \
  DEFINE(way, Values, dim, nodes, 1)                                                                                   \
  DEFINE(way, Values, dim, nodes, 2)                                                                                   \
  DEFINE(way, Values, dim, nodes, 3)
#define DEFINE_ALL(way, Values)                                                                                        \
  static void way##Values##Any(const MpmCloud *cloud, PetscReal node[], PetscReal product[])                           \
  {                                                                                                                    \
    const int dim = (int)cloud->dim, nodes = (int)cloud->nodes, kinds = (int)cloud->kinds;                             \
                                                                                                                       \
    if (nodes > 0 && kinds >= 0) way##Values(dim, nodes, kinds, cloud, node, product); /* as the compiler must know */ \
  }                                                                                                                    \
  DEFINE_KINDS(way, Values, 2, 2)                                                                                      \
  DEFINE_KINDS(way, Values, 2, 3)                                                                                      \
  DEFINE_KINDS(way, Values, 2, 4)                                                                                      \
  DEFINE_KINDS(way, Values, 3, 2)                                                                                      \
  DEFINE_KINDS(way, Values, 3, 3)                                                                                      \
  DEFINE_KINDS(way, Values, 3, 4)
DEFINE_ALL(Gather, Four)
DEFINE_ALL(Spread, Four)
#ifdef HAS_EIGHT
DEFINE_GATHER(Eight)
DEFINE_SPREAD(Eight)
DEFINE_ALL(Gather, Eight)
DEFINE_ALL(Spread, Eight)
#endif

#define KINDS(way, Values, dim, nodes)                                                                                 \
  {                                                                                                                    \
    way##Values##dim##nodes##0, way##Values##dim##nodes##1, way##Values##dim##nodes##2, way##Values##dim##nodes##3     \
  }
#define ALL(way, Values)                                                                                               \
  {                                                                                                                    \
    {KINDS(way, Values, 2, 2), KINDS(way, Values, 2, 3), KINDS(way, Values, 2, 4)},                                    \
        {KINDS(way, Values, 3, 2), KINDS(way, Values, 3, 3), KINDS(way, Values, 3, 4)},                                \
  }
typedef MpmBundleMap Maps[2][3][1 + MPM_BUNDLE_KINDS];

PetscInt MpmBundleWidth(PetscInt fields)
{
#ifdef HAS_EIGHT
  if (fields > 4) return 8;
#endif
  (void)fields;
  return 4;
}

MpmBundleMap MpmBundleMapFind(PetscBool to_nodes, PetscInt dim, PetscInt nodes, PetscInt kinds, PetscInt width)
{
  static const Maps four[2] = {ALL(Gather, Four), ALL(Spread, Four)};
#ifdef HAS_EIGHT
  static const Maps eight[2] = {ALL(Gather, Eight), ALL(Spread, Eight)};

  if (width > 4 && (nodes < 2 || nodes > 4)) return to_nodes ? SpreadEightAny : GatherEightAny;
  if (width > 4) return eight[to_nodes ? 1 : 0][dim - 2][nodes - 2][kinds];
#endif
  (void)width;
  if (nodes < 2 || nodes > 4) return to_nodes ? SpreadFourAny : GatherFourAny;
  return four[to_nodes ? 1 : 0][dim - 2][nodes - 2][kinds];
}
