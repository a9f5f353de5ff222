// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "gazetrace/video.hpp"

namespace gazetrace {
namespace {

constexpr Rgb8Color kBlack{0, 0, 0};
constexpr Rgb8Color kWhite{255, 255, 255};

void blend(DisplayImage& image, int x, int y, const Rgb8Color& color, double coverage) {
  std::uint8_t* const pixel = &image.bytes[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width_px) +
                                                static_cast<std::size_t>(x))];
  for (std::size_t c = 0; c < 3; ++c) {
    pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + coverage * (color[c] - pixel[c])));
  }
}

// Calls paint(x, y) for the pixels of a square about a point, as far as they are inside the picture.
template <class Paint>
void around(const DisplayImage& image, const Vec2d& middle, double reach_px, const Paint& paint) {
  if (!std::isfinite(middle.x) || !std::isfinite(middle.y)) {
    return;
  }
  const auto bound = [](double value, int most) {
    return static_cast<int>(std::clamp(std::floor(value), 0.0, static_cast<double>(most)));
  };
  for (int y = bound(middle.y - reach_px, image.height_px); y < bound(middle.y + reach_px + 1, image.height_px); ++y) {
    for (int x = bound(middle.x - reach_px, image.width_px); x < bound(middle.x + reach_px + 1, image.width_px); ++x) {
      paint(x, y);
    }
  }
}

// Draws a disc whose antialiased edge is one pixel wide.
void draw_disc(DisplayImage& image, const Vec2d& middle, double radius_px, const Rgb8Color& color) {
  around(image, middle, radius_px + 1, [&](int x, int y) {
    const double distance = std::hypot(x + 0.5 - middle.x, y + 0.5 - middle.y);
    const double coverage = std::clamp(radius_px + 0.5 - distance, 0.0, 1.0);
    if (coverage > 0) {
      blend(image, x, y, color, coverage);
    }
  });
}

// Capital letters of 5 x 7 dots, the rows from the top, the left dot of each in its highest bit.
constexpr int kGlyphWidth = 5;
constexpr int kGlyphHeight = 7;
struct Glyph {
  char letter;
  std::uint64_t dots;
};
constexpr Glyph kGlyphs[] = {
    {'%', 0x672222273}, {'(', 0x088842082}, {')', 0x208210888}, {'+', 0x0084F9080}, {'-', 0x0000F8000},
    {'.', 0x00000018C}, {'/', 0x042222210}, {'0', 0x3A75AD72E}, {'1', 0x11842108E}, {'2', 0x3A213221F},
    {'3', 0x78217043E}, {'4', 0x08CA97C42}, {'5', 0x7E1E0862E}, {'6', 0x1910F462E}, {'7', 0x7C2222108},
    {'8', 0x3A317462E}, {'9', 0x3A317844C}, {':', 0x018C03180}, {'=', 0x001F07C00}, {'A', 0x3A31FC631},
    {'B', 0x7A31F463E}, {'C', 0x3A308422E}, {'D', 0x7A318C63E}, {'E', 0x7E10F421F}, {'F', 0x7E10F4210},
    {'G', 0x3A30BC62F}, {'H', 0x4631FC631}, {'I', 0x38842108E}, {'J', 0x1C4210A4C}, {'K', 0x4654C5251},
    {'L', 0x42108421F}, {'M', 0x4775AC631}, {'N', 0x47359C631}, {'O', 0x3A318C62E}, {'P', 0x7A31F4210},
    {'Q', 0x3A318D64D}, {'R', 0x7A31F5251}, {'S', 0x3E107043E}, {'T', 0x7C8421084}, {'U', 0x46318C62E},
    {'V', 0x46318C544}, {'W', 0x4631AD771}, {'X', 0x462A22A31}, {'Y', 0x462A21084}, {'Z', 0x7C222221F}};

