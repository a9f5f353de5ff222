// SPDX-License-Identifier: Apache-2.0
#include "trace/lights/light_sampling.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "core/hash.hpp"
#include "core/luminance.hpp"
#include "trace/kernel/shading_frame.hpp"
#include "trace/lights/duplicate_emitters.hpp"
#include "trace/lights/emission_average.hpp"
#include "trace/scene/instance_transform.hpp"

namespace gazetrace {
namespace {

// This share of the samples is divided equally among the classes that are present, since power says nothing about which
// light is near. The same is done among punctual lights.
constexpr double kClassFloor = 0.3;
constexpr double kPunctualFloor = 0.1;

// From this many triangles and point or spot lights on, the tree saves more noise than its traversal costs; measured by
// tests/benchmarks/many_lights.cpp.
constexpr std::size_t kTreeFromLights = 4;

// In float, a triangle with a smaller area cannot be distinguished from a line.
constexpr double kSmallestArea = 1e-30;
constexpr float kGrazing = 1e-6F;
// How near its end a shadow ray may hit the light itself: rounding errors of the direction, divided by the cosine at
// the light, which is limited for lights at very grazing angles.
constexpr float kDirectionUlps = 0x1p-20F;
constexpr float kLeastSlant = 0.01F;

bool usable(double weight) {
  return weight > 0 && std::isfinite(weight);
}

// The radius of the sphere about the scene's bounding box, in metres; 1 for an empty scene.
double scene_radius_m(const Scene& scene) {
  const SceneSummary summary = summarize(scene);
  const double radius =
      summary.bounds_min.x <= summary.bounds_max.x ? 0.5 * length(summary.bounds_max - summary.bounds_min) : 1.0;
  return usable(radius) ? radius : 1.0;
}

// The power, in watts, that a light sends into the scene's sphere.
double power(const PunctualLight& light, double radius_m) {
  const double intensity = luminance(to_double(light.intensity));
  switch (light.kind) {
    case LightKind::directional:
      return intensity * kPi * radius_m * radius_m;
    case LightKind::spot:
      return intensity * 2 * kPi * std::max(1.0 - static_cast<double>(light.cos_outer), 1e-6);
    case LightKind::point:
      break;
  }
  return intensity * 4 * kPi;
}

// KHR_lights_punctual, "Range Property": the window is 1 near the light and 0 from `range` on.
float range_window(float range_m, float distance_squared) {
  if (!(range_m > 0)) {
    return 1.0F;
  }
  const float s = distance_squared / (range_m * range_m);
  return std::clamp(1.0F - s * s, 0.0F, 1.0F);
}

// KHR_lights_punctual, "Inner and Outer Cone Angles".
float cone_falloff(const PunctualLight& light, float cosine) {
  const float scale = 1.0F / std::max(0.001F, light.cos_inner - light.cos_outer);
  const float t = std::clamp((cosine - light.cos_outer) * scale, 0.0F, 1.0F);
  return t * t;
}

// Adds 32 bits below the 24 bits of u, as a function of the other two numbers; choosing among a million lights needs
// them.
double refine(float u, const Vec2f& other) {
  const std::uint32_t digits =
      hash32(std::bit_cast<std::uint32_t>(other.x) + 0x9e3779b9U * std::bit_cast<std::uint32_t>(other.y));
  return static_cast<double>(u) + static_cast<double>(digits) * 0x1p-56;
}

// Whether a light has a position, so that the tree can bound its effect.
bool is_local(const PunctualLight& light) {
  return light.kind != LightKind::directional;
}

// With a zero normal light may come from anywhere.
bool faces(const Vec3f& normal, const Vec3f& direction) {
  const float cosine = dot(normal, direction);
  return cosine > 0 || (cosine == 0 && dot(normal, normal) == 0);
}

double area_of(const EmissiveTriangle& triangle) {
  return 0.5 * length(cross(to_double(triangle.edge1), to_double(triangle.edge2)));
}

}  // namespace

LightSampler::LightSampler(const Scene& scene, LightChoice choice, const Vec3d& origin_m)
    : environment_(scene.environment) {
  const double radius = scene_radius_m(scene);
  auto [triangle_powers, places] = collect_triangles(scene, origin_m);
  first_of_duplicates_ = first_of_duplicates(places);
  for (std::size_t i = 0; i < first_of_duplicates_.size(); ++i) {
    if (first_of_duplicates_[i] != i) {
      triangle_powers[i] = 0;
    }
  }
  std::vector<double> punctual_powers;
  for (const PunctualLight& light : scene.lights) {
    if (const double p = power(light, radius); usable(p)) {
      punctual_.push_back(light);
      punctual_.back().direction = normalize(light.direction);
      punctual_.back().position_m = light.position_m - origin_m;
      punctual_powers.push_back(p);
    }
  }
  std::array<double, 3> powers{environment_.total() * kPi * radius * radius,
                               std::accumulate(triangle_powers.begin(), triangle_powers.end(), 0.0), 0.0};
  const auto small_lights =
      static_cast<std::size_t>(std::count_if(triangle_powers.begin(), triangle_powers.end(), usable)) +
      static_cast<std::size_t>(std::count_if(punctual_.begin(), punctual_.end(), is_local));
  if (choice == LightChoice::tree || (choice == LightChoice::automatic && small_lights >= kTreeFromLights)) {
    build_tree(triangle_powers);
    for (std::size_t i = 0; i < punctual_.size(); ++i) {
      if (is_local(punctual_[i])) {
        powers[1] += std::exchange(punctual_powers[i], 0.0);
      }
    }
  }
  powers[2] = std::accumulate(punctual_powers.begin(), punctual_powers.end(), 0.0);

  const double total = powers[0] + powers[1] + powers[2];
  const auto present = static_cast<double>(std::count_if(powers.begin(), powers.end(), usable));
  std::array<double, 3> probability{};
  for (std::size_t i = 0; i < powers.size(); ++i) {
    probability[i] = usable(powers[i]) ? (1 - kClassFloor) * (powers[i] / total) + kClassFloor / present : 0;
  }
  environment_probability_ = static_cast<float>(probability[0]);
  triangle_probability_ = static_cast<float>(probability[1]);
  punctual_probability_ = static_cast<float>(probability[2]);

  if (triangle_probability_ > 0) {
    if (tree_.empty()) {
      triangle_choice_ = AliasTable(triangle_powers);
    }
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      EmissiveTriangle& triangle = triangles_[i];
      const double share = tree_.empty() ? triangle_powers[i] / powers[1] : 1.0;
      triangle.pdf_area =
          triangle_powers[i] > 0 ? static_cast<float>(probability[1] * share / area_of(triangle)) : 0.0F;
    }
  }
  if (punctual_probability_ > 0) {
    const auto count = static_cast<double>(std::count_if(punctual_powers.begin(), punctual_powers.end(), usable));
    for (double& p : punctual_powers) {
      p = p > 0 ? (1 - kPunctualFloor) * (p / powers[2]) + kPunctualFloor / count : 0;
      punctual_pdf_.push_back(static_cast<float>(p * probability[2]));
    }
    punctual_choice_ = AliasTable(punctual_powers);
  }
}

