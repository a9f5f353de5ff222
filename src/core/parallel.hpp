// SPDX-License-Identifier: Apache-2.0
// The only use of threads (oneTBB). Results must not depend on which thread runs which index.
#pragma once

#include <cstddef>
#include <functional>

namespace gazetrace {

// Calls body(i) for every i in [0, count) on at most `threads` threads (0: as many as the machine has cores). An
// exception that a body throws is rethrown here.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);
int resolve_threads(int threads);

}  // namespace gazetrace
