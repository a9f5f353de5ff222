// SPDX-License-Identifier: Apache-2.0
// Textures that are read together, against the definition of bilinear reading worked out in double for each alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/hash.hpp"
#include "gazetrace/scene.hpp"
#include "trace/scene/texture.hpp"

namespace gazetrace::texel_group_test {
namespace {

Texture noise(int width, int height, std::uint32_t seed, TextureWrap wrap) {
  Texture texture;
  texture.wrap_u = wrap;
  texture.wrap_v = wrap;
  for (int w = width, h = height;; w = std::max(1, w / 2), h = std::max(1, h / 2)) {
    Texture::Level& level = texture.levels.emplace_back();
    level.width_px = w;
    level.height_px = h;
    for (int i = 0; i < 4 * w * h; ++i) {
      level.rgba.push_back(static_cast<std::uint8_t>(hash32(++seed)));
    }
    if (w == 1 && h == 1) {
      return texture;
    }
  }
}

int wrapped(int i, int size, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) {
    return std::clamp(i, 0, size - 1);
  }
  const int period = wrap == TextureWrap::mirror ? 2 * size : size;
  const int k = ((i % period) + period) % period;
  return k < size ? k : period - 1 - k;
}

double channel_at(const Texture& texture, std::size_t level, double u, double v, std::size_t channel) {
  const Texture::Level& image = texture.levels[level];
  const double x = u * image.width_px - 0.5;
  const double y = v * image.height_px - 0.5;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  double sum = 0;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const double weight = (i == 1 ? x - x0 : 1 - (x - x0)) * (j == 1 ? y - y0 : 1 - (y - y0));
      const int column = wrapped(x0 + i, image.width_px, texture.wrap_u);
      const int row = wrapped(y0 + j, image.height_px, texture.wrap_v);
      sum += weight * image.rgba[static_cast<std::size_t>(4 * (row * image.width_px + column)) + channel] / 255.0;
    }
  }
  return sum;
}

// Three at once, in pairs, and one apart.
TEST(TexelGroup, ReadsWhatEachTextureHolds) {
  for (const TextureWrap wrap : {TextureWrap::repeat, TextureWrap::clamp, TextureWrap::mirror}) {
    for (const auto& [width, height] : {std::array{1, 1}, {7, 5}, {1, 13}, {256, 64}, {16384, 3}}) {
      for (unsigned present = 1; present < 8; ++present) {
        Scene scene;
        Material& material = scene.materials.emplace_back();
        const std::array refs{&material.base_color_texture, &material.metallic_roughness_texture,
                              &material.normal_texture};
        for (unsigned m = 0; m < 3; ++m) {
          scene.textures.push_back(noise(width, height, 7919 * m, wrap));
          refs[m]->texture = (present >> m & 1U) != 0 ? static_cast<int>(m) : -1;
        }
        const std::vector<ShadingMaterial> shading = make_materials(scene);
        ASSERT_EQ(shading.at(0).group_count, 1) << present;
        const TexelGroup& group = shading[0].groups[0];
        for (std::uint32_t i = 0; i < 200; ++i) {
          const float u = 3 * static_cast<float>(hash32(2 * i) >> 8U) * 0x1p-24F - 1;
          const float v = 3 * static_cast<float>(hash32(2 * i + 1) >> 8U) * 0x1p-24F - 1;
          const std::size_t level = i % group.levels.size();
          TexelValues values;
          read_group(group, u, v, static_cast<float>(level), values);
          const auto expect = [&](unsigned m, std::size_t channel, float value, double absent) {
            const double expected =
                (present >> m & 1U) != 0 ? channel_at(scene.textures[m], level, u, v, channel) : absent;
            // A float coordinate of 16384 texels has 9 bits left within one.
            EXPECT_NEAR(value, expected, width > 1000 ? 0x1p-8 : 1e-4)
                << "texture " << m << " of " << present << ", " << width << " x " << height << ", level " << level
                << ", at " << u << ", " << v;
          };
          expect(0, 0, values.base.x, 1);
          expect(0, 1, values.base.y, 1);
          expect(0, 2, values.base.z, 1);
          expect(1, 1, values.roughness, 1);
          expect(1, 2, values.metallic, 1);
          expect(2, 0, values.normal.x, 0.5);
          expect(2, 1, values.normal.y, 0.5);
          expect(2, 2, values.normal.z, 1);
        }
      }
    }
  }
}

// Beside each other in one material: another size, another wrapping.
TEST(TexelGroup, UnlikeTexturesAreReadApart) {
  Scene scene;
  scene.textures.push_back(noise(8, 8, 1, TextureWrap::repeat));
  scene.textures.push_back(noise(8, 4, 2, TextureWrap::repeat));
  scene.textures.push_back(noise(8, 8, 3, TextureWrap::clamp));
  Material& material = scene.materials.emplace_back();
  material.base_color_texture.texture = 0;
  material.metallic_roughness_texture.texture = 1;
  material.normal_texture.texture = 2;
  const std::vector<ShadingMaterial> shading = make_materials(scene);
  ASSERT_EQ(shading.at(0).group_count, 3);
  TexelValues values;
  for (const TexelGroup& group : shading[0].groups) {
    read_group(group, 1.3F, 0.4F, 0, values);
  }
  EXPECT_NEAR(values.base.x, channel_at(scene.textures[0], 0, 1.3, 0.4, 0), 1e-4);
  EXPECT_NEAR(values.roughness, channel_at(scene.textures[1], 0, 1.3, 0.4, 1), 1e-4);
  EXPECT_NEAR(values.normal.z, channel_at(scene.textures[2], 0, 1.3, 0.4, 2), 1e-4);
}

}  // namespace
}  // namespace gazetrace::texel_group_test
