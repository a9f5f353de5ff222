// SPDX-License-Identifier: Apache-2.0
// How two runs that write the same files keep out of each other's way.
//   prepare_outputs(resolved);  // makes the folders
//   const OutputLock lock = lock_outputs(resolved.pipeline, resolved.frames);
//   prepare_outputs(resolved);  // once more: another run may have made frames until then
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/pipeline.hpp"

namespace gazetrace {

// A run's claim to the files that it writes. The kernel holds it for as long as the object lives, and no longer than
// the process: a run that was killed holds up nobody, and one that is stopped keeps its claim however long that takes.
//
// The claim is on a file `.gazetrace.lock` in each folder that frames, maps, checkpoint and record go to. Each name of
// a file stands for one position in it, which is locked, so that runs of other frames or other pictures share a
// folder, however the folder and the pattern of the names are spelled. A pattern with the frame's number in a folder's
// name is claimed in the folder above; a run that names such a folder itself does not see that claim. While runs hold
// it, its text names them. Afterwards it stays, empty: who removed it could take it from a run that has just opened it.
class OutputLock {
 public:
  OutputLock() = default;  // claims nothing
  ~OutputLock();
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&& other) noexcept;
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

  // One line for each folder whose file system has no locks: nothing keeps two runs apart there.
  [[nodiscard]] const Warnings& warnings() const { return warnings_; }

 private:
  friend OutputLock lock_outputs(const PipelineSettings& settings, const std::vector<std::int32_t>& frames);
  void release();
  std::vector<int> files_;  // as the system numbers open files
  Warnings warnings_;
};

// Claims all files of a run over these frames, without waiting. The folders must be there. Error(runtime) that names
// the owner where a living run writes one of them, on any machine or in any container, so that it may help to try again
// later; Error(input) where a lock's file cannot be made.
OutputLock lock_outputs(const PipelineSettings& settings, const std::vector<std::int32_t>& frames);

// Whether a run lives that has claimed this file.
bool is_locked(const std::string& path);

}  // namespace gazetrace
