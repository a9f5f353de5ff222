// SPDX-License-Identifier: Apache-2.0
// Checks settings.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "foveation/model.hpp"
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

void check_regions(const RegionSampling& regions) {
  for (const std::uint32_t samples : regions.samples) {
    require(samples >= 1 && samples <= kMaxSamples, "`region-samples`",
            std::to_string(samples) + " samples are not possible", "give 1 to " + std::to_string(kMaxSamples));
  }
  for (const int block : regions.blocks_px) {
    require(block >= 1 && block <= kMaxBlockPx, "`region-blocks`",
            "blocks of " + std::to_string(block) + " pixels are not possible",
            "give 1 to " + std::to_string(kMaxBlockPx));
  }
  constexpr std::string_view kEccentricities = "`region-eccentricities`";
  // tan(a/2) of eq. (1) ends at 180 degrees.
  const bool cone = regions.shape == RegionShape::cone;
  const double limit = regions.shape == RegionShape::disc ? 90.0 : 180.0;
  for (const double angle : regions.eccentricities_deg) {
    require(std::isfinite(angle) && angle >= 0 && (cone ? angle <= limit : angle < limit), kEccentricities,
            shown(angle) + " degrees are not possible",
            "give " + std::string(cone ? "0 to " : "0 to below ") + shown(limit) + " degrees");
  }
  require(regions.eccentricities_deg[0] <= regions.eccentricities_deg[1], kEccentricities,
          "the fovea (" + shown(regions.eccentricities_deg[0]) + ") is wider than the intermediate region (" +
              shown(regions.eccentricities_deg[1]) + ")",
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

void check_rate_and_blocks(const FoveationSettings& settings) {
  if (settings.spp) {
    require(*settings.spp > 0 && *settings.spp <= kMaxSamples, "`spp`",
            shown(*settings.spp) + " samples a pixel are not possible",
            "give more than 0, up to " + std::to_string(kMaxSamples));
  }
  require_between("`block-samples`", settings.block_samples, 1, 65536, "the samples of a block");
  require(settings.max_block_px >= 1 && settings.max_block_px <= kMaxDensityBlockPx &&
              (settings.max_block_px & (settings.max_block_px - 1)) == 0,
          "`max-block`", "blocks of up to " + std::to_string(settings.max_block_px) + " pixels are not possible",
          "give 1, 2, 4, 8 or 16");
}

void check_rates(const FoveationSettings& settings) {
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
  require(looks_first(settings.sampling) || !target.relmse, place,
          "sampling '" + to_string(settings.sampling) + "' does not know a frame's error", "give `sampling` adaptive");
  require(!settings.spp, place, "there is `spp`, too", "give one of them");
  if (target.jod) {
    require(*target.jod > 0 && *target.jod < 10, place, shown(*target.jod) + " JOD are not possible",
            "give more than 0 and less than 10, such as 9.5");
  } else {
    require_positive(place, *target.relmse, "a relative squared error");
  }
}

}  // namespace

void check_foveation(const FoveationSettings& settings) {
  if (const RegionSampling* regions = regions_of(settings.sampling)) {
    check_regions(*regions);
  } else if (const auto* density = std::get_if<DensitySampling>(&settings.sampling)) {
    check_density(*density);
  }
  check_rate_and_blocks(settings);
  check_rates(settings);
}

}  // namespace gazetrace
