// SPDX-License-Identifier: Apache-2.0
#include "trace/duplicate_emitters.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <tuple>
#include <utility>

namespace gazetrace {
namespace {

using Corner = std::tuple<float, float, float>;

struct Key {
  std::array<Corner, 3> corners;
  std::int32_t material = 0;
  auto operator<=>(const Key&) const = default;
};

// The smallest corner first, so that it does not matter where a triangle begins; both ways round for a double-sided
// one.
Key key_of(const EmissiveTriangle& triangle) {
  const auto corner = [&](const Vec3f& edge) {
    return Corner{triangle.origin.x + edge.x, triangle.origin.y + edge.y, triangle.origin.z + edge.z};
  };
  Key key{{corner({}), corner(triangle.edge1), corner(triangle.edge2)}, triangle.material};
  std::rotate(key.corners.begin(), std::min_element(key.corners.begin(), key.corners.end()), key.corners.end());
  if (triangle.double_sided && key.corners[2] < key.corners[1]) {
    std::swap(key.corners[1], key.corners[2]);
  }
  return key;
}

}  // namespace

std::vector<std::uint32_t> first_of_duplicates(const std::vector<EmissiveTriangle>& triangles) {
  std::vector<Key> keys;
  keys.reserve(triangles.size());
  std::transform(triangles.begin(), triangles.end(), std::back_inserter(keys), key_of);
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::tie(keys[a], a) < std::tie(keys[b], b); });
  std::vector<std::uint32_t> first(triangles.size());
  bool any = false;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool again = i > 0 && keys[order[i]] == keys[order[i - 1]];
    first[order[i]] = again ? first[order[i - 1]] : order[i];
    any = any || again;
  }
  return any ? first : std::vector<std::uint32_t>();
}

}  // namespace gazetrace