void LightSampler::build_tree(const std::vector<double>& triangle_powers) {
  std::vector<LightBounds> all;
  all.reserve(triangles_.size() + punctual_.size());
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const EmissiveTriangle& triangle = triangles_[i];
    const Vec3d a = to_double(triangle.origin);
    const Vec3d b = a + to_double(triangle.edge1);
    const Vec3d c = a + to_double(triangle.edge2);
    LightBounds bounds;
    bounds.low = {std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})};
    bounds.high = {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})};
    bounds.axis = to_double(triangle.normal);
    bounds.two_sided = triangle.double_sided;
    bounds.intensity = triangle_powers[i] / (triangle.double_sided ? 2 * kPi : kPi);
    all.push_back(bounds);
  }
  for (const PunctualLight& light : punctual_) {
    LightBounds bounds;
    bounds.low = bounds.high = light.position_m;
    bounds.intensity = is_local(light) ? luminance(to_double(light.intensity)) : 0;
    bounds.normals_rad = kPi;
    if (light.kind == LightKind::spot) {
      bounds.axis = to_double(light.direction);
      bounds.normals_rad = 0;
      bounds.emission_rad = std::acos(std::clamp(static_cast<double>(light.cos_outer), 0.0, 1.0));
    }
    if (light.range_m > 0) {
      bounds.reach_m = static_cast<double>(light.range_m);
    }
    all.push_back(bounds);
  }
  tree_ = LightTree(all);
}

