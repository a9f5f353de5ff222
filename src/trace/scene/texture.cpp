// SPDX-License-Identifier: Apache-2.0
#include "trace/scene/texture.hpp"

#include <algorithm>
#include <utility>

#include "core/instruction_sets.hpp"
#include "core/srgb.hpp"
#include "scene/texel.hpp"

namespace gazetrace {
namespace {

// Exact for the 256 codes.
std::array<float, 256> srgb_table() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<float>(light_of_srgb(static_cast<double>(i) / 255.0));
  }
  return table;
}

bool same_coordinates(const TextureRef& a, const TextureRef& b) {
  return a.uv_set == b.uv_set && a.has_transform == b.has_transform && (!a.has_transform || a.transform == b.transform);
}

const std::array<float, 256> kSrgbToLinear = srgb_table();
const std::array<float, 256> kUnorm = [] {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<float>(static_cast<double>(i) / 255.0);
  }
  return table;
}();

struct Axis {
  int low, high;   // two neighbouring texels
  float fraction;  // weight of `high`
};

// Coordinates are first reduced to one period, so any finite one is possible.
inline Axis locate(float c, int size, TextureWrap wrap, bool nearest) {
  c = std::fabs(c) < 1e9F ? c : 0.0F;
  if (wrap == TextureWrap::repeat) {
    c -= std::floor(c);
  } else if (wrap == TextureWrap::clamp) {
    c = std::clamp(c, 0.0F, 1.0F);
  } else {
    c = std::fabs(c - 2.0F * std::floor(0.5F * c + 0.5F));  // a triangle wave of period 2
  }
  const float x = c * static_cast<float>(size) - (nearest ? 0.0F : 0.5F);
  const float whole = std::floor(x);
  int low = static_cast<int>(whole);
  int high = low + 1;
  if (wrap == TextureWrap::repeat) {
    low = low < 0 ? size - 1 : low;
    low = low >= size ? 0 : low;
    high = high >= size ? 0 : high;
  } else {
    low = std::clamp(low, 0, size - 1);
    high = std::clamp(high, 0, size - 1);
  }
  return {low, high, nearest ? 0.0F : x - whole};
}

// Formats with two bytes per channel are rare, so their textures are read one at a time.
[[gnu::noinline]] void read_deep_group(const TexelGroup& group, float u, float v, float level, TexelValues& out) {
  const Vec4f c = read_texture(*group.coordinates.texture, u, v, level);
  if (group.base) {
    out.base = {std::min(c.x, 1.0F), std::min(c.y, 1.0F), std::min(c.z, 1.0F)};  // since floats may exceed white
  } else if (group.metal_rough) {
    out.roughness = std::clamp(c.y, 0.0F, 1.0F);
    out.metallic = std::clamp(c.z, 0.0F, 1.0F);
  } else {
    out.normal = {c.x, c.y, c.z};
  }
}

}  // namespace

GAZETRACE_CLONES void read_group(const TexelGroup& group, float u, float v, float level, TexelValues& out) {
  if (group.deep) {
    read_deep_group(group, u, v, level, out);
    return;
  }
  const auto index = static_cast<std::size_t>(std::clamp(level, 0.0F, group.last_level));
  const TexelGroup::Level& image = group.levels[index];
  const Axis x = locate(u, image.width_px, group.wrap_u, group.nearest);
  const Axis y = locate(v, image.height_px, group.wrap_v, group.nearest);
  const auto pitch = 4 * static_cast<std::size_t>(image.width_px);
  const std::size_t low_row = static_cast<std::size_t>(y.low) * pitch;
  const std::size_t high_row = static_cast<std::size_t>(y.high) * pitch;
  const std::size_t a = low_row + 4 * static_cast<std::size_t>(x.low);
  const std::size_t b = low_row + 4 * static_cast<std::size_t>(x.high);
  const std::size_t c = high_row + 4 * static_cast<std::size_t>(x.low);
  const std::size_t d = high_row + 4 * static_cast<std::size_t>(x.high);
  const float wd = x.fraction * y.fraction;
  const float wb = x.fraction - wd;
  const float wc = y.fraction - wd;
  const float wa = 1.0F - x.fraction - wc;
  const auto blend = [&](const std::array<float, 256>& table, const std::uint8_t* texels) {
    return wa * table[texels[a]] + wb * table[texels[b]] + wc * table[texels[c]] + wd * table[texels[d]];
  };
  if (group.base) {
    const std::array<float, 256>& table = group.srgb ? kSrgbToLinear : kUnorm;
    const std::uint8_t* texels = image.texels[0];
    out.base = {blend(table, texels), blend(table, texels + 1), blend(table, texels + 2)};
  }
  if (group.metal_rough) {
    const std::uint8_t* texels = image.texels[1];
    out.roughness = blend(kUnorm, texels + 1);
    out.metallic = blend(kUnorm, texels + 2);
  }
  if (group.normal) {
    const std::uint8_t* texels = image.texels[2];
    out.normal = {blend(kUnorm, texels), blend(kUnorm, texels + 1), blend(kUnorm, texels + 2)};
  }
}

