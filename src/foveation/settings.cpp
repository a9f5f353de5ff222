// SPDX-License-Identifier: Apache-2.0
// The list of fall-offs, and what settings are allowed.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"

namespace gazetrace {
namespace {

constexpr int kMaxBlockPx = 64;                   // a site counts its pixels in 16 bits
constexpr std::uint32_t kMaxSamples = 1'000'000;  // times 64 x 64 pixels still fits 32 bits

void require(bool holds, std::string_view place, const std::string& problem, std::string_view remedy) {
  if (!holds) {
    throw Error(ErrorKind::usage, place, problem, remedy);
  }
}

std::string shown(double value) {
  std::string text = std::to_string(value);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') {
      text.pop_back();
    }
  }
  return text;
}

void check_samples(std::string_view place, std::uint32_t samples) {
  require(samples >= 1 && samples <= kMaxSamples, place, std::to_string(samples) + " samples are not possible",
          "give 1 to " + std::to_string(kMaxSamples));
}

void check_angles(const FoveationSettings& settings) {
  constexpr std::string_view kPlace = "--region-angles";
  // tan(a/2) of eq. (1) ends at 180 degrees; a cone ends at 180 degrees of eccentricity.
  const bool cone = settings.shape == RegionShape::cone;
  const double limit = cone && settings.reading == AngleReading::full_angle ? 360.0 : 180.0;
  for (const double angle : settings.region_angles_deg) {
    require(std::isfinite(angle) && angle >= 0 && (cone ? angle <= limit : angle < limit), kPlace,
            shown(angle) + " degrees are not possible",
            "give " + std::string(cone ? "0 to " : "0 to below ") + shown(limit) + " degrees");
  }
  require(settings.region_angles_deg[0] <= settings.region_angles_deg[1], kPlace,
          "the fovea (" + shown(settings.region_angles_deg[0]) + ") is wider than the intermediate region (" +
              shown(settings.region_angles_deg[1]) + ")",
          "give the smaller angle first");
}

}  // namespace

std::vector<FalloffInfo> falloffs() {
  return {
#define FALLOFF(name, description) {#name, description},
#include "foveation/falloffs.def"
#undef FALLOFF
  };
}

void check_foveation(const FoveationSettings& settings) {
  std::vector<std::string> names;
  for (const FalloffInfo& info : falloffs()) {
    names.push_back(info.name);
  }
  if (std::find(names.begin(), names.end(), settings.falloff) == names.end()) {
    throw Error(ErrorKind::usage, "falloff", unknown_name_message("falloff", settings.falloff, names));
  }
  check_samples("--spp", settings.uniform_spp);
  for (const std::uint32_t samples : settings.region_samples) {
    check_samples("--region-samples", samples);
  }
  for (const int block : settings.region_blocks_px) {
    require(block >= 1 && block <= kMaxBlockPx, "--region-blocks",
            "blocks of " + std::to_string(block) + " pixels are not possible",
            "give 1 to " + std::to_string(kMaxBlockPx));
  }
  check_angles(settings);
}

FoveationSettings widened(const FoveationSettings& settings, double by_deg) {
  FoveationSettings wider = settings;
  const bool is_diameter = settings.reading == AngleReading::full_angle;
  // tan(a/2) of a disc has its pole at 180 degrees.
  const double most = settings.shape == RegionShape::disc ? 179.0 : is_diameter ? 360.0 : 180.0;
  for (double& angle : wider.region_angles_deg) {
    angle = std::max(angle, std::min(angle + (is_diameter ? 2 : 1) * by_deg, most));
  }
  return wider;
}

}  // namespace gazetrace
