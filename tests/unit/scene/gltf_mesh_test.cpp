// SPDX-License-Identifier: Apache-2.0
// Geometry out of hand-made files. Expected values are written out from the glTF 2.0 specification.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "gazetrace/scene.hpp"
#include "support/gltf_builder.hpp"
#include "support/png_bytes.hpp"

namespace gazetrace::gltf_mesh_test {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Scene load(GltfBuilder& builder) {
  const test::TempFolder folder;
  return load_scene(folder.write("scene.gltf", builder.text()));
}

const Geometry& only_geometry(const Scene& scene) {
  EXPECT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes.at(0).geometries.size(), 1U);
  return scene.meshes.at(0).geometries.at(0);
}

void expect_near(const Vec3f& a, const Vec3f& b, float tolerance = 1e-6F) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// Six vertices on a zigzag: a strip over them has four triangles that all face +z.
const std::vector<float> kZigzag{0, 0, 0, 0, -1, 0, 1, 0, 0, 1, -1, 0, 2, 0, 0, 2, -1, 0};
const std::vector<float> kUp{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};

TEST(Primitives, ModesAssembleTheSpecifiedTriangles) {
  struct Case {
    int mode;
    bool indexed;
    Triangles expected;
  };
  for (const Case& c : {Case{4, false, {{0, 1, 2}, {3, 4, 5}}}, Case{4, true, {{5, 4, 3}, {2, 1, 0}}},
                        Case{5, false, {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}}},
                        Case{5, true, {{5, 4, 3}, {4, 2, 3}, {3, 2, 1}, {2, 0, 1}}},
                        Case{6, false, {{1, 2, 0}, {2, 3, 0}, {3, 4, 0}, {4, 5, 0}}},
                        Case{6, true, {{4, 3, 5}, {3, 2, 5}, {2, 1, 5}, {1, 0, 5}}}}) {
    GltfBuilder builder;
    json primitive{{"mode", c.mode},
                   {"attributes", {{"POSITION", builder.add(kZigzag, 3)}, {"NORMAL", builder.add(kUp, 3)}}}};
    if (c.indexed) {
      primitive["indices"] = builder.add<std::uint16_t>({5, 4, 3, 2, 1, 0}, 1);
    }
    builder.add_node({{"mesh", builder.add_mesh(primitive)}});
    EXPECT_EQ(only_geometry(load(builder)).triangles, c.expected) << "mode " << c.mode << " indexed " << c.indexed;
  }
}

TEST(Primitives, EveryIndexTypeIsRead) {
  const auto check = [](auto zero) {
    using Index = decltype(zero);
    GltfBuilder builder;
    const json primitive{{"attributes", {{"POSITION", builder.add(kZigzag, 3)}, {"NORMAL", builder.add(kUp, 3)}}},
                         {"indices", builder.add<Index>({0, 1, 2, 2, 3, 5}, 1)}};
    builder.add_node({{"mesh", builder.add_mesh(primitive)}});
    EXPECT_EQ(only_geometry(load(builder)).triangles, (Triangles{{0, 1, 2}, {2, 3, 5}}));
  };
  check(std::uint8_t{});
  check(std::uint16_t{});
  check(std::uint32_t{});
}

TEST(Primitives, PointsAndLinesAreListedAsIgnored) {
  for (const int mode : {0, 1, 2, 3}) {
    GltfBuilder builder;
    builder.add_triangle({{"mode", mode}});
    const Scene scene = load(builder);
    EXPECT_TRUE(scene.meshes.at(0).geometries.empty());
    EXPECT_TRUE(scene.instances.empty());
    ASSERT_EQ(scene.ignored.size(), 1U);
    EXPECT_NE(scene.ignored[0].find(mode == 0 ? "points" : "lines"), std::string::npos);
  }
}

