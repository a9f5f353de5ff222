// SPDX-License-Identifier: Apache-2.0
#include "trace/lights/light_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "core/instruction_sets.hpp"

namespace gazetrace {
namespace {

constexpr int kBins = 12;
// The least intensity of a light relative to all lights together; products of such numbers are still normal floats.
constexpr double kLeastShare = 1e-18;

// cos(max(a - b, 0)), and its sine, from the sines and cosines of angles a and b in [0, pi].
inline float cos_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 1.0F : cos_a * cos_b + sin_a * sin_b;
}
inline float sin_of_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 0.0F : sin_a * cos_b - cos_a * sin_b;
}

double component(const Vec3d& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

Vec3d middle(const LightBounds& b) {
  return (b.low + b.high) * 0.5;
}

// Rotates by Rodrigues' formula.
Vec3d turned(const Vec3d& v, const Vec3d& unit_axis, double angle_rad) {
  const double c = std::cos(angle_rad);
  return v * c + cross(unit_axis, v) * std::sin(angle_rad) + unit_axis * (dot(unit_axis, v) * (1 - c));
}

// Conty Estevez and Kulla 2018, section 4.2: the solid angle into which a cone of normals emits, weighted by cosines.
double orientation_measure(const LightBounds& b) {
  const double o = b.normals_rad;
  const double w = std::min(o + b.emission_rad, kPi);
  return 2 * kPi * (1 - std::cos(o)) +
         kPi / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
}

double split_cost(const LightBounds& b) {
  const Vec3d d = b.high - b.low;
  // Half the surface, plus a term with the square of the longest side, so that lines and points still differ.
  const double longest = std::max({d.x, d.y, d.z});
  const double area = d.x * d.y + d.y * d.z + d.z * d.x + 1e-3 * longest * longest;
  return b.intensity * orientation_measure(b) * area;
}

void grow(LightBounds& all, bool& any, const LightBounds& one) {
  all = any ? join(all, one) : one;
  any = true;
}

}  // namespace

LightBounds join(const LightBounds& a, const LightBounds& b) {
  LightBounds all;
  all.low = {std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)};
  all.high = {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)};
  all.emission_rad = std::max(a.emission_rad, b.emission_rad);
  all.intensity = a.intensity + b.intensity;
  all.reach_m = std::max(a.reach_m, b.reach_m);
  all.two_sided = a.two_sided || b.two_sided;

  const bool a_wider = a.normals_rad >= b.normals_rad;
  const LightBounds& wide = a_wider ? a : b;
  const LightBounds& narrow = a_wider ? b : a;
  Vec3d other = narrow.axis;
  double cosine = dot(wide.axis, other);
  if (cosine < 0 && narrow.two_sided && (wide.two_sided || narrow.normals_rad < kPi)) {
    // Two-sided lights have no front, so the side that keeps the cone narrow is taken.
    other = other * -1.0;
    cosine = -cosine;
  }
  const double between = std::acos(std::clamp(cosine, -1.0, 1.0));
  all.axis = wide.axis;
  if (between + narrow.normals_rad <= wide.normals_rad) {
    all.normals_rad = wide.normals_rad;
    return all;
  }
  const double half = (wide.normals_rad + between + narrow.normals_rad) / 2;
  const Vec3d around = cross(wide.axis, other);
  if (half >= kPi || !(length(around) > 1e-12)) {
    all.normals_rad = half >= kPi || between > 1 ? kPi : half;
    return all;
  }
  all.normals_rad = half;
  all.axis = normalize(turned(wide.axis, normalize(around), half - wide.normals_rad));
  return all;
}

struct LightTree::Builder {
  const std::vector<LightBounds>& lights;
  LightTree& tree;
  Vec3d center;
  double scale, total;

  struct Group {
    std::span<std::uint32_t> members;
    LightBounds bounds;
  };

