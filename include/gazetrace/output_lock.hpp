// SPDX-License-Identifier: Apache-2.0
// How two runs that write the same files keep out of each other's way.
//   make_output_folders(resolved);
//   const OutputLock lock = lock_outputs(resolved.pipeline, resolved.frames);
//   prepare_outputs(resolved);  // looks at the existing files, of which nothing changes from here on
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/pipeline.hpp"

namespace gazetrace {

class FolderLock;

// Files by the folder in which they are claimed: their own, or one above it.
using FilesByFolder = std::map<std::string, std::vector<std::string>>;

// A run's claim to the files that it writes. The kernel holds it for as long as the object lives, and no longer than
// the process: a run that was killed holds up nobody, and one that is stopped keeps its claim however long that takes.
//
// The claim is on a file `.gazetrace.lock` in each folder that frames, maps and record go to. Each name of
// a file stands for one position in it, which is locked, so that runs of other frames or other pictures share a
// folder, however the folder and the pattern of the names are spelled. A pattern with the frame's number in a folder's
// name is claimed in the folder above, where a run that names such a folder itself looks, too. Of more than 2000
// ranges of frames with gaps between them the nearest are claimed as one. While runs hold it, its text names them.
// Afterwards it stays, empty: who removed it could take it from a run that has just opened it.
class OutputLock {
 public:
  OutputLock();  // claims nothing
  ~OutputLock();
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&& other) noexcept;
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;

  // One line for each folder whose file system has no locks: nothing keeps two runs apart there.
  [[nodiscard]] const Warnings& warnings() const { return warnings_; }

 private:
  friend OutputLock lock_files(const FilesByFolder& files);
  std::vector<std::unique_ptr<FolderLock>> folders_;
  Warnings warnings_;
};

// Claims these files, without waiting. The folders must be there. Error(runtime) that names the owner where a living
// run writes one of them, on any machine or in any container, so that it may help to try again later; Error(input)
// where a lock's file cannot be made.
OutputLock lock_files(const FilesByFolder& files);
// Those of a run over these frames.
OutputLock lock_outputs(const PipelineSettings& settings, const std::vector<std::int32_t>& frames);

// Whether a run lives that has claimed this file; nothing where that cannot be told, as in file systems without locks.
std::optional<bool> is_locked(const std::string& path);

}  // namespace gazetrace
