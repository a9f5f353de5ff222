// SPDX-License-Identifier: Apache-2.0
// The spectrum of the last N values of many series, carried on from frame to frame: adding a value costs as much as
// there are frequencies (Jacobsen and Lyons, "The sliding DFT", IEEE Signal Processing Magazine, 2003).
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "gazetrace/image.hpp"

namespace gazetrace {

// X_k = sum over n = 0 .. N-1, the oldest first, of x_n exp(-2 pi i k n / N), for k = 0 .. N/2. Of the values the first
// one of each series is taken off: a series that never changes has zeros and nothing else.
class SlidingSpectrum {
 public:
  SlidingSpectrum(int width, int height, int frames);
  void add(const ImageGray& values, int threads);
  [[nodiscard]] bool is_full() const { return added_ >= static_cast<std::size_t>(frames_); }
  [[nodiscard]] std::size_t bins() const { return bins_; }
  [[nodiscard]] const std::complex<double>* at(std::size_t series) const { return &spectrum_[series * bins_]; }
  [[nodiscard]] double mean(std::size_t series) const {
    return static_cast<double>(first_[series]) + at(series)[0].real() / frames_;
  }

 private:
  int frames_;
  std::size_t bins_;
  std::size_t added_ = 0;
  std::vector<float> first_;
  std::vector<std::vector<float>> values_;  // the last N frames, in a ring
  std::vector<std::complex<double>> turn_;  // exp(2 pi i k / N)
  std::vector<std::complex<double>> spectrum_;
};

// Power at k = 1 .. N/2 under a Hann window, the mean taken off: their sum is the mean square of a series that the
// window holds whole periods of, but for what a period of N leaks to 0. X holds k = 0 .. N/2.
void hann_power(const std::complex<double>* spectrum, int frames, std::vector<double>& power);

}  // namespace gazetrace
