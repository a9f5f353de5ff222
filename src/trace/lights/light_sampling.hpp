// SPDX-License-Identifier: Apache-2.0
// Next-event estimation over everything in a scene that shines: environment, emissive triangles, punctual lights.
// One class is chosen with a fixed probability (by power, with a floor for each class that is present), then one light
// of it: by power, or, where lights are many, by a tree that knows the shaded point; then point and spot lights are in
// the tree with the triangles and the third class is directional lights alone. All densities below are over solid angle
// at the shaded point and include these choices, so that
//   estimate = f cos * radiance / pdf                       (delta: the same, no MIS partner)
// and a BSDF-sampled ray that finds an emitter weighs against pdf_environment or pdf_triangle.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"
#include "trace/lights/alias_table.hpp"
#include "trace/lights/duplicate_emitters.hpp"
#include "trace/lights/environment_sampling.hpp"
#include "trace/lights/light_tree.hpp"

namespace gazetrace {

inline constexpr std::uint32_t kNoEmitter = 0xffffffffU;

struct LightSample {
  Vec3f direction;     // world, towards the light, unit length
  float distance = 0;  // infinite: environment and directional lights
  float slack = 0;     // how much nearer rounding may bring the light's own surface, m
  // Arriving along `direction` if nothing is in the way, before any cosine. Triangles: see `emitter`.
  // Delta lights: W/m^2 on a surface that faces the light, taking the place of radiance times solid angle.
  Vec3f radiance;
  float pdf = 0;
  bool valid = false;  // false: no light, or this one does not reach the point; the estimate is zero
  bool delta = false;
  // Triangle lights only. Where the material has an emissive texture, `radiance` is its factor alone: multiply by the
  // texture at `barycentric` (weights of the second and third vertex).
  std::uint32_t emitter = kNoEmitter;
  Vec2f barycentric;
};

// A triangle that shines, in world space.
struct EmissiveTriangle {
  Vec3f origin, edge1, edge2;  // first vertex; to the second and third
  Vec3f normal;                // unit, towards the front face
  Vec3f emission;              // Material::emission
  // Selection probability / area, without the tree's part of it; 0: never chosen (no area, or black).
  float pdf_area = 0;
  std::int32_t instance = 0, geometry = 0, primitive = 0, material = 0;
  bool double_sided = false;
};

class LightSampler {
 public:
  // Keeps a reference to the scene's environment picture, which must outlive it.
  // A compensated density is for use with MIS only.
  explicit LightSampler(const Scene& scene, LightChoice choice = LightChoice::automatic,
                        EnvironmentDensity density = EnvironmentDensity::plain);

  // False: sample() never returns a valid sample.
  [[nodiscard]] bool any() const noexcept {
    return environment_probability_ + triangle_probability_ + punctual_probability_ > 0;
  }

  // True: densities of triangles depend on the shaded point, and whoever asks for one later must keep it.
  [[nodiscard]] bool depends_on_place() const noexcept { return !tree_.empty(); }

  // `normal` is the side the light must come from: samples below its horizon come back invalid. Zero: either side.
  [[nodiscard]] LightSample sample(const Vec3f& position, const Vec3f& normal, const Vec2f& u,
                                   float u_select) const noexcept;

  // The same for many at once, with the same results.
  void sample_many(std::size_t count, const Vec3f* position, const Vec3f* normal, const Vec2f* u, const float* u_select,
                   LightSample* out) const noexcept;

  // Radiance and density seen by a ray that leaves the scene; zero without an environment.
  struct EnvironmentHit {
    Vec3f radiance;
    float pdf = 0;
  };
  [[nodiscard]] EnvironmentHit environment(const Vec3f& direction) const noexcept;
  void environment_many(const Vec3f* directions, std::size_t count, EnvironmentHit* out) const noexcept;
  [[nodiscard]] Vec3f environment_radiance(const Vec3f& direction) const noexcept;
  [[nodiscard]] float pdf_environment(const Vec3f& direction) const noexcept;

  // kNoEmitter where the triangle does not shine. geometry: index within the instance's mesh.
  [[nodiscard]] std::uint32_t emitter_of(std::uint32_t instance, std::uint32_t geometry,
                                         std::uint32_t primitive) const noexcept {
    const std::uint32_t first = first_emitter_[first_geometry_[instance] + geometry];
    if (first == kNoEmitter) {
      return kNoEmitter;
    }
    return first_of_duplicates_.empty() ? first + primitive : first_of_duplicates_[first + primitive];
  }
  [[nodiscard]] const EmissiveTriangle& triangle(std::uint32_t emitter) const noexcept { return triangles_[emitter]; }
  // cos_at_light: between the triangle's normal and the direction back to the shaded point; its sign matters for
  // single-sided emitters.
  // `position` and `normal`: those that sample() was given at the shaded point.
  [[nodiscard]] float pdf_triangle(std::uint32_t emitter, float cos_at_light, float distance_squared,
                                   const Vec3f& position, const Vec3f& normal) const noexcept;

  [[nodiscard]] float environment_probability() const noexcept { return environment_probability_; }
  [[nodiscard]] float triangle_probability() const noexcept { return triangle_probability_; }
  [[nodiscard]] float punctual_probability() const noexcept { return punctual_probability_; }
  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles_.size(); }

 private:
  [[nodiscard]] LightSample sample_environment(const Vec3f& normal, const Vec2f& u) const noexcept;
  // A point of a given triangle, chosen with probability `selection` on top of its pdf_area.
  [[nodiscard]] LightSample sample_triangle(std::uint32_t emitter, float selection, const Vec3f& position,
                                            const Vec3f& normal, const Vec2f& u) const noexcept;
  [[nodiscard]] LightSample sample_punctual(std::uint32_t index, float probability, const Vec3f& position,
                                            const Vec3f& normal) const noexcept;
  [[nodiscard]] LightSample sample_tree(const Vec3f& position, const Vec3f& normal, const Vec2f& u,
                                        double u_select) const noexcept;
  [[nodiscard]] static float density(const EmissiveTriangle& triangle, float selection, float cos_at_light,
                                     float distance_squared) noexcept;

  struct Collected {
    std::vector<double> powers;  // watts; 0 for what is never chosen
    std::vector<EmitterPlace> places;
  };
  Collected collect_triangles(const Scene& scene);
  void build_tree(const std::vector<double>& triangle_powers);

  EnvironmentSampler environment_;
  std::vector<EmissiveTriangle> triangles_;
  AliasTable triangle_choice_;
  LightTree tree_;                             // over all triangles, then the punctual lights in their order
  std::vector<std::uint32_t> first_geometry_;  // of each instance, into first_emitter_
  std::vector<std::uint32_t> first_emitter_;
  std::vector<std::uint32_t> first_of_duplicates_;  // duplicate_emitters.hpp
  std::vector<PunctualLight> punctual_;
  std::vector<float> punctual_pdf_;  // selection probability of each, class included
  AliasTable punctual_choice_;
  float environment_probability_ = 0;
  float triangle_probability_ = 0;
  float punctual_probability_ = 0;
};

}  // namespace gazetrace
