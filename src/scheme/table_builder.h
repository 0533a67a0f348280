/*
   What MpmTableCreate needs while it makes a table, and the parts of its work that have files of their own: registers
   (table_registers.c), walls (table_walls.c), operations of finite deformation (table_finite.c). The rest is in
   table.c.
*/
#pragma once
#include <mpmstab/table.h>

#define MPM_MAX_MOVED 4 /* node fields whose sum is the velocity that particles move with, at most */

/*S
   MpmTableBuilder - a table in the making.

   particle, node  - particle[f] and node[n]: the first registers of the formulation's fields. Stresses at finite
                     deformation share some scratch.
   kept            - kept[n]: the node register with the values of node register n from before the wall, or MPM_NONE
   sharp, sharp_at - sharp[n]: the node register that particles take instead of node register n, as it was when the
                     table had sharp_at[n] operations

   trial           - the first of the node registers for a velocity that colliders act on, or MPM_NONE
   lost, lost_by   - the same for the velocity before they did, or what it has lost; and the particle field that is to
                     get this, MPM_NONE where none is

   At finite deformation besides:

   stretched       - stretched[f]: the first register of the stretch that stress f is the stress of
   moved, nmoved   - the node fields whose sum is the velocity that particles move with, and the lines MOVE
   share, moved_at - the share of each of them, and the line of the formulation after which it is in the register
                     velocity
   nsummed         - the number of them that are in this register
   velocity        - the first of the node registers with the velocity that particles move with, or MPM_NONE
   slope, load, way - the first of the scratch registers with the velocity's slopes in a step, the body force, and the
                     way that particles go in a step
   gone            - the first of the registers that keep how far particles have gone in the step, or MPM_NONE
   at_part         - the part of the step that particles have gone
   stretching      - the slopes are complete, and the stretch with this first register is to be stretched by them, or
                     MPM_NONE
   staged          - a step has several stages
   implicit        - the formulation has IMPLICIT. Then a scratch stress is that of the middle of the step, at the part
                     ahead of it with the velocity in the node registers from start on; its first register is stress
   viscous         - the first of the scratch registers of the viscous stress, or MPM_NONE
   rate            - the same of the velocity's slopes that the viscous stress of a material is made of
S*/
typedef struct {
  const MpmFormulation   *formulation;
  const MpmTransfer      *transfer;
  const MpmSchemeNumbers *numbers;
  const MpmSpace         *space;
  PetscInt                trial, lost, lost_by;
  PetscInt                particle[MPM_MAX_FIELDS], node[MPM_MAX_FIELDS], kept[MPM_MAX_FIELDS], sharp[MPM_MAX_FIELDS],
      sharp_at[MPM_MAX_FIELDS];
  PetscInt stretched[MPM_MAX_FIELDS], moved[MPM_MAX_MOVED], moved_at[MPM_MAX_MOVED], nmoved, nsummed, velocity, slope,
      load, way, gone, stretching;
  PetscReal share[MPM_MAX_MOVED];
  PetscBool staged, implicit;
  PetscReal ahead, at_part;
  PetscInt  start, stress, viscous, rate;
  MpmTable *table;
} MpmTableBuilder;

/* Not collective. The components of a rank, and the component ab of a stress: of a fluid MPM_NONE unless a is b. */
PetscInt MpmSpaceComponents(const MpmSpace *space, MpmRank rank);
PetscInt MpmSpaceStress(const MpmSpace *space, PetscInt a, PetscInt b);

/*
   Not collective. Whether a field is a stress of the middle of an implicit step about a prestress: T = tau A^-T
   (deform.c) has dim x dim components, and its own part of the prestress.
*/
PetscBool MpmBuilderIsAhead(const MpmTableBuilder *b, PetscInt field);

/* Not collective. The number of registers of a field. */
PetscInt MpmBuilderComponents(const MpmTableBuilder *b, PetscBool on_nodes, PetscInt field);

/*
   Not collective. MpmBuilderAddRegisters adds the registers of the state, the scratch that the space needs, and those
   of the nodes. MpmBuilderAddComponents adds those of a field of the state, whose names end in the directions where
   there are several: v_x, s_xy. whole: a tensor is not symmetric. MpmBuilderAddState adds one register of the state.
*/
PetscErrorCode MpmBuilderAddRegisters(MpmTableBuilder *b);
PetscErrorCode MpmBuilderAddState(MpmTable *table, const char name[], PetscInt field, PetscInt component);
PetscErrorCode MpmBuilderAddComponents(MpmTable *table, const char name[], PetscInt field, MpmRank rank,
                                       PetscBool whole);

/*
   Not collective. MpmBuilderNodes adds n node registers like those from register like on, MpmBuilderScratches n scratch
   registers, and *first is the first of them. MpmBuilderClear sets n scratch registers to 0.
*/
PetscErrorCode MpmBuilderNodes(MpmTable *table, PetscInt like, PetscInt n, PetscInt *first);
PetscErrorCode MpmBuilderScratches(MpmTable *table, PetscInt n, PetscInt *first);
PetscErrorCode MpmBuilderClear(MpmTable *table, PetscInt n, PetscInt first);

