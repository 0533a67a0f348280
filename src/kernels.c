/* The maps of THEORY.md, section 2 on arrays. */
#include <mpmstab/kernels.h>

/* P2G for the hat: phi = 1 - xi at node i, xi at node i + 1. The sums of a cell's run of particles stay in
   registers, and the right node's sum is carried on when the next run is the next cell. */
void MpmHatP2G(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
               PetscReal *restrict particle, PetscReal *restrict node)
{
  PetscReal left = 0, right = 0;
  PetscInt  c;

  (void)width;
  (void)a;
  if (n == 0) return;
  c = cell[0];
  for (PetscInt p = 0; p < n; p++) {
    if (cell[p] != c) {
      node[c] += left;
      if (cell[p] == c + 1) {
        left = right;
      } else {
        node[c + 1] += right;
        left = 0;
      }
      right = 0;
      c     = cell[p];
    }
    const PetscReal q = particle[p], share = xi[p] * q;
    right += share;
    left += q - share;
  }
  node[c] += left;
  node[c + 1] += right;
}

void MpmHatP2GMass(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                   const PetscReal *restrict particle, PetscReal *restrict node, PetscReal *restrict mass)
{
  PetscReal left = 0, right = 0, mass_left = 0, mass_right = 0;
  PetscInt  c;

  (void)width;
  if (n == 0) return;
  c = cell[0];
  for (PetscInt p = 0; p < n; p++) {
    if (cell[p] != c) {
      node[c] += left;
      mass[c] += mass_left;
      if (cell[p] == c + 1) {
        left      = right;
        mass_left = mass_right;
      } else {
        node[c + 1] += right;
        mass[c + 1] += mass_right;
        left = mass_left = 0;
      }
      right = mass_right = 0;
      c                  = cell[p];
    }
    const PetscReal q = particle[p], share = xi[p] * q;
    right += share;
    left += q - share;
    mass_right += xi[p];
    mass_left += 1 - xi[p];
  }
  node[c] += left;
  node[c + 1] += right;
  mass[c] += mass_left;
  mass[c + 1] += mass_right;
}

void MpmHatG2P(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
               PetscReal *restrict particle, PetscReal *restrict node)
{
  (void)width;
  for (PetscInt p = 0; p < n; p++) {
    const PetscReal left = node[cell[p]], right = node[cell[p] + 1];
    particle[p] += a * (left + xi[p] * (right - left));
  }
}

void MpmHatGrad(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                PetscReal *restrict particle, PetscReal *restrict node)
{
  (void)xi;
  (void)width;
  for (PetscInt p = 0; p < n; p++) particle[p] += a * (node[cell[p] + 1] - node[cell[p]]);
}

void MpmHatDiv(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
               PetscReal *restrict particle, PetscReal *restrict node)
{
  (void)xi;
  (void)width;
  for (PetscInt p = 0; p < n; p++) {
    node[cell[p]] -= a * particle[p];
    node[cell[p] + 1] += a * particle[p];
  }
}

/* phi (x_i - x_p) is -(1 - xi) xi on the left and as much on the right, where D is (1 - xi) xi. */
void MpmHatP2GAffine(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                     PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  (void)width;
  for (PetscInt p = 0; p < n; p++) {
    const PetscReal share = a * xi[p] * (1 - xi[p]) * particle[p];

    node[cell[p]] -= share;
    node[cell[p] + 1] += share;
  }
}

void MpmScale(PetscInt n, PetscReal a, PetscReal *restrict particle)
{
  if (a == 0)
    for (PetscInt p = 0; p < n; p++) particle[p] = 0; /* whatever was there */
  else
    for (PetscInt p = 0; p < n; p++) particle[p] *= a;
}

void MpmPlaceBlock(PetscInt n, const PetscInt *restrict cell0, const PetscReal *restrict xi0, PetscInt whole,
                   PetscReal part, PetscInt *restrict cell, PetscReal *restrict xi)
{
  for (PetscInt p = 0; p < n; p++) {
    const PetscReal place = xi0[p] + part;
    const PetscInt  next  = place >= 1 - 0x1p-52;

    cell[p] = cell0[p] + whole + next;
    xi[p]   = next ? PetscMax(place - 1, 0) : place;
  }
}

PetscReal MpmSumSquares(PetscInt n, const PetscReal *restrict q)
{
  PetscReal sum = 0;

#pragma omp simd reduction(+ : sum)
  for (PetscInt p = 0; p < n; p++) sum += q[p] * q[p];
  return sum;
}

void MpmNodeLaplacian(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] = a * ((f[i + 1] - f[i]) - (f[i] - f[i - 1]));
}

void MpmNodeAdd(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] += a * f[i];
}

void MpmNodeCopy(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] = a * f[i];
}
