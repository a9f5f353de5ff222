// SPDX-License-Identifier: Apache-2.0
#include "metrics/sliding_spectrum.hpp"

#include "core/parallel.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

SlidingSpectrum::SlidingSpectrum(int width, int height, int frames)
    : frames_(frames),
      bins_(static_cast<std::size_t>(frames / 2 + 1)),
      values_(static_cast<std::size_t>(frames)),
      spectrum_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * bins_) {
  for (std::size_t k = 0; k < bins_; ++k) {
    turn_.push_back(std::polar(1.0, 2 * kPi * static_cast<double>(k) / frames));
  }
}

void SlidingSpectrum::add(const ImageGray& values, int threads) {
  if (added_ == 0) {
    first_ = values.pixels;
  }
  std::vector<float>& slot = values_[added_ % values_.size()];
  const bool is_new = slot.empty();
  slot.resize(values.pixels.size());
  const auto columns = static_cast<std::size_t>(values.width_px);
  parallel_for(static_cast<std::size_t>(values.height_px), threads, [&](std::size_t row) {
    for (std::size_t i = row * columns; i < (row + 1) * columns; ++i) {
      const float value = values.pixels[i] - first_[i];
      const double change = static_cast<double>(value) - (is_new ? 0.0 : static_cast<double>(slot[i]));
      slot[i] = value;
      std::complex<double>* bins = &spectrum_[i * bins_];
      for (std::size_t k = 0; k < bins_; ++k) {
        const double re = bins[k].real() + change;
        const double im = bins[k].imag();
        bins[k] = {re * turn_[k].real() - im * turn_[k].imag(), re * turn_[k].imag() + im * turn_[k].real()};
      }
    }
  });
  ++added_;
}

void hann_power(const std::complex<double>* spectrum, int frames, std::vector<double>& power) {
  const auto n = static_cast<std::size_t>(frames);
  const std::size_t last = n / 2;
  const double scale = 8.0 / 3 / (static_cast<double>(n) * static_cast<double>(n));
  const auto bin = [&](std::size_t k) {
    return k == 0 ? std::complex<double>() : k <= last ? spectrum[k] : std::conj(spectrum[n - k]);
  };
  for (std::size_t k = 1; k <= last; ++k) {
    const std::complex<double> windowed = 0.5 * bin(k) - 0.25 * (bin(k - 1) + bin(k + 1));
    const double sides = 2 * k == n ? 1 : 2;
    power[k - 1] = sides * scale * std::norm(windowed);
  }
}

}  // namespace gazetrace
