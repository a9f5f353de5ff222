// SPDX-License-Identifier: Apache-2.0
// Pupil Labs Neon's and Invisible's own recording: `gaze ps1.raw`, little-endian float32 pairs in pixels of the scene
// camera from the top left, of which Neon's has 1600 x 1200 and Invisible's 1088 x 1080; `gaze ps1.time`, one uint64
// for each pair, in nanoseconds from 1970; `worn ps1.raw`, one byte for each pair. Directions need the lens:
// scene_camera.json beside them, as Pupil Cloud gives it.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "core/text.hpp"
#include "gazelog/json.hpp"
#include "gazelog/read_support.hpp"
#include "gazelog/row_samples.hpp"
#include "gazelog/xdf_file.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

std::string sibling(const std::string& path, const std::string& name) {
  return (fs::path(path).parent_path() / name).string();
}

// "gaze ps1.raw" or "gaze ps1.time" -> "ps1"
std::string part_of(const std::string& path) {
  const std::string stem = fs::path(path).stem().string();
  const std::size_t blank = stem.rfind(' ');
  return blank == std::string::npos ? "ps1" : stem.substr(blank + 1);
}

bool exists(const std::string& path) {
  std::error_code code;
  return fs::exists(path, code);
}

}  // namespace

double sniff_gaze_neon_native(const GazeFile& file) {
  const std::string name = fs::path(file.path).filename().string();
  const bool named = name.starts_with("gaze ps") && (name.ends_with(".raw") || name.ends_with(".time"));
  return named ? 0.98 : 0.0;
}

RawGaze read_gaze_neon_native(const GazeFile& file, const GazeReadOptions& options) {
  const std::string part = part_of(file.path);
  const std::string raw_path = sibling(file.path, "gaze " + part + ".raw");
  const std::string time_path = sibling(file.path, "gaze " + part + ".time");
  const std::string lens_path = sibling(file.path, "scene_camera.json");
  const bool has_lens = exists(lens_path);
  const std::string bytes = read_file_bytes(raw_path);
  const std::string times = read_file_bytes(time_path);
  const std::string worn_path = sibling(file.path, "worn " + part + ".raw");
  const std::string worn = exists(worn_path) ? read_file_bytes(worn_path) : "";
  if (bytes.size() % 8 != 0 || times.size() % 8 != 0 || bytes.size() != times.size()) {
    throw Error(ErrorKind::input, file.path,
                fmt::format("{} bytes of places and {} of times do not make pairs", bytes.size(), times.size()),
                "each sample has 8 bytes in both files; one of them may be cut off");
  }
  RawGaze raw;
  raw.way_out = has_lens ? "map gaze onto a surface in Pupil Cloud, or take directions from the head with "
                           "`frame` head"
                         : "map gaze onto a surface in Pupil Cloud, or put its scene_camera.json beside it and "
                           "take directions from the head with `frame` head";
  raw.source = file.path;
  raw.clock = "UTC, from 1970";
  raw.kind = options.frame == GazeFrame::head ? GazeKind::direction : GazeKind::scene_camera;
  raw.declared.time_column = {"gaze " + part + ".time", Evidence::format, {}};
  raw.declared.time_exponent = {0, Evidence::format, {}};
  bool is_invisible = false;
  if (const std::string path = sibling(file.path, "info.json"); exists(path)) {
    const JsonLeaves info(read_text_file(path), path);
    raw.nominal_rate_hz = info.number("gaze_frequency").value_or(0);
    is_invisible = info.has("glasses_serial_number") && !info.has("module_serial_number");
  }
  const std::size_t count = bytes.size() / 8;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = little_endian<std::uint64_t>(times.data() + 8 * i);
    if (t > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      throw Error(ErrorKind::input, time_path, fmt::format("time {} of record {} is beyond int64", t, i + 1));
    }
    RawSample sample = missing_row(static_cast<std::int64_t>(t), static_cast<std::int64_t>(i) + 1, Eye::cyclopean);
    sample.at.x = static_cast<double>(little_endian<float>(bytes.data() + 8 * i));
    sample.at.y = static_cast<double>(little_endian<float>(bytes.data() + 8 * i + 4));
    const bool known = std::isfinite(sample.at.x) && std::isfinite(sample.at.y);
    const bool is_worn = worn.size() != count || worn[i] != '\0';
    sample.validity = known && is_worn ? GazeValidity::ok : GazeValidity::lost;
    if (!known) {
      sample.at.x = sample.at.y = kNan;
    }
    raw.rows.push_back(sample);
  }
  const std::string columns = "gaze " + part + ".raw";
  if (options.frame == GazeFrame::head) {
    if (!has_lens) {
      throw Error(ErrorKind::input, file.path, "places on the scene picture become directions only through its lens",
                  "put scene_camera.json beside it");
    }
    declare_directions(raw, {columns, Evidence::format, "through scene_camera.json"}, GazeAxes::cv, Evidence::format,
                       file.path);
    raw.declared.form = PlaceForm::lens_pixel;
    raw.declared.unit = {PositionUnit::px, Evidence::format, {}};
    raw.declared.lens = load_scene_lens(lens_path);
    return raw;
  }
  raw.picture_px = is_invisible ? Vec2d{1088, 1080} : Vec2d{1600, 1200};
  add_note(raw, "picture size", is_invisible ? "1088x1080 px" : "1600x1200 px",
           is_invisible ? Evidence::sidecar : Evidence::format, is_invisible ? "info.json is Invisible's" : "");
  declare_places(raw, {PositionUnit::px, PositionOrigin::top_left, Evidence::format, columns}, file.path);
  return raw;
}

}  // namespace gazetrace
