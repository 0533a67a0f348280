/*
   The whole public interface. A program makes a scene, which is a problem with all its numbers, and asks questions of
   it.

     errors.h       how a program begins and ends, and how bad input comes back as an error code
     scene.h        a scene from options, text or a file
     critical.h     the largest stable Courant number
     symbol.h       amplification factors over the phase, on uniform layouts
     operator.h     the operator of a step, or of a period of drift, as a sparse matrix
     march.h        the explicit loop over time steps
     verdict.h      stable, unstable or undecided, and what the verdict rests on

   The parts of a scene:

     layout.h       the grid and the particles at rest
     collider.h     rigid bodies that act on nodal velocities
     scheme.h       formulation.h with a basis (basis.h) and a transfer (transfer.h); Courant number and drift
     table.h        formulation, transfer and boundary (boundary.h) as one list of operations
     material.h     materials at finite strain: stress, its differential, energy and wave speed
     wave.h         the continuous problem and its exact solutions

   fraction.h and compat.h serve the others.

   examples/library has a first program, and says how to compile it.
*/
#pragma once
#include <mpmstab/basis.h>
#include <mpmstab/boundary.h>
#include <mpmstab/collider.h>
#include <mpmstab/compat.h>
#include <mpmstab/critical.h>
#include <mpmstab/errors.h>
#include <mpmstab/formulation.h>
#include <mpmstab/fraction.h>
#include <mpmstab/layout.h>
#include <mpmstab/march.h>
#include <mpmstab/material.h>
#include <mpmstab/operator.h>
#include <mpmstab/scene.h>
#include <mpmstab/scheme.h>
#include <mpmstab/step_bound.h>
#include <mpmstab/symbol.h>
#include <mpmstab/table.h>
#include <mpmstab/transfer.h>
#include <mpmstab/verdict.h>
#include <mpmstab/wave.h>