  LightBounds bounds_of(std::span<const std::uint32_t> members) const {
    LightBounds all;
    bool any = false;
    for (const std::uint32_t i : members) {
      grow(all, any, lights[i]);
    }
    return all;
  }

  // Splits a group in two at the border between bins with the least cost; in the middle where all are in one place.
  std::array<Group, 2> split(const Group& group) const {
    Vec3d low = middle(lights[group.members[0]]);
    Vec3d high = low;
    for (const std::uint32_t i : group.members) {
      const Vec3d m = middle(lights[i]);
      low = {std::min(low.x, m.x), std::min(low.y, m.y), std::min(low.z, m.z)};
      high = {std::max(high.x, m.x), std::max(high.y, m.y), std::max(high.z, m.z)};
    }
    const Vec3d extent = high - low;
    const double longest = std::max({extent.x, extent.y, extent.z});
    double best = std::numeric_limits<double>::infinity();
    int best_axis = -1;
    int best_border = 0;
    const auto bin_of = [&](std::uint32_t i, int axis) {
      const double at = (component(middle(lights[i]), axis) - component(low, axis)) / component(extent, axis);
      return std::min(static_cast<int>(at * kBins), kBins - 1);
    };
    for (int axis = 0; axis < 3; ++axis) {
      if (!(component(extent, axis) > 0)) {
        continue;
      }
      std::array<LightBounds, kBins> bins;
      std::array<bool, kBins> filled{};
      for (const std::uint32_t i : group.members) {
        const auto bin = static_cast<std::size_t>(bin_of(i, axis));
        grow(bins[bin], filled[bin], lights[i]);
      }
      std::array<double, kBins> right{};
      LightBounds all;
      bool any = false;
      for (std::size_t b = kBins; b-- > 1;) {
        if (filled[b]) {
          grow(all, any, bins[b]);
        }
        right[b] = any ? split_cost(all) : 0;
      }
      any = false;
      const double stretch = longest / component(extent, axis);
      for (std::size_t b = 0; b + 1 < kBins; ++b) {
        if (filled[b]) {
          grow(all, any, bins[b]);
        }
        const double cost = stretch * ((any ? split_cost(all) : 0) + right[b + 1]);
        if (cost < best) {
          best = cost;
          best_axis = axis;
          best_border = static_cast<int>(b);
        }
      }
    }
    std::size_t left = group.members.size() / 2;
    if (best_axis >= 0) {
      const auto border = std::stable_partition(group.members.begin(), group.members.end(),
                                                [&](std::uint32_t i) { return bin_of(i, best_axis) <= best_border; });
      const auto count = static_cast<std::size_t>(border - group.members.begin());
      left = count > 0 && count < group.members.size() ? count : left;
    }
    const auto first = group.members.first(left);
    const auto second = group.members.subspan(left);
    return {Group{first, bounds_of(first)}, Group{second, bounds_of(second)}};
  }

  // Divides a group into up to eight. The group with the largest cost is split first, so that lights that are close and
  // similar stay together.
  std::vector<Group> divide(const Group& whole) const {
    std::vector<Group> groups{whole};
    while (groups.size() < kWidth) {
      std::size_t widest = groups.size();
      double most = -1;
      for (std::size_t g = 0; g < groups.size(); ++g) {
        const double cost = groups[g].members.size() > 1 ? split_cost(groups[g].bounds) : -1;
        if (cost > most) {
          most = cost;
          widest = g;
        }
      }
      if (widest == groups.size()) {
        break;
      }
      const auto [a, b] = split(groups[widest]);
      groups[widest] = a;
      groups.insert(groups.begin() + static_cast<std::ptrdiff_t>(widest) + 1, b);
    }
    return groups;
  }

