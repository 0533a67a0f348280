/*
   Match: two operators of the same cells, given by their blocks A_d and B_d. They are those of one step if numbers of a
   particle go with one another so that, with a factor e_i for each,

     B_d,ij = e_i A_d,ij / e_j    for all distances d, sites of a cell, and numbers i, j:

   one keeps e_i times what the other keeps.
*/
#pragma once
#include "symbol/blocks.h"

#define MPM_MATCH_NAME 64
#define MPM_MATCH_WIDTH 32   /* numbers of a particle */
#define MPM_MATCH_WHY 8192   /* names all fields of both sides */
#define MPM_DIFFERENCES 1024 /* that are kept */

/*E
   MpmMatchKind - in which orders codes keep the components of a field: of a symmetric tensor row by row, or the
   diagonal first; of a matrix by rows or by columns.
E*/
typedef enum { MPM_MATCH_NUMBERS, MPM_MATCH_TENSOR, MPM_MATCH_MATRIX } MpmMatchKind;

/*S
   MpmMatchSide - one of the two operators.

   blocks - unknown i of site k of a cell is number (site[k] width + i); site: in which order the sites are
   fields - size numbers each, from number first of a particle's on; kind is that of the first side's fields alone
S*/
typedef struct {
  char         name[MPM_MATCH_NAME];
  PetscInt     size, first;
  MpmMatchKind kind;
} MpmMatchField;

typedef struct {
  const MpmBlocks *blocks;
  PetscInt         sites, *site, width, nfields;
  MpmMatchField    fields[MPM_MATCH_WIDTH];
} MpmMatchSide;

/*S
   MpmDifference - the entry that differs most of those by which field from of the cell at -d gives to field to: fields
   of the first side, and in its units.
S*/
typedef struct {
  PetscInt  d[MPM_MAX_DIM], to, from;
  PetscReal one, other, differ;
} MpmDifference;

/*S
   MpmMatch - what was found.

   fits    - numbers go with one another one by one; else only amplification factors are compared, and why_not says why
   number  - for each number of a particle of the first side that of the other
   factor  - e of each number; only their ratios mean something
   differ  - the largest abs(B_ij e_j / e_i - A_ij)
   differences - the largest for each block and pair of fields, those above bound, the largest first; n of them
   factors - at some phases, the largest distance of an amplification factor of the side that has fewer from one of the
             other's
   more[s] - the factors that side s has more of, at a phase; most: the largest abs of those
S*/
typedef struct {
  PetscBool     fits;
  char          why_not[MPM_MATCH_WHY];
  PetscInt      number[MPM_MATCH_WIDTH], n, more[2];
  PetscReal     factor[MPM_MATCH_WIDTH], differ, factors, most;
  MpmDifference differences[MPM_DIFFERENCES];
} MpmMatch;

/*
   MpmMatchFind - tries the ways in which fields of the same size can go together, and takes the one that differs least.
   Factors follow from the entries of both, along the pairs of numbers that agree best.

   Not collective. bound: differences up to it are none. Both sides have the same sites, which each orders by site.
*/
PetscErrorCode MpmMatchFind(const MpmMatchSide *one, const MpmMatchSide *other, PetscReal bound, MpmMatch *match);
