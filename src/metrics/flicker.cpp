// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/flicker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "metrics/contrast_sensitivity.hpp"
#include "metrics/flicker_sensitivity.hpp"
#include "metrics/luminance_patches.hpp"
#include "metrics/sliding_spectrum.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kScales = 4;
constexpr double kFinestCpd = 4;
constexpr double kLeastLuminance = 0.1;  // of the background L, cd/m2

int finest_patch_px(double pixels_per_degree) {
  return std::max(1, static_cast<int>(std::lround(pixels_per_degree / (2 * kFinestCpd))));
}

// The spectra of both sequences in the patches of one size.
struct PatchSpectra {
  int patch_px = 0, columns = 0, rows = 0;
  std::vector<std::complex<double>> reference, test;  // k = 0 .. N/2 of each patch
  std::vector<double> luminance;                      // mean of the reference
  std::vector<double> pixels;                         // number of the patch's pixels inside the picture
};

// The spectra of patches of twice the side, as means over four patches.
PatchSpectra paired(const PatchSpectra& fine, std::size_t bins, int threads) {
  PatchSpectra coarse;
  coarse.patch_px = 2 * fine.patch_px;
  coarse.columns = (fine.columns + 1) / 2;
  coarse.rows = (fine.rows + 1) / 2;
  const auto patches = static_cast<std::size_t>(coarse.columns) * static_cast<std::size_t>(coarse.rows);
  coarse.reference.resize(patches * bins);
  coarse.test.resize(patches * bins);
  coarse.luminance.resize(patches);
  coarse.pixels.resize(patches);
  parallel_for(static_cast<std::size_t>(coarse.rows), threads, [&](std::size_t r) {
    const int row = static_cast<int>(r);
    for (int column = 0; column < coarse.columns; ++column) {
      const std::size_t to = r * static_cast<std::size_t>(coarse.columns) + static_cast<std::size_t>(column);
      for (int y = 2 * row; y < std::min(2 * row + 2, fine.rows); ++y) {
        for (int x = 2 * column; x < std::min(2 * column + 2, fine.columns); ++x) {
          const auto from =
              static_cast<std::size_t>(y) * static_cast<std::size_t>(fine.columns) + static_cast<std::size_t>(x);
          const double weight = fine.pixels[from];
          coarse.pixels[to] += weight;
          coarse.luminance[to] += weight * fine.luminance[from];
          for (std::size_t k = 0; k < bins; ++k) {
            coarse.reference[to * bins + k] += weight * fine.reference[from * bins + k];
            coarse.test[to * bins + k] += weight * fine.test[from * bins + k];
          }
        }
      }
      coarse.luminance[to] /= coarse.pixels[to];
      for (std::size_t k = 0; k < bins; ++k) {
        coarse.reference[to * bins + k] /= coarse.pixels[to];
        coarse.test[to * bins + k] /= coarse.pixels[to];
      }
    }
  });
  return coarse;
}

double pixels_per_degree_of(const PlanarView& view) {
  return 1 / (view.step_x * kDegPerRad);
}

}  // namespace

int frames_of_a_second(double frames_per_second) {
  constexpr double kLeastRate = 4;
  constexpr double kMostRate = 1000;
  if (!(frames_per_second >= kLeastRate && frames_per_second <= kMostRate)) {
    throw Error(ErrorKind::usage, "flicker", fmt::format("{:g} frames a second", frames_per_second),
                fmt::format("it can be measured at {:g} to {:g} frames a second: give `fps`, or leave the metric out",
                            kLeastRate, kMostRate));
  }
  return static_cast<int>(std::lround(frames_per_second));
}

FlickerRange flicker_range(double frames_per_second, double luminance_cd_m2) {
  constexpr double kMostHz = 200;
  const int frames = frames_of_a_second(frames_per_second);
  FlickerRange range;
  range.lowest_hz = frames_per_second / frames;
  const int whole_periods = frames / 2;  // of the highest frequency, within a second
  range.highest_hz = range.lowest_hz * whole_periods;
  const auto sees = [&](double hz) {
    double most = 0;
    for (std::size_t s = 0; s < kScales; ++s) {
      most = std::max(most, contrast_sensitivity(kFinestCpd / std::exp2(s), hz, luminance_cd_m2, 0));
    }
    return most >= 1;
  };
  double seen = 1;
  double unseen = kMostHz;
  while (unseen - seen > 0.01) {
    const double middle = 0.5 * (seen + unseen);
    (sees(middle) ? seen : unseen) = middle;
  }
  range.fusion_hz = seen;
  return range;
}

std::string flicker_range_text(const FlickerRange& range) {
  return fmt::format(
      "from {:g} to {:g} Hz, over the second up to each frame; {}", range.lowest_hz, range.highest_hz,
      range.fusion_hz > range.highest_hz
          ? fmt::format("flicker of up to {:.0f} Hz would be visible, but flicker above {:g} Hz cannot be measured "
                        "at this frame rate: it appears slower, or not at all",
                        range.fusion_hz, range.highest_hz)
          : "all visible flicker can be measured at this frame rate");
}

struct FlickerMeter::Impl {
  FlickerSettings settings;
  int frames;
  int patch_px;
  SlidingSpectrum reference, test;
  std::vector<FlickerSensitivity> sensitivity;  // one per scale

