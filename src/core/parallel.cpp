// SPDX-License-Identifier: Apache-2.0
#include "core/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#endif

namespace gazetrace {
namespace {
constexpr int kMaxThreads = 1024;  // the task library fails far above this

#ifdef __SANITIZE_THREAD__
// The thread sanitizer does not see how oneTBB, which is not instrumented, hands work from thread to thread: every loop
// would be a race, and what silences those silences all that happens in the bodies as well. So it gets the same loop of
// plain threads, where it sees everything, and so every race between bodies. oneTBB itself is not watched.
void loop_over_threads(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        body(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        error = error ? error : std::current_exception();
        next = count;
      }
    }
  };
  std::vector<std::jthread> others;
  for (std::size_t t = 1; t < std::min(static_cast<std::size_t>(threads), count); ++t) {
    others.emplace_back(work);
  }
  work();
  others.clear();
  if (error) {
    std::rethrow_exception(error);
  }
}
#endif
}  // namespace

int resolve_threads(int threads) {
  return threads > 0 ? std::min(threads, kMaxThreads) : tbb::info::default_concurrency();
}

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
  const int resolved = resolve_threads(threads);
  if (resolved == 1) {
    for (std::size_t i = 0; i < count; ++i) {
      body(i);
    }
    return;
  }
#ifdef __SANITIZE_THREAD__
  loop_over_threads(count, resolved, body);
  return;
#endif
  const auto loop = [&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) {
            body(i);
          }
        },
        tbb::simple_partitioner());
  };
  const int cores = tbb::info::default_concurrency();
  const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(resolved));
  if (resolved <= cores) {
    // Isolated, so that a thread that waits in here does not take a task of an outer loop, which might wait for it.
    tbb::this_task_arena::isolate(loop);
    return;
  }
  // More threads than cores need an arena with room for them. An arena is made only then, since each one leaves some
  // kilobytes behind in the task library.
  tbb::task_arena arena(resolved);
  arena.execute(loop);
}

}  // namespace gazetrace
