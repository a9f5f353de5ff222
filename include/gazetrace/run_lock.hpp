// SPDX-License-Identifier: Apache-2.0
// How two runs that write the same files keep out of each other's way.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

// A run's claim to the files it writes: a file beside its record that says host, process and since when, and whose time
// is renewed while the run lives. Runs of other parts of the frames hold it up only where their frames overlap, and
// runs of other parts of the samples never.
class RunLock {
 public:
  // Error(runtime) where a living run writes some of these files, so that it helps to try again later, and where the
  // lock cannot be written. A lock that nobody holds any more is taken over; `waiting` is told where that takes a while
  // to find out, since the other was on another machine. `family` begins the lock's name. Locks of different families
  // do not hold each other up, so that one folder can have several kinds of files.
  RunLock(const RunRecord& record, const std::string& record_path,
          const std::function<void(const std::string& text)>& waiting = {}, const std::string& family = {});
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  // What became of earlier locks, in words.
  [[nodiscard]] const Warnings& taken_over() const { return taken_over_; }

 private:
  struct Heart;
  Warnings taken_over_;
  std::unique_ptr<Heart> heart_;
};

}  // namespace gazetrace
