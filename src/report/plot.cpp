// SPDX-License-Identifier: Apache-2.0
#include "report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

namespace gazetrace {
namespace {

constexpr double kLegendLine = 19;
// What fits where letters are as wide as those of DejaVu, the widest of the usual fonts.
constexpr std::size_t kLegendLetters = 46, kTitleLetters = 62, kSecondTitleLetters = 74;

// Cuts a text between letters, never inside a letter of several bytes.
std::string shortened(const std::string& words, std::size_t most) {
  if (words.size() <= most) {
    return words;
  }
  std::size_t end = most - 1;
  while (end > 0 && (static_cast<unsigned char>(words[end]) & 0xC0U) == 0x80U) {
    --end;
  }
  return words.substr(0, end) + "…";
}

std::string tick_text(double value) {
  return fmt::format("{:.4g}", value);
}

}  // namespace

bool wants_log(const std::vector<double>& values) {
  if (values.empty()) {
    return false;
  }
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  constexpr double kWide = 8;
  return *low > 0 && *high / *low > kWide;
}

PlotScale::PlotScale(const std::vector<double>& values, double begin, double end, bool log, bool from_zero) {
  double low = values.empty() ? 0 : *std::min_element(values.begin(), values.end());
  double high = values.empty() ? 1 : *std::max_element(values.begin(), values.end());
  log_ = log && low > 0;
  if (log_) {
    low = std::log10(low);
    high = std::log10(high);
  } else if (from_zero) {
    low = std::min(low, 0.0);
    high = std::max(high, 0.0);
  }
  // A single value gets room on both sides. The least room keeps ticks apart within the digits of a double.
  const double least = std::max(1e-9 * std::max(std::fabs(low), std::fabs(high)), log_ ? 0.05 : 1e-12);
  const double room = high - low > least ? 0.08 * (high - low) : std::max(0.1 * std::fabs(high), 10 * least);
  const bool at_zero = from_zero && !log_ && low == 0;
  axis_ = {at_zero ? 0 : low - room, high + room, begin, end};
}

double PlotScale::at(double value) const {
  return axis_.at(log_ ? std::log10(value) : value);
}

double PlotScale::within(double value) const {
  if (log_ && value <= 0) {
    return axis_.begin;
  }
  return std::clamp(at(value), std::min(axis_.begin, axis_.end), std::max(axis_.begin, axis_.end));
}

std::vector<double> plotted_range(const std::vector<Interval>& estimates) {
  std::vector<double> values;
  values.reserve(3 * estimates.size());
  for (const Interval& estimate : estimates) {
    values.push_back(estimate.mean);
  }
  if (values.empty()) {
    return values;
  }
  const double low = *std::min_element(values.begin(), values.end());
  const double high = *std::max_element(values.begin(), values.end());
  const double room = std::max(0.5 * (high - low), 0.1 * std::fabs(high));
  const double least = low >= 0 ? std::max(low / 2, low - room) : low - room;
  for (const Interval& estimate : estimates) {
    if (estimate.low) {
      values.push_back(std::max(*estimate.low, least));
      values.push_back(std::min(*estimate.high, high + room));
    }
  }
  return values;
}

std::vector<double> PlotScale::ticks(double count) const {
  if (!log_) {
    return gazetrace::ticks(axis_, count);
  }
  std::vector<double> values;
  const bool dense = axis_.high - axis_.low < 1.2;
  const auto first = static_cast<int>(std::floor(axis_.low));
  const auto last = static_cast<int>(std::floor(axis_.high));
  for (int power = first; power <= last; ++power) {
    for (const double digit : {1.0, 2.0, 3.0, 5.0, 7.0}) {
      const double value = digit * std::pow(10.0, power);
      const double place = std::log10(value);
      if (place >= axis_.low && place <= axis_.high &&
          (dense || digit == 1 || (digit == 3 && axis_.high - axis_.low < 3))) {
        values.push_back(value);
      }
    }
  }
  return values.size() >= 2 ? values : std::vector{std::pow(10.0, axis_.low), std::pow(10.0, axis_.high)};
}

PlotSvg::PlotSvg(double height, const std::string& title) {
  add(fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:g} {:g}\" width=\"{:g}\" height=\"{:g}\" role=\"img\" "
      "aria-label=\"{}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"13\">",
      kPlotWidth, height, kPlotWidth, height, escaped(title)));
  add(fmt::format("<title>{}</title>", escaped(title)));
  add("<rect class=\"ground\" width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>");
}

void PlotSvg::text(double x, double y, const std::string& words, const char* anchor, const char* more) {
  add(fmt::format("<text class=\"ink\" x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#1c1c1c\" text-anchor=\"{}\"{}>{}</text>", x, y,
                  anchor, more, escaped(words)));
}

