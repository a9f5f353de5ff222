// SPDX-License-Identifier: Apache-2.0
// Small, valid glTF files that between them have everything that is read: every extension, packed and sparse geometry,
// skins, morph targets, animations, lights, cameras and pictures within the file. Fuzzers and mutation tests begin with
// them.
#pragma once

#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "support/gltf_builder.hpp"
#include "support/png_bytes.hpp"

namespace gazetrace::test {

namespace seeds {

using Json = nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

inline Json texture(int index) {
  return {
      {"index", index},
      {"texCoord", 0},
      {"extensions",
       {{"KHR_texture_transform", {{"offset", {0.1, 0.2}}, {"scale", {2, 3}}, {"rotation", 0.5}, {"texCoord", 1}}}}}};
}

// Two pictures, and a material with every extension that can stand beside others.
inline void add_materials(GltfBuilder& builder) {
  const Bytes color = png_bytes(2, 2, PngColor::rgba, 8, {255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 0, 9, 9, 9, 255});
  const Bytes deep = png_bytes(1, 1, PngColor::rgb, 16, {30000, 40000, 65535});
  Json& json = builder.json;
  json["images"] = {{{"name", "color"}, {"mimeType", "image/png"}, {"bufferView", builder.add_view(color)}},
                    {{"uri", "data:image/png;base64," + base64(deep)}}};
  json["samplers"] = {{{"magFilter", 9728}, {"minFilter", 9987}, {"wrapS", 33071}, {"wrapT", 33648}}, Json::object()};
  json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 1}, {"sampler", 1}}, {{"source", 0}}};
  json["textures"][2]["extensions"]["EXT_texture_webp"]["source"] = 1;
  Json normal = texture(1);
  normal["scale"] = 0.7;
  json["materials"] = {
      {{"name", "layers"},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.3},
       {"doubleSided", true},
       {"emissiveFactor", {0.1, 0.2, 0.3}},
       {"emissiveTexture", texture(2)},
       {"normalTexture", normal},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.9, 0.8, 0.7, 0.6}},
         {"metallicFactor", 0.5},
         {"roughnessFactor", 0.4},
         {"baseColorTexture", texture(0)},
         {"metallicRoughnessTexture", texture(1)}}},
       {"extensions",
        {{"KHR_materials_emissive_strength", {{"emissiveStrength", 3}}},
         {"KHR_materials_ior", {{"ior", 1.4}}},
         {"KHR_materials_specular",
          {{"specularFactor", 0.5}, {"specularColorFactor", {1, 0.5, 2}}, {"specularTexture", texture(1)}}},
         {"KHR_materials_clearcoat",
          {{"clearcoatFactor", 0.6}, {"clearcoatRoughnessFactor", 0.1}, {"clearcoatNormalTexture", normal}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 0.4}, {"transmissionTexture", texture(2)}}},
         {"KHR_materials_volume",
          {{"thicknessFactor", 1}, {"attenuationDistance", 0.7}, {"attenuationColor", {0.3, 0.6, 0.9}}}},
         {"KHR_materials_sheen", {{"sheenColorFactor", {0.2, 0.1, 0.3}}, {"sheenRoughnessFactor", 0.5}}},
         {"KHR_materials_anisotropy",
          {{"anisotropyStrength", 0.6}, {"anisotropyRotation", 0.4}, {"anisotropyTexture", texture(1)}}},
         {"KHR_materials_iridescence",
          {{"iridescenceFactor", 0.8},
           {"iridescenceIor", 1.3},
           {"iridescenceThicknessMinimum", 100},
           {"iridescenceThicknessMaximum", 400}}},
         {"KHR_materials_diffuse_transmission",
          {{"diffuseTransmissionFactor", 0.3}, {"diffuseTransmissionColorFactor", {0.9, 0.4, 0.2}}}},
         {"KHR_materials_dispersion", {{"dispersion", 0.2}}}}}},
      {{"name", "gloss"},
       {"alphaMode", "BLEND"},
       {"extensions",
        {{"KHR_materials_pbrSpecularGlossiness",
          {{"diffuseFactor", {0.5, 0.6, 0.7, 0.8}},
           {"glossinessFactor", 0.7},
           {"specularFactor", {0.1, 0.2, 0.3}},
           {"diffuseTexture", texture(0)}}}}}},
      {{"name", "plain"}, {"extensions", {{"KHR_materials_unlit", Json::object()}}}}};
}