TEST(Accessors, ColorsOutsideTheirRangeAreClampedWithAWarning) {
  GltfBuilder builder;
  builder.add_triangle({{"attributes", {{"COLOR_0", builder.add<float>({2, 0.5, -1, 1, 0, 1, 0, 3, 0, 0, 0, 0}, 4)}}}});
  const Scene scene = load(builder);
  EXPECT_EQ(only_geometry(scene).colors.at(0), (Vec4f{1, 0.5F, 0, 1}));
  EXPECT_EQ(only_geometry(scene).colors.at(1), (Vec4f{0, 1, 0, 1}));
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_NE(scene.warnings[0].find("colours of 2 vertices are outside 0..1"), std::string::npos) << scene.warnings[0];
}

TEST(Accessors, NormalizedIntegersFollowTheSpecification) {
  GltfBuilder builder;
  // unsigned: c / max; signed: max(c / max, -1)
  json primitive{
      {"attributes", {{"COLOR_0", builder.add<std::uint8_t>({0, 51, 255, 255, 0, 0, 0, 102, 9, 9, 9, 255}, 4, true)}}}};
  builder.add_triangle(primitive);
  const Scene bytes = load(builder);
  EXPECT_NEAR(only_geometry(bytes).colors.at(0).y, 0.2F, 1e-7F);
  EXPECT_FLOAT_EQ(only_geometry(bytes).colors.at(0).z, 1.0F);
  EXPECT_NEAR(only_geometry(bytes).colors.at(1).w, 0.4F, 1e-7F);

  GltfBuilder shorts;
  primitive["attributes"] = {{"COLOR_0", shorts.add<std::uint16_t>({0, 65535, 13107, 0, 0, 0, 0, 0, 0}, 3, true)}};
  shorts.add_triangle(primitive);
  const Scene colors = load(shorts);
  EXPECT_FLOAT_EQ(only_geometry(colors).colors.at(0).y, 1.0F);
  EXPECT_NEAR(only_geometry(colors).colors.at(0).z, 0.2F, 1e-7F);
  EXPECT_FLOAT_EQ(only_geometry(colors).colors.at(0).w, 1.0F);  // of a VEC3

  GltfBuilder quantized;  // KHR_mesh_quantization: normalised bytes as normals, shorts as positions
  quantized.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  quantized.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  primitive["attributes"] = {{"POSITION", quantized.add<std::int16_t>({-32767, 100, -7, 0, 32767, 2, -32768, 0, 0}, 3)},
                             {"NORMAL", quantized.add<std::int8_t>({0, 0, 127, -128, 0, 0, 0, -127, 0}, 3, true)}};
  quantized.add_node({{"mesh", quantized.add_mesh(primitive)}});
  const Scene scene = load(quantized);
  expect_near(only_geometry(scene).positions.at(0), {-32767, 100, -7});
  expect_near(only_geometry(scene).positions.at(2), {-32768, 0, 0});
  expect_near(only_geometry(scene).normals.at(1), {-1, 0, 0});
  expect_near(only_geometry(scene).normals.at(2), {0, -1, 0});
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Accessors, NormalizedPositionsAndUnsignedShortsDequantize) {
  GltfBuilder builder;
  json primitive{
      {"attributes", {{"POSITION", builder.add<std::int16_t>({32767, 0, 0, 0, -32768, 0, 0, 0, 16384}, 3, true)}}}};
  builder.add_node({{"mesh", builder.add_mesh(primitive)}});
  const Scene scene = load(builder);
  expect_near(only_geometry(scene).positions.at(0), {1, 0, 0});
  expect_near(only_geometry(scene).positions.at(1), {0, -1, 0});
  expect_near(only_geometry(scene).positions.at(2), {0, 0, 16384.0F / 32767.0F});
}

TEST(Accessors, InterleavedAttributesAreReadByStride) {
  GltfBuilder builder;
  const int interleaved = builder.add<float>({0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0, 9}, 4);
  auto& accessor = builder.json["accessors"][static_cast<std::size_t>(interleaved)];
  accessor["type"] = "VEC3";
  builder.json["bufferViews"][0]["byteStride"] = 16;
  builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", interleaved}}}})}});
  const Scene scene = load(builder);
  expect_near(only_geometry(scene).positions.at(1), {1, 0, 0});
  expect_near(only_geometry(scene).positions.at(2), {0, 1, 0});
}

