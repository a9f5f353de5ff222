// SPDX-License-Identifier: Apache-2.0
// Accumulation along the ways of surfaces, with counts for worth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/sites.hpp"
#include "gazetrace/temporal.hpp"
#include "temporal/history_lookup.hpp"

namespace gazetrace {
namespace {

constexpr int kReach = 2;  // the neighborhood is 5x5 sites
constexpr float kFullRatePx = 1.5F;
constexpr float kKnowsNoise = 2;  // samples
// Of residuals: the correlation that chance makes of noise, how often the stated variance noise may hold, and how much
// more a bias counts than its mean over the neighborhood, since pixels differ. Measured: smaller ones keep texture
// sharper, larger ones more of what takes noise away.
constexpr double kChance = 0;
constexpr double kStated = 1;
constexpr double kCaution = 4;
constexpr double kRounding = 1e-3;  // of a flat surface without noise: floats, and what bilinear weights blur

ImageGray footprints_of(const SamplingMap& map) {
  ImageGray footprint(map.width_px, map.height_px, 1.0F);
  for (const Site& site : map.sites) {
    const float side = std::sqrt(static_cast<float>(site.pixels));
    for_each_pixel(map, site, [&](int x, int y) { footprint(x, y) = side; });
  }
  return footprint;
}

bool eye_forbids(const FrameRequest& request, const AccumulateSettings& settings) {
  return (settings.reset_at_saccades && request.saccade_since_last_frame) ||
         (settings.reset_at_blinks && request.blink_since_last_frame);
}

// Mean and variance of a channel over the neighborhood.
struct Spread {
  Vec3d mean, variance;
  int taps = 0;
};

// Of the current frame about a pixel, on the same object, a site's width apart, so that each tap is another site.
Spread spread_around(const Frame& frame, const SurfaceMotion& motion, int x, int y, float footprint_px) {
  const int stride = std::max(1, static_cast<int>(std::lround(footprint_px)));
  const std::uint32_t object = motion.object(x, y);
  Spread spread;
  Vec3d squares;
  double sample_variance = 0;
  double luminance_sum = 0;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const int i = x + dx * stride;
      const int j = y + dy * stride;
      if (i < 0 || j < 0 || i >= frame.radiance.width_px || j >= frame.radiance.height_px ||
          motion.object(i, j) != object) {
        continue;
      }
      const Vec3d value = to_double(frame.radiance(i, j));
      spread.mean += value;
      squares += value * value;
      sample_variance += static_cast<double>(frame.variance(i, j));
      luminance_sum += luminance(value);
      ++spread.taps;
    }
  }
  const double n = spread.taps;
  spread.mean = spread.mean / n;
  const double mean_luminance = luminance_sum / n;
  // What the samples say of their own noise, for a neighborhood that agrees by chance; channels in proportion.
  const double own = mean_luminance > 0 ? sample_variance / n / (mean_luminance * mean_luminance) : 0;
  const Vec3d& m = spread.mean;
  spread.variance = {std::max(squares.x / n - m.x * m.x, own * m.x * m.x),
                     std::max(squares.y / n - m.y * m.y, own * m.y * m.y),
                     std::max(squares.z / n - m.z * m.z, own * m.z * m.z)};
  return spread;
}

// Brings the past to within the limits; a past that was r times as far off keeps 1 / r^4 of its count: it is
// contradicted, and the limit is no place to rest.
void clip(const Spread& spread, double sigmas, PastSums& past) {
  const Vec3d mean = past.radiance / past.count;
  // The past has noise of its own: a variance of its luminance, shared out in proportion.
  const double past_luminance = luminance(mean);
  const double own =
      past_luminance > 0 ? past.variance / (past.count * past.count) / (past_luminance * past_luminance) : 0;
  double farthest = 1;
  const auto clipped = [&](double value, double center, double variance) {
    const double limit =
        sigmas * std::sqrt(std::max(variance, 0.0) + own * value * value) + kRounding * std::abs(center);
    const double off = std::abs(value - center);
    if (off <= limit) {
      return value;
    }
    farthest = std::max(farthest, limit > 0 ? off / limit : 1e3);
    return center + (value < center ? -limit : limit);
  };
  const Vec3d within{clipped(mean.x, spread.mean.x, spread.variance.x),
                     clipped(mean.y, spread.mean.y, spread.variance.y),
                     clipped(mean.z, spread.mean.z, spread.variance.z)};
  const double kept = 1 / (farthest * farthest * farthest * farthest);
  past.count *= kept;
  past.variance *= kept * kept;
  past.radiance = within * past.count;
}

void scale_worth(PastSums& past, double factor) {
  past.radiance = past.radiance * factor;
  past.count *= factor;
  past.variance *= factor * factor;
}

// How far the past was off from two frames running, at full rate: noise differs from one to the other, the blur of
// resampled texture does not.
struct Residuals {
  const ImageGray& now;
  const ImageGray& before;  // luminance of past - frame; 0: not known
  const ImageGray& noise;   // variance of the frame, as its samples tell; in truth well-spread samples have less