inline void add_view(GltfBuilder& builder) {
  Json& json = builder.json;
  json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.01}, {"zfar", 100}, {"aspectRatio", 1.5}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.01}, {"zfar", 10}}}}};
  json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", 20}, {"range", 10}, {"color", {1, 0.5, 0.2}}},
      {{"type", "directional"}, {"name", "sun"}, {"intensity", 3}},
      {{"type", "spot"}, {"intensity", 30}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.6}}}}};
  builder.add_node({{"name", "camera"}, {"camera", 0}, {"translation", {0.5, 0.5, 3}}});
  builder.add_node({{"camera", 1}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 2, 1}}});
  for (int light = 0; light < 3; ++light) {
    builder.add_node({{"translation", {0, 1, 2}},
                      {"rotation", {-0.3, 0, 0, 0.954}},
                      {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  }
}

// A square of two triangles with everything a vertex may have.
inline Json square(GltfBuilder& builder, int material) {
  return {{"attributes",
           {{"POSITION", builder.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3)},
            {"NORMAL", builder.add<std::int8_t>({0, 0, 127, 0, 0, 127, 0, 0, 127, 0, 0, 127}, 3, true)},
            {"TANGENT", builder.add<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, -1}, 4)},
            {"TEXCOORD_0", builder.add<float>({0, 0, 1, 0, 1, 1, 0, 1}, 2)},
            {"TEXCOORD_1", builder.add<std::uint16_t>({0, 0, 65535, 0, 65535, 65535, 0, 65535}, 2, true)},
            {"COLOR_0",
             builder.add<std::uint8_t>({255, 255, 255, 255, 200, 1, 1, 9, 1, 200, 1, 255, 1, 1, 1, 1}, 4, true)}}},
          {"indices", builder.add<std::uint16_t>({0, 1, 2, 0, 2, 3}, 1)},
          {"mode", 4},
          {"material", material}};
}

inline GltfBuilder still() {
  GltfBuilder builder;
  add_materials(builder);
  add_view(builder);
  Json strip = square(builder, 1);
  strip["mode"] = 5;
  strip.erase("indices");
  Json fan = {{"attributes", {{"POSITION", builder.add<std::int16_t>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1}, 3)}}},
              {"mode", 6}};
  builder.json["meshes"] = {{{"name", "square"}, {"primitives", {square(builder, 0), strip}}},
                            {{"primitives", {fan, square(builder, 2)}}}};
  const int child = builder.add_node({{"mesh", 1}, {"scale", {0.5, 0.5, 2}}, {"translation", {0, 0, -1}}}, false);
  builder.add_node({{"name", "parent"}, {"mesh", 0}, {"rotation", {0, 0.7071, 0, 0.7071}}, {"children", {child}}});
  builder.add_node({{"mesh", 0},
                    {"extensions",
                     {{"EXT_mesh_gpu_instancing",
                       {{"attributes",
                         {{"TRANSLATION", builder.add<float>({0, 0, 0, 2, 0, 0}, 3)},
                          {"ROTATION", builder.add<std::int16_t>({0, 0, 0, 32767, 0, 32767, 0, 0}, 4, true)},
                          {"SCALE", builder.add<float>({1, 1, 1, 0.5, 0.5, 0.5}, 3)}}}}}}}});
  builder.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing", "KHR_lights_punctual", "KHR_texture_transform"};
  builder.json["scenes"][0]["name"] = "whole";
  return builder;
}

