// SPDX-License-Identifier: Apache-2.0
// Materials in the form that the inner loops read, and texture reads.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gazetrace/scene.hpp"

namespace gazetrace {

struct ShadingTexture {
  const Texture* texture = nullptr;
  float half_log2_texels = 0;  // 0.5 log2(width * height) of level 0
  bool own_uv = false;         // its coordinates are not those stored in the triangle, but come from TriangleExtra
  std::uint8_t uv_set = 0;
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};
};

// Textures of one material that share size, wrapping and coordinates, so that a position is computed once and read in
// each.
struct TexelGroup {
  struct Level {
    std::array<const std::uint8_t*, 3> texels{};  // base colour; roughness and metalness; normals; 4 bytes per texel
    int width_px = 1, height_px = 1;
  };
  std::vector<Level> levels;
  float last_level = 0;
  bool base = false, metal_rough = false, normal = false;
  bool srgb = false;  // of the base colour
  bool deep = false;  // a single texture with two bytes per channel
  bool nearest = false;
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  ShadingTexture coordinates;
};

struct TexelValues {
  Vec3f base{1, 1, 1};
  float roughness = 1, metallic = 1;
  Vec3f normal{0.5F, 0.5F, 1};
};

// Sets those values of `out` whose textures are in the group.
void read_group(const TexelGroup& group, float u, float v, float level, TexelValues& out);

struct ShadingMaterial {
  Vec4f base_color{1, 1, 1, 1};
  float metallic = 1, roughness = 1;
  Vec3f emission;
  float normal_scale = 1;
  float alpha_cutoff = 0.5F;
  AlphaMode alpha_mode = AlphaMode::opaque;
  bool double_sided = false, unlit = false, emissive = false;
  bool any_own_uv = false;
  std::uint8_t group_count = 0;
  std::array<TexelGroup, 3> groups;
  ShadingTexture base, metal_rough, normal, emit;
};

// The texture whose coordinates ShadingTriangle stores; nullptr without textures.
const TextureRef* shared_coordinates(const Material& material);

// The result keeps pointers into the scene's texels.
std::vector<ShadingMaterial> make_materials(const Scene& scene);

// Channels are 0..1; RGB of sRGB textures is linearised per texel, before interpolation.
Vec4f read_texture(const Texture& texture, float u, float v, float level);
float read_alpha(const Texture& texture, float u, float v);  // from level 0

}  // namespace gazetrace
