// SPDX-License-Identifier: Apache-2.0
// Noise of known variance and spectrum, and what FovVideoVDP itself says of it.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "gazetrace/fovvideovdp.hpp"
#include "gazetrace/visible_error.hpp"

namespace gazetrace {

inline PlanarView view_of(int width_px, int height_px, double pixels_per_degree) {
  const double step = std::tan(1 / (pixels_per_degree * kDegPerRad));
  return {-step * width_px / 2, step * height_px / 2, step, step, width_px, height_px};
}

// A display whose scene luminance 1 is 1 cd/m2 more than its black, which is 0.
inline DisplayCurve luminance_as_it_is() {
  constexpr double kPeak = 1 << 13;
  const DisplayPhotometry photometry{DisplayResponse::linear, kPeak, 1e12, 0, 0};
  return linear_display_curve(photometry, -std::log2(kPeak));
}

inline ImageGray white_noise(int width_px, int height_px, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<float> normal;
  ImageGray noise(width_px, height_px);
  for (float& value : noise.pixels) {
    value = normal(engine);
  }
  return noise;
}

// Of unit variance, one value a block.
inline ImageGray block_noise(int width_px, int height_px, int block_px, unsigned seed) {
  const ImageGray small =
      white_noise((width_px + block_px - 1) / block_px, (height_px + block_px - 1) / block_px, seed);
  ImageGray noise(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      noise(x, y) = small(x / block_px, y / block_px);
    }
  }
  return noise;
}

// White noise after a Gaussian, brought to unit variance. The borders are those of a larger picture.
inline ImageGray low_pass_noise(int width_px, int height_px, double sigma_px, unsigned seed) {
  const int reach = static_cast<int>(std::ceil(4 * sigma_px));
  std::vector<double> kernel;
  double squares = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(std::exp(-i * i / (2 * sigma_px * sigma_px)));
    squares += kernel.back() * kernel.back();
  }
  const ImageGray white = white_noise(width_px + 2 * reach, height_px + 2 * reach, seed);
  ImageGray across(width_px, white.height_px);
  for (int y = 0; y < across.height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      double sum = 0;
      for (int i = 0; i <= 2 * reach; ++i) {
        sum += kernel[static_cast<std::size_t>(i)] * static_cast<double>(white(x + i, y));
      }
      across(x, y) = static_cast<float>(sum);
    }
  }
  ImageGray noise(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      double sum = 0;
      for (int i = 0; i <= 2 * reach; ++i) {
        sum += kernel[static_cast<std::size_t>(i)] * static_cast<double>(across(x, y + i));
      }
      noise(x, y) = static_cast<float>(sum / squares);
    }
  }
  return noise;
}

// The reference plus noise times a deviation for each pixel.
inline ImageGray with_noise(const ImageGray& reference, const ImageGray& noise, const ImageGray& deviation) {
  ImageGray sum = reference;
  for (std::size_t i = 0; i < sum.pixels.size(); ++i) {
    sum.pixels[i] += deviation.pixels[i] * noise.pixels[i];
  }
  return sum;
}

inline ImageGray squared(ImageGray image) {
  for (float& value : image.pixels) {
    value *= value;
  }
  return image;
}

// Q that the metric measures of a test sequence, as the mean over `frames` frames. The metric is primed with enough
// frames to have forgotten its start, unless the start counts.
inline double measured_q(const PlanarView& view, double fps, const Vec2d& gaze_px, const ImageGray& reference,
                         const std::function<ImageGray(int frame)>& test, int frames, bool from_start = false) {
  FovVideoVdpSettings settings;
  settings.geometry = fovvideovdp_geometry(view);
  settings.frames_per_second = fps;
  settings.threads = 2;
  FovVideoVdp metric(settings, view.width_px, view.height_px);
  int frame = 0;
  for (; !from_start && fps > 0 && frame < metric.taps(); ++frame) {
    metric.prime(reference, test(frame));
  }
  double sum = 0;
  for (int i = 0; i < frames; ++i, ++frame) {
    sum += metric.add(reference, test(frame), gaze_px).q;
  }
  return sum / frames;
}

}  // namespace gazetrace
