// SPDX-License-Identifier: Apache-2.0
#include "temporal/two_sided.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "core/luminance.hpp"
#include "temporal/clip.hpp"
#include "temporal/for_each_place.hpp"
#include "temporal/resampling_error.hpp"
#include "temporal/residuals.hpp"
#include "temporal/worth.hpp"

namespace gazetrace {
namespace {

// Of different samples, so that variances are added.
PastSums sum_of(const PastSums& a, const PastSums& b) {
  PastSums sum;
  sum.radiance = a.radiance + b.radiance;
  sum.count = a.count + b.count;
  sum.variance = a.variance + b.variance;
  sum.resampled = a.resampled || b.resampled;
  return sum;
}

void clip_to(const Spread& spread, double sigmas, PastSums& side) {
  if (!spread.known || !(sigmas > 0)) {
    return;
  }
  const double bright = luminance(side.radiance / side.count);
  const double here = luminance(spread.mean);
  const double darker = bright > here ? here / bright : 1;
  const double variance = side.variance;
  const double count = side.count;
  side.variance = variance * darker * darker;
  clip(spread, sigmas, side);
  side.variance = variance * (side.count / count) * (side.count / count);
}

}  // namespace

TemporalHistory history_of_frame(const Frame& frame, const SamplingMap& map, const SurfaceMotion& motion,
                                 const FrameRequest& request, int threads) {
  TemporalHistory history;
  (void)reproject(frame, map, motion, request, {AccumulateMode::reproject}, history, threads);
  return history;
}

WindowReach reach_of(const std::vector<WindowFrame>& window, std::size_t own, const AccumulateSettings& settings) {
  // Whether the frame at `later` and the one before it have nothing to do with each other.
  const auto apart = [&](std::size_t later) {
    const TemporalHistory& before = *window[later - 1].alone;
    const FrameRequest& request = *window[later].request;
    return eye_forbids(request, settings) || is_cut(before, request.camera, request.width_px, request.height_px);
  };
  WindowReach reach{own, own + 1};
  while (reach.begin > 0 && !apart(reach.begin)) {
    --reach.begin;
  }
  while (reach.end < window.size() && !apart(reach.end)) {
    ++reach.end;
  }
  return reach;
}

NeighbourSums::NeighbourSums(const Frame& frame, const SamplingMap& map, const AccumulateSettings& settings,
                             int threads)
    : frame_(frame), settings_(settings), threads_(threads), footprint_(footprints_of(map)) {
  sides_.fill(Image<PastSums>(map.width_px, map.height_px));
}

void NeighbourSums::add(const TemporalHistory& neighbour, const SurfaceMotion& motion, int frames_later) {
  const PixelProjection view(*neighbour.camera, frame_.radiance.width_px, frame_.radiance.height_px);
  const double kept = std::pow(share_kept_a_frame(settings_), std::abs(frames_later));
  Image<PastSums>& side = sides_[frames_later < 0 ? 0 : 1];
  for_each_place(frame_, threads_, [&](int, int, std::size_t i) {
    PastSums found = look_up(neighbour, view, motion, i);
    if (found.count > 0) {
      scale_worth(found, kept / ratio_of_areas(found, static_cast<double>(footprint_.pixels[i])));
      if (footprint_.pixels[i] < kFullRatePx) {
        scale_worth(found,
                    share_kept_between_pixels(found, frame_, neighbour.surfaces, motion, i, 2 * settings_.window));
      }
      side.pixels[i] = sum_of(side.pixels[i], found);
    }
  });
}

Frame NeighbourSums::joined(const SurfaceMotion& motion) const {
  const int width = frame_.radiance.width_px;
  const int height = frame_.radiance.height_px;
  ImageGray off(width, height);
  for_each_place(frame_, threads_, [&](int, int, std::size_t i) {
    const PastSums both = sum_of(sides_[0].pixels[i], sides_[1].pixels[i]);
    if (shows_residual(frame_, footprint_, both, i)) {
      off.pixels[i] = residual_of(frame_, both, i);
    }
  });
  const ImageGray nothing(width, height);
  const Residuals residuals{off, nothing, frame_.variance};
  Frame joined = frame_;
  for_each_place(frame_, threads_, [&](int x, int y, std::size_t i) {
    std::array<PastSums, 2> sides{sides_[0].pixels[i], sides_[1].pixels[i]};
    const auto count = static_cast<double>(frame_.sample_count.pixels[i]);
    const double counts = sides[0].count + sides[1].count;
    if (!(counts > 0)) {
      return;
    }
    const double kept = off.pixels[i] != 0 ? residuals.share_kept(motion, count, counts, x, y) : 1;
    const Spread spread =
        settings_.clip_sigmas > 0 ? spread_around(frame_, motion, x, y, footprint_.pixels[i]) : Spread{};
    for (PastSums& side : sides) {
      if (side.count > 0) {
        scale_worth(side, kept);
        clip_to(spread, settings_.clip_sigmas, side);
      }
    }
    PastSums found = sum_of(sides[0], sides[1]);
    if (!(found.count >= kLeastWorth)) {
      return;
    }
    scale_to_blend(settings_, count, found);
    const double total = count + found.count;
    joined.radiance.pixels[i] = to_float((count * to_double(frame_.radiance.pixels[i]) + found.radiance) / total);
    joined.sample_count.pixels[i] = static_cast<float>(total);
    joined.variance.pixels[i] = static_cast<float>(
        (count * count * static_cast<double>(frame_.variance.pixels[i]) + found.variance) / (total * total));
  });
  return joined;
}

}  // namespace gazetrace
