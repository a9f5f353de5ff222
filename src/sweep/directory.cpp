// SPDX-License-Identifier: Apache-2.0
// One sweep at a time in a directory, or any number of tasks of one.
#include <fmt/format.h>

#include "core/file_lock.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/sweep.hpp"

namespace gazetrace {

struct SweepDirectory::Locks {
  FileLock whole;
  std::optional<FileLock> task;
};

SweepDirectory::SweepDirectory(const std::string& path, const std::optional<SweepTask>& task) {
  const auto refuse = [&](bool is_held, const std::string& who) {
    if (!is_held) {
      throw Error(ErrorKind::input, path, who + " is at work there", "wait for it, or give another `output` folder");
    }
  };
  FileLock whole(path + "/lock", task ? FileLock::Kind::shared : FileLock::Kind::alone, false);
  refuse(whole.is_held(), "another sweep");
  locks_ = std::make_unique<Locks>(Locks{std::move(whole), std::nullopt});
  if (task) {
    FileLock own(fmt::format("{}/lock.{}-of-{}", path, task->number, task->count), FileLock::Kind::alone, false);
    refuse(own.is_held(), "this chunk");
    locks_->task.emplace(std::move(own));
  }
}

SweepDirectory::~SweepDirectory() = default;
SweepDirectory::SweepDirectory(SweepDirectory&& other) noexcept = default;

}  // namespace gazetrace
