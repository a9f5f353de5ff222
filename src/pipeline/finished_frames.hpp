// SPDX-License-Identifier: Apache-2.0
// Looks at the files of frames that an earlier run has finished.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

class FinishedFrames {
 public:
  // `known` are the files that the run so far lists. Keeps references to both.
  FinishedFrames(const PipelineSettings& settings, const WrittenFiles& known);

  // Whether all files of the frame are there, as they were written, under these settings.
  [[nodiscard]] bool is_complete(std::int32_t frame) const;
  // The files of a complete frame. What the run so far does not list is listed as it is now.
  void add_files(std::int32_t frame, WrittenFiles& files) const;

 private:
  [[nodiscard]] bool is_complete_picture(const std::string& path, std::int32_t frame) const;
  [[nodiscard]] std::vector<std::string> files_of(std::int32_t frame) const;
  // Of a file that the run so far does not list nobody says that it is whole but itself.
  [[nodiscard]] bool vouches(const std::string& path) const;
  [[nodiscard]] bool is_as_written(const std::string& path) const;

  const PipelineSettings& settings_;
  const WrittenFiles& known_;
  std::set<std::string> bad_;
};

}  // namespace gazetrace
