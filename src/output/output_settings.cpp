// SPDX-License-Identifier: Apache-2.0
// Checks output settings before the first ray.
#include <fmt/format.h>

#include <algorithm>

#include "gazetrace/aovs.hpp"
#include "gazetrace/output.hpp"
#include "output/aovs.hpp"
#include "output/exr.hpp"

namespace gazetrace {
namespace {

void check_known(const char* what, const std::string& given, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), given) == known.end()) {
    throw Error(ErrorKind::usage, "", unknown_name_message(what, given, known));
  }
}

void check_exr_name(const std::string& pattern, bool require_number) {
  if (!pattern.ends_with(".exr")) {
    throw Error(ErrorKind::usage, pattern, "a scene-linear file must end in .exr");
  }
  frame_file_name(pattern, 1, require_number);
}

}  // namespace

const std::vector<AovInfo>& aov_infos() {
  static const std::vector<AovInfo> kInfos{
      {"albedo", "albedo.R .G .B: the share of light that the first surface reflects, 0 to 1, linear Rec.709, half"},
      {"normal", "normal.X .Y .Z: of the first surface, world axes (+y up), unit length where a pixel sees one, half"},
      {"depth",
       "depth.Z: of the first surface along the axis of the view, metres, float; infinite where there is none"},
      {"samples", "samples: effective number of samples behind the pixel, float"},
      {"variance",
       "variance: of the pixel's mean luminance, squared scene-linear units, float, as far as the spread of "
       "its samples tells"},
      {"eccentricity",
       "eccentricity: angle between the pixel and the true gaze, as the eye sees it, degrees, float; "
       "NaN in frames without gaze"},
  };
  return kInfos;
}

const std::vector<std::string>& aov_names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const AovInfo& info : aov_infos()) {
      names.push_back(info.name);
    }
    return names;
  }();
  return kNames;
}

bool show_first_hits(const std::vector<std::string>& aovs) {
  return std::any_of(aovs.begin(), aovs.end(),
                     [](const std::string& aov) { return aov == "albedo" || aov == "normal" || aov == "depth"; });
}

void check_output_settings(const OutputSettings& settings, bool several_frames) {
  if (!settings.exr.pattern.empty()) {
    check_exr_name(settings.exr.pattern, several_frames);
    check_known("EXR compression", settings.exr.compression, exr_compression_names());
  }
  for (const std::string& aov : settings.exr.aovs) {
    check_known("AOV", aov, aov_names());
    if (settings.exr.pattern.empty()) {
      throw Error(ErrorKind::usage, "`aov`", "AOVs are channels of an EXR, and none is written",
                  "add `output` frame.####.exr");
    }
  }
  if (!settings.map_pattern.empty()) {
    check_exr_name(settings.map_pattern, several_frames);
  }
  if (!settings.display.pattern.empty()) {
    frame_file_name(settings.display.pattern, 1, several_frames);
    display_image_bits(settings.display);
    if (settings.display.quality < 1 || settings.display.quality > 100) {
      throw Error(ErrorKind::usage, "",
                  fmt::format("a JPEG quality of {} lies outside 1..100", settings.display.quality));
    }
  }
}

}  // namespace gazetrace
