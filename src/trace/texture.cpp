// SPDX-License-Identifier: Apache-2.0
#include "trace/texture.hpp"

#include <algorithm>

namespace gazetrace {
namespace {

// IEC 61966-2-1, exact for the 256 codes.
std::array<float, 256> srgb_table() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double c = static_cast<double>(i) / 255.0;
    table[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return table;
}

int wrap_texel(int i, int size, TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::clamp:
      return std::clamp(i, 0, size - 1);
    case TextureWrap::mirror: {
      const int m = ((i % (2 * size)) + 2 * size) % (2 * size);
      return m < size ? m : 2 * size - 1 - m;
    }
    case TextureWrap::repeat:
      break;
  }
  const int m = i % size;
  return m < 0 ? m + size : m;
}

bool same_coordinates(const TextureRef& a, const TextureRef& b) {
  return a.uv_set == b.uv_set && a.has_transform == b.has_transform && (!a.has_transform || a.transform == b.transform);
}

}  // namespace

Vec4f read_texture(const Texture& texture, float u, float v, float level) {
  static const std::array<float, 256> kLinear = srgb_table();
  const auto last = static_cast<float>(texture.levels.size() - 1);
  const auto index = static_cast<std::size_t>(std::clamp(level, 0.0F, last));
  const Texture::Level& image = texture.levels[index];
  const auto texel = [&](int x, int y) -> Vec4f {
    const auto i = 4 * (static_cast<std::size_t>(wrap_texel(y, image.height_px, texture.wrap_v)) *
                            static_cast<std::size_t>(image.width_px) +
                        static_cast<std::size_t>(wrap_texel(x, image.width_px, texture.wrap_u)));
    const std::uint8_t* p = image.rgba.data() + i;
    const float alpha = static_cast<float>(p[3]) * (1.0F / 255.0F);
    if (texture.srgb) {
      return {kLinear[p[0]], kLinear[p[1]], kLinear[p[2]], alpha};
    }
    const float s = 1.0F / 255.0F;
    return {static_cast<float>(p[0]) * s, static_cast<float>(p[1]) * s, static_cast<float>(p[2]) * s, alpha};
  };
  // Beyond 2^20 tiles float has no digits left inside one; any texel is as good.
  const auto bounded = [](float c) { return std::fabs(c) < 1048576.0F ? c : 0.0F; };
  const float x = bounded(u) * static_cast<float>(image.width_px);
  const float y = bounded(v) * static_cast<float>(image.height_px);
  if (texture.nearest) {
    return texel(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
  }
  const float x0 = std::floor(x - 0.5F);
  const float y0 = std::floor(y - 0.5F);
  const float fx = x - 0.5F - x0;
  const float fy = y - 0.5F - y0;
  const int ix = static_cast<int>(x0);
  const int iy = static_cast<int>(y0);
  const Vec4f a = texel(ix, iy);
  const Vec4f b = texel(ix + 1, iy);
  const Vec4f c = texel(ix, iy + 1);
  const Vec4f d = texel(ix + 1, iy + 1);
  const auto blend = [&](float p, float q, float r, float s) {
    const float top = p + fx * (q - p);
    const float bottom = r + fx * (s - r);
    return top + fy * (bottom - top);
  };
  return {blend(a.x, b.x, c.x, d.x), blend(a.y, b.y, c.y, d.y), blend(a.z, b.z, c.z, d.z), blend(a.w, b.w, c.w, d.w)};
}

const TextureRef* shared_coordinates(const Material& material) {
  for (const TextureRef* ref : {&material.base_color_texture, &material.metallic_roughness_texture,
                                &material.normal_texture, &material.emissive_texture}) {
    if (ref->present()) {
      return ref;
    }
  }
  return nullptr;
}

std::vector<ShadingMaterial> make_materials(const Scene& scene) {
  std::vector<ShadingMaterial> result;
  result.reserve(scene.materials.size());
  for (const Material& source : scene.materials) {
    ShadingMaterial m;
    m.base_color = source.base_color;
    m.metallic = source.metallic;
    m.roughness = source.roughness;
    m.emission = source.emission;
    m.emissive = source.emission.x > 0 || source.emission.y > 0 || source.emission.z > 0;
    m.normal_scale = source.normal_scale;
    m.alpha_cutoff = source.alpha_cutoff;
    m.alpha_mode = source.alpha_mode;
    m.double_sided = source.double_sided;
    m.unlit = source.unlit;
    const TextureRef* shared = shared_coordinates(source);
    const auto bind = [&](const TextureRef& ref) {
      ShadingTexture texture;
      if (!ref.present()) {
        return texture;
      }
      const Texture& image = scene.textures[static_cast<std::size_t>(ref.texture)];
      if (image.levels.empty() || image.levels[0].rgba.empty()) {
        return texture;
      }
      texture.texture = &image;
      texture.half_log2_texels = 0.5F * std::log2(static_cast<float>(image.levels[0].width_px) *
                                                  static_cast<float>(image.levels[0].height_px));
      texture.own_uv = !same_coordinates(ref, *shared);
      texture.uv_set = ref.uv_set;
      if (ref.has_transform) {
        texture.transform = ref.transform;
      }
      return texture;
    };
    m.base = bind(source.base_color_texture);
    m.metal_rough = bind(source.metallic_roughness_texture);
    m.normal = bind(source.normal_texture);
    m.emit = bind(source.emissive_texture);
    result.push_back(m);
  }
  return result;
}

}  // namespace gazetrace
