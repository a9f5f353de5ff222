// SPDX-License-Identifier: Apache-2.0
// A heat map on a scene as files: a picture for people, a table for other programs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/image_io.hpp"
#include "gazetrace/gaze_objects.hpp"

namespace gazetrace {
namespace {

using Rgb = std::array<double, 3>;

constexpr double kDarkened = 0.65;  // the picture behind, so that the colors stand out

// From a level of 0..1 to a color that gets lighter all the way: a coarse "inferno" (van der Walt & Smith 2015).
Rgb heat_color(double level) {
  static constexpr std::array<Rgb, 8> kColors{{{66, 10, 104},
                                               {107, 23, 110},
                                               {147, 38, 103},
                                               {187, 55, 84},
                                               {221, 81, 58},
                                               {243, 120, 25},
                                               {252, 165, 10},
                                               {246, 215, 70}}};
  const double at = level * static_cast<double>(kColors.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kColors.size() - 2);
  const double share = at - static_cast<double>(below);
  Rgb color;
  for (std::size_t c = 0; c < 3; ++c) {
    color[c] = (1 - share) * kColors[below][c] + share * kColors[below + 1][c];
  }
  return color;
}

// The picture at the middle of each pixel of the map.
class Ground {
 public:
  Ground(const SceneHeat& heat, const std::string& picture) : heat_(heat) {
    if (!picture.empty()) {
      image_ = read_image_rgba(picture, picture);
      if (image_.bytes.empty()) {
        throw Error(ErrorKind::input, picture, "has more than 8 bits a channel", "give a display picture of 8 bits");
      }
    }
  }
  [[nodiscard]] Rgb at(std::size_t i) const {
    if (image_.bytes.empty()) {
      const double grey = heat_.greys[i];
      return {grey, grey, grey};
    }
    const auto scaled = [](std::size_t place, int from, int to) {
      return static_cast<std::size_t>((static_cast<double>(place) + 0.5) * to / from);
    };
    const auto columns = static_cast<std::size_t>(heat_.width_px);
    const std::size_t x = scaled(i % columns, heat_.width_px, image_.width_px);
    const std::size_t y = scaled(i / columns, heat_.height_px, image_.height_px);
    const std::size_t byte = 4 * (y * static_cast<std::size_t>(image_.width_px) + x);
    return {kDarkened * image_.bytes[byte], kDarkened * image_.bytes[byte + 1], kDarkened * image_.bytes[byte + 2]};
  }

 private:
  const SceneHeat& heat_;
  ImageRgba image_;
};

}  // namespace

std::vector<std::uint8_t> scene_heat_png(const SceneHeat& heat, const std::string& picture) {
  constexpr double kLeast = 0.1;  // of the highest value: what is below stays the picture
  const Ground ground(heat, picture);
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < heat.values.size(); ++i) {
    const double level = heat.highest > 0 ? heat.values[i] / heat.highest : 0;
    const Rgb behind = ground.at(i);
    const Rgb color = heat_color(level);
    const double cover = level < kLeast ? 0 : 0.5 + 0.4 * level;
    for (std::size_t c = 0; c < 3; ++c) {
      rgb.push_back(static_cast<std::uint8_t>(std::lround((1 - cover) * behind[c] + cover * color[c])));
    }
  }
  return encode_image("heat.png", heat.width_px, heat.height_px, 8, rgb, {});
}

std::string scene_heat_csv(const SceneHeat& heat) {
  std::string text;
  for (std::size_t i = 0; i < heat.values.size(); ++i) {
    const bool is_last = (i + 1) % static_cast<std::size_t>(heat.width_px) == 0;
    fmt::format_to(std::back_inserter(text), "{:.6g}{}", heat.values[i], is_last ? '\n' : ',');
  }
  return text;
}

}  // namespace gazetrace
