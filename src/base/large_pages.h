/* Large pages of memory for large arrays. */
#pragma once
#include <stddef.h>

/*
   MpmLargePages - asks the system to keep an array in large pages, and to bring together at once what is there already.
   The processor then looks up few pages where it would look up thousands. Arrays below 4 MiB are left as they are, and
   so is everything on systems that do not have this call: it changes no number.

   Not collective. Linux 6.1 or later moves an array that has values; before, only pages that are first used later are
   large.
*/
void MpmLargePages(void *array, size_t bytes);
