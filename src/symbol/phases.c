/*
   Phases with the same amplification factors, and the one of them that is computed. docs/theory.md, section 4, says why
   these symmetries hold.
*/
#include "symbol/source.h"
#include "base/text.h"

PetscErrorCode MpmPhasesText(PetscInt dim, const PetscInt each[], size_t room, char text[])
{
  PetscFunctionBegin;
  text[0] = 0;
  for (PetscInt a = 0; a < dim; a++) {
    char part[16];

    PetscCall(PetscSNPrintf(part, sizeof part, "%s%" PetscInt_FMT, a ? "," : "", each[a]));
    MpmTextJoin(text, part, room);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmPhasesSymmetries(const MpmLayout *layout, const MpmSpace *space, const MpmFraction drift[], PetscBool mirror[],
                         PetscInt alike[])
{
  for (PetscInt a = 0; a < layout->dim; a++) {
    mirror[a] =
        layout->offset[a].value == 0.5 && drift[a].value == 0 && MpmSpaceMirrors(space, a) ? PETSC_TRUE : PETSC_FALSE;
    alike[a] = a;
    for (PetscInt b = a - 1; b >= 0; b--)
      if (layout->ppc[a] == layout->ppc[b] && layout->offset[a].value == layout->offset[b].value &&
          drift[a].value == drift[b].value && MpmSpaceAlike(space, a, b))
        alike[a] = b;
  }
}

void MpmPhasesFind(const MpmSource *source, MpmSymbol *s)
{
  for (PetscInt a = 0; a < s->dim; a++) {
    s->reflects[a] = source->reflects[a];
    s->alike[a]    = a;
    for (PetscInt b = a - 1; b >= 0; b--)
      if (source->alike[a] == source->alike[b] && s->phases[a] == s->phases[b]) s->alike[a] = b;
  }
}

void MpmSymbolBeta(const MpmSymbol *s, PetscInt phase, PetscReal beta[])
{
  for (PetscInt a = 0; a < s->dim; a++) {
    beta[a] = MpmSymbolPhase(phase % s->phases[a], s->phases[a]);
    phase /= s->phases[a];
  }
}

/* The least number that reflections and exchanges make of a phase, or of its negative. */
static PetscInt Least(const MpmSymbol *s, PetscInt phase, PetscBool negative)
{
  PetscInt m[MPM_MAX_DIM], number = 0;

  for (PetscInt a = 0; a < s->dim; a++) {
    m[a] = phase % s->phases[a];
    phase /= s->phases[a];
    if (m[a] && negative) m[a] = s->phases[a] - m[a];
    if (s->reflects[a] && 2 * (PetscInt64)m[a] > s->phases[a]) m[a] = s->phases[a] - m[a];
  }
  for (PetscInt a = 0; a < s->dim; a++) /* the largest first: the last direction counts most in the number */
    for (PetscInt b = a + 1; b < s->dim; b++) {
      const PetscInt other = m[b];

      if (s->alike[a] != s->alike[b] || m[a] >= other) continue;
      m[b] = m[a];
      m[a] = other;
    }
  for (PetscInt a = s->dim - 1; a >= 0; a--) number = number * s->phases[a] + m[a];
  return number;
}

static PetscInt Representative(const MpmSymbol *s, PetscInt phase, PetscBool *conjugate)
{
  const PetscInt plain = Least(s, phase, PETSC_FALSE), negative = Least(s, phase, PETSC_TRUE);

  *conjugate = negative < plain ? PETSC_TRUE : PETSC_FALSE;
  return PetscMin(plain, negative);
}

PetscErrorCode MpmPhasesList(MpmSymbol *s)
{
  PetscBool conjugate;

  PetscFunctionBegin;
  s->classes = s->all / 2 + 1;
  if (s->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  s->classes = 0;
  for (PetscInt phase = 0; phase < s->all; phase++)
    if (Representative(s, phase, &conjugate) == phase) s->classes++;
  PetscCall(PetscMalloc1(s->classes, &s->list));
  for (PetscInt phase = 0, i = 0; phase < s->all; phase++)
    if (Representative(s, phase, &conjugate) == phase) s->list[i++] = phase;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt MpmSymbolPhaseOfClass(const MpmSymbol *s, PetscInt i)
{
  return s->list ? s->list[i] : i;
}

PetscInt MpmSymbolClass(const MpmSymbol *s, PetscInt phase, PetscBool *conjugate)
{
  const PetscInt number = Representative(s, phase, conjugate);
  PetscInt       place;

  if (!s->list) return number;
  PetscCallAbort(PETSC_COMM_SELF, PetscFindInt(number, s->classes, s->list, &place));
  return place;
}
