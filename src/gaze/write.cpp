// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>

#include "gazetrace/gaze.hpp"

namespace gazetrace {
namespace {

// Lengths are written in mm where dividing by ten gives the very same number back, else in cm.
std::string geometry_line(std::string_view key, std::initializer_list<double> values_cm) {
  bool exact = true;
  for (const double value : values_cm) {
    exact = exact && value * 10.0 / 10.0 == value;
  }
  std::string line = fmt::format("# {}_{}", key, exact ? "mm" : "cm");
  for (const double value : values_cm) {
    line += fmt::format(" {}", exact ? value * 10.0 : value);
  }
  return line + "\n";
}

std::string preamble(const GazeLog& log) {
  std::string text = "# gazetrace-gaze 1\n";
  if (log.recording_geometry) {
    const DisplayGeometry& g = *log.recording_geometry;
    if (g.width_px > 0 && g.height_px > 0) {
      text += fmt::format("# display_px {} {}\n", g.width_px, g.height_px);
    }
    if (g.width_cm > 0 && g.height_cm > 0) {
      text += geometry_line("display", {g.width_cm, g.height_cm});
    }
    if (g.distance_cm > 0) {
      text += geometry_line("distance", {g.distance_cm});
    }
    if (g.eye_x_cm != 0 || g.eye_y_cm != 0) {
      text += fmt::format("# eye_cm {} {}\n", g.eye_x_cm, g.eye_y_cm);
    }
  }
  if (!log.clock.empty()) {
    text += fmt::format("# clock {}\n", log.clock);
  }
  return text;
}

// Shortest text that reads back as the same bits; nothing for what is unknown.
template <class Number>
void append_number(std::string& text, Number value) {
  text += ',';
  if (!std::isnan(value)) {
    fmt::format_to(std::back_inserter(text), "{}", value);
  }
}

}  // namespace

void write_gaze_csv(const GazeLog& log, const std::string& path) {
  bool has_confidence = false;
  bool has_pupil = false;
  for (const GazeSample& sample : log.samples) {
    has_confidence = has_confidence || !std::isnan(sample.confidence);
    has_pupil = has_pupil || !std::isnan(sample.pupil);
  }
  const bool is_screen = log.kind == GazeKind::screen;
  std::string text = preamble(log);
  text += is_screen ? "t[ns],u[1],v[1],valid,eye" : "t[ns],dx,dy,dz,valid,eye";
  text += has_confidence ? ",confidence" : "";
  text += has_pupil ? ",pupil" : "";
  text += '\n';
  for (const GazeSample& sample : log.samples) {
    fmt::format_to(std::back_inserter(text), "{}", sample.t_ns);
    if (is_screen) {
      append_number(text, sample.u);
      append_number(text, sample.v);
    } else {
      append_number(text, sample.direction.x);
      append_number(text, sample.direction.y);
      append_number(text, sample.direction.z);
    }
    fmt::format_to(std::back_inserter(text), ",{},{}", to_string(sample.validity), to_string(sample.eye));
    if (has_confidence) {
      append_number(text, sample.confidence);
    }
    if (has_pupil) {
      append_number(text, sample.pupil);
    }
    text += '\n';
  }
  // Under its name only when complete.
  const std::string part = path + ".part";
  std::FILE* const file = std::fopen(part.c_str(), "wb");
  bool good = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  good = (file == nullptr || std::fclose(file) == 0) && good;
  std::error_code code;
  if (good) {
    std::filesystem::rename(part, path, code);
  }
  if (!good || code) {
    std::filesystem::remove(part, code);
    throw Error(ErrorKind::runtime, path, "cannot be written", "check that its folder exists and has room");
  }
}

}  // namespace gazetrace
