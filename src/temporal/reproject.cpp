// SPDX-License-Identifier: Apache-2.0
// Accumulation that follows surfaces from frame to frame; counts of samples say what each past is worth.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/luminance.hpp"
#include "core/statistics.hpp"
#include "gazetrace/temporal.hpp"
#include "temporal/clip.hpp"
#include "temporal/for_each_place.hpp"
#include "temporal/history_lookup.hpp"
#include "temporal/resampling_error.hpp"
#include "temporal/residuals.hpp"
#include "temporal/worth.hpp"

namespace gazetrace {
namespace {

// What is found of a frame's past before the frame is joined to it.
struct FoundPast {
  TemporalHistory next;       // its sums are those of the past alone until join() adds the frame
  ImageGray residual_before;  // HistorySurfaces::residual of the frame before
  ImageGray kept_between;     // share_kept_between_pixels()
};

void put(const PastSums& sums, std::size_t i, TemporalHistory& next) {
  next.radiance_sum.pixels[i] = sums.radiance;
  next.count_sum.pixels[i] = sums.count;
  next.variance_weight_sum.pixels[i] = sums.variance;
  next.surfaces.footprint_px.pixels[i] = static_cast<float>(sums.footprint_px);
}

PastSums past_at(const TemporalHistory& next, std::size_t i) {
  return {next.radiance_sum.pixels[i], next.count_sum.pixels[i], next.variance_weight_sum.pixels[i],
          static_cast<double>(next.surfaces.footprint_px.pixels[i])};
}

FoundPast nothing_found(const SurfaceMotion& motion, const ImageGray& footprint) {
  const int width = footprint.width_px;
  const int height = footprint.height_px;
  FoundPast found;
  found.next.radiance_sum = Image<Vec3d>(width, height);
  found.next.count_sum = Image<double>(width, height);
  found.next.variance_weight_sum = Image<double>(width, height);
  found.next.surfaces = {motion.depth_m, motion.normal, motion.object, footprint, ImageGray(width, height)};
  found.residual_before = ImageGray(width, height);
  found.kept_between = ImageGray(width, height, 1.0F);
  return found;
}

// `kept`: the share of the past that is kept from frame to frame.
FoundPast find_past(const TemporalHistory& history, const Frame& frame, const SurfaceMotion& motion,
                    const ImageGray& footprint, double kept, int threads) {
  FoundPast found = nothing_found(motion, footprint);
  const PixelProjection earlier_view(*history.camera, footprint.width_px, footprint.height_px);
  for_each_place(frame, threads, [&](int, int, std::size_t i) {
    PastSums past = look_up(history, earlier_view, motion, i);
    if (!(past.count > 0)) {
      return;
    }
    scale_worth(past, kept / ratio_of_areas(past, static_cast<double>(footprint.pixels[i])));
    if (footprint.pixels[i] < kFullRatePx) {
      found.kept_between.pixels[i] =
          static_cast<float>(share_kept_between_pixels(past, frame, history.surfaces, motion, i));
    }
    if (shows_residual(frame, footprint, past, i)) {
      found.next.surfaces.residual.pixels[i] = residual_of(frame, past, i);
      found.residual_before.pixels[i] = static_cast<float>(past.residual);
    }
    put(past, i, found.next);
  });
  return found;
}

// What a frame says about the past of its pixels.
struct PastJudge {
  const Frame& frame;
  const SurfaceMotion& motion;
  const ImageGray& footprint;
  const AccumulateSettings& settings;
  Residuals residuals;
  const ImageGray& kept_between;  // as FoundPast

  // What is believed of the past of a pixel. Residuals and clipping both judge the past as it was found. Were one to
  // judge what the other left of it, it would expect more noise of it, and see less.
  [[nodiscard]] PastSums believed(PastSums past, int x, int y) const {
    const std::size_t i = frame.radiance.index(x, y);
    const auto count = static_cast<double>(frame.sample_count.pixels[i]);
    const double lasting = residuals.before.pixels[i] != 0 ? residuals.share_kept(motion, count, past.count, x, y) : 1;
    scale_worth(past, std::min(lasting, static_cast<double>(kept_between.pixels[i])));
    if (settings.clip_sigmas > 0) {
      clip(spread_around(frame, motion, x, y, footprint.pixels[i]), settings.clip_sigmas, past);
    }
    if (past.count < kLeastWorth) {
      return {};
    }
    scale_to_blend(settings, count, past);
    return past;
  }
};

PastSums own_sums(const Frame& frame, const ImageGray& footprint, std::size_t i) {
  const auto count = static_cast<double>(frame.sample_count.pixels[i]);
  return {count * to_double(frame.radiance.pixels[i]), count,
          count * count * static_cast<double>(frame.variance.pixels[i]), static_cast<double>(footprint.pixels[i])};
}

void add(const PastSums& past, PastSums& sums) {
  const double total = sums.count + past.count;
  sums.footprint_px = (sums.count * sums.footprint_px + past.count * past.footprint_px) / total;
  sums.radiance += past.radiance;
  sums.variance += past.variance;
  sums.count = total;
}

// The images of a frame that accumulation changes.
struct JoinedImages {
  ImageRgb radiance;
  ImageGray sample_count, variance;
};

// The judge's frame and what is believed of its past. `next` holds the past, and then the frame as well.
JoinedImages join(const PastJudge& judge, TemporalHistory& next, int threads) {
  const Frame& frame = judge.frame;
  JoinedImages joined{frame.radiance, frame.sample_count, frame.variance};
  for_each_place(frame, threads, [&](int x, int y, std::size_t i) {
    PastSums sums = own_sums(frame, judge.footprint, i);
    PastSums past = past_at(next, i);
    if (past.count > 0) {
      past = judge.believed(past, x, y);
    }
    if (past.count > 0) {
      add(past, sums);
      joined.radiance.pixels[i] = to_float(sums.radiance / sums.count);
      joined.sample_count.pixels[i] = static_cast<float>(sums.count);
      joined.variance.pixels[i] = static_cast<float>(sums.variance / (sums.count * sums.count));
    }
    put(sums, i, next);
  });
  return joined;
}

// Makes `next` the history after the frame; what is not of pixels goes on from the one before.
void replace(TemporalHistory& history, TemporalHistory next, const FrameRequest& request) {
  next.camera = request.camera;
  next.t_video_ns = request.t_video_ns;
  next.frames = history.frames + 1;
  next.passed = std::move(history.passed);
  next.smoothed_ev = history.smoothed_ev;
  next.smoothed_ev_t_ns = history.smoothed_ev_t_ns;
  history = std::move(next);
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
  if (is_cut(history, request.camera, frame.radiance.width_px, frame.radiance.height_px) ||
      eye_forbids(request, settings)) {
    history.frames = 0;
  }
  const ImageGray footprint = footprints_of(map);
  FoundPast found = history.frames > 0
                        ? find_past(history, frame, motion, footprint, share_kept_a_frame(settings), threads)
                        : nothing_found(motion, footprint);
  const Residuals residuals{found.next.surfaces.residual, found.residual_before, frame.variance};
  const PastJudge judge{frame, motion, footprint, settings, residuals, found.kept_between};
  JoinedImages joined = join(judge, found.next, threads);
  frame.radiance = std::move(joined.radiance);
  frame.sample_count = std::move(joined.sample_count);
  frame.variance = std::move(joined.variance);
  replace(history, std::move(found.next), request);
  return frame;
}

}  // namespace gazetrace
