// SPDX-License-Identifier: Apache-2.0
#include "pipeline/replica_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/hash.hpp"
#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "pipeline/discarded.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kReplicaTag = 0x5245504c494341ULL;  // "REPLICA"
// By how much the noise is moved, in steps of this many pixels, between frames that show the same of the three: noise
// of single pixels is then uncorrelated in these frames. It stays near enough to where it is as strong.
constexpr int kStepPx = 2;
constexpr int kPlaces = 3;  // in either direction

Vec3f positive(const Vec3f& light) {
  return {std::max(light.x, 0.0F), std::max(light.y, 0.0F), std::max(light.z, 0.0F)};
}

struct Shift {
  int x_px, y_px;
};

// The nearest places first: clips are short.
Shift shift_of(std::size_t turn) {
  const auto place = static_cast<int>(turn % (kPlaces * kPlaces));
  return {(place % kPlaces) * kStepPx, (place / kPlaces) * kStepPx};
}

// Evenly between -1 and 1.
double by_chance(std::size_t frame) {
  return 0x1p-52 * static_cast<double>(hash_combine(kReplicaTag, frame) >> 11U) - 1;
}

// Where one of the four has seen much more light than the others, by the noise around: 1, elsewhere 0.
Image<std::uint8_t> rare_light(const std::array<ImageRgb, ReplicaNoise::kRenderings>& pictures) {
  constexpr double kRare = 8;  // standard deviations of what the others saw
  const int width = pictures[0].width_px;
  const int height = pictures[0].height_px;
  // Of the three darker ones: their variance, and how far the brightest is above their mean.
  Image<double> variance(width, height);
  Image<double> above(width, height);
  for (std::size_t i = 0; i < variance.pixels.size(); ++i) {
    std::array<double, ReplicaNoise::kRenderings> seen{};
    for (std::size_t k = 0; k < seen.size(); ++k) {
      seen.at(k) = static_cast<double>(luminance(pictures.at(k).pixels[i]));
    }
    std::sort(seen.begin(), seen.end());
    const double mean = (seen[0] + seen[1] + seen[2]) / 3;
    for (std::size_t k = 0; k < 3; ++k) {
      variance.pixels[i] += 0.5 * (seen.at(k) - mean) * (seen.at(k) - mean);
    }
    above.pixels[i] = seen[3] - mean;
  }
  Image<std::uint8_t> rare(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double most = 0;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
          most = std::max(most, variance(u, v));
        }
      }
      rare(x, y) = above(x, y) > kRare * std::sqrt(most) ? 1 : 0;
    }
  }
  return rare;
}

}  // namespace

FrameSettings discarded_settings(const FrameSettings& settings, double spp, std::uint64_t tag) {
  FrameSettings own = discarded(settings, tag);
  own.accumulate.mode = AccumulateMode::off;
  own.foveation.budget_spp = spp;
  own.trace.seed = hash_combine(hash_combine(settings.trace.seed, kReplicaTag), tag);
  return own;
}

ReplicaNoise::ReplicaNoise(const std::array<ImageRgb, kRenderings>& pictures, int threads)
    : rare_(rare_light(pictures)), threads_(threads) {
  // Signs of the renderings in each of the sums.
  constexpr std::array<std::array<float, kRenderings>, kRenderings - 1> kSigns = {
      {{1, 1, -1, -1}, {1, -1, 1, -1}, {1, -1, -1, 1}}};
  constexpr float kUnit = 0.5F;  // the root of 1 / kRenderings
  for (std::size_t row = 0; row < noise_.size(); ++row) {
    ImageRgb& noise = noise_.at(row);
    noise = ImageRgb(rare_.width_px, rare_.height_px);
    for (std::size_t k = 0; k < kRenderings; ++k) {
      const float weight = kUnit * kSigns.at(row).at(k);
      for (std::size_t i = 0; i < noise.pixels.size(); ++i) {
        noise.pixels[i] += weight * pictures.at(k).pixels[i];
      }
    }
  }
}

