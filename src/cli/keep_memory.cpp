// SPDX-License-Identifier: Apache-2.0
#include "cli/keep_memory.hpp"

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace gazetrace {

void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);         // blocks over 32 MiB are mapped by themselves, whatever M_MMAP_THRESHOLD says
  mallopt(M_TRIM_THRESHOLD, -1);  // never
  mallopt(M_TOP_PAD, 64 << 20);   // bytes: the heap grows in large steps
#endif
}

}  // namespace gazetrace
