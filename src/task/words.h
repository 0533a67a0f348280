/* Words: the command line as people type it becomes the words that tasks read, before MPI and PETSc start. */
#pragma once

/*
   MpmWordsRead - gives *argc and *argv the words that were meant. The old words stay as they are.

     --option value, --option=value    -option value
     -Courant                          -courant
     version, --version, -version      version
     help, --help, -h, TASK --help     help, or help TASK
     critical musl                     critical -formulation musl, unless there is a file of that name

   Not collective. Returns 0, or 1 when memory ends. The new *argv is freed with free, after MpmFinalize.
*/
int MpmWordsRead(int *argc, char ***argv);

/*
   MpmWordsCheckViewers - returns whether no option of PETSc's, such as -log_view :FILE, names the file of another word: the
   scene, or a file that is read or written. Otherwise the first rank prints which one does.

   Not collective; call it before PetscInitialize, which empties such a file.
*/
int MpmWordsCheckViewers(int argc, char **argv);
