// SPDX-License-Identifier: Apache-2.0
// Finds the colors that a video states from the name of a display.
#include <algorithm>

#include "core/text.hpp"
#include "gazetrace/video.hpp"

namespace gazetrace {
namespace {

struct ViewNames {
  std::string display, view;
};

// Takes the names from "CONFIG: display DISPLAY, view VIEW".
ViewNames names_of(const std::string& description) {
  constexpr std::string_view kDisplay = ": display ", kView = ", view ";
  const std::string text = to_lower(description);
  const std::size_t display = text.find(kDisplay);
  const std::size_t view = text.find(kView, display == std::string::npos ? 0 : display);
  if (display == std::string::npos || view == std::string::npos) {
    return {text, {}};
  }
  const std::size_t begin = display + kDisplay.size();
  return {text.substr(begin, view - begin), text.substr(view + kView.size())};
}

bool has(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

const std::vector<VideoColor>& video_colors() {
  static const std::vector<VideoColor> kColors{
      {"srgb", "bt709", "iec61966-2-1"},
      // H.273 has no code for BT.1886, but players show bt709 as such a display does.
      {"rec709", "bt709", "bt709"},
      {"display-p3", "smpte432", "iec61966-2-1"},
      {"linear", "bt709", "linear"}};
  return kColors;
}

VideoColor video_color_by_name(const std::string& name) {
  std::vector<std::string> known;
  for (const VideoColor& color : video_colors()) {
    if (color.name == name) {
      return color;
    }
    known.push_back(color.name);
  }
  throw Error(ErrorKind::usage, "`color`", unknown_name_message("color", name, known));
}

VideoColor video_color_of_view(const std::string& description) {
  const auto [display, view] = names_of(description);
  for (const char* const hdr : {"2100", "2084", "pq", "hlg", "hdr"}) {
    if (has(display, hdr) || has(view, hdr)) {
      throw Error(ErrorKind::usage, "'" + description + "'", "is of high dynamic range, which 8 bits cannot hold",
                  "render through a view of standard range");
    }
  }
  if (view == "raw" || display == "raw") {
    return video_color_by_name("linear");
  }
  if (display.empty() || has(display, "srgb")) {
    return video_color_by_name("srgb");
  }
  if (has(display, "1886") || has(display, "709")) {
    return video_color_by_name("rec709");
  }
  if (has(display, "display p3") || has(display, "display-p3")) {
    return video_color_by_name("display-p3");
  }
  throw Error(ErrorKind::usage, "'" + description + "'", "it is not known how a video file states these colors",
              "give `color` srgb, rec709 or display-p3");
}

}  // namespace gazetrace
