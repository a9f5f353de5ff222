// SPDX-License-Identifier: Apache-2.0
#include "pipeline/replica_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/hash.hpp"
#include "core/parallel.hpp"
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

}  // namespace

FrameSettings discarded_settings(const FrameSettings& settings, double spp, std::uint64_t tag) {
  FrameSettings discarded = settings;
  discarded.foveation.target = {};
  discarded.foveation.budget_samples.reset();
  discarded.foveation.budget_spp = spp;
  discarded.trace.seed = hash_combine(hash_combine(settings.trace.seed, kReplicaTag), tag);
  discarded.trace.guides = false;
  discarded.trace.only_pixel.reset();
  return discarded;
}

ReplicaNoise::ReplicaNoise(PathTracer& tracer, const FrameRequest& request, const FrameSettings& settings, double spp,
                           std::uint64_t round)
    : threads_(settings.threads) {
  // Signs of the renderings in each of the sums.
  constexpr std::array<std::array<float, kRenderings>, kRenderings - 1> kSigns = {
      {{1, 1, -1, -1}, {1, -1, 1, -1}, {1, -1, -1, 1}}};
  constexpr float kUnit = 0.5F;  // the root of 1 / kRenderings
  for (std::size_t k = 0; k < kRenderings; ++k) {
    TemporalHistory none;
    const FrameSettings own = discarded_settings(settings, spp, hash_combine(round, k));
    RenderedFrame rendered = FrameRenderer(tracer, own).render(request, none);
    add_traces(rendered.samples, stats_);
    add_traces(rendered.first_look, stats_);
    const ImageRgb& picture = rendered.frame.radiance;
    for (std::size_t row = 0; row < noise_.size(); ++row) {
      ImageRgb& noise = noise_.at(row);
      if (k == 0) {
        noise = ImageRgb(picture.width_px, picture.height_px);
      }
      const float weight = kUnit * kSigns.at(row).at(k);
      for (std::size_t i = 0; i < noise.pixels.size(); ++i) {
        noise.pixels[i] += weight * picture.pixels[i];
      }
    }
  }
}

ImageRgb ReplicaNoise::noisy(const ImageRgb& picture, double share, std::size_t index) const {
  const ImageRgb& noise = noise_.at(index % noise_.size());
  const Shift shift = shift_of(index / noise_.size());
  const auto scale = static_cast<float>(std::sqrt(share));
  ImageRgb result(picture.width_px, picture.height_px);
  parallel_for(static_cast<std::size_t>(picture.height_px), threads_, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const int from_y = (y + shift.y_px) % picture.height_px;
    for (int x = 0; x < picture.width_px; ++x) {
      result(x, y) = positive(picture(x, y) + scale * noise((x + shift.x_px) % picture.width_px, from_y));
    }
  });
  return result;
}

}  // namespace gazetrace
