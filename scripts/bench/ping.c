/* Measures a message between two ranks: {"latency": s, "bandwidth": bytes/s}, from half of the best round trips. */
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

#define LARGE (4 << 20)

/* Returns the seconds of one way, from the best of several batches. */
static double OneWay(char buffer[], int bytes, int trips, int batches)
{
  double best = 1e30;
  int    rank;

  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  for (int b = 0; b < batches; b++) {
    const double begin = MPI_Wtime();

    for (int t = 0; t < trips; t++) {
      if (rank == 0) MPI_Send(buffer, bytes, MPI_BYTE, 1, 0, MPI_COMM_WORLD);
      MPI_Recv(buffer, bytes, MPI_BYTE, 1 - rank, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      if (rank == 1) MPI_Send(buffer, bytes, MPI_BYTE, 0, 0, MPI_COMM_WORLD);
    }
    const double seconds = (MPI_Wtime() - begin) / (2 * trips);

    if (seconds < best) best = seconds;
  }
  return best;
}

int main(int argc, char **argv)
{
  char *buffer = calloc(LARGE, 1);
  int   rank, size;

  MPI_Init(&argc, &argv); /* errors end the program: MPI's default */
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (!buffer || size != 2) MPI_Abort(MPI_COMM_WORLD, 1);
  const double latency = OneWay(buffer, 8, 1000, 20), large = OneWay(buffer, LARGE, 10, 10);

  if (rank == 0) printf("{\"latency\": %.9g, \"bandwidth\": %.9g}\n", latency, LARGE / large);
  free(buffer);
  return MPI_Finalize() ? 1 : 0;
}