std::uint64_t dots_of(char letter) {
  const int capital = std::toupper(static_cast<unsigned char>(letter));
  const Glyph* const found =
      std::find_if(std::begin(kGlyphs), std::end(kGlyphs), [&](const Glyph& glyph) { return glyph.letter == capital; });
  return found == std::end(kGlyphs) ? 0 : found->dots;
}

// An orthonormal pair across a direction.
struct Across {
  Vec3d a, b;
};
Across across(const Vec3d& direction) {
  const Vec3d axis = std::fabs(direction.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d a = normalize(cross(direction, axis));
  return {a, cross(direction, a)};
}

}  // namespace

DisplayImage side_by_side(const DisplayImage& left, const DisplayImage& right) {
  if (left.height_px != right.height_px || left.bits != 8 || right.bits != 8) {
    throw Error(ErrorKind::input, "side by side",
                "one picture is " + std::to_string(left.height_px) + " pixels high, the other " +
                    std::to_string(right.height_px),
                "show sequences of one height");
  }
  DisplayImage both{left.width_px + right.width_px, left.height_px, 8, {}};
  both.bytes.reserve(left.bytes.size() + right.bytes.size());
  for (int y = 0; y < both.height_px; ++y) {
    for (const DisplayImage* const image : {&left, &right}) {
      const auto row = static_cast<std::ptrdiff_t>(3 * image->width_px);
      both.bytes.insert(both.bytes.end(), image->bytes.begin() + y * row, image->bytes.begin() + (y + 1) * row);
    }
  }
  return both;
}

void draw_gaze_ring(DisplayImage& image, const Vec2d& gaze_px, double radius_px, double width_px) {
  for (const auto& [color, width] : {std::pair{kBlack, 2 * width_px}, std::pair{kGazeColor, width_px}}) {
    around(image, gaze_px, radius_px + width + 1, [&, &color = color, width = width](int x, int y) {
      const double distance = std::hypot(x + 0.5 - gaze_px.x, y + 0.5 - gaze_px.y);
      const double coverage = std::clamp(width / 2 + 0.5 - std::fabs(distance - radius_px), 0.0, 1.0);
      if (coverage > 0) {
        blend(image, x, y, color, coverage);
      }
    });
  }
}

