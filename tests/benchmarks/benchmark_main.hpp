// SPDX-License-Identifier: Apache-2.0
// Where a benchmark's errors end: one line, exit code 2.
#pragma once

#include <fmt/core.h>

#include <cstdio>
#include <exception>

namespace gazetrace::benchmark {

inline int benchmark_main(int (*run)(int argc, char** argv), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}

}  // namespace gazetrace::benchmark
