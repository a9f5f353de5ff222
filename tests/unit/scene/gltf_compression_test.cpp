// SPDX-License-Identifier: Apache-2.0
// Packed geometry: what meshoptimizer's and Draco's own encoders wrote comes back, and damaged streams are
// refused.
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "gazetrace/scene.hpp"
#include "scene/gltf/draco_claims.hpp"
#include "support/gltf_builder.hpp"

namespace gazetrace::gltf_compression_test {
namespace {

using nlohmann::json;
using test::error_of;
using test::GltfBuilder;
using ::testing::HasSubstr;
using ::testing::Not;
using Bytes = std::vector<std::uint8_t>;
using Triangle = std::array<std::uint32_t, 3>;

struct Source {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> uvs;
  std::vector<std::uint32_t> indices;
};

// A bumpy sheet: no two vertices alike, no symmetry that could hide a permutation.
Source sheet(int side) {
  Source source;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(side - 1);
      const float v = static_cast<float>(y) / static_cast<float>(side - 1);
      source.positions.push_back({7 * u, std::sin(9 * u + 4 * v), -3 * v});
      source.normals.push_back(normalize(Vec3f{-std::cos(9 * u), 1, std::sin(5 * v)}));
      source.uvs.push_back({u, v});
    }
  }
  for (int y = 0; y + 1 < side; ++y) {
    for (int x = 0; x + 1 < side; ++x) {
      const auto i = static_cast<std::uint32_t>(y * side + x);
      const auto s = static_cast<std::uint32_t>(side);
      for (const std::uint32_t corner : {i, i + s, i + 1, i + 1, i + s, i + s + 1}) {
        source.indices.push_back(corner);
      }
    }
  }
  return source;
}

// The smallest corner first, so that a triangle equals itself however a codec turned it.
Triangle turned(const Triangle& t) {
  const std::size_t first = static_cast<std::size_t>(std::min_element(t.begin(), t.end()) - t.begin());
  return {t[first], t[(first + 1) % 3], t[(first + 2) % 3]};
}
std::multiset<Triangle> triangles_of(const Source& source) {
  std::multiset<Triangle> result;
  for (std::size_t i = 0; i < source.indices.size(); i += 3) {
    result.insert(turned({source.indices[i], source.indices[i + 1], source.indices[i + 2]}));
  }
  return result;
}

// Either a scene or one line that names the file; `damaged` counts the latter.
void expect_scene_or_one_line(const std::string& path, int& refused) {
  try {
    static_cast<void>(load_scene(path));
  } catch (const Error& error) {
    ++refused;
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), HasSubstr(path));
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
  }
}

// --- EXT_meshopt_compression

struct Packed {  // NOLINT(bugprone-exception-escape): moving JSON
  Bytes bytes;
  json extension;
  int component_type = 0;
  const char* type = "";
  bool normalized = false;
};

template <class T>
Packed pack_attribute(const std::vector<T>& elements, int component_type, const char* type, const char* filter) {
  Packed packed;
  packed.bytes.resize(meshopt_encodeVertexBufferBound(elements.size(), sizeof(T)));
  packed.bytes.resize(meshopt_encodeVertexBuffer(packed.bytes.data(), packed.bytes.size(), elements.data(),
                                                 elements.size(), sizeof(T)));
  packed.extension = {{"mode", "ATTRIBUTES"}, {"count", elements.size()}, {"byteStride", sizeof(T)}};
  if (filter != nullptr) {
    packed.extension["filter"] = filter;
  }
  packed.component_type = component_type;
  packed.type = type;
  return packed;
}

Packed pack_indices(const Source& source, bool triangles) {
  Packed packed;
  const std::size_t count = source.indices.size();
  const std::size_t vertices = source.positions.size();
  packed.bytes.resize(triangles ? meshopt_encodeIndexBufferBound(count, vertices)
                                : meshopt_encodeIndexSequenceBound(count, vertices));
  packed.bytes.resize(
      triangles ? meshopt_encodeIndexBuffer(packed.bytes.data(), packed.bytes.size(), source.indices.data(), count)
                : meshopt_encodeIndexSequence(packed.bytes.data(), packed.bytes.size(), source.indices.data(), count));
  packed.extension = {{"mode", triangles ? "TRIANGLES" : "INDICES"}, {"count", count}, {"byteStride", 4}};
  packed.component_type = 5125;
  packed.type = "SCALAR";
  return packed;
}

