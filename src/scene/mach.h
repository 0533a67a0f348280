/* Mach number: the velocity of the particles over the wave speed, M = U0 / c, which makes a drift of M k. */
#pragma once
#include <mpmstab/fraction.h>
#include <mpmstab/scene.h>

/*S
   MpmMach - the Mach numbers of all directions, as whole multiples without a common divisor of one fraction:
   direction a has times[a] unit. Particles then drift by whole multiples of k unit, and are back in their places after
   as many steps as the denominator of k unit says. At rest all are 0.
S*/
typedef struct {
  PetscInt    dim;
  MpmFraction unit; /* above 0, or 0 at rest */
  PetscInt64  times[MPM_MAX_DIM];
} MpmMach;

/* Not collective. Sets the Mach numbers of dim directions; ok: they are ratios with short enough terms. */
void MpmMachCreate(PetscInt dim, const MpmFraction number[], MpmMach *mach, PetscBool *ok);

/* Not collective. The drift times[a] part of each direction, where part stands for k unit. */
void MpmMachDrift(const MpmMach *mach, const MpmFraction *part, MpmFraction drift[]);

/*
   MpmMachNearest - the fraction that is nearest to k unit, of those with a denominator up to most, or up to the number
   of steps in which particles move by a cell, where that is more.

   Not collective. den is 0 where that number is beyond MPM_LONGEST_PERIOD, or particles rest.
*/
MpmFraction MpmMachNearest(const MpmMach *mach, PetscReal courant, PetscInt64 most);

/* Not collective. The Courant number at which k unit is a given fraction. */
MpmFraction MpmMachCourant(const MpmMach *mach, const MpmFraction *part);
