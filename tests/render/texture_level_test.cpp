// SPDX-License-Identifier: Apache-2.0
// Which level of a texture a first hit reads, for coordinates of its own and shared ones: textures whose levels have a
// value each, against the pixel's footprint in texels.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "gazetrace/guides.hpp"
#include "render/tracer_scenes.hpp"

namespace gazetrace::texture_level_test {
namespace {

using namespace test;

constexpr int kFrame = 64;
constexpr int kStep = 20;  // a level is so much brighter than the one before, of 255

Texture dial() {
  Texture texture;
  for (int size = 256; size > 0; size /= 2) {
    const auto value = static_cast<std::uint8_t>(kStep * static_cast<int>(texture.levels.size()));
    texture.levels.push_back({size, size, {}});
    texture.levels.back().rgba.assign(static_cast<std::size_t>(4 * size * size), value);
  }
  return texture;
}

// A square of 2 x 2 m, 2 m away and seen straight on. At this angle of view a pixel is 2^2.5 texels wide there.
Guides seen(const Material& material, float uv1_scale) {
  Scene scene;
  scene.textures = {dial()};
  scene.materials = {material};
  Geometry square = quad({{{-1, -1, -2}, {1, -1, -2}, {1, 1, -2}, {-1, 1, -2}}}, 0);
  for (const Vec2f& uv : square.uv0) {
    square.uv1.push_back({uv1_scale * uv.x, uv1_scale * uv.y});
  }
  add_mesh(scene, {square});
  const double yfov_deg = 2 * std::atan(std::sqrt(0.5)) * kDegPerRad;
  GuideSettings settings;
  settings.diffuse = DiffuseModel::matte;
  return PathTracer(scene, threads(1))
      .at_rest()
      .guides(camera_at({0, 0, 0}, {0, 0, -1}, yfov_deg), kFrame, kFrame, settings);
}

int level_of(float value) {
  return static_cast<int>(std::lround(value * 255 / kStep));
}

TextureRef tiled(float u, float v, std::uint8_t uv_set = 0) {
  TextureRef ref;
  ref.texture = 0;
  ref.uv_set = uv_set;
  ref.has_transform = true;
  ref.transform = {u, 0, 0, 0, v, 0};
  return ref;
}

TEST(TextureLevel, FollowsTheCoordinatesOfEachTexture) {
  TextureRef plain;
  plain.texture = 0;
  TextureRef second = plain;
  second.uv_set = 1;
  TextureRef turned = tiled(1, 1);
  turned.transform = {0, -8, 0, 2, 0, 0};
  struct Case {
    std::string name;
    TextureRef base, emission;
    int base_level, emission_level;
  };
  for (const Case& c : std::array<Case, 7>{{
           {"emission alone", {}, plain, 0, 2},
           {"one for both", plain, plain, 2, 2},
           {"tiled base", tiled(8, 8), plain, 5, 2},
           {"tiled emission", plain, tiled(8, 8), 2, 5},
           {"tiled and turned emission", plain, turned, 2, 4},
           {"second set, which is four times as dense", plain, second, 2, 4},
           {"tiled second set under a tiled base", tiled(4, 4), tiled(0.5F, 0.5F, 1), 4, 3},
       }}) {
    Material material = diffuse_material({1, 1, 1}, {1, 1, 1});
    material.base_color_texture = c.base;
    material.emissive_texture = c.emission;
    const Guides guides = seen(material, 4);
    for (const int x : {30, 33}) {
      for (const int y : {30, 33}) {
        EXPECT_EQ(level_of(guides.emission(x, y).x), c.emission_level) << c.name;
        if (c.base.present()) {
          EXPECT_EQ(level_of(guides.albedo(x, y).x), c.base_level) << c.name;
        }
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::texture_level_test