// Fills in triangles_ and the indices into it.
LightSampler::Collected LightSampler::collect_triangles(const Scene& scene, const Vec3d& origin_m) {
  Collected found;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    first_geometry_.push_back(static_cast<std::uint32_t>(first_emitter_.size()));
    const Affine to_world = counted_from(origin_m, instance.to_world);
    const double side = determinant(to_world) < 0 ? -1.0 : 1.0;  // a mirrored one has the opposite winding
    for (std::size_t g = 0; g < mesh.geometries.size(); ++g) {
      const Geometry& geometry = mesh.geometries[g];
      const Material& material = scene.materials[static_cast<std::size_t>(geometry.material)];
      // What moves or deforms has no fixed position to sample.
      if (material.unlit || instance.motion >= 0 || instance.deformation >= 0 ||
          !usable(luminance(to_double(material.emission)))) {
        first_emitter_.push_back(kNoEmitter);
        continue;
      }
      first_emitter_.push_back(static_cast<std::uint32_t>(triangles_.size()));
      for (std::size_t t = 0; t < geometry.triangles.size(); ++t) {
        const auto corner = [&](std::size_t k) {
          return transform_point(to_world, to_double(geometry.positions[geometry.triangles[t][k]]));
        };
        const std::array<Vec3d, 3> corners{corner(0), corner(1), corner(2)};
        EmissiveTriangle triangle;
        triangle.origin = to_float(corners[0]);
        triangle.edge1 = to_float(corners[1] - corners[0]);
        triangle.edge2 = to_float(corners[2] - corners[0]);
        triangle.normal = to_float(normalize(cross(to_double(triangle.edge1), to_double(triangle.edge2))) * side);
        triangle.emission = material.emission;
        triangle.instance = static_cast<std::int32_t>(i);
        triangle.geometry = static_cast<std::int32_t>(g);
        triangle.primitive = static_cast<std::int32_t>(t);
        triangle.material = geometry.material;
        triangle.double_sided = material.double_sided;
        const double area = area_of(triangle);
        const double emitted = luminance(average_emission(scene, material, geometry, t));
        const double p = emitted * area * kPi * (material.double_sided ? 2 : 1);
        triangles_.push_back(triangle);
        found.powers.push_back(area >= kSmallestArea && usable(p) ? p : 0.0);
        // Corners in the winding of the front side.
        found.places.push_back({side < 0 ? std::array{corners[0], corners[2], corners[1]} : corners, geometry.material,
                                material.double_sided});
      }
    }
  }
  return found;
}

LightSample LightSampler::sample(const Vec3f& position, const Vec3f& normal, const Vec2f& u,
                                 float u_select) const noexcept {
  double choice = refine(u_select, u);
  const auto pe = static_cast<double>(environment_probability_);
  const auto pt = static_cast<double>(triangle_probability_);
  const auto pp = static_cast<double>(punctual_probability_);
  // The floats sum to 1 except for rounding errors, so the last class that is present takes the rest.
  if (pe > 0 && (choice < pe || !(pt + pp > 0))) {
    return sample_environment(normal, u);
  }
  choice -= pe;
  if (pt > 0 && (choice < pt || !(pp > 0))) {
    const double rest = std::min(choice / pt, 0x1.fffffffffffffp-1);
    return tree_.empty() ? sample_triangle(triangle_choice_.choose(rest), 1.0F, position, normal, u)
                         : sample_tree(position, normal, u, rest);
  }
  if (!(pp > 0)) {
    return {};
  }
  const std::uint32_t chosen = punctual_choice_.choose(std::min((choice - pt) / pp, 0x1.fffffffffffffp-1));
  return sample_punctual(chosen, punctual_pdf_[chosen], position, normal);
}

LightSample LightSampler::sample_tree(const Vec3f& position, const Vec3f& normal, const Vec2f& u,
                                      double u_select) const noexcept {
  const LightTree::Choice chosen = tree_.choose(position, normal, u_select);
  if (!(chosen.probability > 0)) {
    return {};
  }
  if (chosen.light < triangles_.size()) {
    return sample_triangle(chosen.light, chosen.probability, position, normal, u);
  }
  const auto light = static_cast<std::uint32_t>(chosen.light - triangles_.size());
  return sample_punctual(light, chosen.probability * triangle_probability_, position, normal);
}

void LightSampler::sample_many(std::size_t count, const Vec3f* position, const Vec3f* normal, const Vec2f* u,
                               const float* u_select, LightSample* out) const noexcept {
  if (!(environment_probability_ > 0) || triangle_probability_ + punctual_probability_ > 0) {
    for (std::size_t i = 0; i < count; ++i) {
      out[i] = sample(position[i], normal[i], u[i], u_select[i]);
    }
    return;
  }
  constexpr std::size_t kStage = 64;
  std::array<EnvironmentSampler::Sample, kStage> chosen;
  for (std::size_t begin = 0; begin < count; begin += kStage) {
    const std::size_t n = std::min(kStage, count - begin);
    environment_.sample_many(u + begin, n, chosen.data());
    for (std::size_t i = 0; i < n; ++i) {
      LightSample& result = out[begin + i];
      result = {};
      result.direction = chosen[i].direction;
      result.distance = std::numeric_limits<float>::infinity();
      result.radiance = chosen[i].radiance;
      result.pdf = chosen[i].pdf * environment_probability_;
      result.valid = result.pdf > 0 && faces(normal[begin + i], chosen[i].direction);
    }
  }
}