/*
   Not collective. MpmBuilderImposeWithReaction sets a node register to 0 at ends with a reaction, and keeps its values
   from before if a later REACT wants them. MpmBuilderReact is REACT of a node register.
*/
PetscErrorCode MpmBuilderImposeWithReaction(MpmTableBuilder *b, PetscInt node, PetscBool wanted);
PetscErrorCode MpmBuilderReact(MpmTableBuilder *b, PetscInt dst, PetscInt imposed);

/*
   Not collective. What colliders do (table_walls.c) at line number o of the formulation, an IMPOSE, and
   MpmBuilderCollideAgain at one that is a REACT; nothing without colliders. MpmBuilderGiveLost: after it, and after the
   walls, particles get what the velocity has lost.
*/
PetscErrorCode MpmBuilderCollide(MpmTableBuilder *b, PetscInt o);
PetscErrorCode MpmBuilderCollideAgain(MpmTableBuilder *b, PetscInt o);
PetscErrorCode MpmBuilderGiveLost(MpmTableBuilder *b);

/*
   Not collective. MpmBuilderAppend appends an operation. Where it goes from nodes to particles, it reads what the
   transfer's sharpen makes of the nodes. MpmBuilderSharpen makes it, if the transfer has one, and says where it is;
   MpmBuilderSharpenAll of n registers. MpmBuilderTerm appends a term of DIV, GRAD, G2P_SLOPE or CURVE: along an axis or
   two, with the weights of the space's gradient. MpmBuilderSlopes adds the slopes of a velocity, from node register v
   on, to dim x dim scratch registers.
*/
PetscErrorCode MpmBuilderAppend(MpmTableBuilder *b, MpmOp op);
PetscErrorCode MpmBuilderSharpen(MpmTableBuilder *b, PetscInt node, PetscInt *sharp);
PetscErrorCode MpmBuilderSharpenAll(MpmTableBuilder *b, PetscInt first, PetscInt n);
PetscErrorCode MpmBuilderSlopes(MpmTableBuilder *b, const MpmOp *op, PetscInt slopes, PetscInt v);
PetscErrorCode MpmBuilderTerm(MpmTableBuilder *b, const MpmOp *op, PetscInt dst, PetscInt src, PetscInt axis,
                              PetscReal factor, PetscBool accumulates);

/*
   Damping and viscosity (table_damping.c): what goes before line number o of the formulation, and after it. Not
   collective.
*/
PetscErrorCode MpmDampingBefore(MpmTableBuilder *b, PetscInt o);
PetscErrorCode MpmDampingAfter(MpmTableBuilder *b, PetscInt o);

/*
   Operations of finite deformation (table_finite.c). Not collective.

   MpmFiniteAddState   - the registers of the stretch, in the place of a stress
   MpmFiniteAddScratch - the scratch registers
   MpmFinitePlan       - finds out what particles move with
   MpmFiniteSet        - the operations for a stress of a stage that is set to that of the state
   MpmFiniteDiv, MpmFiniteGrad - the operations for DIV of a stress and GRAD to a stress
   MpmFiniteGo         - particles go to where a velocity from node register velocity on has taken them by a part of the
                         step: all of it for DRIFT. MpmFiniteMoveTo: of MOVE_TO
   MpmFiniteAhead      - the operations for IMPLICIT of a field, whose own table has the acceleration in registers from
                         image on
   MpmFiniteBefore     - what must be done before line number o of the formulation, and MpmFiniteAfter: after it
*/
PetscErrorCode MpmFiniteAddState(MpmTableBuilder *b, PetscInt field);
PetscErrorCode MpmFiniteAhead(MpmTableBuilder *b, PetscInt field, PetscInt image);
PetscErrorCode MpmFiniteAddScratch(MpmTableBuilder *b);
PetscErrorCode MpmFinitePlan(MpmTableBuilder *b);
PetscErrorCode MpmFiniteSet(MpmTableBuilder *b, const MpmOp *op);
PetscErrorCode MpmFiniteDiv(MpmTableBuilder *b, const MpmOp *op);
PetscErrorCode MpmFiniteGrad(MpmTableBuilder *b, const MpmOp *op, PetscBool begins, PetscBool ends);
PetscErrorCode MpmFiniteGo(MpmTableBuilder *b, PetscInt velocity, PetscReal part);
PetscErrorCode MpmFiniteMoveTo(MpmTableBuilder *b, const MpmOp *op);
PetscErrorCode MpmFiniteBefore(MpmTableBuilder *b, const MpmOp *op);
PetscErrorCode MpmFiniteAfter(MpmTableBuilder *b, PetscInt o);

/*
   MpmTableCheck - refuses (PETSC_ERR_SUP) a table that the interpreters do not support; MpmTableCreate says what that
                   is.

   Not collective.
*/
PetscErrorCode MpmTableCheck(const MpmTable *table);