Vec4f read_texture(const Texture& texture, float u, float v, float level) {
  const auto last = static_cast<float>(texture.levels.size() - 1);
  const auto index = static_cast<std::size_t>(std::clamp(level, 0.0F, last));
  const Texture::Level& image = texture.levels[index];
  const auto texel = [&](int x, int y) -> Vec4f {
    const std::size_t i =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width_px) + static_cast<std::size_t>(x);
    const std::uint8_t* p = image.rgba.data() + i * texel_bytes(texture.format);
    if (texture.format != TexelFormat::unorm8) {
      return deep_texel(p, texture.format);
    }
    const float alpha = static_cast<float>(p[3]) * (1.0F / 255.0F);
    if (texture.srgb) {
      return {kSrgbToLinear[p[0]], kSrgbToLinear[p[1]], kSrgbToLinear[p[2]], alpha};
    }
    const float s = 1.0F / 255.0F;
    return {static_cast<float>(p[0]) * s, static_cast<float>(p[1]) * s, static_cast<float>(p[2]) * s, alpha};
  };
  const Axis x = locate(u, image.width_px, texture.wrap_u, texture.nearest);
  const Axis y = locate(v, image.height_px, texture.wrap_v, texture.nearest);
  const Vec4f a = texel(x.low, y.low);
  if (texture.nearest) {
    return a;
  }
  const Vec4f b = texel(x.high, y.low);
  const Vec4f c = texel(x.low, y.high);
  const Vec4f d = texel(x.high, y.high);
  const auto blend = [&](float p, float q, float r, float t) {
    const float top = p + x.fraction * (q - p);
    const float bottom = r + x.fraction * (t - r);
    return top + y.fraction * (bottom - top);
  };
  return {blend(a.x, b.x, c.x, d.x), blend(a.y, b.y, c.y, d.y), blend(a.z, b.z, c.z, d.z), blend(a.w, b.w, c.w, d.w)};
}

float read_alpha(const Texture& texture, float u, float v) {
  const Texture::Level& image = texture.levels[0];
  const Axis x = locate(u, image.width_px, texture.wrap_u, texture.nearest);
  const Axis y = locate(v, image.height_px, texture.wrap_v, texture.nearest);
  const auto texel = [&](int column, int row) {
    const std::size_t i =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width_px) + static_cast<std::size_t>(column);
    if (texture.format != TexelFormat::unorm8) {
      return deep_texel(&image.rgba[i * texel_bytes(texture.format)], texture.format).w * 255.0F;
    }
    return static_cast<float>(image.rgba[4 * i + 3]);
  };
  const float a = texel(x.low, y.low);
  if (texture.nearest) {
    return a * (1.0F / 255.0F);
  }
  const float top = a + x.fraction * (texel(x.high, y.low) - a);
  const float c = texel(x.low, y.high);
  const float bottom = c + x.fraction * (texel(x.high, y.high) - c);
  return (top + y.fraction * (bottom - top)) * (1.0F / 255.0F);
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

namespace {

bool alike(const ShadingTexture& a, const ShadingTexture& b) {
  const Texture& s = *a.texture;
  const Texture& t = *b.texture;
  if (a.own_uv != b.own_uv || a.uv_set != b.uv_set || a.transform != b.transform || s.nearest != t.nearest ||
      s.wrap_u != t.wrap_u || s.wrap_v != t.wrap_v || s.levels.size() != t.levels.size()) {
    return false;
  }
  for (std::size_t i = 0; i < s.levels.size(); ++i) {
    if (s.levels[i].width_px != t.levels[i].width_px || s.levels[i].height_px != t.levels[i].height_px) {
      return false;
    }
  }
  return true;
}

TexelGroup start_group(const ShadingTexture& texture) {
  TexelGroup group;
  group.coordinates = texture;
  group.last_level = static_cast<float>(texture.texture->levels.size() - 1);
  group.nearest = texture.texture->nearest;
  group.deep = texture.texture->format != TexelFormat::unorm8;
  group.wrap_u = texture.texture->wrap_u;
  group.wrap_v = texture.texture->wrap_v;
  return group;
}

std::vector<TexelGroup::Level> levels_of(const std::array<const Texture*, 3>& members, const Texture& any_member) {
  std::vector<TexelGroup::Level> levels(any_member.levels.size());
  for (std::size_t l = 0; l < levels.size(); ++l) {
    levels[l].width_px = any_member.levels[l].width_px;
    levels[l].height_px = any_member.levels[l].height_px;
    for (std::size_t m = 0; m < members.size(); ++m) {
      levels[l].texels[m] = members[m] != nullptr ? members[m]->levels[l].rgba.data() : nullptr;
    }
  }
  return levels;
}

void make_groups(ShadingMaterial& material) {
  const std::array<const ShadingTexture*, 3> textures{&material.base, &material.metal_rough, &material.normal};
  std::array<bool, 3> done{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (done[i] || textures[i]->texture == nullptr) {
      continue;
    }
    TexelGroup group = start_group(*textures[i]);
    std::array<const Texture*, 3> members{};
    for (std::size_t j = i; j < 3; ++j) {
      if (!done[j] && textures[j]->texture != nullptr &&
          (j == i ||
           (!group.deep && textures[j]->texture->format == TexelFormat::unorm8 && alike(*textures[i], *textures[j])))) {
        members[j] = textures[j]->texture;
        done[j] = true;
      }
    }
    group.base = members[0] != nullptr;
    group.metal_rough = members[1] != nullptr;
    group.normal = members[2] != nullptr;
    group.srgb = group.base && members[0]->srgb;
    group.levels = levels_of(members, *textures[i]->texture);
    material.any_own_uv = material.any_own_uv || textures[i]->own_uv;
    material.groups[material.group_count++] = std::move(group);
  }
}

}  // namespace

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
    make_groups(m);
    result.push_back(std::move(m));
  }
  return result;
}

}  // namespace gazetrace
