// SPDX-License-Identifier: Apache-2.0
// gazetrace CSV. Preamble `# gazetrace-gaze 1` with `# display_px W H`, `# display_mm W H`, `# distance_mm D` and `#
// clock TEXT`; header with units, `t[ns],u[1],v[1],valid,eye,...` or `t[ns],dx,dy,dz,...`, with a head's pose
// `hx[m],hy[m],hz[m],hqx,hqy,hqz,hqw` (position and quaternion; empty in rows without one). Everything that is not a
// row stands in the preamble, see mapped_table.hpp.
#include <fmt/format.h>

#include "gazelog/mapped_table.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {

double sniff_gaze_gazetrace_csv(const GazeFile& file) {
  constexpr std::string_view kMark = "# gazetrace-gaze";
  if (file.text.starts_with(kMark)) {
    return 1.0;
  }
  const WordsIn has{first_line_of(file)};
  return has("t[ns],") && (has("u[1],v[1]") || has("dx,dy,dz")) ? 0.9 : 0.0;
}

RawGaze read_gaze_gazetrace_csv(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  const GazetracePreamble preamble = read_preamble(file, table);
  if (preamble.version.value_or(1) != 1) {
    throw Error(ErrorKind::input, file.path,
                fmt::format("is gazetrace CSV of version {}; this program reads version 1", *preamble.version),
                "use a newer gazetrace");
  }
  GazeColumns columns = options.columns;
  if (columns.head_x.empty() && columns.head_rotation_x.empty() &&
      table.has_all({"hx[m]", "hy[m]", "hz[m]", "hqx", "hqy", "hqz", "hqw"})) {
    std::tie(columns.head_x, columns.head_y, columns.head_z) = std::tuple("hx[m]", "hy[m]", "hz[m]");
    std::tie(columns.head_rotation_x, columns.head_rotation_y, columns.head_rotation_z) = xyz("hq");
    columns.head_rotation_w = "hqw";
  }
  const bool names = options.columns.valid_values.empty() && options.columns.valid_mask == 0;
  RawGaze raw = read_mapped_table(file, table, columns, names ? ValidityStyle::names : ValidityStyle::any);
  const GazeRecord& stated = preamble.stated;
  raw.nominal_rate_hz = stated.nominal_rate_hz;
  raw.sample_age_unknown = stated.sample_age_unknown;
  raw.stated_eye = stated.stated_eye;
  raw.device = stated.device;
  raw.events = stated.events;
  raw.calibrations = stated.calibrations;
  raw.head.insert(raw.head.end(), stated.head.begin(), stated.head.end());
  if (raw.stated_eye) {
    add_note(raw, "chosen eye", std::string(to_string(*raw.stated_eye)), Evidence::header,
             "chosen before it was converted");
  }
  if (raw.device) {
    add_note(raw, "device", std::string(to_string(*raw.device)), Evidence::header);
  }
  return raw;
}

}  // namespace gazetrace
