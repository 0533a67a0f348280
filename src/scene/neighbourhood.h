/*
   Neighbourhoods: where a particle may be. A lattice that fills space says nothing of its own free surface, nor of a
   particle that has left it, and these often limit the time step.
*/
#pragma once

/*E
   MpmNeighbourhoodKind - MPM_IN_BULK: the scene as it is. MPM_AT_EDGE: a half-space of its lattice; MPM_AT_CORNER: a
   quarter-space. Their free surfaces go through the grid. MPM_ALONE: one particle. MPM_AT_RANDOM: layouts with voids.
   MPM_DISORDERED: random layouts of as many particles as the lattice has.
   MPM_AT_WORST: the layout of the least limit that a search over places and numbers of particles finds.
E*/
typedef enum {
  MPM_IN_BULK,
  MPM_AT_EDGE,
  MPM_AT_CORNER,
  MPM_ALONE,
  MPM_AT_RANDOM,
  MPM_DISORDERED,
  MPM_AT_WORST,
  MPM_NEIGHBOURHOODS
} MpmNeighbourhoodKind;

/* The words of the option. The last one, all, stands after those of the kinds. */
extern const char *const MpmNeighbourhoodNames[];
