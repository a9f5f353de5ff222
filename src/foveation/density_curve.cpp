// SPDX-License-Identifier: Apache-2.0
#include "foveation/density_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/text.hpp"
#include "gazetrace/density.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

MonotoneCubic::MonotoneCubic(std::vector<Vec2d> points) : points_(std::move(points)), slopes_(points_.size(), 0.0) {
  const std::size_t n = points_.size();
  const auto step = [&](std::size_t i) { return points_[i + 1].x - points_[i].x; };
  const auto secant = [&](std::size_t i) { return (points_[i + 1].y - points_[i].y) / step(i); };
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = secant(i - 1);
    const double after = secant(i);
    if (before * after > 0) {
      const double w1 = 2 * step(i) + step(i - 1);
      const double w2 = step(i) + 2 * step(i - 1);
      slopes_[i] = (w1 + w2) / (w1 / before + w2 / after);  // weighted harmonic mean
    }
  }
  if (n >= 2) {
    slopes_[0] = secant(0);
    slopes_[n - 1] = secant(n - 2);
  }
}

double MonotoneCubic::operator()(double x) const {
  if (x <= points_.front().x) {
    return points_.front().y;
  }
  if (x >= points_.back().x) {
    return points_.back().y;
  }
  const auto after = std::upper_bound(points_.begin(), points_.end(), x,
                                      [](double value, const Vec2d& point) { return value < point.x; });
  const auto i = static_cast<std::size_t>(after - points_.begin()) - 1;
  const double h = points_[i + 1].x - points_[i].x;
  const double t = (x - points_[i].x) / h;
  const double u = 1 - t;
  return points_[i].y * (1 + 2 * t) * u * u + points_[i + 1].y * t * t * (1 + 2 * u) +
         h * t * u * (slopes_[i] * u - slopes_[i + 1] * t);
}

DensityCurve load_density_curve(const std::string& path) {
  const std::string text = read_text_file(path);
  LineReader lines(text);
  std::vector<Vec2d> points;
  std::vector<std::string_view> cells;
  std::string_view line;
  bool has_head = false;
  const auto fail = [&](const std::string& problem, const std::string& remedy) {
    throw Error(ErrorKind::input, fmt::format("{}:{}", path, lines.number()), problem, remedy);
  };
  while (lines.next(line)) {
    line = trim(line);
    if (line.empty() || line.starts_with('#')) {
      continue;
    }
    split_cells(line, ',', cells);
    if (!has_head) {
      if (cells.size() != 2 || trim(cells[0]) != "ecc_deg" || trim(cells[1]) != "density") {
        fail("the first line does not name the columns", "begin the file with ecc_deg,density");
      }
      has_head = true;
      continue;
    }
    const auto cell = [&](std::size_t i) { return i < cells.size() ? number_from(trim(cells[i])) : std::nullopt; };
    const std::optional<double> angle_deg = cell(0);
    const std::optional<double> density = cell(1);
    if (cells.size() != 2 || !angle_deg || !density) {
      fail(fmt::format("'{}' is not two numbers", line), "write an eccentricity and a density");
    }
    if (!(*angle_deg >= 0 && *angle_deg <= 180)) {
      fail(fmt::format("an eccentricity of {} degrees is not possible", *angle_deg), "give 0 to 180");
    }
    if (!points.empty() && *angle_deg <= points.back().x) {
      fail(fmt::format("eccentricity {} does not come after {}", *angle_deg, points.back().x),
           "sort the lines, each eccentricity once");
    }
    if (!(*density >= 0 && *density <= 1)) {
      fail(fmt::format("a density of {} is not possible", *density), "give 0 to 1, where 1 is the full rate");
    }
    points.push_back({*angle_deg, *density});
  }
  if (points.empty()) {
    throw Error(ErrorKind::input, path, "the table has no points", "write lines of ecc_deg,density");
  }
  return {path, std::move(points)};
}

}  // namespace gazetrace
