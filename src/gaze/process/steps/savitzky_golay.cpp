// SPDX-License-Identifier: Apache-2.0
// A polynomial fitted by least squares to the samples of a window, evaluated at its middle (Savitzky & Golay 1964). The
// fit uses the samples' own times, so that uneven steps do no harm. Near the ends of a run the first or last whole
// window is used and evaluated away from its middle, so that polynomials up to the order stay unchanged everywhere.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "gaze/process/gaze_step.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kMostTerms = 6;

// The coefficient c0 of the best fitting polynomial with `terms` coefficients in (t - at).
Vec3d value_at(const std::vector<GazeSample>& samples, GazeKind kind, std::size_t first, std::size_t end,
               std::int64_t at_ns, double scale_ns, std::size_t terms) {
  std::array<double, 2 * kMostTerms> moments{};
  std::array<Vec3d, kMostTerms> right{};
  for (std::size_t i = first; i < end; ++i) {
    const double tau = static_cast<double>(samples[i].t_ns - at_ns) / scale_ns;
    const Vec3d place = place_of(samples[i], kind);
    double power = 1;
    for (std::size_t p = 0; p < 2 * terms - 1; ++p) {
      moments[p] += power;
      if (p < terms) {
        right[p] += power * place;
      }
      power *= tau;
    }
  }
  // Plain elimination is enough for this symmetric, positive system, which is small and well scaled.
  std::array<std::array<double, kMostTerms>, kMostTerms> a{};
  for (std::size_t r = 0; r < terms; ++r) {
    for (std::size_t c = 0; c < terms; ++c) {
      a[r][c] = moments[r + c];
    }
  }
  // The last unknown is eliminated first, so that c0 remains.
  for (std::size_t pivot = terms - 1; pivot > 0; --pivot) {
    for (std::size_t r = 0; r < pivot; ++r) {
      const double factor = a[r][pivot] / a[pivot][pivot];
      for (std::size_t c = 0; c <= pivot; ++c) {
        a[r][c] -= factor * a[pivot][c];
      }
      right[r] = right[r] - factor * right[pivot];
    }
  }
  return right[0] / a[0][0];
}

}  // namespace

std::string apply_savitzky_golay(GazeLog& log, const GazeStep& step) {
  const auto terms = static_cast<std::size_t>(step.value("order")) + 1;
  const std::int64_t step_ns = median_step_ns(times_of(log));
  if (step_ns <= 0) {
    return "nothing to filter";
  }
  const auto half =
      static_cast<std::size_t>(std::max<std::int64_t>(1, (step.duration_ns("window") / 2 + step_ns / 2) / step_ns));
  const std::size_t count = 2 * half + 1;
  if (count < terms + 1) {
    throw Error(ErrorKind::usage, "gaze step savitzky-golay",
                fmt::format("a window of {} samples is no more than a polynomial of order {} needs", count, terms - 1),
                "give a longer window or a lower order");
  }
  const std::vector<GazeSample> before = log.samples;
  std::size_t short_runs = 0;
  for (const FilterRun& run : filter_runs(log)) {
    if (run.end - run.first < count) {
      ++short_runs;
      continue;
    }
    for (std::size_t i = run.first; i < run.end; ++i) {
      const std::size_t first = std::clamp(i, run.first + half, run.end - 1 - half) - half;
      const auto scale_ns = static_cast<double>(before[first + count - 1].t_ns - before[first].t_ns);
      set_place(log.samples[i], log.kind,
                value_at(before, log.kind, first, first + count, before[i].t_ns, scale_ns, terms));
    }
  }
  return fmt::format("windows of {} samples; {} runs were shorter and stay", count, short_runs);
}

}  // namespace gazetrace