  Impl(const FlickerSettings& given, int frame_count, int patch, int columns, int rows)
      : settings(given),
        frames(frame_count),
        patch_px(patch),
        reference(columns, rows, frame_count),
        test(columns, rows, frame_count) {
    std::vector<double> frequencies_hz;
    for (int k = 1; k <= frames / 2; ++k) {
      frequencies_hz.push_back(k * settings.frames_per_second / frames);
    }
    for (std::size_t s = 0; s < kScales; ++s) {
      const double rho_cpd = pixels_per_degree_of(settings.view) / (2 * patch_px * std::exp2(s));
      sensitivity.emplace_back(rho_cpd, frequencies_hz, settings.threads);
    }
  }

  [[nodiscard]] PatchSpectra finest() const {
    PatchSpectra patches;
    patches.patch_px = patch_px;
    patches.columns = (settings.view.width_px + patch_px - 1) / patch_px;
    patches.rows = (settings.view.height_px + patch_px - 1) / patch_px;
    const auto count = static_cast<std::size_t>(patches.columns) * static_cast<std::size_t>(patches.rows);
    patches.reference.assign(reference.at(0), reference.at(0) + count * reference.bins());
    patches.test.assign(test.at(0), test.at(0) + count * test.bins());
    for (int row = 0; row < patches.rows; ++row) {
      for (int column = 0; column < patches.columns; ++column) {
        const int width = std::min(patch_px, settings.view.width_px - column * patch_px);
        const int height = std::min(patch_px, settings.view.height_px - row * patch_px);
        patches.pixels.push_back(static_cast<double>(width) * height);
        patches.luminance.push_back(reference.mean(patches.luminance.size()));
      }
    }
    return patches;
  }

  // F of each patch at one scale, before the maximum over the scales is taken.
  [[nodiscard]] ImageGray excess(const PatchSpectra& patches, std::size_t scale, const Vec3d& gaze) const {
    ImageGray result(patches.columns, patches.rows);
    const std::size_t bins = reference.bins();
    parallel_for(static_cast<std::size_t>(patches.rows), settings.threads, [&](std::size_t r) {
      const int row = static_cast<int>(r);
      std::vector<double> s2(bins - 1);
      std::vector<double> of_reference(bins - 1);
      std::vector<double> of_test(bins - 1);
      const double y_px = std::min((row + 0.5) * patches.patch_px, static_cast<double>(settings.view.height_px));
      for (int column = 0; column < patches.columns; ++column) {
        const auto patch = r * static_cast<std::size_t>(patches.columns) + static_cast<std::size_t>(column);
        const double x_px = std::min((column + 0.5) * patches.patch_px, static_cast<double>(settings.view.width_px));
        const double luminance = std::max(patches.luminance[patch], kLeastLuminance);
        sensitivity[scale].squared(luminance, eccentricity_deg(settings.view, gaze, x_px, y_px), s2);
        hann_power(&patches.reference[patch * bins], frames, of_reference);
        hann_power(&patches.test[patch * bins], frames, of_test);
        double sum = 0;
        for (std::size_t k = 0; k < s2.size(); ++k) {
          sum += s2[k] * (of_test[k] - of_reference[k]);
        }
        result(column, row) = static_cast<float>(std::max(0.0, 2 * sum / (luminance * luminance)));
      }
    });
    return result;
  }

  [[nodiscard]] ImageGray score(const Vec2d& gaze_px) const {
    const Vec3d gaze = settings.view.direction(gaze_px.x, gaze_px.y);
    PatchSpectra patches = finest();
    ImageGray most = excess(patches, 0, gaze);
    for (std::size_t scale = 1; scale < kScales; ++scale) {
      patches = paired(patches, reference.bins(), settings.threads);
      const ImageGray coarse = excess(patches, scale, gaze);
      for (int y = 0; y < most.height_px; ++y) {
        for (int x = 0; x < most.width_px; ++x) {
          most(x, y) = std::max(most(x, y), coarse(x >> scale, y >> scale));
        }
      }
    }
    return spread_patches(most, patch_px, settings.view.width_px, settings.view.height_px, settings.threads);
  }
};

FlickerMeter::FlickerMeter(const FlickerSettings& settings) {
  const int frames = frames_of_a_second(settings.frames_per_second);
  const int patch_px = finest_patch_px(pixels_per_degree_of(settings.view));
  impl_ = std::make_unique<Impl>(settings, frames, patch_px, (settings.view.width_px + patch_px - 1) / patch_px,
                                 (settings.view.height_px + patch_px - 1) / patch_px);
}
FlickerMeter::~FlickerMeter() = default;

std::optional<ImageGray> FlickerMeter::add(const ImageGray& reference_cd_m2, const ImageGray& test_cd_m2,
                                           std::optional<Vec2d> gaze_px) {
  Impl& state = *impl_;
  for (const ImageGray* image : {&reference_cd_m2, &test_cd_m2}) {
    if (image->width_px != state.settings.view.width_px || image->height_px != state.settings.view.height_px) {
      throw Error(ErrorKind::usage, "flicker",
                  fmt::format("a frame has {}x{} pixels, not {}x{}", image->width_px, image->height_px,
                              state.settings.view.width_px, state.settings.view.height_px));
    }
  }
  state.reference.add(patch_means(reference_cd_m2, state.patch_px, state.settings.threads), state.settings.threads);
  state.test.add(patch_means(test_cd_m2, state.patch_px, state.settings.threads), state.settings.threads);
  if (!gaze_px || !state.reference.is_full()) {
    return std::nullopt;
  }
  return state.score(*gaze_px);
}

}  // namespace gazetrace
