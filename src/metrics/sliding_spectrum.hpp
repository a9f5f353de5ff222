// SPDX-License-Identifier: Apache-2.0
// The spectrum of the last N values of many series, updated from frame to frame: the cost of adding a value grows with
// the number of frequencies only (Jacobsen and Lyons, "The sliding DFT", IEEE Signal Processing Magazine, 2003).
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "gazetrace/image.hpp"

namespace gazetrace {

// X_k = sum over n = 0 .. N-1, oldest first, of x_n exp(-2 pi i k n / N), for k = 0 .. N/2. The first value of each
// series is subtracted from all its values, so that the spectrum of a series that never changes is exactly 0.
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

// The power at k = 1 .. N/2 under a Hann window, with the mean subtracted. The sum over k is the mean square of a
// series of which the window holds whole periods, except for what a period of N values leaks to k = 0. `spectrum` holds
// k = 0 .. N/2.
void hann_power(const std::complex<double>* spectrum, int frames, std::vector<double>& power);

}  // namespace gazetrace
