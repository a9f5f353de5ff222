// SPDX-License-Identifier: Apache-2.0
// Threads that are used again. The task library keeps some kilobytes for every thread that ever called it, so that a
// new one for each of a thousand renderings would be a leak.
#pragma once

#include <functional>
#include <memory>

namespace gazetrace::python {

class Threads {
 public:
  Threads();
  ~Threads();
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;
  // Runs the work on a thread that has none, or on a new one. The work throws nothing.
  void run(std::function<void()> work);

 private:
  struct Shelf;
  std::shared_ptr<Shelf> shelf_;
};

}  // namespace gazetrace::python
