/* XDMF: a text that tells ParaView what is in the HDF5 file of a run. */
#pragma once
#include <mpmstab/scene.h>
#include <stdio.h>

/* Not collective. Begin and end the text. */
void MpmXdmfBegin(FILE *xmf);
void MpmXdmfEnd(FILE *xmf);

/*
   MpmXdmfStep - describes the particles and nodes of a step, which are in a group of a file in the same folder.

   Not collective. The components of a vector become one field, with three components as ParaView wants it.
*/
void MpmXdmfStep(FILE *xmf, const MpmScene *scene, const char file[], const char group[], PetscReal time);
