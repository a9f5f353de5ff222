// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "gazetrace/gaze_outlines.hpp"

namespace gazetrace {
namespace {

constexpr std::uint32_t kNoObject = 0;
// Sides of a pixel, clockwise from the upper one: where each begins, where it leads, and what lies beyond it.
constexpr std::array<PixelCorner, 4> kBegin{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
constexpr std::array<PixelCorner, 4> kAlong{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
constexpr std::array<PixelCorner, 4> kBeyond{{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};

PixelCorner operator+(const PixelCorner& a, const PixelCorner& b) {
  return {a.x + b.x, a.y + b.y};
}

// Twice the area within; positive: clockwise, as y counts downwards.
std::int64_t signed_area(const std::vector<PixelCorner>& ring) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const PixelCorner& a = ring[i];
    const PixelCorner& b = ring[(i + 1) % ring.size()];
    sum += static_cast<std::int64_t>(a.x) * b.y - static_cast<std::int64_t>(b.x) * a.y;
  }
  return sum;
}

class Tracer {
 public:
  explicit Tracer(const Image<std::uint32_t>& numbers)
      : numbers_(numbers), pieces_(numbers.width_px, numbers.height_px), done_(numbers.width_px, numbers.height_px) {
    find_pieces();
  }

  std::vector<std::vector<OutlinePolygon>> trace() {
    std::vector<OutlinePolygon> polygons(number_of_.size());
    for (std::int32_t y = 0; y < numbers_.height_px; ++y) {
      for (std::int32_t x = 0; x < numbers_.width_px; ++x) {
        // Every ring has an upper side somewhere.
        const std::uint32_t piece = pieces_(x, y);
        if (piece != kNoObject && done_(x, y) == 0 && piece_at({x, y - 1}) != piece) {
          add_rings({x, y}, polygons[piece - 1]);
        }
      }
    }
    std::vector<std::vector<OutlinePolygon>> of_number;
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      of_number.resize(std::max<std::size_t>(of_number.size(), number_of_[i] + std::size_t{1}));
      of_number[number_of_[i]].push_back(std::move(polygons[i]));
    }
    return of_number;
  }

 private:
  [[nodiscard]] bool is_inside(const PixelCorner& p) const {
    return p.x >= 0 && p.y >= 0 && p.x < numbers_.width_px && p.y < numbers_.height_px;
  }
  [[nodiscard]] std::uint32_t piece_at(const PixelCorner& p) const {
    return is_inside(p) ? pieces_(p.x, p.y) : kNoObject;
  }

  // Numbers the pieces of one object that hang together by sides, from 1.
  void find_pieces() {
    std::vector<PixelCorner> open;
    for (std::int32_t y = 0; y < numbers_.height_px; ++y) {
      for (std::int32_t x = 0; x < numbers_.width_px; ++x) {
        const std::uint32_t number = numbers_(x, y);
        if (number == 0 || pieces_(x, y) != kNoObject) {
          continue;
        }
        number_of_.push_back(number);
        const auto piece = static_cast<std::uint32_t>(number_of_.size());
        pieces_(x, y) = piece;
        open.push_back({x, y});
        while (!open.empty()) {
          const PixelCorner p = open.back();
          open.pop_back();
          for (const PixelCorner& step : kBeyond) {
            const PixelCorner next = p + step;
            if (is_inside(next) && numbers_(next.x, next.y) == number && pieces_(next.x, next.y) == kNoObject) {
              pieces_(next.x, next.y) = piece;
              open.push_back(next);
            }
          }
        }
      }
    }
  }

  // Goes around with the piece to the right. Where two of its pixels touch by a corner alone it stays with the one that
  // it came along. That corner is passed twice: what lies between is a ring of its own.
  void add_rings(PixelCorner pixel, OutlinePolygon& polygon) {
    const std::uint32_t piece = piece_at(pixel);
    const PixelCorner first = pixel;
    std::size_t side = 0;
    std::vector<PixelCorner> ring;
    std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> place;  // of a corner in the ring
    do {
      done_(pixel.x, pixel.y) |= static_cast<std::uint8_t>(side == 0);
      const PixelCorner corner = pixel + kBegin[(side + 1) % 4];
      const PixelCorner ahead = pixel + kAlong[side];
      const PixelCorner across = ahead + kBeyond[side];
      if (piece_at(ahead) == piece && piece_at(across) != piece) {
        pixel = ahead;
        continue;
      }
      if (piece_at(ahead) != piece) {
        side = (side + 1) % 4;
      } else {
        pixel = across;
        side = (side + 3) % 4;
      }
      const auto [known, is_new] = place.try_emplace({corner.x, corner.y}, ring.size());
      if (is_new) {
        ring.push_back(corner);
        continue;
      }
      const auto begin = ring.begin() + static_cast<std::ptrdiff_t>(known->second);
      std::vector<PixelCorner> part(begin, ring.end());
      ring.erase(begin + 1, ring.end());
      for (std::size_t i = 1; i < part.size(); ++i) {
        place.erase({part[i].x, part[i].y});
      }
      add(std::move(part), polygon);
    } while (pixel != first || side != 0);
    add(std::move(ring), polygon);
  }

  static void add(std::vector<PixelCorner> ring, OutlinePolygon& polygon) {
    const bool is_border = signed_area(ring) > 0;
    polygon.rings.insert(is_border ? polygon.rings.begin() : polygon.rings.end(), std::move(ring));
  }

  const Image<std::uint32_t>& numbers_;
  Image<std::uint32_t> pieces_;
  Image<std::uint8_t> done_;              // whose upper side a ring has followed
  std::vector<std::uint32_t> number_of_;  // of each piece, from 1
};

}  // namespace

std::vector<std::vector<OutlinePolygon>> outlines_of(const Image<std::uint32_t>& numbers) {
  return Tracer(numbers).trace();
}

}  // namespace gazetrace
