// SPDX-License-Identifier: Apache-2.0
// What the events of a log look like as a whole: main sequence and histograms.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.hpp"
#include "gazetrace/gaze_synth.hpp"
#include "study/report/drawing.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kMostMarks = 3000;  // of a scatter plot; more are thinned

bool is_measured_saccade(const EyeEvent& event) {
  return (event.movement == EyeMovement::saccade || event.movement == EyeMovement::microsaccade) &&
         event.amplitude_deg > 0 && event.peak_velocity_deg_s > 0 && std::isfinite(event.amplitude_deg) &&
         std::isfinite(event.peak_velocity_deg_s);
}

Axis log_axis(double low, double high, double begin, double end) {
  const double from = std::floor(std::log10(low) * 2) / 2;
  const double to = std::ceil(std::log10(high) * 2) / 2;
  return {from, std::max(to, from + 0.5), begin, end};
}

}  // namespace

MainSequence fit_main_sequence(const std::vector<EyeEvent>& events) {
  constexpr double kLeastDeg = 0.5;
  constexpr double kMostDeg = 30;
  std::vector<double> x;
  std::vector<double> y;
  for (const EyeEvent& event : events) {
    if (is_measured_saccade(event) && event.amplitude_deg >= kLeastDeg && event.amplitude_deg <= kMostDeg) {
      x.push_back(std::log10(event.amplitude_deg));
      y.push_back(std::log10(event.peak_velocity_deg_s));
    }
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MainSequence fit{x.size(), nan, nan, nan};
  if (x.size() < 5) {
    return fit;
  }
  const double mean_x = mean_of(x);
  const double mean_y = mean_of(y);
  double xx = 0;
  double xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  if (xx > 0) {
    fit.exponent = xy / xx;
    fit.factor = std::pow(10.0, mean_y - fit.exponent * mean_x);
    fit.correlation = correlation(x, y);
  }
  return fit;
}

GazePlot main_sequence_plot(const std::vector<EyeEvent>& events, const MainSequence& fit) {
  std::vector<const EyeEvent*> saccades;
  for (const EyeEvent& event : events) {
    if (is_measured_saccade(event)) {
      saccades.push_back(&event);
    }
  }
  double low = 1;
  double high = 10;
  double slow = 50;
  double fast = 300;
  for (const EyeEvent* s : saccades) {
    low = std::min(low, s->amplitude_deg);
    high = std::max(high, s->amplitude_deg);
    slow = std::min(slow, s->peak_velocity_deg_s);
    fast = std::max(fast, s->peak_velocity_deg_s);
  }
  const Axis x = log_axis(low, high, 58, kSmallWidth - 14);
  const Axis y = log_axis(slow, fast, kSmallHeight - 48, 16);
  Drawing svg(kSmallWidth, kSmallHeight, "Main sequence: peak velocity over amplitude of saccades");
  svg.x_axis(x, y, 5, "amplitude [deg]", true);
  svg.y_axis(x, y, 5, "peak velocity [deg/s]", true);
  const std::size_t stride = saccades.size() / kMostMarks + 1;
  for (std::size_t i = 0; i < saccades.size(); i += stride) {
    const bool is_micro = saccades[i]->movement == EyeMovement::microsaccade;
    svg.add(fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="2.6" fill="{}" fill-opacity="0.55"/>)",
                        x.at(std::log10(saccades[i]->amplitude_deg)),
                        y.at(std::log10(saccades[i]->peak_velocity_deg_s)), is_micro ? "#009e73" : kLeftColor));
  }
  // As in synthetic gaze: 15/8 amplitude / duration, by the durations of the main sequence.
  std::string curve;
  for (int i = 0; i <= 40; ++i) {
    const double amplitude = std::pow(10.0, x.low + (x.high - x.low) * i / 40);
    const double peak = 1.875 * amplitude / main_sequence_duration_s(amplitude);
    const double at = y.at(std::log10(peak));
    if (at <= y.begin && at >= y.end) {
      curve += fmt::format("{}{:.1f} {:.1f}", curve.empty() ? "M" : "L", x.at(std::log10(amplitude)), at);
    }
  }
  svg.add(
      fmt::format(R"(<path d="{}" fill="none" stroke="#888888" stroke-width="1.6" stroke-dasharray="6 4"/>)", curve));
  svg.frame(x, y);
  svg.text(x.begin + 8, y.end + 14, "- - expected (Carpenter 1988)", "start", R"(fill="#666666")");
  if (std::isfinite(fit.factor)) {
    svg.text(x.end - 6, y.begin - 10,
             fmt::format("fit: {:.0f} A^{:.2f}, r = {:.2f}", fit.factor, fit.exponent, fit.correlation), "end");
  }
  return {"main_sequence", fmt::format("Main sequence of {} saccades", saccades.size()), svg.str(), false, {}};
}

GazePlot histogram_plot(const std::string& name, const std::string& title, const std::string& label,
                        std::vector<double> values, const char* color) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  const std::size_t count = values.size();
  Drawing svg(kSmallWidth, kSmallHeight, title);
  const double most = count > 0 ? lower_quantile(values, 0.98) * 1.1 : 1;
  const Axis rough{0, most > 0 ? most : 1, 0, 1};
  const double bin = rough.tick(16);
  const auto bins = static_cast<std::size_t>(std::ceil(rough.high / bin));
  std::vector<double> shares(bins, 0.0);
  std::size_t beyond = 0;
  for (const double value : values) {
    const auto at = static_cast<std::size_t>(std::max(value, 0.0) / bin);
    if (at < bins) {
      shares[at] += 100.0 / static_cast<double>(count);
    } else {
      ++beyond;
    }
  }
  const double highest = std::max(*std::max_element(shares.begin(), shares.end()), 1.0);
  const Axis x{0, bin * static_cast<double>(bins), 58, kSmallWidth - 14};
  const Axis y{0, highest * 1.08, kSmallHeight - 48, 16};
  svg.x_axis(x, y, 6, label);
  svg.y_axis(x, y, 5, "share [%]");
  for (std::size_t i = 0; i < bins; ++i) {
    const double left = x.at(bin * static_cast<double>(i));
    const double right = x.at(bin * static_cast<double>(i + 1));
    svg.add(fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}" fill-opacity="0.8"/>)",
                        left + 0.5, y.at(shares[i]), right - left - 1, y.begin - y.at(shares[i]), color));
  }
  if (count > 0) {
    const double median = lower_quantile(values, 0.5);  // as in the page's table
    svg.add(
        fmt::format(R"(<path d="M{:.1f} {:.1f}V{:.1f}" stroke="#111111" stroke-width="1.4" stroke-dasharray="3 3"/>)",
                    x.at(median), y.begin, y.end));
    const bool is_right = x.at(median) < (x.begin + x.end) / 2;
    svg.text(x.at(median) + (is_right ? 6 : -6), y.end + 12, fmt::format("median {:.3g}", median),
             is_right ? "start" : "end");
  }
  if (beyond > 0) {
    svg.text(x.end, y.begin + 36, fmt::format("{} farther right", beyond), "end",
             R"(fill="#555555" stroke="#ffffff" stroke-width="3" paint-order="stroke")");
  }
  svg.frame(x, y);
  return {name, fmt::format("{} ({})", title, count), svg.str(), false, {}};
}

}  // namespace gazetrace
