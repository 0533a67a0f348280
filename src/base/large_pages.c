/* Large pages by madvise: many systems give them only to programs that ask, and glibc's malloc does not ask. */
#define _DEFAULT_SOURCE /* madvise */
#include "base/large_pages.h"
#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

#if defined(MADV_HUGEPAGE) && !defined(MADV_COLLAPSE)
#define MADV_COLLAPSE 25 /* of Linux 6.1, which headers of glibc before 2.38 do not name; an older kernel refuses it */
#endif

#define LEAST ((size_t)4 << 20) /* bytes; a large page mostly has half of that */

void MpmLargePages(void *array, size_t bytes)
{
#ifdef MADV_HUGEPAGE
  const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE), begin = ((uintptr_t)array + page - 1) / page * page,
                  end = ((uintptr_t)array + bytes) / page * page;

  if (bytes < LEAST) return;
  (void)madvise((void *)begin, end - begin, MADV_HUGEPAGE);
  (void)madvise((void *)begin, end - begin, MADV_COLLAPSE);
#else
  (void)array;
  (void)bytes;
#endif
}
