// SPDX-License-Identifier: Apache-2.0
#include "study/report/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"

namespace gazetrace {

Drawing::Drawing(double width, double height, const std::string& title) {
  add(fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {:.0f} {:.0f}" role="img" aria-label="{}" )"
                  R"(font-family="Helvetica, Arial, sans-serif" font-size="13" fill="#222222">)",
                  width, height, escaped(title)));
  add(fmt::format(R"(<title>{}</title>)", escaped(title)));
  add(fmt::format(R"(<rect width="{:.0f}" height="{:.0f}" fill="#ffffff"/>)", width, height));
}

void Drawing::text(double x, double y, const std::string& words, const char* anchor, const char* more) {
  add(fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}" {}>{}</text>)", x, y, anchor, more, escaped(words)));
}

namespace {

// 1, 2 and 5 of each power of ten, as decimal logarithms; powers alone over a wide range.
std::vector<double> log_ticks(const Axis& axis) {
  const double low = std::min(axis.low, axis.high);
  const double high = std::max(axis.low, axis.high);
  const bool powers_alone = high - low > 3;
  std::vector<double> values;
  for (double power = std::floor(low); power <= high && values.size() < 60; ++power) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double value = power + std::log10(digit);
      if (value >= low - 1e-9 && value <= high + 1e-9 && (digit == 1 || !powers_alone)) {
        values.push_back(value);
      }
    }
  }
  return values;
}

std::string tick_text(double value, bool is_log) {
  return fmt::format("{:.4g}", is_log ? std::pow(10.0, value) : value);
}

}  // namespace

void Drawing::x_axis(const Axis& x, const Axis& y, double count, const std::string& label, bool is_log) {
  for (const double value : is_log ? log_ticks(x) : ticks(x, count)) {
    add(fmt::format(R"(<path d="M{:.1f} {:.1f}V{:.1f}" stroke="#e4e4e4"/>)", x.at(value), y.begin, y.end));
    text(x.at(value), std::max(y.begin, y.end) + 17, tick_text(value, is_log), "middle");
  }
  text((x.begin + x.end) / 2, std::max(y.begin, y.end) + 36, label, "middle");
}

void Drawing::y_axis(const Axis& x, const Axis& y, double count, const std::string& label, bool is_log) {
  for (const double value : is_log ? log_ticks(y) : ticks(y, count)) {
    add(fmt::format(R"(<path d="M{:.1f} {:.1f}H{:.1f}" stroke="#e4e4e4"/>)", x.begin, y.at(value), x.end));
    text(x.begin - 6, y.at(value) + 4.5, tick_text(value, is_log), "end");
  }
  add(fmt::format(R"-(<text transform="translate({:.1f} {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)-", 15.0,
                  (y.begin + y.end) / 2, escaped(label)));
}

void Drawing::frame(const Axis& x, const Axis& y) {
  add(fmt::format(R"(<path d="M{:.1f} {:.1f}V{:.1f}H{:.1f}" fill="none" stroke="#444444"/>)", x.begin,
                  std::min(y.begin, y.end), std::max(y.begin, y.end), x.end));
}

std::string picture_uri(const std::string& path) {
  if (path.empty()) {
    return {};
  }
  constexpr std::size_t kMostBytes = std::size_t{32} << 20U;
  const std::string bytes = read_file_bytes(path);
  const bool is_png = bytes.starts_with("\x89PNG");
  const bool is_jpeg = bytes.starts_with("\xff\xd8");
  if (!is_png && !is_jpeg) {
    throw Error(ErrorKind::input, path, "is neither PNG nor JPEG", "give a rendered frame, such as frame.0001.png");
  }
  if (bytes.size() > kMostBytes) {
    throw Error(ErrorKind::input, path, "is larger than 32 MiB", "give a smaller picture");
  }
  return std::string("data:image/") + (is_png ? "png" : "jpeg") + ";base64," + base64(bytes);
}

}  // namespace gazetrace
