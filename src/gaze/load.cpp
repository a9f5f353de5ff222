// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/text.hpp"
#include "gaze/finish.hpp"
#include "gaze/gaze_format.hpp"
#include "gazetrace/gaze.hpp"

namespace gazetrace {

#define GAZE_FORMAT(name, ...)               \
  double sniff_gaze_##name(const GazeFile&); \
  GazeLog read_gaze_##name(const GazeFile&, const GazeReadOptions&);
#include "gaze/formats/formats.def"
#undef GAZE_FORMAT

namespace {

const std::vector<GazeFormat>& formats() {
  static const std::vector<GazeFormat> all{
#define GAZE_FORMAT(name, text, description) {text, description, sniff_gaze_##name, read_gaze_##name},
#include "gaze/formats/formats.def"
#undef GAZE_FORMAT
  };
  return all;
}

const GazeFormat& choose_format(const GazeFile& file, const std::string& name) {
  std::vector<std::string> names;
  for (const GazeFormat& format : formats()) {
    if (format.name == name) {
      return format;
    }
    names.push_back(format.name);
  }
  if (!name.empty()) {
    throw Error(ErrorKind::usage, "", unknown_name_message("gaze format", name, names));
  }
  if (file.text.starts_with("\x1F\x8B")) {
    throw Error(ErrorKind::input, file.path, "is compressed with gzip, which is not read here",
                "unpack it first: gunzip");
  }
  const GazeFormat* best = nullptr;
  double sure = 0;
  for (const GazeFormat& format : formats()) {
    const double confidence = format.sniff(file);
    if (confidence > sure) {
      best = &format;
      sure = confidence;
    }
  }
  if (best == nullptr) {
    throw Error(ErrorKind::input, file.path, "is not a gaze log of a known format",
                "give a CSV or TSV with a header, or name the format with --gaze-format");
  }
  return *best;
}

}  // namespace

std::string_view to_string(GazeValidity validity) {
  switch (validity) {
    case GazeValidity::ok:
      return "ok";
    case GazeValidity::low_confidence:
      return "low_confidence";
    case GazeValidity::blink:
      return "blink";
    case GazeValidity::lost:
      return "lost";
    case GazeValidity::off_screen:
      return "off_screen";
    case GazeValidity::interpolated:
      return "interpolated";
  }
  return "lost";
}

std::string_view to_string(Eye eye) {
  switch (eye) {
    case Eye::left:
      return "left";
    case Eye::right:
      return "right";
    case Eye::cyclopean:
      return "cyclopean";
  }
  return "cyclopean";
}

std::vector<GazeFormatInfo> gaze_formats() {
  std::vector<GazeFormatInfo> infos;
  for (const GazeFormat& format : formats()) {
    infos.push_back({format.name, format.description});
  }
  return infos;
}

GazeLog load_gaze_log(const std::string& path, const GazeReadOptions& options) {
  const GazeFile file{path, read_text_file(path)};
  if (trim(file.text).empty()) {
    throw Error(ErrorKind::input, path, "is empty", "give a gaze log with a header and at least one sample");
  }
  const GazeFormat& format = choose_format(file, options.format);
  GazeLog log = format.read(file, options);
  log.source = path;
  log.format = format.name;
  finish_log(log, options.unordered);
  return log;
}

}  // namespace gazetrace
