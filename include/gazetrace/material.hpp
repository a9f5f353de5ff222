// SPDX-License-Identifier: Apache-2.0
// Surface description as glTF 2.0 states it: plain data, no evaluation.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "gazetrace/math.hpp"

namespace gazetrace {

// Shape of the diffuse lobe; both are balanced so that a white surface loses no light.
// matte: every surface is the ideal Lambertian one, base colour / pi, without any specular lobe; for closed forms and
// for comparison with renderers that have nothing else.
enum class DiffuseModel : std::uint8_t { burley, lambert, matte };

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

// A texture with the coordinates it is read at: uv' = (a u + b v + tx, c u + d v + ty) (KHR_texture_transform).
struct TextureRef {
  std::int32_t texture = -1;  // index into Scene::textures; -1: none
  std::uint8_t uv_set = 0;    // 0 or 1
  bool has_transform = false;
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};  // a, b, tx, c, d, ty

  [[nodiscard]] bool present() const { return texture >= 0; }
  friend bool operator==(const TextureRef&, const TextureRef&) = default;
};

// glTF 2.0 section 3.9, metallic-roughness; factors multiply what the textures hold.
struct Material {
  std::string name;
  Vec4f base_color{1, 1, 1, 1};  // linear Rec.709, alpha last
  float metallic = 1.0F;         // 0..1, texture channel B
  float roughness = 1.0F;        // 0..1, perceptual: alpha = roughness^2; texture channel G
  Vec3f emission{0, 0, 0};       // emissiveFactor * KHR_materials_emissive_strength, radiance
  float normal_scale = 1.0F;
  AlphaMode alpha_mode = AlphaMode::opaque;  // loading turns mask and blend into opaque where nothing is transparent
  float alpha_cutoff = 0.5F;
  bool double_sided = false;
  bool unlit = false;  // KHR_materials_unlit: base colour is the outgoing radiance

  TextureRef base_color_texture;          // sRGB
  TextureRef metallic_roughness_texture;  // linear
  TextureRef normal_texture;              // linear, tangent space
  TextureRef emissive_texture;            // sRGB
};

}  // namespace gazetrace
