// SPDX-License-Identifier: Apache-2.0
// Next-event estimation over everything in a scene that emits light: environment, emissive triangles, punctual lights.
// First one of these classes is chosen with a fixed probability (by power, with a least probability for each class that
// is present), then one light of it: by power or, where there are many lights, by a tree that considers the shaded
// point. In that case point and spot lights are in the tree together with the triangles, and the third class has
// directional lights only. All densities below are over solid angle at the shaded point and include these choices, so
// that
//   estimate = f cos * radiance / pdf                       (the same for delta lights, which have no MIS partner)
// and a BSDF-sampled ray that finds an emitter is weighted against pdf_environment or pdf_triangle.
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
  Vec3f direction;     // towards the light, in world space, of unit length
  float distance = 0;  // m; infinite for environment and directional lights
  float slack = 0;     // how much nearer the light's own surface may be because of rounding, m
  // The radiance that arrives along `direction` if nothing is in the way, before any cosine; for triangles see
  // `emitter`. For delta lights it is the irradiance on a surface that faces the light (W/m^2), in place of radiance
  // times solid angle.
  Vec3f radiance;
  float pdf = 0;
  bool valid = false;  // false: there is no light, or the chosen one does not reach the point; the estimate is zero
  bool delta = false;
  // For triangles only. Where the material has an emissive texture, `radiance` is the factor alone and must be
  // multiplied by the texture at `barycentric` (the weights of the second and third vertex).
  std::uint32_t emitter = kNoEmitter;
  Vec2f barycentric;
};

// An emissive triangle in world space.
struct EmissiveTriangle {
  Vec3f origin, edge1, edge2;  // the first vertex, and the edges to the second and third
  Vec3f normal;                // unit, on the front side
  Vec3f emission;              // Material::emission
  // Selection probability divided by area, without the tree's factor; 0 where it is never chosen (no area, or black).
  float pdf_area = 0;
  std::int32_t instance = 0, geometry = 0, primitive = 0, material = 0;
  bool double_sided = false;
};

class LightSampler {
 public:
  // Keeps a reference to the scene's environment picture, which must outlive it.
  // Its coordinates count from `origin_m`.
  explicit LightSampler(const Scene& scene, LightChoice choice = LightChoice::automatic, const Vec3d& origin_m = {});

  // False where sample() never returns a valid sample.
  [[nodiscard]] bool any() const noexcept {
    return environment_probability_ + triangle_probability_ + punctual_probability_ > 0;
  }

  // True where the densities of triangles depend on the shaded point, which pdf_triangle then needs.
  [[nodiscard]] bool depends_on_place() const noexcept { return !tree_.empty(); }

  // `normal` is that of the side that light must come from; samples below its horizon are invalid. Zero: both sides.
  [[nodiscard]] LightSample sample(const Vec3f& position, const Vec3f& normal, const Vec2f& u,
                                   float u_select) const noexcept;

  // The same for many points at once, with the same results.
  void sample_many(std::size_t count, const Vec3f* position, const Vec3f* normal, const Vec2f* u, const float* u_select,
                   LightSample* out) const noexcept;

  // Radiance and density for a ray that leaves the scene; zero without an environment.
  struct EnvironmentHit {
    Vec3f radiance;
    float pdf = 0;
  };
  [[nodiscard]] EnvironmentHit environment(const Vec3f& direction) const noexcept;
  void environment_many(const Vec3f* directions, std::size_t count, EnvironmentHit* out) const noexcept;
  [[nodiscard]] Vec3f environment_radiance(const Vec3f& direction) const noexcept;
  [[nodiscard]] float pdf_environment(const Vec3f& direction) const noexcept;

  // The emitter of a triangle, or kNoEmitter where it does not emit. `geometry` is the index within the instance's
  // mesh.
  [[nodiscard]] std::uint32_t emitter_of(std::uint32_t instance, std::uint32_t geometry,
                                         std::uint32_t primitive) const noexcept {
    const std::uint32_t first = first_emitter_[first_geometry_[instance] + geometry];
    if (first == kNoEmitter) {
      return kNoEmitter;
    }
    return first_of_duplicates_.empty() ? first + primitive : first_of_duplicates_[first + primitive];
  }
  [[nodiscard]] const EmissiveTriangle& triangle(std::uint32_t emitter) const noexcept { return triangles_[emitter]; }
  // `cos_at_light` is between the triangle's normal and the direction back to the shaded point; its sign matters for
  // single-sided emitters. `position` and `normal` are the arguments of sample() at the shaded point.
  [[nodiscard]] float pdf_triangle(std::uint32_t emitter, float cos_at_light, float distance_squared,
                                   const Vec3f& position, const Vec3f& normal) const noexcept;

  [[nodiscard]] float environment_probability() const noexcept { return environment_probability_; }
  [[nodiscard]] float triangle_probability() const noexcept { return triangle_probability_; }
  [[nodiscard]] float punctual_probability() const noexcept { return punctual_probability_; }
  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles_.size(); }

 private:
  [[nodiscard]] LightSample sample_environment(const Vec3f& normal, const Vec2f& u) const noexcept;
  // Samples a point of a given triangle; `selection` is the tree's factor of its selection probability.
  [[nodiscard]] LightSample sample_triangle(std::uint32_t emitter, float selection, const Vec3f& position,
                                            const Vec3f& normal, const Vec2f& u) const noexcept;
  [[nodiscard]] LightSample sample_punctual(std::uint32_t index, float probability, const Vec3f& position,
                                            const Vec3f& normal) const noexcept;
  [[nodiscard]] LightSample sample_tree(const Vec3f& position, const Vec3f& normal, const Vec2f& u,
                                        double u_select) const noexcept;
  [[nodiscard]] static float density(const EmissiveTriangle& triangle, float selection, float cos_at_light,
                                     float distance_squared) noexcept;

  struct Collected {
    std::vector<double> powers;  // in watts; 0 for lights that are never chosen
    std::vector<EmitterPlace> places;
  };
  Collected collect_triangles(const Scene& scene, const Vec3d& origin_m);
  void build_tree(const std::vector<double>& triangle_powers);

  EnvironmentSampler environment_;
  std::vector<EmissiveTriangle> triangles_;
  AliasTable triangle_choice_;
  LightTree tree_;                             // over all triangles and then the punctual lights, in their order
  std::vector<std::uint32_t> first_geometry_;  // index of each instance into first_emitter_
  std::vector<std::uint32_t> first_emitter_;
  std::vector<std::uint32_t> first_of_duplicates_;  // duplicate_emitters.hpp
  std::vector<PunctualLight> punctual_;
  std::vector<float> punctual_pdf_;  // selection probability of each, including that of the class
  AliasTable punctual_choice_;
  float environment_probability_ = 0;
  float triangle_probability_ = 0;
  float punctual_probability_ = 0;
};

}  // namespace gazetrace