// A triangle mesh of packed positions, normals and indices, unpacked into a fallback buffer without data.
GltfBuilder meshopt_file(const std::vector<Packed>& parts, const std::vector<const char*>& names) {
  GltfBuilder builder;
  json primitive;
  std::size_t plain_size = 0;
  json views = json::array();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::size_t raw = static_cast<std::size_t>(builder.add_view(parts[i].bytes));
    json extension = parts[i].extension;
    extension["buffer"] = 0;
    extension["byteOffset"] = builder.json["bufferViews"][raw]["byteOffset"];
    extension["byteLength"] = parts[i].bytes.size();
    const std::size_t size = extension["count"].get<std::size_t>() * extension["byteStride"].get<std::size_t>();
    views.push_back({{"buffer", 1},
                     {"byteOffset", plain_size},
                     {"byteLength", size},
                     {"extensions", {{"EXT_meshopt_compression", extension}}}});
    if (extension["mode"] == "ATTRIBUTES") {
      views.back()["byteStride"] = extension["byteStride"];
    }
    plain_size += size;
    builder.json["accessors"].push_back({{"bufferView", i},
                                         {"componentType", parts[i].component_type},
                                         {"normalized", parts[i].normalized},
                                         {"count", extension["count"]},
                                         {"type", parts[i].type}});
    if (std::string_view(names[i]) == "indices") {
      primitive["indices"] = i;
    } else {
      primitive["attributes"][names[i]] = i;
    }
  }
  builder.json["bufferViews"] = views;
  builder.json["buffers"][1] = {{"byteLength", plain_size},
                                {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}};
  builder.json["extensionsUsed"] = {"EXT_meshopt_compression"};
  builder.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  builder.add_node({{"mesh", builder.add_mesh(primitive)}});
  return builder;
}

struct PackedNormal {
  std::array<std::int8_t, 4> v;
};
struct PackedPosition {
  std::array<std::uint32_t, 3> v;
};

std::vector<PackedNormal> octahedral(const std::vector<Vec3f>& normals) {
  std::vector<float> four;
  for (const Vec3f& n : normals) {
    four.insert(four.end(), {n.x, n.y, n.z, 0});
  }
  std::vector<PackedNormal> packed(normals.size());
  meshopt_encodeFilterOct(packed.data(), packed.size(), sizeof(PackedNormal), 8, four.data());
  return packed;
}

GltfBuilder meshopt_sheet(const Source& source, bool triangles) {
  Packed normals = pack_attribute(octahedral(source.normals), 5120, "VEC3", "OCTAHEDRAL");
  normals.normalized = true;
  return meshopt_file(
      {pack_attribute(source.positions, 5126, "VEC3", nullptr), normals, pack_indices(source, triangles)},
      {"POSITION", "NORMAL", "indices"});
}

TEST(Meshopt, GivesBackWhatItsEncoderTook) {
  const test::TempFolder folder;
  const Source source = sheet(13);
  for (const bool triangles : {true, false}) {
    const Scene scene = load_scene(folder.write("scene.gltf", meshopt_sheet(source, triangles).text()));
    const Geometry& geometry = scene.meshes.at(0).geometries.at(0);
    ASSERT_EQ(geometry.positions, source.positions) << "attributes are kept to the bit";
    ASSERT_EQ(geometry.normals.size(), source.normals.size());
    for (std::size_t i = 0; i < source.normals.size(); ++i) {
      EXPECT_LT(length(geometry.normals[i] - source.normals[i]), 0.03) << "8 bits: 1 / 127 an axis, and rounding";
    }
    std::multiset<Triangle> got;
    for (const Triangle& t : geometry.triangles) {
      got.insert(turned(t));
    }
    EXPECT_EQ(got, triangles_of(source));
  }
}

TEST(Meshopt, DecodesTheExponentialFilter) {
  const test::TempFolder folder;
  const Source source = sheet(5);
  std::vector<PackedPosition> packed(source.positions.size());
#if MESHOPTIMIZER_VERSION >= 190  // since then the sharing of exponents is chosen
  meshopt_encodeFilterExp(packed.data(), packed.size(), sizeof(PackedPosition), 15, &source.positions[0].x,
                          meshopt_EncodeExpSharedVector);
#else
  meshopt_encodeFilterExp(packed.data(), packed.size(), sizeof(PackedPosition), 15, &source.positions[0].x);
#endif
  GltfBuilder builder =
      meshopt_file({pack_attribute(packed, 5126, "VEC3", "EXPONENTIAL"),
                    pack_attribute(source.normals, 5126, "VEC3", nullptr), pack_indices(source, true)},
                   {"POSITION", "NORMAL", "indices"});
  const Scene scene = load_scene(folder.write("scene.gltf", builder.text()));
  const auto& positions = scene.meshes.at(0).geometries.at(0).positions;
  ASSERT_EQ(positions.size(), source.positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_LT(length(positions[i] - source.positions[i]), 2e-3) << "15 bits under the vector's largest component";
  }
}

