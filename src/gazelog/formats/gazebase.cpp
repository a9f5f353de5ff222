// SPDX-License-Identifier: Apache-2.0
// GazeBase and GazeBaseVR: `n` in milliseconds, gaze x, y in degrees from straight ahead, right and up, `val` 0 where
// valid, from a desktop EyeLink; GazeBaseVR has lx, ly, rx, ry of each eye, from a headset. The angles become
// directions, for which no display is needed.
#include "gazelog/mapped_table.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {

double sniff_gaze_gazebase(const GazeFile& file) {
  if (!file.text.starts_with("n,x,y")) {
    return 0.0;
  }
  const GazeFile header{file.path, std::string(first_line_of(file))};
  const DelimitedTable table = open_table(header);
  const bool vr = table.has_all({"lx", "ly", "rx", "ry"});
  return table.has_all({"n", "x", "y"}) && (vr || table.has_all({"val"})) ? 0.9 : 0.0;
}

RawGaze read_gaze_gazebase(const GazeFile& file, const GazeReadOptions& options) {
  const DelimitedTable table = open_table(file);
  GazeColumns c;
  c.time = "n";
  c.time_unit = TimeUnit::ms;
  c.x = "x";
  c.y = "y";
  c.position_unit = PositionUnit::deg;
  c.origin = PositionOrigin::center;
  if (table.find("val")) {
    c.validity = "val";
    c.valid_values = {"0"};
  }
  if (table.has_all({"lx", "ly", "rx", "ry"})) {
    c.left.x = "lx";
    c.left.y = "ly";
    c.right.x = "rx";
    c.right.y = "ry";
  }
  RawGaze raw = read_preset(file, table, options, c);
  raw.declared.degrees_are_directions = true;
  if (c.left.x.empty()) {
    raw.device = GazeDevice::desktop;
    add_note(raw, "device", std::string(to_string(GazeDevice::desktop)), Evidence::format,
             "EyeLink 1000, chin on a rest");
  }
  return raw;
}

}  // namespace gazetrace
