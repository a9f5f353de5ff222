// SPDX-License-Identifier: Apache-2.0
#include "threads.hpp"

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

namespace gazetrace::python {

// The threads are detached, and hold what they wait for: one that is idle when the process ends holds nothing up.
struct Threads::Shelf {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::function<void()>> work;
  std::size_t idle = 0;
  bool over = false;

  void serve() {
    std::unique_lock lock(mutex);
    while (!over) {
      if (work.empty()) {
        ++idle;
        changed.wait(lock, [this] { return over || !work.empty(); });
        --idle;
        continue;
      }
      const std::function<void()> own = std::move(work.front());
      work.pop_front();
      lock.unlock();
      own();
      lock.lock();
    }
  }
};

Threads::Threads() : shelf_(std::make_shared<Shelf>()) {}

Threads::~Threads() {
  const std::lock_guard guard(shelf_->mutex);
  shelf_->over = true;
  shelf_->changed.notify_all();
}

void Threads::run(std::function<void()> work) {
  const std::lock_guard guard(shelf_->mutex);
  shelf_->work.push_back(std::move(work));
  if (shelf_->work.size() <= shelf_->idle) {
    shelf_->changed.notify_one();
  } else {
    std::thread([shelf = shelf_] { shelf->serve(); }).detach();
  }
}

}  // namespace gazetrace::python