TEST(Meshopt, RefusesDamagedStreamsWithOneLine) {
  const test::TempFolder folder;
  const Source source = sheet(6);
  const Bytes file = meshopt_sheet(source, true).glb();
  const std::size_t json_size = file[12] + 256U * file[13] + 65536U * file[14];
  const std::size_t data = 20 + json_size + 8;
  int refused = 0;
  for (std::size_t at = data; at < file.size(); ++at) {
    for (const unsigned bit : {0U, 3U, 7U}) {
      Bytes damaged = file;
      damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ (1U << bit));
      expect_scene_or_one_line(folder.write("damaged.glb", damaged), refused);
    }
  }
  EXPECT_GT(refused, 20) << "some damage must have been noticed";
  // Streams that end early.
  refused = 0;
  int tried = 0;
  for (std::size_t view = 0; view < 3; ++view) {
    for (std::size_t keep = 0; keep < 60; ++keep, ++tried) {
      GltfBuilder builder = meshopt_sheet(source, true);
      builder.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]["byteLength"] = keep;
      expect_scene_or_one_line(folder.write("short.gltf", builder.text()), refused);
    }
  }
  EXPECT_EQ(refused, tried);
}

TEST(Meshopt, RefusesImpossibleHeaders) {
  struct Case {
    const char* key;
    json value;
    const char* message;
  };
  const test::TempFolder folder;
  for (const Case& c :
       {Case{"mode", "MAGIC", "mode 'MAGIC'"}, Case{"filter", "MAGIC", "filter 'MAGIC'"},
        Case{"filter", "QUATERNION", "byteStride of 12"}, Case{"byteStride", 6, "byteStride of 6"},
        Case{"byteStride", 0, "byteStride of 0"}, Case{"count", 35, "35 elements"}, Case{"count", -1, "count"},
        Case{"buffer", 7, "buffer"}, Case{"byteOffset", 100000, "outside buffers[0]"},
        Case{"mode", "TRIANGLES", "byteStride of 12"}}) {
    GltfBuilder builder = meshopt_sheet(sheet(6), true);
    builder.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][c.key] = c.value;
    const std::string path = folder.write("scene.gltf", builder.text());
    const std::string message = error_of(path);
    EXPECT_THAT(message, HasSubstr(path));
    EXPECT_THAT(message, HasSubstr("bufferViews[0]"));
    EXPECT_THAT(message, HasSubstr(c.message));
  }
  // A few bytes that claim to hold gigabytes.
  GltfBuilder builder = meshopt_sheet(sheet(6), true);
  const std::uint64_t count = 4000000000;
  auto& view = builder.json["bufferViews"][0];
  view["extensions"]["EXT_meshopt_compression"]["count"] = count;
  view["byteLength"] = count * 12;
  view["byteOffset"] = 0;
  builder.json["buffers"][1]["byteLength"] = count * 12;
  EXPECT_THAT(error_of(folder.write("large.gltf", builder.text())), HasSubstr("cannot hold 4000000000 elements"));
}

// --- KHR_draco_mesh_compression

constexpr int kPositionBits = 14, kNormalBits = 10, kUvBits = 12;

struct DracoStream {
  Bytes bytes;
  int position_id = 0, normal_id = 0, uv_id = 0;
};

template <class Vec>
int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, int components,
                  const std::vector<Vec>& values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<std::uint8_t>(components), draco::DT_FLOAT32, false, sizeof(Vec), 0);
  const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(values.size()));
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &values[i]);
  }
  return id;
}

DracoStream encode_draco(const Source& source, int method, bool with_metadata = false) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(source.positions.size()));
  for (std::size_t i = 0; i < source.indices.size(); i += 3) {
    mesh.AddFace({draco::PointIndex(source.indices[i]), draco::PointIndex(source.indices[i + 1]),
                  draco::PointIndex(source.indices[i + 2])});
  }
  const int position = add_attribute(mesh, draco::GeometryAttribute::POSITION, 3, source.positions);
  const int normal = add_attribute(mesh, draco::GeometryAttribute::NORMAL, 3, source.normals);
  const int uv = add_attribute(mesh, draco::GeometryAttribute::TEX_COORD, 2, source.uvs);
  if (with_metadata) {
    auto metadata = std::make_unique<draco::GeometryMetadata>();
    auto inner = std::make_unique<draco::Metadata>();
    inner->AddEntryString("exporter", std::string(200, 'x'));
    metadata->AddSubMetadata("inner", std::move(inner));
    metadata->AddEntryInt("version", 3);
    mesh.AddMetadata(std::move(metadata));
    auto of_normals = std::make_unique<draco::AttributeMetadata>();
    of_normals->AddEntryString("name", "normals");
    mesh.AddAttributeMetadata(normal, std::move(of_normals));
  }
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(position, kPositionBits);
  encoder.SetAttributeQuantization(normal, kNormalBits);
  encoder.SetAttributeQuantization(uv, kUvBits);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  DracoStream stream;
  stream.bytes.assign(buffer.data(), buffer.data() + buffer.size());
  stream.position_id = static_cast<int>(mesh.attribute(position)->unique_id());
  stream.normal_id = static_cast<int>(mesh.attribute(normal)->unique_id());
  stream.uv_id = static_cast<int>(mesh.attribute(uv)->unique_id());
  return stream;
}

