// SPDX-License-Identifier: Apache-2.0
// The expectation of FovVideoVDP's masked difference, to the power that it is pooled with, of a picture's contrast u
// and a normally distributed error of standard deviation s, both in multiples of the threshold:
//   a(u, s) = E[D^r],  D = min(|s z|^2.4 / (1 + m^q), 10000),  m = k min(|u|, |u + s z|)   (metrics/masking.hpp).
// Without a picture, and far below the limit, it is s^p E|z|^p with p = 2.4 r, and
// E|z|^p = 2^(p/2) Gamma((p + 1) / 2) / sqrt(pi).
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace gazetrace {

// E|z|^p of a normal z of unit variance.
double absolute_moment(double p);

// a(u, s) / (s^p E|z|^p), at most 1: what masking and the limit leave. By quadrature over 256 values of z, tabulated
// over the logarithms of u (1/4 to 2^16) and s (1/16 to 2^12) in steps of a quarter octave, with bilinear
// interpolation; beyond the table its borders hold, except that above it the limit alone decides.
class MaskedMoments {
 public:
  // The only tables of the two channels, which are made when they are first asked for (about 0.1 s).
  static const MaskedMoments& sustained();
  static const MaskedMoments& transient();

  // a(u, s), for s >= 0; 0 for s = 0.
  [[nodiscard]] float operator()(float contrast, float deviation) const;

 private:
  explicit MaskedMoments(float mask_exponent);
  static constexpr int kStepsPerOctave = 4;
  static constexpr int kLeastLog2U = -2, kMostLog2U = 16;
  static constexpr int kLeastLog2S = -4, kMostLog2S = 12;
  static constexpr std::size_t kContrasts = (kMostLog2U - kLeastLog2U) * kStepsPerOctave + 1;
  static constexpr std::size_t kDeviations = (kMostLog2S - kLeastLog2S) * kStepsPerOctave + 1;
  std::vector<float> log2_left_;  // deviation is the slower index
};

}  // namespace gazetrace