TEST(Accessors, SparseElementsReplaceTheirBase) {
  for (const bool with_base : {true, false}) {
    GltfBuilder builder;
    const int position = builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    const int indices = builder.add<std::uint8_t>({1, 2}, 1);
    const int values = builder.add<float>({5, 6, 7, 8, 9, 10}, 3);
    auto& accessor = builder.json["accessors"][static_cast<std::size_t>(position)];
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                          {"values", {{"bufferView", values}}}};
    if (!with_base) {
      accessor.erase("bufferView");
    }
    builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", position}}}})}});
    const Scene scene = load(builder);
    expect_near(only_geometry(scene).positions.at(0), {0, 0, 0});
    expect_near(only_geometry(scene).positions.at(1), {5, 6, 7});
    expect_near(only_geometry(scene).positions.at(2), {8, 9, 10});
  }
}

TEST(Normals, AreFlatWhereTheFileHasNone) {
  GltfBuilder builder;  // two triangles at a right angle that share an edge
  json primitive{{"attributes", {{"POSITION", builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1}, 3)}}},
                 {"indices", builder.add<std::uint16_t>({0, 1, 2, 0, 3, 1}, 1)}};
  builder.add_node({{"mesh", builder.add_mesh(primitive)}});
  const Scene scene = load(builder);
  const Geometry& geometry = only_geometry(scene);
  ASSERT_EQ(geometry.positions.size(), 6U);  // not shared any more
  EXPECT_EQ(geometry.triangles, (Triangles{{0, 1, 2}, {3, 4, 5}}));
  for (const std::size_t i : {0U, 1U, 2U}) {
    expect_near(geometry.normals.at(i), {0, 0, 1});
  }
  for (const std::size_t i : {3U, 4U, 5U}) {
    expect_near(geometry.normals.at(i), {0, -1, 0});
  }
}

TEST(Normals, AreMadeUnitLengthAndZeroOnesReplaced) {
  GltfBuilder builder;
  builder.add_triangle({{"attributes", {{"NORMAL", builder.add<float>({0, 3, 4, 0, 0, 0, 0, 0, -1}, 3)}}}});
  const Scene scene = load(builder);
  expect_near(only_geometry(scene).normals.at(0), {0, 0.6F, 0.8F});
  expect_near(only_geometry(scene).normals.at(1), {0, 0, 1});  // the triangle's
  expect_near(only_geometry(scene).normals.at(2), {0, 0, -1});
}

// As one of length 0.
TEST(Normals, ThatAreNoNumbersAreReplacedWithAWarning) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    GltfBuilder builder;
    builder.add_triangle({{"attributes", {{"NORMAL", builder.add<float>({0, 3, 4, bad, 0, 1, 0, 0, -1}, 3)}}}});
    const Scene scene = load(builder);
    expect_near(only_geometry(scene).normals.at(0), {0, 0.6F, 0.8F});
    expect_near(only_geometry(scene).normals.at(1), {0, 0, 1});
    ASSERT_EQ(scene.warnings.size(), 1U);
    EXPECT_NE(scene.warnings[0].find("attributes.NORMAL: 1 elements are not finite"), std::string::npos);
  }
}

// A unit square facing +z with a normal map. `uv` of (0,0) (1,0) (1,1) (0,1), y up.
GltfBuilder normal_mapped_square(const std::vector<float>& uv, const json& texture_extension = json()) {
  GltfBuilder builder;
  const auto png = test::png_bytes(1, 1, test::PngColor::rgb, 8, {128, 128, 255});
  builder.json["images"] = {{{"bufferView", builder.add_view(png)}, {"mimeType", "image/png"}}};
  builder.json["textures"] = {{{"source", 0}}};
  json info{{"index", 0}};
  if (!texture_extension.is_null()) {
    info["extensions"] = {{"KHR_texture_transform", texture_extension}};
  }
  builder.json["materials"] = {{{"normalTexture", info}}};
  json primitive{{"material", 0},
                 {"attributes",
                  {{"POSITION", builder.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3)},
                   {"NORMAL", builder.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3)},
                   {"TEXCOORD_0", builder.add(uv, 2)}}},
                 {"indices", builder.add<std::uint16_t>({0, 1, 2, 0, 2, 3}, 1)}};
  builder.add_node({{"mesh", builder.add_mesh(primitive)}});
  return builder;
}

