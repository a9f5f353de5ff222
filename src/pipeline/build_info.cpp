// SPDX-License-Identifier: Apache-2.0
// What a run record says about the program and the machine.
#include <sys/resource.h>

#include <string>

#include "gazetrace/build_info.hpp"

namespace gazetrace {

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux counts in KiB
}

std::string build_description() {
#if defined(__clang__)
  std::string text = "clang " __clang_version__;
#else
  std::string text = "gcc " __VERSION__;
#endif
#if defined(__OPTIMIZE__)
  text += ", optimised";
#else
  text += ", not optimised";
#endif
#if !defined(NDEBUG)
  text += ", assertions";
#endif
  return text;
}

std::string instruction_set() {
#if defined(__AVX512F__)
  return "x86-64 avx512";
#elif defined(__AVX2__)
  return "x86-64 avx2";
#elif defined(__x86_64__) && defined(GAZETRACE_DISPATCH)
  return "x86-64, inner loops for avx2 too";
#elif defined(__x86_64__)
  return "x86-64";
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "unknown";
#endif
}

}  // namespace gazetrace