void LightSampler::environment_many(const Vec3f* directions, std::size_t count, EnvironmentHit* out) const noexcept {
  constexpr std::size_t kStage = 64;
  std::array<EnvironmentSampler::Value, kStage> values;
  for (std::size_t begin = 0; begin < count; begin += kStage) {
    const std::size_t n = std::min(kStage, count - begin);
    environment_.value_many(directions + begin, n, values.data());
    for (std::size_t i = 0; i < n; ++i) {
      out[begin + i] = {values[i].radiance, values[i].pdf * environment_probability_};
    }
  }
}

LightSample LightSampler::sample_environment(const Vec3f& normal, const Vec2f& u) const noexcept {
  const EnvironmentSampler::Sample chosen = environment_.sample(u);
  LightSample result;
  result.direction = chosen.direction;
  result.distance = std::numeric_limits<float>::infinity();
  result.radiance = chosen.radiance;
  result.pdf = chosen.pdf * environment_probability_;
  result.valid = result.pdf > 0 && faces(normal, chosen.direction);
  return result;
}

LightSample LightSampler::sample_triangle(std::uint32_t emitter, float selection, const Vec3f& position,
                                          const Vec3f& normal, const Vec2f& u) const noexcept {
  LightSample result;
  result.emitter = emitter;
  const EmissiveTriangle& triangle = triangles_[result.emitter];
  // Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
  float b1 = u.x;
  float b2 = u.y;
  if (b2 > b1) {
    b1 *= 0.5F;
    b2 -= b1;
  } else {
    b2 *= 0.5F;
    b1 -= b2;
  }
  result.barycentric = {b1, b2};
  const Vec3f way = (triangle.origin - position) + triangle.edge1 * b1 + triangle.edge2 * b2;
  const float distance_squared = dot(way, way);
  if (!(distance_squared > 0)) {
    return result;
  }
  result.distance = std::sqrt(distance_squared);
  result.direction = way / result.distance;
  result.radiance = triangle.emission;
  const float cosine = -dot(triangle.normal, result.direction);
  const float reach = largest(triangle.origin) + largest(triangle.edge1) + largest(triangle.edge2);
  result.slack = (kOffsetUlps * reach + kDirectionUlps * result.distance) / std::max(std::fabs(cosine), kLeastSlant);
  result.pdf = density(triangle, selection, cosine, distance_squared);
  result.valid = result.pdf > 0 && faces(normal, result.direction);
  return result;
}

LightSample LightSampler::sample_punctual(std::uint32_t index, float probability, const Vec3f& position,
                                          const Vec3f& normal) const noexcept {
  const PunctualLight& light = punctual_[index];
  LightSample result;
  result.delta = true;
  result.pdf = probability;
  if (light.kind == LightKind::directional) {
    result.direction = -light.direction;
    result.distance = std::numeric_limits<float>::infinity();
    result.radiance = light.intensity;
  } else {
    const Vec3f way = to_float(light.position_m) - position;
    const float distance_squared = dot(way, way);
    if (!(distance_squared > 0)) {
      return result;
    }
    result.distance = std::sqrt(distance_squared);
    result.direction = way / result.distance;
    float falloff = range_window(light.range_m, distance_squared);
    if (light.kind == LightKind::spot) {
      falloff *= cone_falloff(light, -dot(light.direction, result.direction));
    }
    result.radiance = light.intensity * (falloff / distance_squared);
  }
  // A point too close to a light for float's range gets an infinite value, which is counted as a non-finite sample.
  const float sum = result.radiance.x + result.radiance.y + result.radiance.z;
  result.valid = sum > 0 && faces(normal, result.direction);
  return result;
}

LightSampler::EnvironmentHit LightSampler::environment(const Vec3f& direction) const noexcept {
  const EnvironmentSampler::Value value = environment_.value(direction);
  return {value.radiance, value.pdf * environment_probability_};
}

Vec3f LightSampler::environment_radiance(const Vec3f& direction) const noexcept {
  return environment_.radiance(direction);
}

float LightSampler::pdf_environment(const Vec3f& direction) const noexcept {
  return environment_.pdf(direction) * environment_probability_;
}

float LightSampler::pdf_triangle(std::uint32_t emitter, float cos_at_light, float distance_squared,
                                 const Vec3f& position, const Vec3f& normal) const noexcept {
  const float selection = tree_.empty() ? 1.0F : tree_.probability(emitter, position, normal);
  return density(triangles_[emitter], selection, cos_at_light, distance_squared);
}

float LightSampler::density(const EmissiveTriangle& triangle, float selection, float cos_at_light,
                            float distance_squared) noexcept {
  const float cosine = triangle.double_sided ? std::fabs(cos_at_light) : cos_at_light;
  return cosine > kGrazing ? triangle.pdf_area * selection * distance_squared / cosine : 0.0F;
}

}  // namespace gazetrace