TEST(Tangents, PointAlongUWithTheBitangentUpInThePicture) {
  struct Case {
    const char* what;
    std::vector<float> uv;
    Vec4f expected;
  };
  // glTF: v grows downwards in the picture, green points up: bitangent = cross(n, t) * w is the way of falling v.
  for (const Case& c : {Case{"upright", {0, 1, 1, 1, 1, 0, 0, 0}, {1, 0, 0, 1}},
                        Case{"mirrored in u", {1, 1, 0, 1, 0, 0, 1, 0}, {-1, 0, 0, -1}},
                        Case{"upside down", {0, 0, 1, 0, 1, 1, 0, 1}, {1, 0, 0, -1}},
                        Case{"quarter turn", {1, 1, 1, 0, 0, 0, 0, 1}, {0, -1, 0, 1}}}) {
    GltfBuilder builder = normal_mapped_square(c.uv);
    const Scene scene = load(builder);
    const Geometry& geometry = only_geometry(scene);
    ASSERT_EQ(geometry.tangents.size(), geometry.positions.size()) << c.what;
    for (const Vec4f& tangent : geometry.tangents) {
      expect_near({tangent.x, tangent.y, tangent.z}, {c.expected.x, c.expected.y, c.expected.z});
      EXPECT_EQ(tangent.w, c.expected.w) << c.what;
    }
  }
}

TEST(Tangents, FollowTheTextureTransform) {
  GltfBuilder builder = normal_mapped_square({0, 1, 1, 1, 1, 0, 0, 0}, {{"rotation", kPi / 2}});
  const Scene scene = load(builder);
  // u' = v: grows downwards, which is -y.
  const Vec4f tangent = only_geometry(scene).tangents.at(0);
  expect_near({tangent.x, tangent.y, tangent.z}, {0, -1, 0});
}

TEST(Tangents, AMirrorSeamIsSplit) {
  // The two triangles share the diagonal; the second one's picture is mirrored about it.
  GltfBuilder builder = normal_mapped_square({0, 1, 1, 1, 1, 0, 1, 1});
  const Scene scene = load(builder);
  const Geometry& geometry = only_geometry(scene);
  EXPECT_EQ(geometry.positions.size(), 6U);
  for (std::size_t t = 0; t < 2; ++t) {
    for (const std::uint32_t vertex : geometry.triangles.at(t)) {
      EXPECT_EQ(geometry.tangents.at(vertex).w, t == 0 ? 1.0F : -1.0F);
      EXPECT_EQ(geometry.normals.at(vertex), (Vec3f{0, 0, 1}));
    }
  }
}

TEST(Tangents, WithoutUvAreaAnyPerpendicularServes) {
  GltfBuilder builder = normal_mapped_square({0, 0, 0, 0, 0, 0, 0, 0});
  const Scene scene = load(builder);
  for (const Vec4f& t : only_geometry(scene).tangents) {
    EXPECT_NEAR(t.z, 0, 1e-6F);
    EXPECT_NEAR(t.x * t.x + t.y * t.y, 1, 1e-6F);
  }
}

TEST(Tangents, AreNotKeptWhereNothingReadsThem) {
  GltfBuilder builder;
  builder.add_triangle({{"attributes",
                         {{"NORMAL", builder.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3)},
                          {"TANGENT", builder.add<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, 4)},
                          {"TEXCOORD_0", builder.add<float>({0, 0, 1, 0, 0, 1}, 2)}}}});
  const Scene scene = load(builder);
  EXPECT_TRUE(only_geometry(scene).tangents.empty());
  EXPECT_TRUE(only_geometry(scene).uv0.empty());
}

}  // namespace
}  // namespace gazetrace::gltf_mesh_test
