// SPDX-License-Identifier: Apache-2.0
// Broken files: each is refused with one line that names the place and the fault.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <functional>
#include <limits>

#include "gazetrace/scene.hpp"
#include "support/gltf_builder.hpp"
#include "support/picture_leaks.hpp"
#include "support/png_bytes.hpp"

namespace gazetrace::gltf_errors_test {
namespace {

using nlohmann::json;
using test::error_of;
using test::GltfBuilder;
using ::testing::HasSubstr;
using ::testing::Not;

void expect_one_line(const std::string& message, const std::string& path, const std::vector<std::string>& parts) {
  EXPECT_THAT(message, HasSubstr(path));
  EXPECT_THAT(message, Not(HasSubstr("\n")));
  for (const std::string& part : parts) {
    EXPECT_THAT(message, HasSubstr(part));
  }
}

const float kNan = std::numeric_limits<float>::quiet_NaN();

struct BrokenFile {
  const char* name;
  std::function<void(GltfBuilder&)> change;  // of a good file: accessors 0 normals, 1 positions; mesh 0, node 0
  std::vector<std::string> message;
};

class BrokenFiles : public ::testing::TestWithParam<BrokenFile> {};

TEST_P(BrokenFiles, AreRefusedWithOneLine) {
  GltfBuilder builder;
  builder.add_triangle({{"attributes", {{"NORMAL", builder.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3)}}}});
  GetParam().change(builder);
  const test::TempFolder folder;
  const std::string path = folder.write("scene.gltf", builder.text());
  expect_one_line(error_of(path), path, GetParam().message);
}

json& primitive_of(GltfBuilder& b) {
  return b.json["meshes"][0]["primitives"][0];
}
void add_camera(GltfBuilder& b, const json& lens) {
  b.json["cameras"] = {{{"type", "perspective"}, {"perspective", lens}}};
  b.add_node({{"camera", 0}});
}
void add_animation(GltfBuilder& b, const std::vector<float>& times, const std::vector<float>& values,
                   const char* interpolation) {
  add_camera(b, {{"yfov", 1}, {"znear", 1}});
  const int input = b.add(times, 1);
  const int output = b.add(values, 3);
  b.json["animations"] = {{{"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
}
void add_picture(GltfBuilder& b, const json& image) {
  b.json["images"] = {image};
  b.json["textures"] = {{{"source", 0}}};
  b.json["materials"] = {{{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}}};
  primitive_of(b)["material"] = 0;
}

const BrokenFile kBroken[] = {
    // what the file asks for
    {"RequiredExtension", [](auto& b) { b.json["extensionsRequired"] = {"VENDOR_magic"}; }, {"VENDOR_magic"}},
    {"Version1", [](auto& b) { b.json["asset"]["version"] = "1.0"; }, {"asset", "1.0", "cannot be read"}},
    {"MinVersion", [](auto& b) { b.json["asset"]["minVersion"] = "2.1"; }, {"asset", "2.1"}},
    {"NoAsset", [](auto& b) { b.json.erase("asset"); }, {"'asset' is missing"}},
    // types
    {"MeshesNoArray", [](auto& b) { b.json["meshes"] = 3; }, {"meshes", "is not a JSON array"}},
    {"NodeNoObject", [](auto& b) { b.json["nodes"][0] = "x"; }, {"nodes[0]", "is not a JSON object"}},
    {"NegativeIndex", [](auto& b) { b.json["nodes"][0]["mesh"] = -1; }, {"nodes[0].mesh", "-1 is not an index"}},
    {"FractionalIndex", [](auto& b) { b.json["nodes"][0]["mesh"] = 0.5; }, {"nodes[0].mesh", "0.5"}},
    {"ShortMatrix",
     [](auto& b) {
       b.json["nodes"][0]["matrix"] = {1, 2, 3};
     },
     {"nodes[0].matrix", "16 numbers"}},
    {"TextualRotation",
     [](auto& b) {
       b.json["nodes"][0]["rotation"] = {"a", 0, 0, 1};
     },
     {"nodes[0].rotation", "4 numbers"}},
    {"AccessorType", [](auto& b) { b.json["accessors"][0]["type"] = "VEC9"; }, {"VEC9"}},
    {"ComponentType", [](auto& b) { b.json["accessors"][0]["componentType"] = 5124; }, {"accessors[0]", "5124"}},
    {"HugeNumber", [](auto& b) { b.json["accessors"][0]["count"] = 1e30; }, {"accessors[0].count"}},
    {"Mode", [](auto& b) { primitive_of(b)["mode"] = 9; }, {"meshes[0].primitives[0].mode", "0 to 6"}},
    // references
    {"MeshReference", [](auto& b) { b.json["nodes"][0]["mesh"] = 5; }, {"nodes[0].mesh", "the 1 meshes"}},
    {"AccessorReference",
     [](auto& b) { primitive_of(b)["attributes"]["POSITION"] = 77; },
     {"meshes[0].primitives[0].attributes.POSITION", "77"}},
    {"MaterialReference",
     [](auto& b) { primitive_of(b)["material"] = 0; },
     {"primitives[0].material", "the 0 materials"}},
    {"TextureReference",
     [](auto& b) {
       b.json["materials"] = {{{"normalTexture", {{"index", 2}}}}};
     },
     {"materials[0].normalTexture.index", "2"}},
    {"SamplerReference",
     [](auto& b) {
       b.json["textures"] = {{{"sampler", 0}}};
     },
     {"textures[0].sampler"}},
    {"ImageReference",
     [](auto& b) {
       b.json["textures"] = {{{"source", 4}}};
     },
     {"textures[0].source"}},
    {"ViewReference", [](auto& b) { b.json["accessors"][0]["bufferView"] = 9; }, {"accessors[0].bufferView"}},
    {"BufferReference", [](auto& b) { b.json["bufferViews"][0]["buffer"] = 1; }, {"bufferViews[0].buffer"}},
    {"ChildReference", [](auto& b) { b.json["nodes"][0]["children"] = {3}; }, {"nodes[0].children[0]"}},
    {"SceneReference", [](auto& b) { b.json["scene"] = 2; }, {"scene", "the 1 scenes"}},
    {"LightReference",
     [](auto& b) {
       b.json["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
     },
     {"nodes[0].extensions.KHR_lights_punctual", "the 0 lights"}},
    {"SkinReference", [](auto& b) { b.json["nodes"][0]["skin"] = 0; }, {"nodes[0].skin"}},
    // ranges
    {"ViewOutsideBuffer",
     [](auto& b) { b.json["bufferViews"][1]["byteLength"] = 4000; },
     {"bufferViews[1]", "4000", "outside buffers[0] of 72 bytes"}},
    {"ViewOverflow",
     [](auto& b) { b.json["bufferViews"][1]["byteOffset"] = std::numeric_limits<std::int64_t>::max(); },
     {"bufferViews[1]", "outside"}},
    {"AccessorOutsideView",
     [](auto& b) { b.json["accessors"][1]["count"] = 4; },
     {"accessors[1]", "4 elements", "bufferViews[1] of 36 bytes"}},
    {"AccessorOffset", [](auto& b) { b.json["accessors"][1]["byteOffset"] = 40; }, {"accessors[1]", "outside"}},
    {"StrideTooSmall",
     [](auto& b) { b.json["bufferViews"][1]["byteStride"] = 8; },
     {"accessors[1]", "byteStride of 8"}},
    {"Misaligned",
     [](auto& b) {
       b.json["accessors"][1]["byteOffset"] = 2;
       b.json["accessors"][1]["count"] = 2;
     },
     {"accessors[1]", "not aligned to 4"}},
    {"NoElements", [](auto& b) { b.json["accessors"][1]["count"] = 0; }, {"accessors[1]", "count is 0"}},
    {"EndlessZeros",
     [](auto& b) {
       b.json["accessors"][1].erase("bufferView");
       b.json["accessors"][1]["count"] = 4000000000U;
     },
     {"accessors[1]", "4000000000"}},
    // Many uses of zeros that are allowed once; the same for what they place.
    {"ZerosOfManyPrimitives",
     [](auto& b) {
       const json accessor{{"componentType", 5126}, {"count", 1U << 22U}, {"type", "VEC3"}};
       b.json["accessors"].push_back(accessor);
       b.json["meshes"][0]["primitives"] = std::vector<json>(6, {{"attributes", {{"POSITION", 2}}}});
     },
     {"meshes[0].primitives[5].attributes", "75497472 zeros"}},
    {"ZerosInManyPoses",
     [](auto& b) {
       b.json["accessors"].push_back({{"componentType", 5126}, {"count", 1U << 22U}, {"type", "VEC3"}});
       b.json["meshes"][0] = {{"primitives", {{{"attributes", {{"POSITION", 2}}}, {"targets", {{{"POSITION", 2}}}}}}},
                              {"weights", {0.5}}};
       for (int i = 0; i < 5; ++i) {
         b.add_node({{"mesh", 0}});
       }
     },
     {"meshes[0].primitives[0].attributes", "75497472 zeros"}},
    {"ZerosOfMorphTargets",
     [](auto& b) {
       b.json["accessors"].push_back({{"componentType", 5126}, {"count", 1U << 24U}, {"type", "VEC3"}});
       primitive_of(b)["targets"] = std::vector<json>(6, {{"POSITION", 2}});
     },
     {"meshes[0].primitives[0].targets", "301989888 zeros"}},
    {"ZerosOfMatrices",
     [](auto& b) {
       b.json["accessors"].push_back({{"componentType", 5126}, {"count", (1U << 22U) + 1}, {"type", "MAT4"}});
       b.json["skins"] = {{{"joints", {0}}, {"inverseBindMatrices", 2}}};
     },
     {"skins[0].inverseBindMatrices", "67108880 zeros"}},
    {"ZeroInstances",
     [](auto& b) {
       b.json["accessors"].push_back({{"componentType", 5126}, {"count", 65537}, {"type", "VEC3"}});
       b.json["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 2}}}}}};
     },
     {"nodes[0].extensions.EXT_mesh_gpu_instancing", "65537 instances without data"}},
    {"EndlessInstances",
     [](auto& b) {
       const int places = b.template add<float>(std::vector<float>(3U << 18U), 3);
       const json extensions{{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}};
       for (int i = 0; i < 65; ++i) {
         b.add_node({{"mesh", 0}, {"extensions", extensions}});
       }
     },
     {"nodes[65].extensions.EXT_mesh_gpu_instancing", "17039360 instances;"}},
    {"SparseIndex",
     [](auto& b) {
       const int i = b.template add<std::uint8_t>({3}, 1);
       const int v = b.template add<float>({0, 0, 0}, 3);
       b.json["accessors"][1]["sparse"] = {
           {"count", 1}, {"indices", {{"bufferView", i}, {"componentType", 5121}}}, {"values", {{"bufferView", v}}}};
     },
     {"attributes.POSITION", "sparse index 3"}},
    {"SparseValuesOutside",
     [](auto& b) {
       const int i = b.template add<std::uint8_t>({0, 1}, 1);
       const int v = b.template add<float>({0, 0, 0}, 3);
       b.json["accessors"][1]["sparse"] = {
           {"count", 2}, {"indices", {{"bufferView", i}, {"componentType", 5121}}}, {"values", {{"bufferView", v}}}};
     },
     {"accessors[1]", "outside"}},
    // geometry
    {"IndexOutOfRange",
     [](auto& b) {
       primitive_of(b)["indices"] = b.template add<std::uint16_t>({0, 1, 3}, 1);
     },
     {"meshes[0].primitives[0].indices", "index 3 at position 2", "vertex count of 3"}},
    {"SignedIndices",
     [](auto& b) {
       primitive_of(b)["indices"] = b.template add<std::int16_t>({0, 1, 2}, 1);
     },
     {"primitives[0].indices", "unsigned"}},
    {"NanVertex",
     [](auto& b) {
       primitive_of(b)["attributes"]["POSITION"] = b.template add<float>({0, 0, 0, 1, 0, kNan, 0, 1, 0}, 3);
     },
     {"attributes.POSITION", "element 1", "not finite"}},
    {"ComponentsMismatch",
     [](auto& b) {
       primitive_of(b)["attributes"]["NORMAL"] = b.template add<float>({0, 0, 1, 1, 0, 0}, 2);
     },
     {"attributes.NORMAL", "has 2 components where 3 are needed"}},
    {"CountMismatch",
     [](auto& b) {
       primitive_of(b)["attributes"]["NORMAL"] = b.template add<float>({0, 0, 1, 0, 0, 1}, 3);
     },
     {"attributes.NORMAL", "2 values for 3 positions"}},
    // nodes
    {"SelfChild", [](auto& b) { b.json["nodes"][0]["children"] = {0}; }, {"nodes[0]", "cycle"}},
    {"NodeCycle",
     [](auto& b) {
       b.add_node({{"children", {2}}}, false);
       b.add_node({{"children", {3}}}, false);
       b.add_node({{"children", {1}}}, false);
     },
     {"nodes[", "cycle"}},
    {"TwoParents",
     [](auto& b) {
       b.add_node({{"children", {3}}});
       b.add_node({{"children", {3}}});
       b.add_node(json::object(), false);
     },
     {"nodes[3]", "child of nodes[1] and of nodes[2]"}},
    {"RootWithParent",
     [](auto& b) {
       b.add_node({{"children", {0}}});
     },
     {"nodes[0]", "listed in the scene and has a parent"}},
    {"RootTwice",
     [](auto& b) {
       b.json["scenes"][0]["nodes"] = {0, 0};
     },
     {"nodes[0]", "listed twice"}},
    {"InstancingCounts",
     [](auto& b) {
       const json attributes{{"TRANSLATION", b.template add<float>({0, 0, 0}, 3)},
                             {"SCALE", b.template add<float>({1, 1, 1, 1, 1, 1}, 3)}};
       b.json["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}};
     },
     {"nodes[0].extensions.EXT_mesh_gpu_instancing.attributes.SCALE", "2 elements"}},
    // buffers and pictures
    {"BadBase64",
     [](auto& b) {
       b.json["buffers"][1] = {{"byteLength", 3}, {"uri", "data:application/octet-stream;base64,A*BC"}};
     },
     {"buffers[1]", "broken base64"}},
    {"NotBase64",
     [](auto& b) {
       b.json["buffers"][1] = {{"byteLength", 3}, {"uri", "data:text/plain,abc"}};
     },
     {"buffers[1]", "not base64"}},
    {"ShortBuffer",
     [](auto& b) {
       b.json["buffers"][1] = {{"byteLength", 9}, {"uri", "data:x/y;base64,AAAA"}};
     },
     {"buffers[1]", "byteLength says 9, there are 3"}},
    {"MissingBuffer",
     [](auto& b) {
       b.json["buffers"][1] = {{"byteLength", 9}, {"uri", "gone.bin"}};
     },
     {"buffers[1]", "gone.bin"}},
    {"RemoteBuffer",
     [](auto& b) {
       b.json["buffers"][1] = {{"byteLength", 9}, {"uri", "https://example.org/x.bin"}};
     },
     {"buffers[1]", "not a file"}},
    {"BufferWithoutData",
     [](auto& b) {
       b.json["buffers"][1] = {{"byteLength", 36}};
       b.json["bufferViews"][1] = {{"buffer", 1}, {"byteLength", 36}};
     },
     {"attributes.POSITION", "buffers[1] has no data"}},
    {"MissingPicture",
     [](auto& b) {
       add_picture(b, {{"uri", "gone.png"}});
     },
     {"images[0]", "gone.png"}},
    {"PictureNoPicture",
     [](auto& b) {
       add_picture(b, {{"uri", "data:image/png;base64,AAAA"}});
     },
     {"images[0]", "no picture of a known kind"}},
    {"PictureEmpty",
     [](auto& b) {
       add_picture(b, {{"uri", "data:image/png;base64,"}});
     },
     {"images[0]", "no picture"}},
    {"PictureTruncated",
     [](auto& b) {
       auto png = test::png_bytes(64, 64, test::PngColor::rgb, 8, std::vector<std::uint16_t>(64 * 64 * 3, 9));
       png.resize(3000);
       add_picture(b, {{"uri", "data:image/png;base64," + test::base64(png)}});
     },
     {"images[0]"}},
    // cameras, lights, animations
    {"Fov",
     [](auto& b) {
       add_camera(b, {{"yfov", 4}, {"znear", 1}});
     },
     {"cameras[0]", "yfov"}},
    {"NoFov",
     [](auto& b) {
       add_camera(b, {{"znear", 1}});
     },
     {"cameras[0].perspective.yfov", "missing"}},
    {"FarBeforeNear",
     [](auto& b) {
       add_camera(b, {{"yfov", 1}, {"znear", 2}, {"zfar", 1}});
     },
     {"cameras[0]", "zfar"}},
    {"LightType",
     [](auto& b) {
       b.json["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "area"}}}}}}};
     },
     {"KHR_lights_punctual.lights[0]", "'area'"}},
    {"KeysOutOfOrder",
     [](auto& b) {
       add_animation(b, {0, 2, 1}, {0, 0, 0, 1, 0, 0, 2, 0, 0}, "LINEAR");
     },
     {"animations[0].samplers[0].input", "key 2 is before"}},
    {"TooFewValues",
     [](auto& b) {
       add_animation(b, {0, 1}, {0, 0, 0, 1, 0, 0}, "CUBICSPLINE");
     },
     {"animations[0].samplers[0].output", "2 values for 2 keys, 6 are needed"}},
    {"Interpolation",
     [](auto& b) {
       add_animation(b, {0, 1}, {0, 0, 0, 1, 0, 0}, "BEZIER");
     },
     {"animations[0].samplers[0]", "'BEZIER'"}},
    {"ChannelSampler",
     [](auto& b) {
       add_animation(b, {0, 1}, {0, 0, 0, 1, 0, 0}, "LINEAR");
       b.json["animations"][0]["channels"][0]["sampler"] = 1;
     },
     {"animations[0].channels[0]", "the 1 samplers"}},
};

INSTANTIATE_TEST_SUITE_P(Table, BrokenFiles, ::testing::ValuesIn(kBroken),
                         [](const auto& test) { return std::string(test.param.name); });

// glTF 2.0 section 3.2: integers may be written as decimals with a zero fractional part.
TEST(WholeNumbers, MayBeDecimals) {
  GltfBuilder builder;
  builder.add_triangle({{"indices", builder.add<std::uint16_t>({0, 1, 2}, 1)}, {"mode", 4}, {"material", 0}});
  builder.json["materials"] = {{{"name", "only"}}};
  const std::string integers = builder.text();
  json decimals = json::parse(integers);
  const std::function<void(json&)> to_decimals = [&](json& value) {
    if (value.is_number_integer()) {
      value = value.get<double>();
    } else if (value.is_structured()) {
      for (json& item : value) {
        to_decimals(item);
      }
    }
  };
  to_decimals(decimals);
  ASSERT_THAT(decimals.dump(), HasSubstr("\"componentType\":5126.0"));
  const test::TempFolder folder;
  const Scene plain = load_scene(folder.write("integers.gltf", integers));
  const Scene same = load_scene(folder.write("decimals.gltf", decimals.dump()));
  ASSERT_EQ(same.meshes.size(), 1U);
  EXPECT_EQ(same.meshes[0].geometries.at(0).positions, plain.meshes[0].geometries.at(0).positions);
  EXPECT_EQ(same.meshes[0].geometries.at(0).triangles, plain.meshes[0].geometries.at(0).triangles);
  EXPECT_EQ(same.instances.size(), 1U);

  decimals["accessors"][0]["count"] = 3.5;
  EXPECT_THAT(error_of(folder.write("half.gltf", decimals.dump())),
              HasSubstr("accessors[0].count: 3.5 is not a whole"));
}

TEST(WholeNumbers, MayExceed32Bits) {
  GltfBuilder builder;
  builder.add_triangle({{"material", 0}});
  json file = json::parse(builder.text());
  const test::TempFolder folder;
  for (const json& distance : {json(10000000000U), json(1e10)}) {  // integer and decimal
    file["materials"] = {{{"extensions", {{"KHR_materials_volume", {{"attenuationDistance", distance}}}}}}};
    const Scene scene = load_scene(folder.write("far.gltf", file.dump()));
    EXPECT_EQ(scene.materials.at(0).volume.attenuation_distance_m, 1e10F) << distance;
  }
  file["bufferViews"][0]["byteLength"] = 5e9;
  EXPECT_THAT(error_of(folder.write("long.gltf", file.dump())), HasSubstr("5000000000 lie outside buffers[0]"));
}

// Nobody writes to the pipe: opening it would wait for ever.
TEST(BrokenContainers, Pipes) {
  const test::TempFolder folder;
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(error_of(pipe), HasSubstr("is a pipe or a device, not a file"));
  GltfBuilder builder;
  builder.add_triangle();
  json file = json::parse(builder.text());
  file["buffers"][0]["uri"] = "pipe";
  const std::string path = folder.write("scene.gltf", file.dump());
  expect_one_line(error_of(path), path, {"buffers[0]", "is a pipe or a device"});
}

TEST(BrokenContainers, MissingFileFolderAndNonsense) {
  const test::TempFolder folder;
  EXPECT_THAT(error_of(folder.file("gone.gltf")), HasSubstr("gone.gltf: there is no such file"));
  EXPECT_THAT(error_of(folder.file(".")), HasSubstr("is a folder"));
  EXPECT_THAT(error_of(folder.write("empty.gltf", "")),
              HasSubstr("empty.gltf: the file is empty; copy or export it again"));
  EXPECT_THAT(error_of(folder.write("cut.gltf", R"({"asset": {"ver)")), HasSubstr("not valid JSON"));
  EXPECT_THAT(error_of(folder.write("array.gltf", "[]")), HasSubstr("not an object"));
  EXPECT_THAT(error_of(folder.write("deep.gltf", std::string(1000000, '['))), HasSubstr("nested"));
  EXPECT_THAT(error_of(folder.write("no-utf8.gltf", "{\"asset\":{\"version\":\"2.0\",\"generator\":\"\xff\"}}")),
              HasSubstr("not valid JSON"));
}

// Every length of a good .glb short of its own is an error, never a crash.
TEST(BrokenContainers, TruncatedGlb) {
  GltfBuilder builder;
  builder.add_triangle();
  const std::vector<std::uint8_t> good = builder.glb();
  const test::TempFolder folder;
  EXPECT_EQ(error_of(folder.write("good.glb", good)), "no error");
  for (std::size_t size = 4; size < good.size(); ++size) {
    const std::string path =
        folder.write("cut.glb", std::vector<std::uint8_t>(good.begin(), good.begin() + static_cast<long>(size)));
    expect_one_line(error_of(path), path, {"truncated .glb"});
  }
}

// Any single byte of the file changed to anything: loaded or refused, nothing else.
TEST(BrokenContainers, DamagedGlb) {
  GltfBuilder builder;
  builder.add_triangle({{"indices", builder.add<std::uint8_t>({0, 1, 2}, 1)}});
  const std::vector<std::uint8_t> good = builder.glb();
  const test::TempFolder folder;
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (const int value : {0x22, 0x39, 0xFF}) {
      std::vector<std::uint8_t> bad = good;
      bad[at] = static_cast<std::uint8_t>(value);
      EXPECT_THAT(error_of(folder.write("bad.glb", bad)), Not(HasSubstr("\n"))) << at;
    }
  }
}

TEST(BrokenContainers, OtherVersionsAndChunks) {
  GltfBuilder builder;
  builder.add_triangle();
  std::vector<std::uint8_t> glb = builder.glb();
  const test::TempFolder folder;
  glb[4] = 1;
  EXPECT_THAT(error_of(folder.write("one.glb", glb)), HasSubstr("version 1"));
  glb[4] = 2;
  glb[16] = 'X';
  EXPECT_THAT(error_of(folder.write("chunk.glb", glb)), HasSubstr("first chunk is not JSON"));
}

}  // namespace
}  // namespace gazetrace::gltf_errors_test
