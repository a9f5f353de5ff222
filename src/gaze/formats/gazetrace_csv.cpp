// SPDX-License-Identifier: Apache-2.0
// gazetrace CSV. Preamble `# gazetrace-gaze 1` with `# display_px W H`, `# display_mm W H`, `# distance_mm D` and
// `# clock TEXT`; header with units, `t[ns],u[1],v[1],valid,eye,...` or `t[ns],dx,dy,dz,...`.
#include <fmt/format.h>

#include "gaze/delimited.hpp"

namespace gazetrace {

double sniff_gaze_gazetrace_csv(const GazeFile& file) {
  constexpr std::string_view kMark = "# gazetrace-gaze";
  if (file.text.compare(0, kMark.size(), kMark) == 0) {
    return 1.0;
  }
  const auto has = [line = file.text.substr(0, file.text.find('\n'))](std::string_view text) {
    return line.find(text) != std::string::npos;
  };
  return has("t[ns],") && (has("u[1],v[1]") || has("dx,dy,dz")) ? 0.9 : 0.0;
}

GazeLog read_gaze_gazetrace_csv(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  if (table.gazetrace_version.value_or(1) != 1) {
    throw Error(ErrorKind::input, file.path,
                fmt::format("is gazetrace CSV of version {}; this program reads version 1", *table.gazetrace_version),
                "use a newer gazetrace");
  }
  const bool names = options.columns.valid_values.empty();
  return read_table(file, table, options, names ? ValidityStyle::names : ValidityStyle::any);
}

}  // namespace gazetrace