  void set_child(Node& node, std::size_t lane, const LightBounds& b) const {
    const Vec3d at = (middle(b) - center) * scale;
    const double radius = 0.5 * length(b.high - b.low) * scale;
    node.x[lane] = static_cast<float>(at.x);
    node.y[lane] = static_cast<float>(at.y);
    node.z[lane] = static_cast<float>(at.z);
    // Slightly enlarged because of rounding, and never zero, so that the bound of a light at the point itself is
    // finite.
    node.radius_squared[lane] = std::max(static_cast<float>(radius * radius * 1.0001), 1e-16F);
    node.axis_x[lane] = static_cast<float>(b.axis.x);
    node.axis_y[lane] = static_cast<float>(b.axis.y);
    node.axis_z[lane] = static_cast<float>(b.axis.z);
    node.two_sided[lane] = b.two_sided ? 1.0F : 0.0F;
    node.cos_normals[lane] = static_cast<float>(std::cos(b.normals_rad));
    node.sin_normals[lane] = static_cast<float>(std::sin(b.normals_rad));
    node.cos_emission[lane] = static_cast<float>(std::cos(std::min(b.emission_rad + 1e-4, kPi)));
    node.intensity[lane] = static_cast<float>(std::max(b.intensity / total, kLeastShare));
    node.reach[lane] = static_cast<float>(std::min(b.reach_m * scale * 1.0001, 1e18));
  }

  std::uint32_t build(const Group& whole, std::uint32_t parent) {
    const auto index = static_cast<std::uint32_t>(tree.nodes_.size());
    tree.nodes_.emplace_back();
    Node fresh{};
    fresh.parent = parent;
    std::fill(fresh.child.begin(), fresh.child.end(), kNone);
    std::fill_n(fresh.radius_squared.data, kWidth, 1.0F);
    tree.nodes_[index] = fresh;
    const std::vector<Group> groups = divide(whole);
    for (std::size_t lane = 0; lane < groups.size(); ++lane) {
      set_child(tree.nodes_[index], lane, groups[lane].bounds);
      const auto place = static_cast<std::uint32_t>(index * kWidth + lane);
      if (groups[lane].members.size() == 1) {
        const std::uint32_t light = groups[lane].members[0];
        tree.place_[light] = place;
        tree.nodes_[index].child[lane] = light | kLeaf;
      } else {
        const std::uint32_t child = build(groups[lane], place);  // may reallocate the nodes
        tree.nodes_[index].child[lane] = child;
      }
    }
    return index;
  }
};

LightTree::LightTree(const std::vector<LightBounds>& lights) : place_(lights.size(), kNone) {
  std::vector<std::uint32_t> members;
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    if (lights[i].intensity > 0) {
      members.push_back(i);
    }
  }
  if (members.empty()) {
    return;
  }
  Builder builder{lights, *this, {}, 1, 1};
  const LightBounds all = builder.bounds_of(members);
  const double radius = 0.5 * length(all.high - all.low);
  center_ = to_float(middle(all));
  builder.center = to_double(center_);
  scale_ = radius > 1e-30 ? static_cast<float>(1 / radius) : 1.0F;
  builder.scale = static_cast<double>(scale_);
  builder.total = all.intensity;
  builder.build({members, all}, kNone);
}

LightTree::Point LightTree::point_of(const Vec3f& position, const Vec3f& normal) const noexcept {
  const Vec3f p = (position - center_) * scale_;
  return {p.x, p.y, p.z, normal, dot(normal, normal) > 0 ? 0.0F : 1.0F};
}

