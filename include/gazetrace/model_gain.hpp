// SPDX-License-Identifier: Apache-2.0
// The gain of foveation by display, field of view and spectrum of the noise: how many samples uniform
// sampling needs over the best rates by eccentricity alone, at the same visible error by FovVideoVDP's model
// (visible_error.hpp). It knows no picture: noise of the same relative size everywhere, on a field of one luminance.
// So it is no bound of a renderer's gain: that the relative noise of a picture differs from place to place, and
// that its contrast masks noise, are both left out.
//
// The best rates. With n(x) samples a pixel the error in band b and channel c has the standard deviation
// s_bc(x) n(x)^(-1/2), in multiples of the threshold, and FovVideoVDP's Q is a function of
//   A_bc = mean over x of s_bc(x)^p n(x)^(-p/2),   p = kVisiblePooling.
// At the least Q for a given mean of n, the derivative of Q by n(x) is the same everywhere, hence
//   n(x) ~ (sum over b, c of (dQ / dA_bc) s_bc(x)^p)^(1 / (1 + p/2)),
// which is solved by iteration, since the derivatives depend on n. These rates are the same at every quality, since Q
// falls with all of them as their power of -1.2. The samples that reach a quality heed that the metric limits each
// difference to 10000, which at uniform rates ends the fovea's contribution: at less quality there is less to gain.
#pragma once

#include <optional>

#include "gazetrace/display.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/visible_error.hpp"

namespace gazetrace {

struct ModelGainSettings {
  PlanarView view;               // of the frame, as in FrameRequest
  double frames_per_second = 0;  // fresh noise in every frame of a clip; 0: a still
  double luminance_cd_m2 = 30;   // of the field
  // FovVideoVDP counts the pixels per degree of a flat screen, which grow off its middle, so that the same noise is
  // finer there. true: those of the middle hold everywhere, as behind lenses that spread pixels evenly.
  bool even_resolution = false;
  double target_jod = 9.5;  // 5 or more, and below 10
  int threads = 0;
};

struct ModelGain {
  double gain = 1;  // uniform_spp over allocated_spp
  // Samples a pixel that reach the target if the standard deviation of one sample is the luminance itself (a contrast
  // of 1); both are proportional to its square.
  double uniform_spp = 0, allocated_spp = 0;
  ImageGray density;  // the best rates, with a mean of 1, on a raster that covers the frame with squares of pixels
};

// `spectrum` is that of the noise after reconstruction; see cut_error(). Error(usage) where VisibleErrorModel gives
// one, and for a target out of range.
ModelGain model_gain(const ModelGainSettings& settings, const Vec3d& gaze_direction, const ErrorSpectrum& spectrum);

}  // namespace gazetrace
