// SPDX-License-Identifier: Apache-2.0
#include "trace/lights/duplicate_emitters.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <tuple>
#include <utility>

namespace gazetrace {
namespace {

using Corner = std::tuple<double, double, double>;

struct Key {
  std::array<Corner, 3> corners;
  std::int32_t material = 0;
  auto operator<=>(const Key&) const = default;
};

// Begins with the smallest corner, so that it does not matter with which corner a triangle begins; for double-sided
// ones the winding does not matter, either.
Key key_of(const EmitterPlace& place) {
  Key key{{}, place.material};
  std::transform(place.corners.begin(), place.corners.end(), key.corners.begin(), [](const Vec3d& corner) {
    return Corner{corner.x, corner.y, corner.z};
  });
  std::rotate(key.corners.begin(), std::min_element(key.corners.begin(), key.corners.end()), key.corners.end());
  if (place.double_sided && key.corners[2] < key.corners[1]) {
    std::swap(key.corners[1], key.corners[2]);
  }
  return key;
}

}  // namespace

std::vector<std::uint32_t> first_of_duplicates(const std::vector<EmitterPlace>& places) {
  std::vector<Key> keys;
  keys.reserve(places.size());
  std::transform(places.begin(), places.end(), std::back_inserter(keys), key_of);
  std::vector<std::uint32_t> order(places.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::tie(keys[a], a) < std::tie(keys[b], b); });
  std::vector<std::uint32_t> first(places.size());
  bool any = false;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool again = i > 0 && keys[order[i]] == keys[order[i - 1]];
    first[order[i]] = again ? first[order[i - 1]] : order[i];
    any = any || again;
  }
  return any ? first : std::vector<std::uint32_t>();
}

}  // namespace gazetrace