// The bound of their figure 5: intensity * cos(theta') / distance^2 with theta' = max(0, theta - theta_o - theta_u),
// where theta_u is the angle that the bounds subtend, times the cosine at the point, which is bounded likewise. Inside
// the bounds any cosine is possible, and the distance is at least radius / sqrt(3): 3 / r^2 is the mean of 1 /
// distance^2 over a ball seen from its centre. (With the radius itself as the least distance, noise was a quarter to a
// third larger from 10^3 lights on.)
inline LightTree::Lanes LightTree::importance(const Node& node, const Point& point) noexcept {
  Lanes result;
  for (std::size_t i = 0; i < kWidth; ++i) {
    const float dx = node.x[i] - point.x;
    const float dy = node.y[i] - point.y;
    const float dz = node.z[i] - point.z;
    const float d2 = dx * dx + dy * dy + dz * dz;
    const float r2 = node.radius_squared[i];
    const float inverse = 1.0F / std::sqrt(std::max(d2, 1e-30F));
    const float ratio = r2 * inverse * inverse;
    const float sin_u = std::sqrt(std::min(ratio, 1.0F));
    const float cos_u = ratio < 1.0F ? std::sqrt(1.0F - std::min(ratio, 1.0F)) : -1.0F;
    const float along = -(node.axis_x[i] * dx + node.axis_y[i] * dy + node.axis_z[i] * dz) * inverse;
    const float cosine = std::min(node.two_sided[i] != 0 ? std::fabs(along) : along, 1.0F);
    const float sine = std::sqrt(std::max(1.0F - cosine * cosine, 0.0F));
    const float cos_x = cos_of_difference(sine, cosine, node.sin_normals[i], node.cos_normals[i]);
    const float sin_x = sin_of_difference(sine, cosine, node.sin_normals[i], node.cos_normals[i]);
    const float cos_p = cos_of_difference(sin_x, cos_x, sin_u, cos_u);
    const float emitted = cos_p > node.cos_emission[i] ? cos_p : 0.0F;
    const float above = (point.normal.x * dx + point.normal.y * dy + point.normal.z * dz) * inverse;
    const float above_sine = std::sqrt(std::max(1.0F - above * above, 0.0F));
    const float bounded = cos_of_difference(above_sine, above, sin_u, cos_u);
    const float received = std::max(bounded, point.least_received);
    const float beyond = node.reach[i] + std::sqrt(r2);
    const float reached = d2 <= beyond * beyond ? 1.0F : 0.0F;
    result[i] = node.intensity[i] * std::max(emitted, 0.0F) * received * reached / std::max(d2, r2 * (1.0F / 3.0F));
  }
  return result;
}

GAZETRACE_CLONES LightTree::Choice LightTree::choose(const Vec3f& position, const Vec3f& normal,
                                                     double u) const noexcept {
  const Point point = point_of(position, normal);
  float probability = 1;
  std::uint32_t at = 0;
  for (;;) {
    const Node& node = nodes_[at];
    const Lanes weights = importance(node, point);
    float total = 0;
    for (const float w : weights.data) {
      total += w;
    }
    if (!(total > 0)) {
      return {};
    }
    const double target = u * static_cast<double>(total);
    double before = 0;
    std::size_t chosen = kWidth;
    double start = 0;
    for (std::size_t i = 0; i < kWidth; ++i) {
      const auto w = static_cast<double>(weights[i]);
      if (w > 0 && (chosen == kWidth || target >= before)) {
        chosen = i;
        start = before;
      }
      before += w;
    }
    probability *= weights[chosen] / total;
    u = std::clamp((target - start) / static_cast<double>(weights[chosen]), 0.0, 0x1.fffffffffffffp-1);
    const std::uint32_t child = node.child[chosen];
    if ((child & kLeaf) != 0) {
      return {child & ~kLeaf, probability};
    }
    at = child;
  }
}

GAZETRACE_CLONES float LightTree::probability(std::uint32_t light, const Vec3f& position,
                                              const Vec3f& normal) const noexcept {
  std::uint32_t place = place_[light];
  if (place == kNone) {
    return 0;
  }
  const Point point = point_of(position, normal);
  float probability = 1;
  while (place != kNone) {
    const Node& node = nodes_[place / kWidth];
    const Lanes weights = importance(node, point);
    float total = 0;
    for (const float w : weights.data) {
      total += w;
    }
    if (!(total > 0)) {
      return 0;
    }
    probability *= weights[place % kWidth] / total;
    place = node.parent;
  }
  return probability;
}

}  // namespace gazetrace
