// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <vector>

#include "core/parallel.hpp"

namespace gazetrace {

// A parallel_for that runs every body and then rethrows the error of the lowest index, so that a file with several
// faults is always refused with the same message.
inline void parallel_for_first_error(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
  std::vector<std::exception_ptr> errors(count);
  parallel_for(count, threads, [&](std::size_t i) {
    try {
      body(i);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) {
      std::rethrow_exception(error);
    }
  }
}

}  // namespace gazetrace