GltfBuilder draco_file(const Source& source, const DracoStream& stream) {
  GltfBuilder builder;
  const int view = builder.add_view(stream.bytes);
  const std::size_t points = source.positions.size();
  builder.json["accessors"] = {{{"componentType", 5126}, {"count", points}, {"type", "VEC3"}},
                               {{"componentType", 5126}, {"count", points}, {"type", "VEC3"}},
                               {{"componentType", 5126}, {"count", points}, {"type", "VEC2"}},
                               {{"componentType", 5123}, {"count", source.indices.size()}, {"type", "SCALAR"}}};
  const json attributes = {
      {"POSITION", stream.position_id}, {"NORMAL", stream.normal_id}, {"TEXCOORD_0", stream.uv_id}};
  const int mesh = builder.add_mesh(
      {{"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}},
       {"indices", 3},
       {"material", 0},
       {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", attributes}}}}}});
  builder.add_node({{"mesh", mesh}});
  // A picture, so that texture coordinates are wanted.
  builder.json["images"] = {{{"uri",
                              "data:image/png;base64,"
                              "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAA"
                              "BJRU5ErkJggg=="}}};
  builder.json["textures"] = {{{"source", 0}}};
  builder.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  builder.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  builder.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return builder;
}

// Draco orders points anew: each is found again as the nearest one of the source.
std::uint32_t nearest(const std::vector<Vec3f>& points, const Vec3f& p) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < points.size(); ++i) {
    best = length(points[i] - p) < length(points[best] - p) ? i : best;
  }
  return best;
}

TEST(Draco, GivesBackTheMeshWithinItsQuantisation) {
  const test::TempFolder folder;
  const Source source = sheet(14);
  // Draco quantises all axes by the largest extent of the box.
  const double position_step = 7.0 / ((1 << kPositionBits) - 1);
  const double uv_step = 1.0 / ((1 << kUvBits) - 1);
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
    GltfBuilder builder = draco_file(source, encode_draco(source, method));
    const Scene scene = load_scene(folder.write("scene.gltf", builder.text()));
    EXPECT_TRUE(scene.warnings.empty());
    const Geometry& geometry = scene.meshes.at(0).geometries.at(0);
    ASSERT_EQ(geometry.positions.size(), source.positions.size());
    ASSERT_EQ(geometry.uv0.size(), source.uvs.size());
    std::vector<std::uint32_t> original;
    for (std::size_t i = 0; i < geometry.positions.size(); ++i) {
      const std::uint32_t from = nearest(source.positions, geometry.positions[i]);
      original.push_back(from);
      const Vec3f off = geometry.positions[i] - source.positions[from];
      EXPECT_LE(std::max({std::fabs(off.x), std::fabs(off.y), std::fabs(off.z)}), 0.51 * position_step);
      // An octahedron folded onto a square with steps of s = 2 / (2^bits - 2): x and y are off by s / 2 at most and
      // z = 1 - |x| - |y| by s, a distance of sqrt(1.5) s, which the sphere stretches by sqrt(3) at most.
      EXPECT_LT(length(geometry.normals[i] - source.normals[from]), std::sqrt(4.5) * 2 / ((1 << kNormalBits) - 2));
      EXPECT_LE(std::fabs(geometry.uv0[i].x - source.uvs[from].x), 0.51 * uv_step);
      EXPECT_LE(std::fabs(geometry.uv0[i].y - source.uvs[from].y), 0.51 * uv_step);
    }
    EXPECT_EQ(std::set<std::uint32_t>(original.begin(), original.end()).size(), source.positions.size());
    std::multiset<Triangle> got;
    for (const Triangle& t : geometry.triangles) {
      got.insert(turned({original[t[0]], original[t[1]], original[t[2]]}));
    }
    EXPECT_EQ(got, triangles_of(source));
  }
}

TEST(Draco, RefusesDamagedStreamsWithOneLine) {
  const test::TempFolder folder;
  const Source source = sheet(5);
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
    const DracoStream stream = encode_draco(source, method);
    int refused = 0;
    for (std::size_t keep = 0; keep < stream.bytes.size(); ++keep) {
      DracoStream shorter = stream;
      shorter.bytes.resize(keep);
      expect_scene_or_one_line(folder.write("short.glb", draco_file(source, shorter).glb()), refused);
    }
    EXPECT_GT(refused, 40);
    refused = 0;
    for (std::size_t at = 0; at < stream.bytes.size(); ++at) {
      for (const unsigned bit : {0U, 3U, 7U}) {
        DracoStream damaged = stream;
        damaged.bytes[at] = static_cast<std::uint8_t>(damaged.bytes[at] ^ (1U << bit));
        expect_scene_or_one_line(folder.write("damaged.glb", draco_file(source, damaged).glb()), refused);
      }
    }
    EXPECT_GT(refused, 20);
  }
}

