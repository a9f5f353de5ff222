// SPDX-License-Identifier: Apache-2.0
// Accumulation that follows surfaces from frame to frame; counts of samples say what each past is worth.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "core/statistics.hpp"
#include "gazetrace/temporal.hpp"
#include "temporal/clip.hpp"
#include "temporal/history_lookup.hpp"
#include "temporal/resampling_error.hpp"
#include "temporal/residuals.hpp"
#include "temporal/worth.hpp"

namespace gazetrace {
namespace {

// Between the two passes over a frame, the next history holds only what was looked up of the past.
void put(const PastSums& past, std::size_t i, TemporalHistory& next) {
  next.radiance_sum.pixels[i] = past.radiance;
  next.count_sum.pixels[i] = past.count;
  next.variance_weight_sum.pixels[i] = past.variance;
  next.surfaces.footprint_px.pixels[i] = static_cast<float>(past.footprint_px);
}

PastSums past_at(const TemporalHistory& next, std::size_t i) {
  return {next.radiance_sum.pixels[i], next.count_sum.pixels[i], next.variance_weight_sum.pixels[i],
          static_cast<double>(next.surfaces.footprint_px.pixels[i])};
}

double median_depth_m(const ImageGray& depth_m) {
  std::vector<float> depths;
  const std::size_t step = std::max<std::size_t>(1, depth_m.pixels.size() / 4096);
  for (std::size_t i = 0; i < depth_m.pixels.size(); i += step) {
    if (std::isfinite(depth_m.pixels[i])) {
      depths.push_back(depth_m.pixels[i]);
    }
  }
  return depths.empty() ? HUGE_VAL : static_cast<double>(upper_median(depths));
}

}  // namespace

bool is_cut(const TemporalHistory& history, const Camera& camera, int width_px, int height_px) {
  if (history.frames == 0 || !history.camera || history.count_sum.width_px != width_px ||
      history.count_sum.height_px != height_px || history.surfaces.object.empty() ||
      !(history.camera->projection == camera.projection)) {
    return true;
  }
  const auto forward = [](const Camera& of) { return rotate(of.pose.orientation, {0, 0, -1}); };
  const auto up = [](const Camera& of) { return rotate(of.pose.orientation, {0, 1, 0}); };
  const double turned = std::max(angle_between_rad(forward(*history.camera), forward(camera)),
                                 angle_between_rad(up(*history.camera), up(camera)));
  const double moved = length(camera.pose.position_m - history.camera->pose.position_m);
  return turned > kCutTurnDeg * kRadPerDeg || moved > kCutMoveShare * median_depth_m(history.surfaces.depth_m);
}

Frame reproject(Frame frame, const SamplingMap& map, const SurfaceMotion& motion, const FrameRequest& request,
                const AccumulateSettings& settings, TemporalHistory& history, int threads) {
  const int width = frame.radiance.width_px;
  const int height = frame.radiance.height_px;
  const bool alone = is_cut(history, request.camera, width, height) || eye_forbids(request, settings);
  if (alone) {
    history.frames = 0;
  }
  const PixelProjection earlier_view(alone ? request.camera : *history.camera, width, height);
  const ImageGray footprint = footprints_of(map);
  const double kept = share_kept_a_frame(settings);

  TemporalHistory next;
  next.radiance_sum = Image<Vec3d>(width, height);
  next.count_sum = Image<double>(width, height);
  next.variance_weight_sum = Image<double>(width, height);
  next.surfaces = {motion.depth_m, motion.normal, motion.object, footprint, ImageGray(width, height)};
  ImageGray before(width, height);
  ImageGray kept_between(width, height, 1.0F);
  if (!alone) {
    parallel_for(static_cast<std::size_t>(height), threads, [&](std::size_t row) {
      const auto across = static_cast<std::size_t>(width);
      for (std::size_t i = row * across; i < (row + 1) * across; ++i) {
        PastSums past = look_up(history, earlier_view, motion, i);
        if (!(past.count > 0)) {
          continue;
        }
        scale_worth(past, kept / ratio_of_areas(past, static_cast<double>(footprint.pixels[i])));
        if (footprint.pixels[i] < kFullRatePx) {
          kept_between.pixels[i] =
              static_cast<float>(share_kept_between_pixels(past, frame, history.surfaces, motion, i));
        }
        if (past.resampled && footprint.pixels[i] < kFullRatePx && frame.sample_count.pixels[i] >= kKnowsNoise) {
          const double seen = luminance(to_double(frame.radiance.pixels[i]));
          const double difference = luminance(past.radiance / past.count) - seen;
          const double off = std::abs(difference) > kRounding * seen ? difference : 0;
          next.surfaces.residual.pixels[i] = static_cast<float>(off);
          before.pixels[i] = static_cast<float>(past.residual);
        }
        put(past, i, next);
      }
    });
  }
  const Residuals residuals{next.surfaces.residual, before, frame.variance};
  ImageRgb radiance = frame.radiance;
  ImageGray counts = frame.sample_count;
  ImageGray variances = frame.variance;
  parallel_for(static_cast<std::size_t>(height), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      const std::size_t i = frame.radiance.index(x, y);
      const auto count = static_cast<double>(frame.sample_count.pixels[i]);
      const auto own_footprint = static_cast<double>(footprint.pixels[i]);
      Vec3d sum = count * to_double(frame.radiance.pixels[i]);
      double total = count;
      double variance = count * count * static_cast<double>(frame.variance.pixels[i]);
      PastSums past = past_at(next, i);
      if (past.count > 0) {
        // Both judge the past as it was found. Were one to judge what the other left of it, it would expect more noise
        // of it, and see less.
        const double lasting =
            residuals.before.pixels[i] != 0 ? residuals.share_kept(motion, count, past.count, x, y) : 1;
        scale_worth(past, std::min(lasting, static_cast<double>(kept_between.pixels[i])));
        if (settings.clip_sigmas > 0) {
          clip(spread_around(frame, motion, x, y, footprint.pixels[i]), settings.clip_sigmas, past);
        }
        if (past.count < kLeastWorth) {
          past = {};
        } else if (settings.blend > 0 && count > 0) {
          scale_worth(past, count * (1 / settings.blend - 1) / past.count);
        }
      }
      if (past.count > 0) {
        sum += past.radiance;
        total += past.count;
        variance += past.variance;
        radiance.pixels[i] = to_float(sum / total);
        counts.pixels[i] = static_cast<float>(total);
        variances.pixels[i] = static_cast<float>(variance / (total * total));
      }
      next.surfaces.footprint_px.pixels[i] =
          past.count > 0 ? static_cast<float>((count * own_footprint + past.count * past.footprint_px) / total)
                         : footprint.pixels[i];
      next.radiance_sum.pixels[i] = sum;
      next.count_sum.pixels[i] = total;
      next.variance_weight_sum.pixels[i] = variance;
    }
  });
  frame.radiance = std::move(radiance);
  frame.sample_count = std::move(counts);
  frame.variance = std::move(variances);
  next.camera = request.camera;
  next.t_video_ns = request.t_video_ns;
  next.frames = history.frames + 1;
  next.passed = std::move(history.passed);
  next.smoothed_ev = history.smoothed_ev;
  next.smoothed_ev_t_ns = history.smoothed_ev_t_ns;
  history = std::move(next);
  return frame;
}

}  // namespace gazetrace
