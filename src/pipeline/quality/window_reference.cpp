// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/window_reference.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/hash.hpp"
#include "core/luminance.hpp"
#include "pipeline/quality/discarded.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kHalfTag = 0x48414c46ULL;  // "HALF"
constexpr float kMarginShare = 0.25F;              // of the rate, around what counts
constexpr float kLeastOfHalfSpp = 1;               // of a half, in every pixel

ImageRgb weighted_mean(const ImageRgb& a, double weight_a, const ImageRgb& b, double weight_b) {
  ImageRgb mean = a;
  const auto share = static_cast<float>(weight_b / (weight_a + weight_b));
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    mean.pixels[i] += (b.pixels[i] - a.pixels[i]) * share;
  }
  return mean;
}

// A picture that is as far from the mean of two halves as that is from the truth: half of their difference is added.
// Where one half has a bright speck that the other lacks, the mean has half of it, and the difference is taken off
// instead: a speck twice as bright would be cut off by the display, and what the truth lacks is seen in full. Only of
// what counts: around it a pixel has so few samples that ordinary noise would pass for specks, and pictures would be
// too dark.
ImageRgb picture_as_far_off(const ImageRgb& mean, const ImageRgb& a, const ImageRgb& b, const JudgedWindow& window) {
  constexpr float kSpeck = 0.5F;  // of the mean's light
  ImageRgb picture = mean;
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      const Vec3f off = (a(x, y) - b(x, y)) * 0.5F;
      const float light = luminance(off);
      const bool is_bright_speck = light > kSpeck * luminance(mean(x, y)) && window.counts(x, y);
      picture(x, y) += is_bright_speck ? off * -1.0F : off;
    }
  }
  return picture;
}

// A pixel's share of the samples in each window, 1 on average over all of them.
std::vector<ImageGray> rates_in(const JudgedWindows& windows) {
  std::vector<ImageGray> rates;
  double sum = 0;
  double pixels = 0;
  for (const JudgedWindow& window : windows.windows) {
    ImageGray own(window.traced.width_px, window.traced.height_px);
    for (int y = 0; y < own.height_px; ++y) {
      for (int x = 0; x < own.width_px; ++x) {
        own(x, y) = window.counts(x, y) ? 1 : kMarginShare;
        sum += static_cast<double>(own(x, y));
      }
    }
    pixels += static_cast<double>(own.pixels.size());
    rates.push_back(std::move(own));
  }
  for (ImageGray& own : rates) {
    for (float& rate : own.pixels) {
      rate *= static_cast<float>(pixels / sum);
    }
  }
  return rates;
}

}  // namespace

WindowReference::WindowReference(PathTracer& tracer, const JudgedWindows& windows,
                                 std::vector<const FrameRequest*> views, const FrameSettings& settings,
                                 LightOf light_of)
    : tracer_(tracer),
      windows_(windows),
      views_(std::move(views)),
      settings_(settings),
      light_of_(std::move(light_of)),
      rates_(rates_in(windows)) {}

void WindowReference::add_samples(double spp, std::size_t half) {
  // Further samples are those of another seed.
  const std::uint64_t tag = hash_combine(hash_combine(kHalfTag, half), static_cast<std::uint64_t>(std::llround(spp_)));
  WindowPictures& pictures = halves_.at(half);
  pictures.resize(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    pictures[v].resize(windows_.windows.size());
    for (std::size_t w = 0; w < windows_.windows.size(); ++w) {
      FrameSettings own = raw(discarded(settings_, hash_combine(tag, w)), spp, "none");
      own.foveation.sampling = density_of_picture();
      own.foveation.max_block_px = 1;
      own.foveation.spp.reset();
      own.trace.guiding = settings_.trace.guiding && light_of_ != nullptr;
      own.light_of = light_of_;
      own.rates_of = [&](const FrameRequest&) {
        FrameRates rates{rates_[w], 0};
        for (float& rate : rates.spp.pixels) {
          rate = std::max(rate * static_cast<float>(spp), kLeastOfHalfSpp);
        }
        return rates;
      };
      const FrameRenderer renderer(tracer_, own);
      RenderedFrame rendered = renderer.render(part_of(*views_[v], windows_.windows[w].traced));
      add_traces(rendered.samples, stats_);
      ImageRgb& mean = pictures[v][w];
      mean = mean.empty() ? std::move(rendered.frame.radiance)
                          : weighted_mean(mean, 0.5 * spp_, rendered.frame.radiance, spp);
    }
  }
}

void WindowReference::refine(double spp) {
  for (std::size_t half = 0; half < halves_.size(); ++half) {
    add_samples(0.5 * (spp - spp_), half);
  }
  spp_ = spp;
  mean_.assign(views_.size(), {});
  for (std::size_t v = 0; v < views_.size(); ++v) {
    for (std::size_t w = 0; w < windows_.windows.size(); ++w) {
      mean_[v].push_back(weighted_mean(halves_[0][v][w], 1, halves_[1][v][w], 1));
    }
  }
}

WindowPictures WindowReference::as_far_off() const {
  WindowPictures off(views_.size());
  for (std::size_t v = 0; v < views_.size(); ++v) {
    for (std::size_t w = 0; w < windows_.windows.size(); ++w) {
      off[v].push_back(picture_as_far_off(mean_[v][w], halves_[0][v][w], halves_[1][v][w], windows_.windows[w]));
    }
  }
  return off;
}

}  // namespace gazetrace
