// SPDX-License-Identifier: Apache-2.0
// A table whose columns are declared or found by header: the generic format, gazetrace CSV, and presets.
#pragma once

#include <string>
#include <tuple>

#include "gazelog/columns.hpp"

namespace gazetrace {

// `# display_px W H`, `# display_mm W H`, `# distance_mm D`, `# clock TEXT` above a header; in gazetrace CSV also what
// is not a row: `# event TYPE EYE BEGIN_NS END_NS TEXT`, `# calibration EYE NS MEAN_DEG MAX_DEG`, `# head NS X Y Z QX
// QY QZ QW`.
struct GazetracePreamble {
  std::optional<int> version;  // N of `# gazetrace-gaze N`
  // Clock and geometry and, of gazetrace CSV, `# rate_hz R`, `# sample_age unknown`, `# device desktop`, `# eye right`
  // (whose gaze the cyclopean rows are, or that was taken without such), `# kind scene-camera` and the records above.
  GazeRecord stated;
};
// Throws Error(input) for known lines with values that are wrong.
GazetracePreamble read_preamble(const GazeFile& file, const DelimitedTable& table);

// The unit of a column of stamps by their steps, with a warning; Error(input) where these fit none.
int time_exponent_by_statistics(const GazeFile& file, const DelimitedTable& table, std::size_t column, RawGaze& raw);

// Reads the rows, and declares what the header and the map say about them. `columns` replaces `options.columns`; it is
// a preset merged with what the user declared, and `evidence` says where the preset's part comes from.
RawGaze read_mapped_table(const GazeFile& file, const DelimitedTable& table, const GazeColumns& columns,
                          ValidityStyle style, Evidence evidence = Evidence::option);

// The names of three columns: "gaze_" -> gaze_x, gaze_y, gaze_z.
inline std::tuple<std::string, std::string, std::string> xyz(const std::string& stem) {
  return {stem + "x", stem + "y", stem + "z"};
}

// Takes the head's pose from columns in Unity's axes, whose names begin so.
inline void take_unity_head(GazeColumns& c, const std::string& position, const std::string& rotation) {
  std::tie(c.head_x, c.head_y, c.head_z) = xyz(position);
  std::tie(c.head_rotation_x, c.head_rotation_y, c.head_rotation_z) = xyz(rotation);
  c.head_axes = GazeAxes::unity;
}

// Reads a format that is a table with its own columns: what the user declared overrides `preset`.
RawGaze read_preset(const GazeFile& file, const DelimitedTable& table, const GazeReadOptions& options,
                    const GazeColumns& preset);

}  // namespace gazetrace
