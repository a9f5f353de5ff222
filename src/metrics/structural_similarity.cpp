// SPDX-License-Identifier: Apache-2.0
#include "metrics/structural_similarity.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/parallel.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kTaps = 2 * kSsimRadiusPx + 1;
using Window = std::array<double, kTaps>;

Window gaussian_window() {
  constexpr double kSigma = 1.5;
  Window window{};
  double sum = 0;
  for (std::size_t i = 0; i < kTaps; ++i) {
    const double x = static_cast<double>(i) - kSsimRadiusPx;
    window[i] = std::exp(-x * x / (2 * kSigma * kSigma));
    sum += window[i];
  }
  for (double& weight : window) {
    weight /= sum;
  }
  return window;
}

// The means of r, t, r^2, t^2 and r t along the columns, for one output row.
struct ColumnMoments {
  explicit ColumnMoments(std::size_t width) : r(width), t(width), rr(width), tt(width), rt(width) {}
  std::vector<double> r, t, rr, tt, rt;
};

void add_row(const double* r, const double* t, double weight, ColumnMoments& m) {
  for (std::size_t x = 0; x < m.r.size(); ++x) {
    const double wr = weight * r[x];
    const double wt = weight * t[x];
    m.r[x] += wr;
    m.t[x] += wt;
    m.rr[x] += wr * r[x];
    m.tt[x] += wt * t[x];
    m.rt[x] += wr * t[x];
  }
}

void filter_row(const std::vector<double>& in, const Window& window, std::vector<double>& out) {
  const std::size_t width = in.size() - (kTaps - 1);
  for (std::size_t x = 0; x < width; ++x) {
    double sum = 0;
    for (std::size_t k = 0; k < kTaps; ++k) {
      sum += window[k] * in[x + k];
    }
    out[x] = sum;
  }
}

}  // namespace

SsimFactors ssim_factors(const ImageDouble& reference, const ImageDouble& test, int threads) {
  constexpr double kC1 = 0.01 * 0.01;
  constexpr double kC2 = 0.03 * 0.03;
  const int width = reference.width_px - 2 * kSsimRadiusPx;
  const int height = reference.height_px - 2 * kSsimRadiusPx;
  if (width < 1 || height < 1) {
    throw Error(ErrorKind::usage, "ssim",
                fmt::format("{}x{} pixels are less than its window of 11x11", reference.width_px, reference.height_px));
  }
  const Window window = gaussian_window();
  SsimFactors factors{ImageDouble(width, height), ImageDouble(width, height)};
  const auto full_width = static_cast<std::size_t>(reference.width_px);
  parallel_for(static_cast<std::size_t>(height), threads, [&](std::size_t row) {
    ColumnMoments columns(full_width);
    for (std::size_t k = 0; k < kTaps; ++k) {
      const std::size_t from = (row + k) * full_width;
      add_row(&reference.pixels[from], &test.pixels[from], window[k], columns);
    }
    ColumnMoments m(full_width);
    filter_row(columns.r, window, m.r);
    filter_row(columns.t, window, m.t);
    filter_row(columns.rr, window, m.rr);
    filter_row(columns.tt, window, m.tt);
    filter_row(columns.rt, window, m.rt);
    const std::size_t to = row * static_cast<std::size_t>(width);
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
      const double rr = m.r[x] * m.r[x];
      const double tt = m.t[x] * m.t[x];
      const double rt = m.r[x] * m.t[x];
      factors.luminance.pixels[to + x] = (2 * rt + kC1) / (rr + tt + kC1);
      factors.contrast_structure.pixels[to + x] = (2 * (m.rt[x] - rt) + kC2) / ((m.rr[x] - rr) + (m.tt[x] - tt) + kC2);
    }
  });
  return factors;
}

}  // namespace gazetrace
