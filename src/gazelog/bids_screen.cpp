// SPDX-License-Identifier: Apache-2.0
#include "gazelog/bids_recording.hpp"
#include "gazelog/eyelink_block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "gazelog/read_support.hpp"

namespace gazetrace {
namespace {

// EyeLink's inclusive corners are often written as the size, 1919 x 1079, or taken for it, 1281 x 1025.
void mend_resolution(DisplayGeometry& g, RawGaze& raw, const std::string& place) {
  const auto is_corner = [](int n) { return n % 2 == 1 && (n + 1) % 8 == 0; };
  const bool is_beyond = !is_usual_display_height(g.height_px) && is_usual_display_height(g.height_px - 1);
  const int change = is_corner(g.width_px) && is_corner(g.height_px) ? 1 : is_beyond && g.width_px % 8 == 1 ? -1 : 0;
  if (change != 0) {
    raw.warnings.push_back(
        fmt::format("{}: ScreenResolution {}x{} looks like inclusive corners taken for a size; {}x{} is used", place,
                    g.width_px, g.height_px, g.width_px + change, g.height_px + change));
    g.width_px += change;
    g.height_px += change;
  }
}

std::string screen_key(std::string_view what) {
  return fmt::format("StimulusPresentation.{}", what);
}

// The length exactly as it was before it was converted to metres, unless somebody has edited the metres since.
double with_every_bit(double from_metres_cm, double cm) {
  return std::abs(cm - from_metres_cm) <= 1e-12 * from_metres_cm ? cm : from_metres_cm;
}

}  // namespace

// ["top", "left"], in any order. No other origins can be read.
PositionOrigin bids_screen_origin(const Sidecars& events, const GazeReadOptions& options) {
  std::vector<std::string> words = events.texts(screen_key("ScreenOrigin"));
  if (words.empty()) {
    return PositionOrigin::top_left;
  }
  std::string stated;
  for (std::string& word : words) {
    word = to_lower(trim(word));
    stated += (stated.empty() ? "" : ", ") + word.substr(0, 20);
  }
  const auto is = [&](std::string_view vertical, std::string_view horizontal) {
    const auto either = [&](const std::string& word) { return word == vertical || word == horizontal; };
    return std::all_of(words.begin(), words.end(), either);
  };
  if (is("top", "left")) {
    return PositionOrigin::top_left;
  }
  if (is("bottom", "left")) {
    return PositionOrigin::bottom_left;
  }
  if (is("center", "centre")) {
    return PositionOrigin::center;
  }
  const bool from_right = is("top", "right") || is("bottom", "right");
  if (options.columns.origin != PositionOrigin::automatic) {
    return PositionOrigin::top_left;  // the user's option overrules it
  }
  if (from_right && options.flip_x) {
    return is("top", "right") ? PositionOrigin::top_left : PositionOrigin::bottom_left;
  }
  throw Error(ErrorKind::input, events.source(screen_key("ScreenOrigin")),
              fmt::format("its ScreenOrigin is '{}'", stated),
              from_right ? "give `flip-x`, which counts from the left"
                         : "top left, bottom left and center can be read; else give `origin`");
}

void read_bids_screen(const Sidecars& events, RawGaze& raw) {
  const auto& key = screen_key;
  const std::vector<double> resolution = events.numbers(key("ScreenResolution"));
  const std::vector<double> size = events.numbers(key("ScreenSize"));
  const std::vector<double> point = events.numbers(key("ScreenDistance"));
  const double distance = point.size() == 3 ? std::abs(point[2]) : events.number(key("ScreenDistance")).value_or(0);
  const std::string place = events.source(key("ScreenResolution"));
  DisplayGeometry g;
  const auto fits = [](const std::vector<double>& v, double most) {
    return v.size() == 2 && v[0] > 0 && v[1] > 0 && v[0] < most && v[1] < most;
  };
  if (fits(resolution, 1e5)) {
    g.width_px = static_cast<int>(std::lround(resolution[0]));
    g.height_px = static_cast<int>(std::lround(resolution[1]));
    mend_resolution(g, raw, place);
    add_note(raw, "display size", fmt::format("{}x{} px", g.width_px, g.height_px), Evidence::sidecar, place);
  }
  if (fits(size, 1e4)) {
    // Sizes are in metres. Drafts of the standard had centimetres, and no screen is 5 m wide.
    const double to_cm = size[0] > 5 ? 1 : 100;
    g.width_cm = size[0] * to_cm;
    g.height_cm = size[1] * to_cm;
    if (to_cm == 1) {
      raw.warnings.push_back(
          fmt::format("{}: ScreenSize {} is taken for centimetres, as drafts had it", place, size[0]));
    }
    add_note(raw, "display size", fmt::format("{:.5g} x {:.5g} cm", g.width_cm, g.height_cm), Evidence::sidecar, place);
  }
  if (distance > 0 && distance < 1e4) {
    g.distance_cm = distance > 10 ? distance : distance * 100;
    if (point.size() == 3 && (point[0] != 0 || point[1] != 0)) {
      raw.warnings.push_back(fmt::format(
          "{}: of ScreenDistance [{}, {}, {}] only the last is used, for the distance; where the eye stands "
          "beside the display's center can be given with `screen-eye-cm`",
          events.source(key("ScreenDistance")), point[0], point[1], point[2]));
    }
    add_note(raw, "distance", fmt::format("{:.5g} cm", g.distance_cm), Evidence::sidecar, place);
  }
  // The keys from here on are gazetrace's own.
  if (const std::vector<double> cm = events.numbers(key("ScreenSizeCm")); cm.size() == 2) {
    g.width_cm = with_every_bit(g.width_cm, cm[0]);
    g.height_cm = with_every_bit(g.height_cm, cm[1]);
  }
  g.distance_cm = with_every_bit(g.distance_cm, events.number(key("ScreenDistanceCm")).value_or(0));
  if (const std::vector<double> eye = events.numbers(key("EyeOffsetCm")); eye.size() == 2) {
    g.eye_x_cm = eye[0];
    g.eye_y_cm = eye[1];
  }
  if (const std::vector<double> density = events.numbers(key("PixelsPerDegree"));
      density.size() == 2 && density[0] > 0 && density[1] > 0) {
    raw.pixels_per_degree = Vec2d{density[0], density[1]};
  }
  if (g.width_px > 0 || g.width_cm > 0 || g.distance_cm > 0) {
    raw.recording_geometry = g;
  }
}

bool states_screen_origin(const Sidecars& events) {
  return !events.texts(screen_key("ScreenOrigin")).empty();
}

}  // namespace gazetrace
