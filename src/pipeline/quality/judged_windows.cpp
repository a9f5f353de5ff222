// SPDX-License-Identifier: Apache-2.0
#include "pipeline/quality/judged_windows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/hash.hpp"
#include "gazetrace/foveation.hpp"

namespace gazetrace {
namespace {

constexpr double kSideDeg = 3.5, kMovingSideDeg = 5.25;
constexpr int kLeastSidePx = 64, kMostSidePx = 256;
constexpr double kLeastWindows = 12;
constexpr double kShare = 0.05;
constexpr std::size_t kMostFoveae = 12;                  // of a gaze that moves
constexpr double kMostShare = 0.4;                       // beyond, the whole frame is traced
constexpr double kFarthestPx = 1e9;                      // what an int can hold
constexpr std::uint64_t kWindowTag = 0x57494e444f57ULL;  // "WINDOW"

// A screen may be stated to have any number of pixels a degree.
int on_grid(double px) {
  const double within = std::clamp(px, -kFarthestPx, kFarthestPx);
  return kDefaultMaxBlockPx * static_cast<int>(std::lround(within / kDefaultMaxBlockPx));
}

// Of this side, as near to the middle as the grid of blocks and the frame allow.
JudgedWindow window_at(const Vec2d& middle_px, int side_px, int margin_px, const PlanarView& view) {
  struct Span {
    int begin, end, counted_begin, counted_end;
  };
  const auto span = [&](double middle, int size) {
    Span of{};
    of.begin =
        std::clamp(on_grid(middle - 0.5 * side_px), 0, (size - side_px) / kDefaultMaxBlockPx * kDefaultMaxBlockPx);
    of.end = of.begin + side_px;
    // The rest of a frame that is no multiple of the grid belongs to its last window.
    of.end = size - of.end < kDefaultMaxBlockPx ? size : of.end;
    // Beyond the frame's border there is nothing to see.
    of.counted_begin = of.begin == 0 ? 0 : of.begin + margin_px;
    of.counted_end = of.end == size ? size : of.end - margin_px;
    return of;
  };
  const Span x = span(middle_px.x, view.width_px);
  const Span y = span(middle_px.y, view.height_px);
  return {{x.begin, y.begin, x.end - x.begin, y.end - y.begin},
          {x.counted_begin, y.counted_begin, x.counted_end - x.counted_begin, y.counted_end - y.counted_begin}};
}

// 0..1
double jitter(std::uint64_t n) {
  return 0x1p-53 * static_cast<double>(hash_combine(kWindowTag, n) >> 11U);
}

void fill(ImageGray& image, const PixelRect& rect, float value) {
  for (int y = rect.y_px; y < rect.bottom_px(); ++y) {
    for (int x = rect.x_px; x < rect.right_px(); ++x) {
      image(x, y) = value;
    }
  }
}

JudgedWindows whole_frame(const PlanarView& view) {
  const PixelRect all{0, 0, view.width_px, view.height_px};
  return {{{all, all}}, {}};
}

}  // namespace

double JudgedWindows::share_of(const PlanarView& view) const {
  double pixels = 0;
  for (const JudgedWindow& window : windows) {
    pixels += static_cast<double>(window.traced.width_px) * window.traced.height_px;
  }
  return pixels / (static_cast<double>(view.width_px) * view.height_px);
}

JudgedWindows judged_windows(const PlanarView& view, const std::vector<Vec2d>& gazes_px, bool view_moves) {
  const double area = static_cast<double>(view.width_px) * view.height_px;
  const double pixels_per_degree = 1 / (view.step_x * kDegPerRad);
  const int side_px =
      std::clamp(on_grid((view_moves ? kMovingSideDeg : kSideDeg) * pixels_per_degree), kLeastSidePx, kMostSidePx);
  const int margin_px = side_px / (view_moves ? 3 : 4);
  const double of_window = static_cast<double>(side_px) * side_px;
  const double wanted = std::max(kLeastWindows, kShare * area / of_window);
  if (std::min(view.width_px, view.height_px) < side_px || wanted * of_window > kMostShare * area) {
    return whole_frame(view);
  }
  std::vector<JudgedWindow> foveae;
  for (const Vec2d& gaze : gazes_px) {
    const PixelRect frame{0, 0, view.width_px, view.height_px};
    const auto has_it = [&](const JudgedWindow& window) { return window.counted.holds(gaze.x, gaze.y); };
    if (foveae.size() < kMostFoveae && frame.holds(gaze.x, gaze.y) &&
        std::none_of(foveae.begin(), foveae.end(), has_it)) {
      foveae.push_back(window_at(gaze, side_px, margin_px, view));
    }
  }
  const int rows = std::max(1, static_cast<int>(std::lround(std::sqrt(wanted * view.height_px / view.width_px))));
  const int columns = static_cast<int>(std::ceil(wanted / rows));
  std::vector<JudgedWindow> others;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::uint64_t n =
          static_cast<std::uint64_t>(row) * static_cast<std::uint64_t>(columns) + static_cast<std::uint64_t>(column);
      const Vec2d middle{(column + jitter(2 * n)) * view.width_px / columns,
                         (row + jitter(2 * n + 1)) * view.height_px / rows};
      const JudgedWindow window = window_at(middle, side_px, margin_px, view);
      const auto meets = [&](const JudgedWindow& other) { return window.traced.overlaps(other.traced); };
      if (std::none_of(foveae.begin(), foveae.end(), meets) && std::none_of(others.begin(), others.end(), meets)) {
        others.push_back(window);
      }
    }
  }
  if (others.empty()) {
    return whole_frame(view);
  }
  JudgedWindows chosen;
  chosen.weights = ImageGray(view.width_px, view.height_px, 0);
  for (const JudgedWindow& window : foveae) {
    fill(chosen.weights, window.counted, 1);
  }
  double foveal = 0;
  for (const float weight : chosen.weights.pixels) {
    foveal += static_cast<double>(weight);
  }
  double counted = 0;
  for (const JudgedWindow& window : others) {
    counted += static_cast<double>(window.counted.width_px) * window.counted.height_px;
  }
  for (const JudgedWindow& window : others) {
    fill(chosen.weights, window.counted, static_cast<float>((area - foveal) / counted));
  }
  chosen.windows = std::move(foveae);
  chosen.windows.insert(chosen.windows.end(), others.begin(), others.end());
  return chosen;
}

}  // namespace gazetrace