// What the library encoded is told by its first bytes, so that the check reads what the decoder will read.
TEST(Draco, ClaimsAreThoseOfTheStream) {
  const Source source = sheet(9);
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
    for (const bool with_metadata : {false, true}) {
      const DracoStream stream = encode_draco(source, method, with_metadata);
      const auto claims = draco_claims(stream.bytes);
      ASSERT_TRUE(claims);
      EXPECT_EQ(claims->faces, source.indices.size() / 3);
      EXPECT_EQ(claims->vertices, source.positions.size());
      for (std::size_t length = 0; length < 13; ++length) {
        EXPECT_FALSE(draco_claims(std::span(stream.bytes).first(length)));
      }
    }
  }
}

// Thirty bytes that ask for gigabytes.
TEST(Draco, RefusesClaimsBeforeTheyAreBelieved) {
  const test::TempFolder folder;
  const Source source = sheet(9);
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
    DracoStream stream = encode_draco(source, method);
    Bytes bomb(stream.bytes.begin(), stream.bytes.begin() + 11);
    if (method == draco::MESH_EDGEBREAKER_ENCODING) {
      bomb.push_back(0);
    }
    for (int i = 0; i < 2; ++i) {
      for (const std::uint8_t byte : std::array<std::uint8_t, 4>{0x80, 0xC2, 0xD7, 0x2F}) {  // 100,000,000
        bomb.push_back(byte);
      }
    }
    bomb.resize(64, 1);
    stream.bytes = bomb;
    EXPECT_THAT(error_of(folder.write("bomb.glb", draco_file(source, stream).glb())),
                HasSubstr("claim 100000000 triangles of 100000000 vertices; the accessors have 81 vertices"));
  }
}

TEST(Draco, RefusesWhatDoesNotFitTheAccessors) {
  const test::TempFolder folder;
  const Source source = sheet(5);
  const DracoStream stream = encode_draco(source, draco::MESH_SEQUENTIAL_ENCODING);
  const auto message = [&](auto change) {
    GltfBuilder builder = draco_file(source, stream);
    change(builder.json, builder.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]);
    return error_of(folder.write("scene.gltf", builder.text()));
  };
  EXPECT_THAT(
      message([](json& all, json&) { all["accessors"][0]["count"] = 24; }),
      HasSubstr("meshes[0].primitives[0].extensions.KHR_draco_mesh_compression.attributes.POSITION: accessors[0] "
                "has a count of 24, the compressed mesh has 25 points"));
  EXPECT_THAT(message([](json& all, json&) { all["accessors"][1]["type"] = "VEC4"; }), HasSubstr("4 components"));
  EXPECT_THAT(message([](json&, json& packed) { packed["attributes"]["NORMAL"] = 99; }), HasSubstr("the id 99"));
  EXPECT_THAT(message([](json&, json& packed) { packed["attributes"]["NORMAL"] = "x"; }), HasSubstr("NORMAL"));
  EXPECT_THAT(message([](json&, json& packed) { packed["attributes"]["TANGENT"] = 1; }), HasSubstr("TANGENT"));
  EXPECT_THAT(message([](json&, json& packed) { packed["bufferView"] = 5; }), HasSubstr("not an index"));
  EXPECT_THAT(message([](json&, json& packed) { packed.erase("attributes"); }), HasSubstr("'attributes' is missing"));
  EXPECT_THAT(message([](json& all, json&) { all["meshes"][0]["primitives"][0]["mode"] = 6; }), HasSubstr("mode 6"));
}

}  // namespace
}  // namespace gazetrace::gltf_compression_test
