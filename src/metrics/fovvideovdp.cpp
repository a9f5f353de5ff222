// SPDX-License-Identifier: Apache-2.0
// The metric itself: temporal channels, contrast in the bands of a Laplacian pyramid, division by the threshold, masked
// difference and pooling. Section numbers are those of the paper.
#include "gazetrace/fovvideovdp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>

#include "core/fast_math.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "metrics/band_sensitivity.hpp"
#include "metrics/masking.hpp"
#include "metrics/pyramid.hpp"
#include "metrics/temporal_channels.hpp"

namespace gazetrace {
namespace {

constexpr float kMostContrast = 1000;
constexpr double kJodScale = 0.0161713;
constexpr double kLog10JodExponent = -0.2280;

// The channels of both sequences at one moment; the transient ones are empty for stills.
struct Planes {
  ImageGray reference_sustained, test_sustained, reference_transient, test_transient;
};

struct LuminancePair {
  ImageGray reference, test;
};

// Buffers of a row: background, sensitivities by which contrasts are multiplied, and results.
struct RowBuffers {
  std::vector<float> scratch, background, sensitivity_sustained, sensitivity_transient, blurred, difference;
  void resize(std::size_t width) {
    for (std::vector<float>* row : {&background, &blurred, &difference}) {
      row->resize(width);
    }
  }
};

// The contrast (G - E) / Lb, at most 1000, times `gain` and the sensitivity, which makes it multiples of the threshold.
void normalised_contrast(const float* plane, const std::vector<float>& blurred, const std::vector<float>& background,
                         const std::vector<float>& sensitivity, float gain, std::vector<float>& out) {
  for (std::size_t x = 0; x < out.size(); ++x) {
    const float contrast = std::min((plane[x] - blurred[x]) / background[x], kMostContrast);
    out[x] = gain * contrast * sensitivity[x];
  }
}

// `weights`: of the values; null where all count alike.
double sum_of_powers(const std::vector<float>& values, const float* weights, float exponent) {
  constexpr std::size_t kRun = 16;
  double sum = 0;
  std::array<float, kRun> powers{};
  for (std::size_t x = 0; x < values.size(); x += kRun) {
    const std::size_t count = std::min(kRun, values.size() - x);
    for (std::size_t i = 0; i < count; ++i) {
      powers[i] = pow_fast(values[x + i], exponent);
    }
    for (std::size_t i = 0; i < count; ++i) {
      sum += static_cast<double>(weights != nullptr ? weights[x + i] * powers[i] : powers[i]);
    }
  }
  return sum;
}

// The weights of the pixels of a band in its mean.
struct BandWeights {
  ImageGray weights;  // empty: all are 1
  double sum = 0;
};

BandWeights band_weights(ImageGray weights, int width_px, int height_px) {
  if (weights.empty()) {
    return {{}, static_cast<double>(width_px) * height_px};
  }
  double sum = 0;
  for (const float weight : weights.pixels) {
    sum += static_cast<double>(weight);
  }
  return {std::move(weights), sum};
}

// Means of two by two; at an odd border, of what is there.
ImageGray halved_weights(const ImageGray& weights) {
  if (weights.empty()) {
    return {};
  }
  ImageGray half((weights.width_px + 1) / 2, (weights.height_px + 1) / 2);
  for (int y = 0; y < half.height_px; ++y) {
    for (int x = 0; x < half.width_px; ++x) {
      const int x1 = std::min(2 * x + 1, weights.width_px - 1);
      const int y1 = std::min(2 * y + 1, weights.height_px - 1);
      half(x, y) = 0.25F * (weights(2 * x, 2 * y) + weights(x1, 2 * y) + weights(2 * x, y1) + weights(x1, y1));
    }
  }
  return half;
}

void check_weights(const ImageGray& weights, int width_px, int height_px) {
  if (weights.empty()) {
    return;
  }
  if (weights.width_px != width_px || weights.height_px != height_px) {
    throw Error(ErrorKind::usage, "`pooling-weights`",
                fmt::format("{}x{} weights, but the pictures have {}x{} pixels", weights.width_px, weights.height_px,
                            width_px, height_px));
  }
  const bool are_weights = std::all_of(weights.pixels.begin(), weights.pixels.end(),
                                       [](float weight) { return weight >= 0 && std::isfinite(weight); });
  const bool any = std::any_of(weights.pixels.begin(), weights.pixels.end(), [](float weight) { return weight > 0; });
  if (!are_weights || !any) {
    throw Error(ErrorKind::usage, "`pooling-weights`",
                are_weights ? "all weights are 0" : "some weights are negative or no numbers",
                "give finite weights of 0 or more, with one above 0");
  }
}

}  // namespace

// The first frequency is Nyquist's, the others are the peaks of the pyramid's bands. The last band is the first one at
// or below half a cycle per degree; small pictures have fewer bands.
std::vector<double> fovvideovdp_bands_cpd(double pixels_per_degree, int width_px, int height_px) {
  constexpr int kMostBands = 15;
  constexpr double kPeakOfNyquist = 0.3228;
  constexpr double kLowest = 0.5;
  std::vector<double> frequencies;
  for (int b = 0; b < kMostBands; ++b) {
    const double nyquist = pixels_per_degree / 2;
    frequencies.push_back(b == 0 ? nyquist : kPeakOfNyquist * nyquist * std::exp2(1 - b));
    if (frequencies.back() <= kLowest) {
      break;
    }
  }
  int by_size = -1;
  for (int side = std::min(width_px, height_px); side > 1; side /= 2) {
    ++by_size;
  }
  frequencies.resize(std::min(frequencies.size(), static_cast<std::size_t>(std::max(by_size, 0))));
  return frequencies;
}

double fovvideovdp_jod(double q) {
  static const double kExponent = std::pow(10, kLog10JodExponent);
  return 10 - kJodScale * std::pow(q, kExponent);
}

double fovvideovdp_q(double jod) {
  return std::pow((10 - jod) / kJodScale, 1 / std::pow(10, kLog10JodExponent));
}

struct FovVideoVdp::Impl {
  FovVideoVdpSettings settings;
  int width_px, height_px;
  TemporalFilters filters;  // empty for stills
  std::vector<double> frequencies_cpd;
  std::vector<BandGeometry> bands;
  std::vector<BandWeights> pooling;   // of each band
  std::deque<LuminancePair> history;  // newest first

