// SPDX-License-Identifier: Apache-2.0
// Jobs of runs that were rendered already, resolved from the records that they left beside their pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gazetrace/output.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {

// The run that rendered given pictures.
struct RecordedRun {
  // With the scope `viewing`: settings, screen, and where the frame lies on it. Pictures carry their own gaze; the
  // run's gaze log is read only where the screen is stated nowhere else, and only if there still is a log of its name.
  ResolvedJob resolved;
  std::string view;  // the view of the display images; empty where the record does not state it

  [[nodiscard]] const JobSettings& settings() const { return resolved.job.settings; }
};

// The run whose record (NAME.run.json, see run_name_of()) lies beside the pictures of a pattern. Empty
// where there is no record, and where it is the record of other pictures: `settings_digest` is the digest that the
// pictures carry (FrameFacts::settings_digest). Throws Error(input) for a record that cannot be read.
std::optional<RecordedRun> find_recorded_run(const std::string& pattern, const std::string& settings_digest);

}  // namespace gazetrace