// A skin, morph targets, sparse accessors, and animations of everything in every interpolation.
inline GltfBuilder moving() {
  GltfBuilder builder;
  add_view(builder);
  Json primitive = square(builder, 0);
  builder.json["materials"] = {{{"name", "cloth"}}};
  primitive["attributes"]["JOINTS_0"] = builder.add<std::uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
  primitive["attributes"]["WEIGHTS_0"] = builder.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 0.5F, 0.5F, 0, 0, 1, 0, 0, 0}, 4);
  const int shift = builder.add<float>({0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1}, 3);
  const int sparse = builder.add<float>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 3);
  const int places = builder.add<std::uint16_t>({1, 3}, 1);
  const int values = builder.add<float>({0, 0.5F, 0, 0, 0, 0.5F}, 3);
  Json& accessors = builder.json["accessors"];
  const auto view_of = [&](int accessor) { return accessors[static_cast<std::size_t>(accessor)]["bufferView"]; };
  Json& of_sparse = accessors[static_cast<std::size_t>(sparse)];
  of_sparse["sparse"] = {{"count", 2},
                         {"indices", {{"bufferView", view_of(places)}, {"componentType", 5123}}},
                         {"values", {{"bufferView", view_of(values)}}}};
  accessors.push_back({{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});  // zeros
  const int zeros = static_cast<int>(accessors.size()) - 1;
  primitive["targets"] = {{{"POSITION", shift}, {"NORMAL", zeros}}, {{"POSITION", sparse}}};
  builder.json["meshes"] = {{{"primitives", {primitive}}, {"weights", {0.2, 0.1}}}};
  const int tip = builder.add_node({{"name", "tip"}, {"translation", {0, 1, 0}}}, false);
  const int base = builder.add_node({{"name", "base"}, {"children", {tip}}});
  const int skinned = builder.add_node({{"mesh", 0}, {"skin", 0}});
  const int hung = builder.add_node({{"mesh", 0}, {"weights", {0.5, 0}}}, false);
  const int swing = builder.add_node({{"children", {hung}}});
  const int matrices = builder.add<float>(
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1}, 1);
  accessors[static_cast<std::size_t>(matrices)]["type"] = "MAT4";
  accessors[static_cast<std::size_t>(matrices)]["count"] = 2;
  builder.json["skins"] = {{{"joints", {base, tip}}, {"inverseBindMatrices", matrices}, {"skeleton", base}}};
  const int times = builder.add<float>({0, 0.5F, 2}, 1);
  const int turns = builder.add<float>({0, 0, 0, 1, 0, 0.7071F, 0, 0.7071F, 0, 1, 0, 0}, 4);
  const int ways = builder.add<float>({0, 0, 0, 1, 0, 0, 0, 0, 1}, 3);
  std::vector<float> spline(27, 0.25F);
  const int splines = builder.add<float>(spline, 3);
  const int weights = builder.add<float>({0, 0, 1, 0.5F, 0, 1}, 1);
  const auto channel = [](int sampler, int node, const char* path) {
    return Json{{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}};
  };
  builder.json["animations"] = {
      {{"name", "walk"},
       {"samplers",
        {{{"input", times}, {"output", turns}, {"interpolation", "LINEAR"}},
         {{"input", times}, {"output", ways}, {"interpolation", "STEP"}},
         {{"input", times}, {"output", splines}, {"interpolation", "CUBICSPLINE"}},
         {{"input", times}, {"output", weights}}}},
       {"channels",
        {channel(0, tip, "rotation"), channel(1, swing, "translation"), channel(2, base, "scale"),
         channel(3, hung, "weights"), channel(3, skinned, "weights"), channel(0, 0, "rotation")}}}};
  return builder;
}

// A bumpy sheet of side x side vertices.
struct Sheet {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;
};
inline Sheet sheet(std::uint32_t side) {
  Sheet sheet;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const float x = static_cast<float>(i % side);
    const float y = static_cast<float>(i / side);
    sheet.positions.push_back({x, y, std::sin(3 * x + y)});
  }
  for (std::uint32_t y = 0; y + 1 < side; ++y) {
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t i = y * side + x;
      for (const std::uint32_t corner : {i, i + 1, i + side, i + 1, i + side + 1, i + side}) {
        sheet.indices.push_back(corner);
      }
    }
  }
  return sheet;
}

