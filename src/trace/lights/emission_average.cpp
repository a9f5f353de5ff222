// SPDX-License-Identifier: Apache-2.0
#include "trace/lights/emission_average.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/srgb.hpp"
#include "scene/texel.hpp"

namespace gazetrace {
namespace {

constexpr int kTexelsAcross = 8;

double decode(std::uint8_t byte, bool srgb) {
  const double x = byte / 255.0;
  return srgb ? light_of_srgb(x) : x;
}

int wrap(long long i, int size, TextureWrap mode) {
  switch (mode) {
    case TextureWrap::clamp:
      return static_cast<int>(std::clamp<long long>(i, 0, size - 1));
    case TextureWrap::mirror: {
      const long long period = 2LL * size;
      const long long at = ((i % period) + period) % period;
      return static_cast<int>(at < size ? at : period - 1 - at);
    }
    case TextureWrap::repeat:
      break;
  }
  return static_cast<int>(((i % size) + size) % size);
}

}  // namespace

Vec3d average_emission(const Scene& scene, const Material& material, const Geometry& geometry, std::size_t triangle) {
  const Vec3d factor = to_double(material.emission);
  const TextureRef& ref = material.emissive_texture;
  if (!ref.present()) {
    return factor;
  }
  const Texture& texture = scene.textures[static_cast<std::size_t>(ref.texture)];
  const std::vector<Vec2f>& coordinates = ref.uv_set == 1 ? geometry.uv1 : geometry.uv0;
  double u_min = 1e30;
  double u_max = -1e30;
  double v_min = 1e30;
  double v_max = -1e30;
  for (const std::uint32_t vertex : geometry.triangles[triangle]) {
    const Vec2f uv = coordinates.empty() ? Vec2f{} : coordinates[vertex];
    const auto& m = ref.transform;
    const double u = ref.has_transform ? m[0] * uv.x + m[1] * uv.y + m[2] : uv.x;
    const double v = ref.has_transform ? m[3] * uv.x + m[4] * uv.y + m[5] : uv.y;
    u_min = std::min(u_min, u);
    u_max = std::max(u_max, u);
    v_min = std::min(v_min, v);
    v_max = std::max(v_max, v);
  }
  if (texture.levels.empty() || !(std::fabs(u_min) < 1e6 && std::fabs(u_max) < 1e6) ||
      !(std::fabs(v_min) < 1e6 && std::fabs(v_max) < 1e6)) {
    return factor;
  }
  std::size_t level = 0;
  while (level + 1 < texture.levels.size() &&
         std::max((u_max - u_min) * texture.levels[level].width_px, (v_max - v_min) * texture.levels[level].height_px) >
             kTexelsAcross) {
    ++level;
  }
  const Texture::Level& texels = texture.levels[level];
  // Limited also where the coarsest level repeats more often than that.
  const auto span = [](double low, double high, int size) {
    const auto first = static_cast<long long>(std::floor(low * size - 0.5));
    const auto last = static_cast<long long>(std::floor(high * size + 0.5));
    return std::array<long long, 2>{first, std::min(last, first + 2 * kTexelsAcross)};
  };
  const auto [x_first, x_last] = span(u_min, u_max, texels.width_px);
  const auto [y_first, y_last] = span(v_min, v_max, texels.height_px);
  Vec3d sum;
  for (long long y = y_first; y <= y_last; ++y) {
    for (long long x = x_first; x <= x_last; ++x) {
      const auto column = static_cast<std::size_t>(wrap(x, texels.width_px, texture.wrap_u));
      const auto row = static_cast<std::size_t>(wrap(y, texels.height_px, texture.wrap_v));
      const std::size_t texel = row * static_cast<std::size_t>(texels.width_px) + column;
      const std::uint8_t* rgba = &texels.rgba[texel_bytes(texture.format) * texel];
      if (texture.format != TexelFormat::unorm8) {
        const Vec4f c = deep_texel(rgba, texture.format);
        sum += {c.x, c.y, c.z};
        continue;
      }
      sum += {decode(rgba[0], texture.srgb), decode(rgba[1], texture.srgb), decode(rgba[2], texture.srgb)};
    }
  }
  return factor * sum / static_cast<double>((x_last - x_first + 1) * (y_last - y_first + 1));
}

}  // namespace gazetrace