  Impl(const FovVideoVdpSettings& given, int width, int height) : settings(given), width_px(width), height_px(height) {
    constexpr int kLeastSide = 8;
    if (std::min(width, height) < kLeastSide) {
      throw Error(ErrorKind::usage, "fovvideovdp", fmt::format("{}x{} pixels are too few", width, height),
                  "compare pictures of at least 8x8 pixels");
    }
    if (settings.frames_per_second != 0) {
      filters = temporal_filters(settings.frames_per_second);
    }
    check_weights(settings.pooling_weights, width, height);
    frequencies_cpd = fovvideovdp_bands_cpd(settings.geometry.pixels_per_degree(), width, height);
    ImageGray of_band = std::move(settings.pooling_weights);
    int w = width;
    int h = height;
    for (const double frequency : frequencies_cpd) {
      bands.push_back(band_geometry(settings.geometry, settings.foveated, frequency, w, h, settings.threads));
      ImageGray coarser = halved_weights(of_band);
      pooling.push_back(band_weights(std::move(of_band), w, h));
      of_band = std::move(coarser);
      w = (w + 1) / 2;
      h = (h + 1) / 2;
    }
  }

  [[nodiscard]] std::size_t taps() const { return std::max<std::size_t>(filters.sustained.size(), 1); }

  void remember(const ImageGray& reference, const ImageGray& test) {
    for (const ImageGray* image : {&reference, &test}) {
      if (image->width_px != width_px || image->height_px != height_px) {
        throw Error(
            ErrorKind::usage, "fovvideovdp",
            fmt::format("a frame has {}x{} pixels, not {}x{}", image->width_px, image->height_px, width_px, height_px));
      }
    }
    if (history.size() == taps()) {
      // Reuses the memory of the oldest pair.
      LuminancePair oldest = std::move(history.back());
      history.pop_back();
      oldest.reference.pixels.assign(reference.pixels.begin(), reference.pixels.end());
      oldest.test.pixels.assign(test.pixels.begin(), test.pixels.end());
      history.push_front(std::move(oldest));
    } else {
      history.push_front({reference, test});
    }
  }

