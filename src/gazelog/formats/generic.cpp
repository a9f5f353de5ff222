// SPDX-License-Identifier: Apache-2.0
// Any CSV or TSV with a column of time and two or three of position; the user declares what the header does not say.
#include "core/text.hpp"
#include "gazelog/mapped_table.hpp"

namespace gazetrace {

double sniff_gaze_generic(const GazeFile& file) {
  constexpr std::size_t kLooked = 256;  // further on, zeros are damage
  if (head_of(file, kLooked).find_first_of(std::string_view("\0\xFF", 2)) != std::string_view::npos) {
    return 0.0;  // binary
  }
  LineReader lines(file.text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view text = trim(line);
    if (text.empty() || text.front() == '#') {
      continue;
    }
    if (text.front() == '{' || text.front() == '[') {
      return 0.0;  // JSON, such as a sidecar
    }
    return text.find_first_of(",;\t") == std::string_view::npos ? 0.05 : 0.2;
  }
  return 0.05;
}

RawGaze read_gaze_generic(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  RawGaze raw = read_mapped_table(file, table, options.columns, ValidityStyle::any);
  raw.is_own_table = true;
  if (table.find("ET_GazeLeftx") && raw.declared.unit.value == PositionUnit::automatic) {
    raw.declared.unit = {PositionUnit::px, Evidence::format, "as iMotions exports gaze"};
    raw.declared.missing_value = -1;
  }
  return raw;
}

}  // namespace gazetrace
