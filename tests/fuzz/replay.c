/* The main of a fuzz target without libFuzzer. Each file given, or in a folder given, is one input. */
#include <dirent.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define LARGEST (1 << 21) /* bytes */

static void Fail(const char path[], const char why[])
{
  fprintf(stderr, "%s: %s\n", path, why);
  exit(EXIT_FAILURE);
}

static void ReplayFile(const char path[])
{
  FILE    *file = fopen(path, "rb");
  uint8_t *data = malloc(LARGEST);
  size_t   size;

  if (!file || !data) Fail(path, "cannot be read");
  size = fread(data, 1, LARGEST, file);
  if (ferror(file)) Fail(path, "cannot be read");
  fclose(file);
  fprintf(stderr, "%s\n", path); /* the last name printed is the input that failed */
  (void)LLVMFuzzerTestOneInput(data, size);
  free(data);
}

static int IsVisible(const struct dirent *entry)
{
  return entry->d_name[0] != '.';
}

static int ReplayFolder(const char folder[])
{
  struct dirent **entries;
  const int       n = scandir(folder, &entries, IsVisible, alphasort);

  for (int i = 0; i < n; i++) {
    char path[4096];

    if (snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name) >= (int)sizeof path)
      Fail(folder, "too long a name");
    ReplayFile(path);
    free(entries[i]);
  }
  if (n > 0) free(entries);
  return n;
}

int main(int argc, char **argv)
{
  int inputs = 0;

  LLVMFuzzerInitialize(&argc, &argv);
  for (int i = 1; i < argc; i++) {
    struct stat is;

    if (stat(argv[i], &is)) Fail(argv[i], "not there");
    if (S_ISDIR(is.st_mode))
      inputs += ReplayFolder(argv[i]);
    else {
      ReplayFile(argv[i]);
      inputs++;
    }
  }
  if (inputs <= 0) Fail(argv[0], "no input: name files, or folders that hold some");
  printf("%d inputs\n", inputs);
  return EXIT_SUCCESS;
}
