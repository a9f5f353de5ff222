// SPDX-License-Identifier: Apache-2.0
// How the pyramid of metrics/pyramid.hpp responds to frequencies.
//
// A value of band b is a weighted sum of the picture's pixels, and the Fourier transform of its weights is
//   H(fx, fy) = K_b(fx) K_b(fy) - E_b(fx) E_b(fy),
// with K_b(f) the product of k(2^i f) over i < b, k(f) = 0.4 + 0.5 cos(2 pi f) + 0.1 cos(4 pi f) the kernel, and E_b
// what interpolation from level b + 1 gives: K_(b+1)(f) times 0.8 + 0.2 cos(2 pi 2^(b+1) f) at the even pixels of level
// b, and times cos(2 pi 2^b f) at the odd ones. So the variance of band b is the integral of H^2 times the power of the
// error over all frequencies, at each of the four kinds of pixels, whatever is aliased on the way.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "gazetrace/visible_error.hpp"

namespace gazetrace {

// Frequencies of quadrature in (0, 1/2), closer together where they are low, and their weights over (-1/2, 1/2).
struct FrequencyGrid {
  std::vector<double> f, weight;
};
const FrequencyGrid& frequency_grid();

// The spectrum of an error whose power at (fx, fy), in cycles a pixel, is this; 1: white noise of unit variance. The
// power must be even in both frequencies.
ErrorSpectrum spectrum_of_power(const std::function<double(double fx, double fy)>& power);

}  // namespace gazetrace
