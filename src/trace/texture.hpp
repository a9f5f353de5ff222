// SPDX-License-Identifier: Apache-2.0
// Materials as the inner loops read them, and texture reads.
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
  bool own_uv = false;         // not the triangle's stored coordinates: read TriangleExtra and transform
  std::uint8_t uv_set = 0;
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};
};

struct ShadingMaterial {
  Vec4f base_color{1, 1, 1, 1};
  float metallic = 1, roughness = 1;
  Vec3f emission;
  float normal_scale = 1;
  float alpha_cutoff = 0.5F;
  AlphaMode alpha_mode = AlphaMode::opaque;
  bool double_sided = false, unlit = false, emissive = false, vertex_color = false;
  ShadingTexture base, metal_rough, normal, emit;
};

// The texture whose coordinates ShadingTriangle stores; nullptr without textures.
const TextureRef* shared_coordinates(const Material& material);

std::vector<ShadingMaterial> make_materials(const Scene& scene);

// Channels 0..1; RGB of sRGB textures are linearised per texel, before interpolation.
Vec4f read_texture(const Texture& texture, float u, float v, float level);

}  // namespace gazetrace