void PlotSvg::mark(const ReportRole& role, double x, double y, double radius) {
  const std::string open =
      fmt::format("class=\"role-{}\" fill=\"{}\" stroke=\"{}\"", escaped(role.name), role.color, role.color);
  const double r = radius;
  if (role.mark == "circle") {
    add(fmt::format("<circle {} cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\"/>", open, x, y, r));
  } else if (role.mark == "triangle") {
    add(fmt::format("<path {} d=\"M{:.1f} {:.1f}l{:g} {:g}h{:g}z\"/>", open, x, y - r, r, 1.8 * r, -2 * r));
  } else if (role.mark == "wedge") {
    add(fmt::format("<path {} d=\"M{:.1f} {:.1f}l{:g} {:g}h{:g}z\"/>", open, x, y + r, r, -1.8 * r, -2 * r));
  } else if (role.mark == "diamond") {
    add(fmt::format("<path {} d=\"M{:.1f} {:.1f}l{:g} {:g}l{:g} {:g}l{:g} {:g}z\"/>", open, x, y - 1.2 * r, 1.2 * r,
                    1.2 * r, -1.2 * r, 1.2 * r, -1.2 * r, -1.2 * r));
  } else if (role.mark == "cross") {
    add(fmt::format("<path {} stroke-width=\"2\" d=\"M{:.1f} {:.1f}l{:g} {:g}m0 {:g}l{:g} {:g}\"/>", open, x - r, y - r,
                    2 * r, 2 * r, -2 * r, -2 * r, 2 * r));
  } else {
    add(fmt::format("<rect {} x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:g}\" height=\"{:g}\"/>", open, x - 0.9 * r,
                    y - 0.9 * r, 1.8 * r, 1.8 * r));
  }
}

void PlotSvg::axes(const PlotScale& x, const PlotScale& y, double left, double top, double right, double bottom,
                   const std::string& x_label, const std::string& y_label, bool with_x_numbers) {
  for (const double value : y.ticks(5)) {
    add(fmt::format("<path class=\"grid\" stroke=\"#d8d8d8\" fill=\"none\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>", left,
                    y.at(value), right));
    text(left - 7, y.at(value) + 4, tick_text(value), "end");
  }
  if (with_x_numbers) {
    for (const double value : x.ticks(7)) {
      add(fmt::format("<path class=\"grid\" stroke=\"#d8d8d8\" fill=\"none\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>",
                      x.at(value), top, bottom));
      text(x.at(value), bottom + 17, tick_text(value), "middle");
    }
  }
  add(fmt::format("<path class=\"line\" stroke=\"#1c1c1c\" fill=\"none\" d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\"/>", left,
                  top, bottom, right));
  text((left + right) / 2, bottom + 36, x_label, "middle");
  const double middle = (top + bottom) / 2;
  text(16, middle, y_label, "middle", fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", middle).c_str());
}

void PlotSvg::title(const std::string& words) {
  constexpr double kLeft = 24;
  if (words.size() <= kTitleLetters) {
    text(kLeft, 24, words, "start", " font-size=\"15\"");
    return;
  }
  // Before what names the run, or else at a comma, or between words.
  for (const std::string_view mark : {": ", ", ", " "}) {
    const std::size_t end = words.rfind(mark, kTitleLetters);
    if (end != std::string::npos && end > 0) {
      const std::size_t next = end + mark.size();
      text(kLeft, 16, words.substr(0, next - 1), "start", " font-size=\"14\"");
      text(kLeft, 33, shortened(words.substr(next), kSecondTitleLetters), "start", " font-size=\"13\"");
      return;
    }
  }
  text(kLeft, 24, shortened(words, kTitleLetters), "start", " font-size=\"15\"");
}

double PlotSvg::legend(const std::vector<std::pair<ReportRole, std::string>>& entries, double left, double top) {
  const double column = (kPlotWidth - left) / 2;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::size_t row = i / 2;
    const double x = left + (i % 2 == 0 ? 0 : column);
    const double y = top + kLegendLine * static_cast<double>(row) + kLegendLine / 2;
    const auto& [role, words] = entries[i];
    add(
        fmt::format("<path class=\"role-{}\" stroke=\"{}\" stroke-width=\"2\" stroke-dasharray=\"{}\" fill=\"none\" "
                    "d=\"M{:.1f} {:.1f}h26\"/>",
                    escaped(role.name), role.color, role.dash.empty() ? "none" : role.dash, x, y));
    mark(role, x + 13, y, 4);
    text(x + 33, y + 4.5, shortened(words, kLegendLetters), "start", " font-size=\"11\"");
  }
  return top + legend_height(entries.size());
}

double legend_height(std::size_t entries) {
  const std::size_t rows = (entries + 1) / 2;
  return kLegendLine * static_cast<double>(rows);
}

std::string plot_file_name(const std::vector<std::string>& parts) {
  std::string name;
  for (const std::string& part : parts) {
    if (part.empty()) {
      continue;
    }
    name += name.empty() ? "" : "_";
    for (const char c : part) {
      const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-';
      name += plain ? c : '-';
    }
  }
  return name;
}

}  // namespace gazetrace
