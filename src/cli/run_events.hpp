// SPDX-License-Identifier: Apache-2.0
// What happens in a run, as lines of JSON for programs that watch it: begin, frame, warning, end (--progress json).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/pipeline.hpp"

namespace gazetrace {

class RunEvents {
 public:
  // `progress` is the value of --progress: json writes on stderr, json:N on the file descriptor N; with any other value
  // nothing is written. Error(usage) where nothing can be written there.
  explicit RunEvents(const std::string& progress);

  [[nodiscard]] bool active() const { return descriptor_ >= 0; }
  [[nodiscard]] bool on_stderr() const;  // where people's text would stand between the lines

  void begin(const std::string& scene, const std::string& frames, std::size_t count, const std::string& digest);
  void frame_done(std::int32_t frame, double ms, bool skipped);
  void warnings(const std::vector<std::string>& texts);
  void end(int exit_code, const SequenceResult& result);
  void end(int exit_code, const std::string& error);

 private:
  void write(const std::string& line);

  int descriptor_ = -1;
  bool ended_ = false;
  std::size_t frames_ = 0, done_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace gazetrace
