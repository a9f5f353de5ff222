// SPDX-License-Identifier: Apache-2.0
// Butterworth low-pass in second-order sections s^2 + 2 sin(pi (2k+1) / 2N) s + 1 by the bilinear transform that keeps
// the cut-off, run forward and backward. The result has no phase shift and the gain 1 / (1 + (tan(pi f T) / tan(pi fc
// T))^2N), which is one half at the cut-off. Runs are continued at both ends by their point reflection, and sections
// begin in the steady state.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gaze/process/gaze_step.hpp"

namespace gazetrace {
namespace {

struct Section {
  double b0, b1, b2, a1, a2;
};

std::vector<Section> low_pass(int order, double cutoff_hz, double rate_hz) {
  const double k = std::tan(kPi * cutoff_hz / rate_hz);
  std::vector<Section> sections;
  for (int i = 0; i < order / 2; ++i) {
    const double damping = 2 * std::sin(kPi * (2 * i + 1) / (2 * order));
    const double a0 = 1 + damping * k + k * k;
    sections.push_back({k * k / a0, 2 * k * k / a0, k * k / a0, 2 * (k * k - 1) / a0, (1 - damping * k + k * k) / a0});
  }
  return sections;
}

void run_forward(const std::vector<Section>& sections, std::vector<Vec3d>& x) {
  for (const Section& s : sections) {
    // Transposed direct form II, which starts as if the first value had been there forever.
    Vec3d z2 = (s.b2 - s.a2) * x.front();
    Vec3d z1 = (1 - s.b0) * x.front();
    for (Vec3d& value : x) {
      const Vec3d out = s.b0 * value + z1;
      z1 = s.b1 * value - s.a1 * out + z2;
      z2 = s.b2 * value - s.a2 * out;
      value = out;
    }
  }
}

}  // namespace

std::string apply_butterworth(GazeLog& log, const GazeStep& step) {
  const int order = static_cast<int>(step.value("order"));
  const double cutoff_hz = step.value("cutoff");
  const std::int64_t step_ns = median_step_ns(times_of(log));
  if (step_ns <= 0) {
    return "nothing to filter";
  }
  const double rate_hz = 1e9 / static_cast<double>(step_ns);
  if (order % 2 != 0) {
    throw Error(ErrorKind::usage, "gaze step butterworth", fmt::format("an order of {} is not even", order),
                "give 2, 4, 6 or 8");
  }
  if (!(cutoff_hz < 0.5 * rate_hz)) {
    throw Error(ErrorKind::usage, "gaze step butterworth",
                fmt::format("a cut-off of {} Hz is not below half the log's rate of {:.4g} Hz", cutoff_hz, rate_hz),
                fmt::format("give cutoff={:.3g} or less", 0.4 * rate_hz));
  }
  const std::vector<Section> sections = low_pass(order, cutoff_hz, rate_hz);
  const auto settle = static_cast<std::size_t>(std::ceil(order * rate_hz / cutoff_hz)) + 3;
  std::size_t runs = 0;
  for (const FilterRun& run : filter_runs(log)) {
    const std::size_t count = run.end - run.first;
    if (count < 4) {
      continue;
    }
    ++runs;
    const std::size_t pad = std::min(count - 1, settle);
    std::vector<Vec3d> x(count + 2 * pad);
    for (std::size_t i = 0; i < count; ++i) {
      x[pad + i] = place_of(log.samples[run.first + i], log.kind);
    }
    for (std::size_t i = 1; i <= pad; ++i) {
      x[pad - i] = 2.0 * x[pad] - x[pad + i];
      x[pad + count - 1 + i] = 2.0 * x[pad + count - 1] - x[pad + count - 1 - i];
    }
    run_forward(sections, x);
    std::reverse(x.begin(), x.end());
    run_forward(sections, x);
    std::reverse(x.begin(), x.end());
    for (std::size_t i = 0; i < count; ++i) {
      set_place(log.samples[run.first + i], log.kind, x[pad + i]);
    }
  }
  return fmt::format("{} runs at {:.4g} Hz", runs, rate_hz);
}

}  // namespace gazetrace
