// SPDX-License-Identifier: Apache-2.0
// The error that the flicker metric cannot see: |mean of the test - mean of the reference| / mean of the reference, of
// the luminance of patches of 4 x 4 pixels over the last second. Frozen or smeared history and lost light show here,
// and so does noise that does not average out within a second.
#include <algorithm>
#include <cmath>
#include <vector>

#include "compare/sequence_metric.hpp"
#include "gazetrace/flicker.hpp"
#include "metrics/luminance_patches.hpp"
#include "metrics/metric.hpp"

namespace gazetrace {
namespace {

constexpr int kPatchPx = 4;
constexpr double kLeastLuminance = 0.1;  // least divisor, cd/m2

// The sum of each patch over the last frames.
class RunningSum {
 public:
  void add(ImageGray patches, std::size_t frames) {
    sums_.resize(patches.pixels.size());
    ring_.resize(frames);
    ImageGray& slot = ring_[next_++ % frames];
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      sums_[i] += static_cast<double>(patches.pixels[i]) - (slot.empty() ? 0.0 : static_cast<double>(slot.pixels[i]));
    }
    slot = std::move(patches);
  }
  [[nodiscard]] double at(std::size_t i) const { return sums_[i]; }

 private:
  std::vector<ImageGray> ring_;
  std::vector<double> sums_;
  std::size_t next_ = 0;
};

class BiasOfFrames : public SequenceMetric {
 public:
  BiasOfFrames(int frames, int threads) : frames_(static_cast<std::size_t>(frames)), threads_(threads) {}

  std::optional<MetricMap> add(const LuminanceFrame& frame) override {
    ImageGray bias = patch_means(frame.reference, kPatchPx, threads_);
    reference_.add(bias, frames_);
    test_.add(patch_means(frame.test, kPatchPx, threads_), frames_);
    if (++added_ < frames_) {
      return std::nullopt;
    }
    const double least = kLeastLuminance * static_cast<double>(frames_);
    for (std::size_t i = 0; i < bias.pixels.size(); ++i) {
      bias.pixels[i] =
          static_cast<float>(std::fabs(test_.at(i) - reference_.at(i)) / std::max(reference_.at(i), least));
    }
    MetricMap map;
    map.values = spread_patches(bias, kPatchPx, frame.reference.width_px, frame.reference.height_px, threads_);
    map.mean = mean_of_map(map.values, 0, threads_);
    return map;
  }

 private:
  std::size_t frames_, added_ = 0;
  int threads_;
  RunningSum reference_, test_;
};

}  // namespace

std::unique_ptr<SequenceMetric> make_temporal_bias(const ComparisonSettings& settings, int /*width_px*/,
                                                   int /*height_px*/) {
  return std::make_unique<BiasOfFrames>(frames_of_a_second(settings.frames_per_second), settings.metric.threads);
}

double sequence_value_temporal_bias(double mean) {
  return mean;
}
double sequence_local_value_temporal_bias(double mean) {
  return mean;
}

}  // namespace gazetrace