inline GltfBuilder meshopt(bool triangles) {
  const Sheet source = sheet(4);
  Bytes vertices(meshopt_encodeVertexBufferBound(source.positions.size(), sizeof(Vec3f)));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), source.positions.data(),
                                             source.positions.size(), sizeof(Vec3f)));
  // Normals through the filter for octahedra, as four bytes.
  std::vector<std::array<float, 4>> plain(source.positions.size(), {0.6F, 0, 0.8F, 0});
  std::vector<std::array<std::int8_t, 4>> filtered(plain.size());
  meshopt_encodeFilterOct(filtered.data(), filtered.size(), 4, 8, plain.front().data());
  Bytes normals(meshopt_encodeVertexBufferBound(filtered.size(), 4));
  normals.resize(meshopt_encodeVertexBuffer(normals.data(), normals.size(), filtered.data(), filtered.size(), 4));
  const std::size_t count = source.indices.size();
  Bytes indices(triangles ? meshopt_encodeIndexBufferBound(count, source.positions.size())
                          : meshopt_encodeIndexSequenceBound(count, source.positions.size()));
  indices.resize(triangles ? meshopt_encodeIndexBuffer(indices.data(), indices.size(), source.indices.data(), count)
                           : meshopt_encodeIndexSequence(indices.data(), indices.size(), source.indices.data(), count));
  GltfBuilder builder;
  add_view(builder);
  struct Part {
    Bytes bytes;
    std::size_t count, stride;
    const char* mode;
    const char* filter;
  };
  const std::vector<Part> parts{{vertices, source.positions.size(), 12, "ATTRIBUTES", "NONE"},
                                {normals, filtered.size(), 4, "ATTRIBUTES", "OCTAHEDRAL"},
                                {indices, count, 4, triangles ? "TRIANGLES" : "INDICES", "NONE"}};
  std::size_t at = 0;
  Json views = Json::array();
  for (const Part& part : parts) {
    const auto raw = static_cast<std::size_t>(builder.add_view(part.bytes));
    views.push_back({{"buffer", 1},
                     {"byteOffset", at},
                     {"byteLength", part.count * part.stride},
                     {"extensions",
                      {{"EXT_meshopt_compression",
                        {{"buffer", 0},
                         {"byteOffset", builder.json["bufferViews"][raw]["byteOffset"]},
                         {"byteLength", part.bytes.size()},
                         {"byteStride", part.stride},
                         {"count", part.count},
                         {"mode", part.mode},
                         {"filter", part.filter}}}}}});
    at += part.count * part.stride;
  }
  const auto first = static_cast<int>(builder.json["bufferViews"].size());
  for (Json& view : views) {
    builder.json["bufferViews"].push_back(view);
  }
  const std::size_t points = source.positions.size();
  builder.json["accessors"] = {
      {{"bufferView", first}, {"componentType", 5126}, {"count", points}, {"type", "VEC3"}},
      {{"bufferView", first + 1}, {"componentType", 5120}, {"count", points}, {"type", "VEC3"}, {"normalized", true}},
      {{"bufferView", first + 2}, {"componentType", 5125}, {"count", count}, {"type", "SCALAR"}}};
  builder.json["bufferViews"][static_cast<std::size_t>(first) + 1]["byteStride"] = 4;
  builder.json["buffers"] = {Json::object(),
                             {{"byteLength", at}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  builder.add_node({{"mesh", builder.add_mesh({{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}})}});
  builder.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  return builder;
}

inline GltfBuilder draco(int method) {
  const Sheet source = sheet(4);
  ::draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(source.positions.size()));
  for (std::size_t i = 0; i < source.indices.size(); i += 3) {
    mesh.AddFace({::draco::PointIndex(source.indices[i]), ::draco::PointIndex(source.indices[i + 1]),
                  ::draco::PointIndex(source.indices[i + 2])});
  }
  ::draco::GeometryAttribute attribute;
  attribute.Init(::draco::GeometryAttribute::POSITION, nullptr, 3, ::draco::DT_FLOAT32, false, sizeof(Vec3f), 0);
  const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(source.positions.size()));
  for (std::uint32_t i = 0; i < source.positions.size(); ++i) {
    mesh.attribute(id)->SetAttributeValue(::draco::AttributeValueIndex(i), &source.positions[i]);
  }
  ::draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(id, 11);
  ::draco::EncoderBuffer buffer;
  static_cast<void>(encoder.EncodeToBuffer(&buffer));
  GltfBuilder builder;
  add_view(builder);
  const int view = builder.add_view(Bytes(buffer.data(), buffer.data() + buffer.size()));
  builder.json["accessors"] = {{{"componentType", 5126}, {"count", source.positions.size()}, {"type", "VEC3"}},
                               {{"componentType", 5125}, {"count", source.indices.size()}, {"type", "SCALAR"}}};
  const Json packed = {{"bufferView", view}, {"attributes", {{"POSITION", mesh.attribute(id)->unique_id()}}}};
  const int index = builder.add_mesh(
      {{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"extensions", {{"KHR_draco_mesh_compression", packed}}}});
  builder.add_node({{"mesh", index}});
  builder.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return builder;
}

}  // namespace seeds

// Name and bytes of each file.
inline std::vector<std::pair<std::string, std::string>> scene_seeds() {
  using namespace seeds;
  std::vector<std::pair<std::string, std::string>> files;
  const auto add = [&](const std::string& name, GltfBuilder builder) {
    files.emplace_back(name + ".gltf", GltfBuilder(builder).text());
    const Bytes glb = builder.glb();
    files.emplace_back(name + ".glb", std::string(glb.begin(), glb.end()));
  };
  add("still", still());
  add("moving", moving());
  files.emplace_back("meshopt-triangles.gltf", meshopt(true).text());
  files.emplace_back("meshopt-indices.gltf", meshopt(false).text());
  add("draco-edgebreaker", draco(::draco::MESH_EDGEBREAKER_ENCODING));
  add("draco-sequential", draco(::draco::MESH_SEQUENTIAL_ENCODING));
  return files;
}

}  // namespace gazetrace::test