  // Section 3.2. Frames before the oldest known one are taken to equal it.
  [[nodiscard]] ImageGray filtered(const std::vector<double>& weights, ImageGray LuminancePair::*which) const {
    ImageGray plane(width_px, height_px);
    parallel_for(static_cast<std::size_t>(height_px), settings.threads, [&](std::size_t row) {
      const std::size_t from = row * static_cast<std::size_t>(width_px);
      float* out = &plane.pixels[from];
      for (std::size_t tap = 0; tap < weights.size(); ++tap) {
        const float* in = &(history[std::min(tap, history.size() - 1)].*which).pixels[from];
        const auto weight = static_cast<float>(weights[tap]);
        for (std::size_t x = 0; x < static_cast<std::size_t>(width_px); ++x) {
          out[x] += weight * in[x];
        }
      }
    });
    return plane;
  }

  [[nodiscard]] Planes planes_now() const {
    if (filters.sustained.empty()) {
      return {history.front().reference, history.front().test, {}, {}};
    }
    return {filtered(filters.sustained, &LuminancePair::reference), filtered(filters.sustained, &LuminancePair::test),
            filtered(filters.transient, &LuminancePair::reference), filtered(filters.transient, &LuminancePair::test)};
  }

  struct BandResult {
    double sustained = 0, transient = 0;
    ImageGray map;  // difference, pooled over channels; empty unless asked for
  };

  // Sections 3.3 to 3.6 for one band; `coarse` are the same planes one level coarser.
  [[nodiscard]] BandResult band_difference(std::size_t b, const Planes& planes, const Planes& coarse,
                                           const Vec2f& gaze_deg, bool want_map) const {
    const int width = planes.reference_sustained.width_px;
    const int height = planes.reference_sustained.height_px;
    const bool has_transient = !planes.reference_transient.empty();
    const float gain = band_contrast_gain(b);
    const std::optional<Vec2f> gaze = settings.foveated ? std::optional(gaze_deg) : std::nullopt;
    BandResult result;
    if (want_map) {
      result.map = ImageGray(width, height);
    }
    std::vector<std::array<double, 2>> row_sum(static_cast<std::size_t>(height));
    parallel_for(row_sum.size(), settings.threads, [&](std::size_t r) {
      const int y = static_cast<int>(r);
      RowBuffers row;
      row.resize(static_cast<std::size_t>(width));
      std::vector<float> reference(static_cast<std::size_t>(width));
      std::vector<float> test(static_cast<std::size_t>(width));
      doubled_row(coarse.reference_sustained, y, width, row.scratch, row.blurred.data());
      for (std::size_t x = 0; x < row.blurred.size(); ++x) {
        row.background[x] = std::max(row.blurred[x], kLeastBackground);
      }
      band_sensitivity(bands[b], gaze, y, row.background, row.sensitivity_sustained, row.sensitivity_transient);
      const std::size_t from = planes.reference_sustained.index(0, y);
      const auto channel = [&](const ImageGray& ref, const ImageGray& ref_coarse, const ImageGray& tst,
                               const ImageGray& tst_coarse, const std::vector<float>& sensitivity, float q) {
        doubled_row(ref_coarse, y, width, row.scratch, row.blurred.data());
        normalised_contrast(&ref.pixels[from], row.blurred, row.background, sensitivity, gain, reference);
        doubled_row(tst_coarse, y, width, row.scratch, row.blurred.data());
        normalised_contrast(&tst.pixels[from], row.blurred, row.background, sensitivity, gain, test);
        masked_differences(reference, test, q, row.difference);
        const float* weights_of_row = pooling[b].weights.empty() ? nullptr : &pooling[b].weights.pixels[from];
        return sum_of_powers(row.difference, weights_of_row, static_cast<float>(kPoolSpace));
      };
      row_sum[r][0] = channel(planes.reference_sustained, coarse.reference_sustained, planes.test_sustained,
                              coarse.test_sustained, row.sensitivity_sustained, kMaskSustained);
      if (want_map) {
        std::copy(row.difference.begin(), row.difference.end(), &result.map.pixels[from]);
      }
      if (has_transient) {
        row_sum[r][1] = channel(planes.reference_transient, coarse.reference_transient, planes.test_transient,
                                coarse.test_transient, row.sensitivity_transient, kMaskTransient);
        for (std::size_t x = 0; want_map && x < row.difference.size(); ++x) {
          result.map.pixels[from + x] += static_cast<float>(kTransientWeight) * row.difference[x];
        }
      }
    });
    for (const auto& sum : row_sum) {
      result.sustained += sum[0];
      result.transient += sum[1];
    }
    result.sustained = std::pow(result.sustained / pooling[b].sum, 1 / kPoolSpace);
    result.transient = std::pow(result.transient / pooling[b].sum, 1 / kPoolSpace);
    return result;
  }