  // A squared bias b^2, beside a variance v of one sample, makes n samples worth n / (1 + n b^2 / v); less where the
  // bias is far above the noise.
  [[nodiscard]] double share_kept(const SurfaceMotion& motion, double count, double past_count, int x, int y) const {
    const std::uint32_t object = motion.object(x, y);
    double squares = 0;
    double squares_before = 0;
    double products = 0;
    double variance = 0;
    for (int j = std::max(y - kReach, 0); j <= std::min(y + kReach, now.height_px - 1); ++j) {
      for (int i = std::max(x - kReach, 0); i <= std::min(x + kReach, now.width_px - 1); ++i) {
        if (motion.object(i, j) == object) {
          const auto a = static_cast<double>(now(i, j));
          const auto b = static_cast<double>(before(i, j));
          squares += a * a;
          squares_before += b * b;
          products += a * b;
          variance += static_cast<double>(noise(i, j));
        }
      }
    }
    const double stated = variance * (1 + count / past_count);
    const double bias = std::max(products - kChance * std::sqrt(squares * squares_before), squares - kStated * stated);
    if (!(bias > 0)) {
      return 1;
    }
    const double ratio = bias / std::max(std::min(variance, squares - products), 1e-12 * bias);
    return 1 / (1 + kCaution * past_count / count * ratio * (1 + ratio));
  }
};

// Between the two passes over a frame, the next history holds the past alone.
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
  if (depths.empty()) {
    return HUGE_VAL;
  }
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return static_cast<double>(*middle);
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
  const double kept = settings.frames > 0 ? 1 - 1 / std::max(settings.frames, 1.0) : 1;

  TemporalHistory next;
  next.radiance_sum = Image<Vec3d>(width, height);
  next.count_sum = Image<double>(width, height);
  next.variance_weight_sum = Image<double>(width, height);
  next.surfaces = {motion.depth_m, motion.normal, motion.object, footprint, ImageGray(width, height)};
  ImageGray before(width, height);
  if (!alone) {
    parallel_for(static_cast<std::size_t>(height), threads, [&](std::size_t row) {
      const auto across = static_cast<std::size_t>(width);
      for (std::size_t i = row * across; i < (row + 1) * across; ++i) {
        PastSums past = look_up(history, earlier_view, motion, i);
        if (!(past.count > 0)) {
          continue;
        }
        const double coarseness = past.footprint_px / static_cast<double>(footprint.pixels[i]);
        scale_worth(past, kept / std::max(1.0, coarseness * coarseness));
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
        if (residuals.before.pixels[i] != 0) {
          scale_worth(past, residuals.share_kept(motion, count, past.count, x, y));
        }
        if (settings.clip_sigmas > 0) {
          clip(spread_around(frame, motion, x, y, footprint.pixels[i]), settings.clip_sigmas, past);
        }
        if (settings.blend > 0 && count > 0) {
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

SparseFrame sites_of_frame(const Frame& frame, const SparseFrame& traced, const SamplingMap& map) {
  SparseFrame sparse = traced;
  for (std::size_t s = 0; s < map.sites.size(); ++s) {
    Vec3d sum;
    double count = 0;
    double deviation = 0;
    for_each_pixel(map, map.sites[s], [&](int x, int y) {
      const auto n = static_cast<double>(frame.sample_count(x, y));
      sum += n * to_double(frame.radiance(x, y));
      deviation += n * std::sqrt(std::max(0.0, static_cast<double>(frame.variance(x, y))));
      count += n;
    });
    const auto whole = static_cast<std::uint32_t>(std::clamp(std::round(count), count > 0 ? 1.0 : 0.0, 4e9));
    sparse.count[s] = whole;
    if (whole == 0) {
      sparse.sum[s] = {};
      sparse.sum_square_luminance[s] = 0;
      continue;
    }
    const auto n = static_cast<double>(whole);
    const Vec3d mean = sum / count;
    const double variance = (deviation / count) * (deviation / count);  // of the mean; the site's pixels share samples
    const double of_luminance = luminance(mean);
    sparse.sum[s] = to_float(mean * n);
    sparse.sum_square_luminance[s] = static_cast<float>(n * of_luminance * of_luminance + n * (n - 1) * variance);
    if (!sparse.guides.empty() && traced.count[s] > 0) {
      const float ratio = static_cast<float>(whole) / static_cast<float>(traced.count[s]);
      GuideSums& guides = sparse.guides[s];
      guides.albedo = guides.albedo * ratio;
      guides.normal = guides.normal * ratio;
      const auto hits = static_cast<std::uint32_t>(std::lround(static_cast<float>(guides.hits) * ratio));
      guides.depth_m =
          guides.hits > 0 ? guides.depth_m / static_cast<float>(guides.hits) * static_cast<float>(hits) : 0;
      guides.hits = hits;
    }
  }
  return sparse;
}

}  // namespace gazetrace