ReplicaNoise::ReplicaNoise(PathTracer& tracer, const FrameRequest& request, const FrameSettings& settings, double spp,
                           std::uint64_t round) {
  std::array<ImageRgb, kRenderings> pictures;
  TraceStats stats;
  for (std::size_t k = 0; k < kRenderings; ++k) {
    TemporalHistory none;
    const FrameSettings own = discarded_settings(settings, spp, hash_combine(round, k));
    RenderedFrame rendered = FrameRenderer(tracer, own).render(request, none);
    add_traces(rendered.samples, stats);
    add_traces(rendered.first_look, stats);
    pictures.at(k) = std::move(rendered.frame.radiance);
  }
  *this = ReplicaNoise(pictures, settings.threads);
  stats_ = std::move(stats);
}

void ReplicaNoise::divide(int pixels) {
  if (pixels < 2) {
    return;
  }
  constexpr std::uint64_t kReachPx = 2;
  constexpr std::uint64_t kSide = 2 * kReachPx + 1;
  const auto width = static_cast<std::size_t>(rare_.width_px);
  const auto height = static_cast<std::size_t>(rare_.height_px);
  const auto weight = static_cast<float>(1 / std::sqrt(static_cast<double>(pixels)));
  for (std::size_t k = 0; k < noise_.size(); ++k) {
    const ImageRgb whole = noise_.at(k);
    parallel_for(height, threads_, [&](std::size_t y) {
      for (std::size_t x = 0; x < width; ++x) {
        Vec3f& pixel = noise_.at(k).pixels[y * width + x];
        if (rare_.pixels[y * width + x] != 0) {
          pixel = {};
        }
        const std::uint64_t place = hash_combine(kReplicaTag, (k * height + y) * width + x);
        for (int n = 0; n < pixels; ++n) {
          const std::uint64_t bits = hash_combine(place, static_cast<std::uint64_t>(n));
          const std::size_t from_x = (x + width - kReachPx + (bits >> 8U) % kSide) % width;
          const std::size_t from_y = (y + height - kReachPx + (bits >> 32U) % kSide) % height;
          const std::size_t from = from_y * width + from_x;
          if (rare_.pixels[from] != 0) {
            pixel += ((bits & 1U) != 0 ? weight : -weight) * whole.pixels[from];
          }
        }
      }
    });
  }
}

ReplicaNoise::Mixture ReplicaNoise::mixture(const SummedFrames& frames) const {
  Mixture mixture;
  if (frames.count == 1) {
    mixture.weights.at(frames.first % noise_.size()) = 1;
    mixture.turn = frames.first / noise_.size();
    return mixture;
  }
  // Moved against each other, sums of the same noise would grow at low frequencies more than at high ones. So each
  // frame adds one of the three in its place, with a weight of its own by chance, and what is new from frame to frame
  // is as much as in a mean over so many frames. Any direction of unit length has the noise of one rendering.
  double squares = 0;
  for (std::size_t frame = frames.first; frame < frames.first + frames.count; ++frame) {
    mixture.weights.at(frame % noise_.size()) += by_chance(frame);
  }
  for (const double weight : mixture.weights) {
    squares += weight * weight;
  }
  for (double& weight : mixture.weights) {
    weight /= std::sqrt(squares * static_cast<double>(frames.count));
  }
  return mixture;
}

ImageRgb ReplicaNoise::noisy(const ImageRgb& picture, double share, const SummedFrames& frames) const {
  const Mixture mixture = this->mixture(frames);
  const Shift shift = shift_of(mixture.turn);
  const double scale = std::sqrt(share);
  ImageRgb result = picture;
  parallel_for(static_cast<std::size_t>(picture.height_px), threads_, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const int from_y = (y + shift.y_px) % picture.height_px;
    for (std::size_t k = 0; k < noise_.size(); ++k) {
      const auto weight = static_cast<float>(scale * mixture.weights.at(k));
      for (int x = 0; weight != 0 && x < picture.width_px; ++x) {
        result(x, y) += weight * noise_.at(k)((x + shift.x_px) % picture.width_px, from_y);
      }
    }
    for (int x = 0; x < picture.width_px; ++x) {
      result(x, y) = positive(result(x, y));
    }
  });
  return result;
}

}  // namespace gazetrace
