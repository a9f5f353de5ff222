// SPDX-License-Identifier: Apache-2.0
// Checks settings.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"

namespace gazetrace {
namespace {

constexpr int kMaxBlockPx = 64;  // since a site counts its pixels in 16 bits
constexpr int kMaxDensityBlockPx = 16;
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
  constexpr std::string_view kPlace = "`region-angles`";
  // tan(a/2) of eq. (1) ends at 180 degrees; a cone ends at 180 degrees of eccentricity.
  const bool cone = settings.shape == RegionShape::cone;
  const double limit = cone ? 180.0 / eccentricity_share(settings.reading) : 180.0;
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

void require_between(std::string_view place, double value, double least, double most, std::string_view what) {
  require(value >= least && value <= most, place, shown(value) + " is not possible for " + std::string(what),
          "give " + shown(least) + " to " + shown(most));
}

void require_positive(std::string_view place, double value, std::string_view what) {
  require(std::isfinite(value) && value > 0, place, shown(value) + " is not possible for " + std::string(what),
          "give a number above 0");
}

void check_density(const FoveationSettings& settings) {
  require(!(settings.budget_spp && settings.budget_samples), "`budget-samples`", "there are two budgets",
          "give `budget-spp` or `budget-samples`");
  if (settings.budget_spp) {
    require(*settings.budget_spp > 0 && *settings.budget_spp <= kMaxSamples, "`budget-spp`",
            shown(*settings.budget_spp) + " samples a pixel are not possible",
            "give more than 0, up to " + std::to_string(kMaxSamples));
  }
  require(!settings.budget_samples || *settings.budget_samples > 0, "`budget-samples`", "0 samples are no budget",
          "give at least 1");
  require_between("`block-samples`", settings.block_samples, 1, 65536, "the samples of a block");
  require(settings.max_block_px >= 1 && settings.max_block_px <= kMaxDensityBlockPx &&
              (settings.max_block_px & (settings.max_block_px - 1)) == 0,
          "`max-block`", "blocks of up to " + std::to_string(settings.max_block_px) + " pixels are not possible",
          "give 1, 2, 4, 8 or 16");
  require(settings.density_floor > 0 && settings.density_floor <= 1, "`density-floor`",
          "a least density of " + std::to_string(settings.density_floor) + " is not possible",
          "give more than 0, up to 1: every place needs some samples");
}

void check_rates(const FoveationSettings& settings) {
  const bool by_pilot = settings.falloff == "visible";
  require(settings.min_spp >= 0 && settings.max_spp > 0 && settings.min_spp <= settings.max_spp &&
              settings.max_spp <= kMaxSamples,
          "`min-spp`", shown(settings.min_spp) + " to " + shown(settings.max_spp) + " samples a pixel are not possible",
          "give at least 0, and a `max-spp` of no less, up to " + std::to_string(kMaxSamples));
  const QualityTarget& target = settings.target;
  if (!target.is_given()) {
    return;
  }
  const std::string_view place = target.relmse ? "`target-relmse`" : "`target-jod`";
  require(!target.relmse || !target.jod, place, "there are several targets", "give `target-relmse` or `target-jod`");
  require(by_pilot || !target.relmse, place, "the fall-off '" + settings.falloff + "' does not know a frame's error",
          "give `falloff` visible");
  require(!settings.budget_spp && !settings.budget_samples, place, "there is a budget, too",
          "give a target, or `budget-spp` or `budget-samples`");
  if (target.jod) {
    require(*target.jod > 0 && *target.jod < 10, place, shown(*target.jod) + " JOD are not possible",
            "give more than 0 and less than 10, such as 9.5");
  } else {
    require_positive(place, *target.relmse, "a relative squared error");
  }
}

void check_parameters(const FoveationSettings& settings) {
  const FalloffParameters& p = settings.parameters;
  const Vec3d& ramp = p.ramp;
  require(
      ramp.x >= 0 && ramp.x <= ramp.y && ramp.y <= 180 && ramp.z >= 0 && ramp.z <= 1, "`falloff-ramp`",
      shown(ramp.x) + "," + shown(ramp.y) + "," + shown(ramp.z) + " are not two ascending eccentricities and a density",
      "give degrees, more degrees up to 180, and 0 to 1");
  require(p.mar_slope >= 0 && p.mar_slope <= 180 && p.mar_foveal_deg >= 0 && p.mar_foveal_deg <= 180, "`falloff-mar`",
          std::to_string(p.mar_slope) + "," + std::to_string(p.mar_foveal_deg) + " are not possible",
          "give two numbers of 0 to 180, such as 0.022,0.0208");
  require(p.contrast > 0 && p.contrast <= 1, "`falloff-contrast`",
          "a contrast of " + std::to_string(p.contrast) + " is not possible", "give more than 0, up to 1");
  require(settings.falloff != "geisler-perry" || p.contrast > 1.0 / 64, "`falloff-contrast`",
          "geisler-perry sees no contrast of 1/64 or less", "give more than 0.015625");
  require_positive("`falloff-luminance`", p.luminance_cd_m2, "a luminance in cd/m2");
  require_positive("`falloff-log-polar`", p.log_polar_sigma, "the ratio of frame and buffer");
  require_positive("`falloff-log-polar`", p.log_polar_alpha, "the exponent of the kernel");
  require(settings.falloff != "table" || !p.table.points.empty(), "`falloff-table`",
          "the fall-off 'table' has no table", "name a CSV of ecc_deg,density");
  const std::vector<Vec2d>& points = p.table.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    require(
        std::isfinite(points[i].x) && points[i].y >= 0 && points[i].y <= 1 && (i == 0 || points[i].x > points[i - 1].x),
        "`falloff-table`", "point " + std::to_string(i + 1) + " is out of order or its density not in 0 to 1",
        "sort the points by eccentricity, each once");
  }
}

}  // namespace

void check_foveation(const FoveationSettings& settings) {
  std::vector<std::string> names;
  for (const FalloffInfo& info : falloffs()) {
    names.push_back(info.name);
  }
  if (std::find(names.begin(), names.end(), settings.falloff) == names.end()) {
    throw Error(ErrorKind::usage, "falloff", unknown_name_message("falloff", settings.falloff, names));
  }
  check_samples("`spp`", settings.uniform_spp);
  for (const std::uint32_t samples : settings.region_samples) {
    check_samples("`region-samples`", samples);
  }
  for (const int block : settings.region_blocks_px) {
    require(block >= 1 && block <= kMaxBlockPx, "`region-blocks`",
            "blocks of " + std::to_string(block) + " pixels are not possible",
            "give 1 to " + std::to_string(kMaxBlockPx));
  }
  check_angles(settings);
  check_density(settings);
  check_rates(settings);
  check_parameters(settings);
}

}  // namespace gazetrace
