// SPDX-License-Identifier: Apache-2.0
// Checks the settings of a comparison.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/compare.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

void require(bool holds, const char* option, double value, const char* wanted) {
  if (!holds || !std::isfinite(value)) {
    throw Error(ErrorKind::usage, option, fmt::format("{} is not {}", value, wanted));
  }
}

}  // namespace

void check_comparison(const ComparisonSettings& settings) {
  const DisplayPhotometry& p = settings.photometry;
  require(p.peak_cd_m2 > 0, "`peak-cd-m2`", p.peak_cd_m2, "a luminance above 0");
  require(settings.metric.peak_cd_m2 > 0, "`peak-cd-m2`", settings.metric.peak_cd_m2, "a luminance above 0");
  require(p.contrast > 1, "`contrast`", p.contrast, "a ratio above 1");
  require(p.ambient_lux >= 0, "`ambient-lux`", p.ambient_lux, "0 lux or more");
  require(p.reflectivity >= 0 && p.reflectivity <= 1, "`reflectivity`", p.reflectivity, "a share of 0 to 1");
  require(settings.metric.relmse_epsilon > 0, "`relmse-epsilon`", settings.metric.relmse_epsilon, "above 0");
  require(settings.metric.pixels_per_degree > 0, "flip", settings.metric.pixels_per_degree,
          "a number of pixels per degree above 0");
  require(settings.frames_per_second >= 0, "`fps`", settings.frames_per_second, "a frame rate");
  for (const std::string& name : settings.metrics) {
    if (!settings.pooling_weights.empty() && name != "fovvideovdp") {
      throw Error(ErrorKind::usage, "`pooling-weights`", name + " has no pooling weights",
                  "give `metrics` fovvideovdp alone");
    }
  }
  // Relative code values fill the range between black and white, so there must be such a range.
  const double black = black_level_cd_m2(p);
  if (!is_absolute(settings.metric.response) && !(black < p.peak_cd_m2)) {
    throw Error(ErrorKind::usage, "`peak-cd-m2`",
                fmt::format("a white of {:g} cd/m2 is not brighter than the black of {:g} cd/m2 that the room's light "
                            "leaves",
                            p.peak_cd_m2, black),
                "give a larger `peak-cd-m2`, or less `ambient-lux` or `reflectivity`");
  }
}

void complete_settings(ComparisonSettings& settings, int threads) {
  settings.metric.threads = threads;
  settings.metric.peak_cd_m2 = settings.photometry.peak_cd_m2;
  if (settings.metric.response == DisplayResponse::linear_hdr) {
    settings.metric.response = DisplayResponse::pq;  // light is scored as the code values of such a display
  }
  settings.photometry.response = settings.metric.response;
  if (settings.view) {
    settings.metric.pixels_per_degree = 1 / (settings.view->step_x * kDegPerRad);
  }
}

void fix_flip_exposures(ComparisonSettings& settings, const ImageRgb& reference_light) {
  if (std::find(settings.metrics.begin(), settings.metrics.end(), "hdr_flip") == settings.metrics.end()) {
    return;
  }
  FlipExposureSettings& fixed = settings.metric.hdr_flip;
  const FlipExposures exposures = flip_exposures(reference_light, fixed);
  fixed.start_ev = exposures.start_ev;
  fixed.stop_ev = exposures.stop_ev;
  fixed.count = exposures.count;
}

}  // namespace gazetrace