void draw_eccentricity_ring(DisplayImage& image, const PlanarView& view, const Vec2d& gaze_px, double eccentricity_deg,
                            double width_px) {
  const Vec3d gaze = normalize(view.direction(gaze_px.x, gaze_px.y));
  const Across plane = across(gaze);
  const double cosine = std::cos(eccentricity_deg * kRadPerDeg);
  const double sine = std::sin(eccentricity_deg * kRadPerDeg);
  // Steps are at most half a pixel where the view's axis meets the picture, and at most one pixel far from there.
  const double circumference_px = 2 * kPi * sine / std::min(view.step_x, view.step_y);
  const auto steps = static_cast<int>(std::clamp(4 * circumference_px, 64.0, 200'000.0));
  for (const auto& [color, radius] : {std::pair{kBlack, width_px}, std::pair{kWhite, width_px / 2}}) {
    for (int i = 0; i < steps; ++i) {
      const double turn = 2 * kPi * i / steps;
      const Vec3d direction = cosine * gaze + sine * (std::cos(turn) * plane.a + std::sin(turn) * plane.b);
      draw_disc(image, view.pixel(direction), radius, color);
    }
  }
}

void draw_fixation_mark(DisplayImage& image, const Vec2d& gaze_px, double pixels_per_degree) {
  const double outer_px = 0.3 * pixels_per_degree;
  const double inner_px = 0.1 * pixels_per_degree;
  draw_disc(image, gaze_px, outer_px, kBlack);
  around(image, gaze_px, outer_px + 1, [&](int x, int y) {
    const double dx = std::fabs(x + 0.5 - gaze_px.x);
    const double dy = std::fabs(y + 0.5 - gaze_px.y);
    const double in_cross = std::clamp(inner_px + 0.5 - std::min(dx, dy), 0.0, 1.0);
    const double in_disc = std::clamp(outer_px + 0.5 - std::hypot(dx, dy), 0.0, 1.0);
    blend(image, x, y, kWhite, in_cross * in_disc);
  });
  draw_disc(image, gaze_px, inner_px, kBlack);
}

DisplayImage with_insets(const DisplayImage& picture, const DisplayImage& clean, const std::optional<Vec2d>& gaze_px) {
  constexpr int kTimes = 3;
  const int half = picture.width_px / 2;
  const int width = (half + kTimes - 1) / kTimes;
  const int height = std::max(1, picture.height_px / (kTimes * kTimes));
  DisplayImage out{picture.width_px, picture.height_px + kTimes * height, 8, picture.bytes};
  out.bytes.resize(3 * static_cast<std::size_t>(out.width_px) * static_cast<std::size_t>(out.height_px));
  if (!gaze_px || !std::isfinite(gaze_px->x) || !std::isfinite(gaze_px->y)) {
    return out;
  }
  const int dot_px = std::max(1, picture.width_px / 320);
  // As far to the side as there is more room.
  const double aside = (gaze_px->x < half ? 0.45 : -0.45) * picture.width_px;
  for (const bool far : {false, true}) {
    const auto begin = [](double middle, int size, int most) {
      return static_cast<int>(std::clamp(std::floor(middle) - size / 2, 0.0, static_cast<double>(most - size)));
    };
    const int left = begin(gaze_px->x + (far ? aside : 0), width, picture.width_px);
    const int top = begin(gaze_px->y, height, picture.height_px);
    const int out_left = far ? picture.width_px - half : 0;
    for (int y = 0; y < kTimes * height; ++y) {
      for (int x = 0; x < half; ++x) {
        const auto from = 3 * (static_cast<std::ptrdiff_t>(top + y / kTimes) * clean.width_px + left + x / kTimes);
        const auto to = 3 * (static_cast<std::ptrdiff_t>(picture.height_px + y) * out.width_px + out_left + x);
        std::copy_n(clean.bytes.begin() + from, 3, out.bytes.begin() + to);
      }
    }
    for (int y = top; y < top + height; ++y) {
      for (int x = left; x < left + width; ++x) {
        if (y == top || y == top + height - 1 || x == left || x == left + width - 1) {
          blend(out, x, y, kWhite, 0.8);
        }
      }
    }
    draw_label(out, {out_left + 4.0 * dot_px, picture.height_px + 4.0 * dot_px}, far ? "periphery 3X" : "gaze 3X",
               dot_px);
  }
  return out;
}

void draw_label(DisplayImage& image, const Vec2d& top_left_px, std::string_view text, int dot_px) {
  const auto fill = [&](int left, int top, int width, int height, const Rgb8Color& color, double coverage) {
    for (int y = std::max(top, 0); y < std::min(top + height, image.height_px); ++y) {
      for (int x = std::max(left, 0); x < std::min(left + width, image.width_px); ++x) {
        blend(image, x, y, color, coverage);
      }
    }
  };
  constexpr int kMargin = 2;  // dots of the ground on each side
  const int step = (kGlyphWidth + 1) * dot_px;
  const int left = static_cast<int>(std::lround(top_left_px.x));
  const int top = static_cast<int>(std::lround(top_left_px.y));
  fill(left, top, static_cast<int>(text.size()) * step + (2 * kMargin - 1) * dot_px,
       (kGlyphHeight + 2 * kMargin) * dot_px, kBlack, 0.6);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::uint64_t dots = dots_of(text[i]);
    for (int dot = 0; dot < kGlyphWidth * kGlyphHeight; ++dot) {
      if ((dots >> static_cast<unsigned>(kGlyphWidth * kGlyphHeight - 1 - dot) & 1U) != 0) {
        fill(left + kMargin * dot_px + static_cast<int>(i) * step + dot % kGlyphWidth * dot_px,
             top + (kMargin + dot / kGlyphWidth) * dot_px, dot_px, dot_px, kWhite, 1);
      }
    }
  }
}

}  // namespace gazetrace