  [[nodiscard]] Planes halved_planes(const Planes& planes) const {
    const auto half = [&](const ImageGray& plane) {
      return plane.empty() ? ImageGray{} : halved(plane, settings.original_border, settings.threads);
    };
    return {half(planes.reference_sustained), half(planes.test_sustained), half(planes.reference_transient),
            half(planes.test_transient)};
  }

  // Collapses the pyramid of differences, with each band but the finest at half its value, and converts it to JOD.
  [[nodiscard]] ImageGray collapsed(std::vector<ImageGray> maps) const {
    ImageGray sum = std::move(maps.back());
    const auto scale = [](ImageGray& map, float factor) {
      for (float& value : map.pixels) {
        value *= factor;
      }
    };
    if (maps.size() > 1) {
      scale(sum, 0.5F);
    }
    for (std::size_t b = maps.size() - 1; b-- > 0;) {
      ImageGray finer = std::move(maps[b]);
      if (b > 0) {
        scale(finer, 0.5F);
      }
      const ImageGray blurred = doubled(sum, finer.width_px, finer.height_px, settings.threads);
      std::transform(finer.pixels.begin(), finer.pixels.end(), blurred.pixels.begin(), finer.pixels.begin(),
                     std::plus<>());
      sum = std::move(finer);
    }
    static const auto kExponent = static_cast<float>(std::pow(10, kLog10JodExponent));
    for (float& value : sum.pixels) {
      value = static_cast<float>(kJodScale) * pow_fast(value, kExponent);
    }
    return sum;
  }

  [[nodiscard]] FovVideoVdpFrame score(const Vec2d& gaze_px, bool want_map) const {
    const Vec2d gaze = settings.geometry.view_direction_deg(gaze_px.x, gaze_px.y, width_px, height_px);
    const Vec2f gaze_deg{static_cast<float>(gaze.x), static_cast<float>(gaze.y)};
    FovVideoVdpFrame frame;
    std::vector<ImageGray> maps;
    Planes planes = planes_now();
    const bool has_transient = !planes.reference_transient.empty();
    for (std::size_t b = 0; b < bands.size(); ++b) {
      Planes coarse = halved_planes(planes);
      BandResult band = band_difference(b, planes, coarse, gaze_deg, want_map);
      frame.sustained.push_back(band.sustained);
      if (has_transient) {
        frame.transient.push_back(band.transient);
      }
      maps.push_back(std::move(band.map));
      planes = std::move(coarse);
    }
    frame.q = pooled_over_bands(frame.sustained, frame.transient);
    if (want_map) {
      frame.map = collapsed(std::move(maps));
    }
    return frame;
  }
};

FovVideoVdp::FovVideoVdp(const FovVideoVdpSettings& settings, int width_px, int height_px)
    : impl_(std::make_unique<Impl>(settings, width_px, height_px)) {}
FovVideoVdp::~FovVideoVdp() = default;
FovVideoVdp::FovVideoVdp(FovVideoVdp&&) noexcept = default;
FovVideoVdp& FovVideoVdp::operator=(FovVideoVdp&&) noexcept = default;

void FovVideoVdp::prime(const ImageGray& reference_cd_m2, const ImageGray& test_cd_m2) {
  impl_->remember(reference_cd_m2, test_cd_m2);
}

FovVideoVdpFrame FovVideoVdp::add(const ImageGray& reference_cd_m2, const ImageGray& test_cd_m2,
                                  std::optional<Vec2d> gaze_px, bool want_map) {
  impl_->remember(reference_cd_m2, test_cd_m2);
  const Vec2d middle{impl_->width_px / 2 + 0.5, impl_->height_px / 2 + 0.5};
  return impl_->score(gaze_px.value_or(middle), want_map);
}

const std::vector<double>& FovVideoVdp::band_frequencies_cpd() const {
  return impl_->frequencies_cpd;
}

int FovVideoVdp::taps() const {
  return static_cast<int>(impl_->taps());
}

}  // namespace gazetrace
