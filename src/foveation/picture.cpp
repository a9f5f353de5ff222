// SPDX-License-Identifier: Apache-2.0
// Pictures that are stretched over the frame.
#include <algorithm>
#include <cmath>

#include "foveation/picture.hpp"

namespace gazetrace {
namespace {

struct Texels {
  int first, second;
  double share;  // of the second
};
Texels around(double position, int size) {
  const double at = std::clamp(position * size - 0.5, 0.0, size - 1.0);
  const int first = static_cast<int>(at);
  return {first, std::min(first + 1, size - 1), at - first};
}

}  // namespace

double picture_at(const ImageGray& picture, double u, double v) {
  const Texels x = around(u, picture.width_px);
  const Texels y = around(v, picture.height_px);
  const auto row = [&](int at) {
    const auto a = static_cast<double>(picture(x.first, at));
    return a + x.share * (static_cast<double>(picture(x.second, at)) - a);
  };
  const double top = row(y.first);
  return top + y.share * (row(y.second) - top);
}

PictureRange picture_within(const ImageGray& picture, double u0, double v0, double u1, double v1) {
  const int x_end = around(u1, picture.width_px).second;
  const int y_end = around(v1, picture.height_px).second;
  const int x_begin = around(u0, picture.width_px).first;
  const int y_begin = around(v0, picture.height_px).first;
  auto least = static_cast<double>(picture(x_begin, y_begin));
  double most = least;
  for (int y = y_begin; y <= y_end; ++y) {
    for (int x = x_begin; x <= x_end; ++x) {
      least = std::min(least, static_cast<double>(picture(x, y)));
      most = std::max(most, static_cast<double>(picture(x, y)));
    }
  }
  return {least, most};
}

double largest_value(const ImageGray& picture) {
  return static_cast<double>(*std::max_element(picture.pixels.begin(), picture.pixels.end()));
}

double full_rate_of_picture(const MapContext& context) {
  return context.full_rate_spp > 0 ? context.full_rate_spp : largest_value(*context.density);
}

}  // namespace gazetrace
