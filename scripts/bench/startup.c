/* Measures what every program that uses SLEPc takes to begin and to end. */
#include <slepcsys.h>

int main(int argc, char **argv)
{
  PetscErrorCode error = SlepcInitialize(&argc, &argv, NULL, NULL);

  if (!error) error = SlepcFinalize();
  return error ? 1 : 0;
}
