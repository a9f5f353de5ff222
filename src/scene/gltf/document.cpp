// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/document.hpp"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Value = tinygltf::Value;

const Value* extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto it = extensions.find(name);
  return it != extensions.end() && it->second.IsObject() ? &it->second : nullptr;
}

// An index or another whole number that may be -1; -1 also for what is none. Extensions that nobody reads are not
// checked.
int whole_or_none(double value) {
  return value >= 0 && value <= std::numeric_limits<int>::max() ? static_cast<int>(value) : -1;
}

double number(const Value& object, const char* key, double fallback) {
  if (!object.Has(key)) {
    return fallback;
  }
  const Value& value = object.Get(key);
  return value.IsNumber() ? value.GetNumberAsDouble() : fallback;
}

template <std::size_t N>
std::array<double, N> array_or(const std::vector<double>& values, const std::array<double, N>& fallback) {
  std::array<double, N> result = fallback;
  if (values.size() == N) {
    std::copy(values.begin(), values.end(), result.begin());
  }
  return result;
}

std::array<double, 2> pair_or(const Value& object, const char* key, const std::array<double, 2>& fallback) {
  if (!object.Has(key) || !object.Get(key).IsArray() || object.Get(key).ArrayLen() != 2) {
    return fallback;
  }
  const Value& pair = object.Get(key);
  return {pair.Get(0).GetNumberAsDouble(), pair.Get(1).GetNumberAsDouble()};
}

// The three kinds of texture info have the same members.
template <class Info>
GltfTextureInfo texture_info(const Info& from) {
  GltfTextureInfo info;
  info.texture = from.index;
  info.tex_coord = from.texCoord;
  if (const Value* transform = extension(from.extensions, "KHR_texture_transform")) {
    info.has_transform = true;
    info.offset = pair_or(*transform, "offset", {0, 0});
    info.scale = pair_or(*transform, "scale", {1, 1});
    info.rotation_rad = number(*transform, "rotation", 0);
    info.tex_coord = whole_or_none(number(*transform, "texCoord", from.texCoord));
  }
  return info;
}

GltfTextureInfo texture_info_of(const Value& from) {
  tinygltf::TextureInfo info;
  info.index = whole_or_none(number(from, "index", -1));
  info.texCoord = whole_or_none(number(from, "texCoord", 0));
  if (from.Has("extensions") && from.Get("extensions").IsObject()) {
    info.extensions = from.Get("extensions").Get<Value::Object>();
  }
  GltfTextureInfo result = texture_info(info);
  result.scale_factor = number(from, "scale", 1);
  return result;
}

GltfExtension extension_fields(const Value& from) {
  GltfExtension to;
  for (const auto& [key, value] : from.Get<Value::Object>()) {
    if (value.IsNumber()) {
      to.numbers[key] = {value.GetNumberAsDouble()};
    } else if (value.IsArray()) {
      const auto& items = value.Get<Value::Array>();
      std::vector<double> numbers;
      for (const Value& item : items) {
        if (item.IsNumber()) {
          numbers.push_back(item.GetNumberAsDouble());
        }
      }
      if (numbers.size() == items.size()) {
        to.numbers[key] = std::move(numbers);
      } else {
        to.others.insert(key);
      }
    } else if (value.IsObject() && value.Has("index")) {
      to.textures[key] = texture_info_of(value);
    } else {
      to.others.insert(key);
    }
  }
  return to;
}

GltfMaterial material(const tinygltf::Material& from) {
  GltfMaterial to;
  to.name = from.name;
  to.alpha_mode = from.alphaMode;
  to.base_color = array_or<4>(from.pbrMetallicRoughness.baseColorFactor, {1, 1, 1, 1});
  to.emissive = array_or<3>(from.emissiveFactor, {0, 0, 0});
  to.metallic = from.pbrMetallicRoughness.metallicFactor;
  to.roughness = from.pbrMetallicRoughness.roughnessFactor;
  to.normal_scale = from.normalTexture.scale;
  to.alpha_cutoff = from.alphaCutoff;
  to.double_sided = from.doubleSided;
  to.unlit = extension(from.extensions, "KHR_materials_unlit") != nullptr;
  to.base_color_texture = texture_info(from.pbrMetallicRoughness.baseColorTexture);
  to.metallic_roughness_texture = texture_info(from.pbrMetallicRoughness.metallicRoughnessTexture);
  to.normal_texture = texture_info(from.normalTexture);
  to.emissive_texture = texture_info(from.emissiveTexture);
  for (const auto& [name, value] : from.extensions) {
    if (value.IsObject()) {
      to.extensions[name] = extension_fields(value);
    }
  }
  return to;
}

GltfNode node(const tinygltf::Node& from) {
  GltfNode to;
  to.name = from.name;
  to.mesh = from.mesh;
  to.camera = from.camera;
  to.skin = from.skin;
  to.children = from.children;
  if (from.matrix.size() == 16) {
    const std::vector<double>& m = from.matrix;  // column by column
    to.has_matrix = true;
    to.matrix = {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
  }
  const auto t = array_or<3>(from.translation, {0, 0, 0});
  const auto r = array_or<4>(from.rotation, {0, 0, 0, 1});
  const auto s = array_or<3>(from.scale, {1, 1, 1});
  to.translation = {t[0], t[1], t[2]};
  to.rotation = normalize(Quatd{r[0], r[1], r[2], r[3]});
  to.scale = {s[0], s[1], s[2]};
  to.weights = from.weights;
  if (const Value* light = extension(from.extensions, "KHR_lights_punctual")) {
    to.light = static_cast<int>(number(*light, "light", -1));
  }
  if (const Value* visibility = extension(from.extensions, "KHR_node_visibility")) {
    const Value visible = visibility->Has("visible") ? visibility->Get("visible") : Value();
    to.hidden = visible.IsBool() && !visible.Get<bool>();
  }
  if (const Value* instancing = extension(from.extensions, "EXT_mesh_gpu_instancing")) {
    for (const auto& [name, accessor] : instancing->Get("attributes").Get<Value::Object>()) {
      to.instancing[name] = accessor.GetNumberAsInt();
    }
  }
  return to;
}

GltfAccessor accessor(const tinygltf::Accessor& from) {
  GltfAccessor to;
  to.buffer_view = from.bufferView;
  to.offset = from.byteOffset;
  to.count = from.count;
  to.component_type = from.componentType;
  to.components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(from.type));
  to.normalized = from.normalized;
  if (from.sparse.isSparse) {
    to.sparse = GltfAccessor::Sparse{static_cast<std::uint64_t>(from.sparse.count),
                                     from.sparse.indices.bufferView,
                                     from.sparse.indices.componentType,
                                     from.sparse.values.bufferView,
                                     static_cast<std::uint64_t>(from.sparse.indices.byteOffset),
                                     static_cast<std::uint64_t>(from.sparse.values.byteOffset)};
  }
  return to;
}

GltfMesh mesh(const tinygltf::Mesh& from) {
  GltfMesh to;
  to.name = from.name;
  to.weights = from.weights;
  for (const tinygltf::Primitive& primitive : from.primitives) {
    to.primitives.push_back(
        {primitive.attributes, primitive.indices, primitive.material, primitive.mode, primitive.targets});
  }
  if (from.extras.Has("targetNames") && from.extras.Get("targetNames").IsArray()) {
    for (const Value& name : from.extras.Get("targetNames").Get<Value::Array>()) {
      to.target_names.push_back(name.IsString() ? name.Get<std::string>() : std::string());
    }
  }
  return to;
}

GltfCamera camera(const tinygltf::Camera& from) {
  GltfCamera to;
  to.name = from.name;
  to.perspective = from.type == "perspective";
  to.yfov_rad = from.perspective.yfov;
  to.aspect = from.perspective.aspectRatio;
  to.xmag = from.orthographic.xmag;
  to.ymag = from.orthographic.ymag;
  to.znear = to.perspective ? from.perspective.znear : from.orthographic.znear;
  to.zfar = to.perspective ? from.perspective.zfar : from.orthographic.zfar;
  // A shifted lens, which glTF has not, in {"extras": {"gazetrace": {"middle_m": [0.1, 0]}}}.
  const Value own = from.extras.Has("gazetrace") ? from.extras.Get("gazetrace") : Value();
  const Value middle = own.Has("middle_m") ? own.Get("middle_m") : Value();
  if (middle.IsArray() && middle.ArrayLen() == 2 && middle.Get(0).IsNumber() && middle.Get(1).IsNumber()) {
    to.middle_m = {middle.Get(0).GetNumberAsDouble(), middle.Get(1).GetNumberAsDouble()};
  }
  return to;
}

GltfLight light(const tinygltf::Light& from) {
  GltfLight to;
  to.name = from.name;
  to.type = from.type;
  to.color = array_or<3>(from.color, {1, 1, 1});
  to.intensity = from.intensity;
  to.range = from.range;
  to.inner_cone_rad = from.spot.innerConeAngle;
  to.outer_cone_rad = from.spot.outerConeAngle;
  return to;
}

GltfAnimation animation(const tinygltf::Animation& from) {
  GltfAnimation to;
  to.name = from.name;
  for (const tinygltf::AnimationSampler& sampler : from.samplers) {
    to.samplers.push_back({sampler.input, sampler.output, sampler.interpolation});
  }
  for (const tinygltf::AnimationChannel& channel : from.channels) {
    to.channels.push_back({channel.sampler, channel.target_node, channel.target_path});
  }
  return to;
}

template <class From, class To, class Convert>
void convert_all(const std::vector<From>& from, std::vector<To>& to, Convert convert) {
  to.reserve(from.size());
  for (const From& item : from) {
    to.push_back(convert(item));
  }
}

std::vector<int> scene_roots(const tinygltf::Model& model) {
  std::vector<int> roots;
  if (!model.scenes.empty()) {
    const auto index = static_cast<std::size_t>(std::max(model.defaultScene, 0));
    roots = model.scenes[std::min(index, model.scenes.size() - 1)].nodes;
  } else {
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node& parent : model.nodes) {
      for (const int child : parent.children) {
        is_child[static_cast<std::size_t>(child)] = true;
      }
    }
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      if (!is_child[i]) {
        roots.push_back(static_cast<int>(i));
      }
    }
  }
  return roots;
}

// What a scene says of the light around it, in {"extras": {"gazetrace": {"environment": "dusk.hdr"}}}.
std::string environment_uri(const tinygltf::Model& model) {
  if (model.scenes.empty()) {
    return {};
  }
  const auto index = static_cast<std::size_t>(std::max(model.defaultScene, 0));
  const Value& extras = model.scenes[std::min(index, model.scenes.size() - 1)].extras;
  const Value own = extras.Has("gazetrace") ? extras.Get("gazetrace") : Value();
  const Value uri = own.Has("environment") ? own.Get("environment") : Value();
  return uri.IsString() ? uri.Get<std::string>() : std::string();
}

// CESIUM_RTC: an offset of the whole model, in metres. It becomes a node above all others, so that bodies, cameras,
// lights and what animations and skins do follow it alike.
void add_offset(const tinygltf::Model& model, GltfDocument& document) {
  const Value* rtc = extension(model.extensions, "CESIUM_RTC");
  if (rtc == nullptr) {
    return;
  }
  const Value center = rtc->Has("center") ? rtc->Get("center") : Value();
  std::array<double, 3> offset{};
  bool usable = center.IsArray() && center.ArrayLen() == 3;
  for (std::size_t i = 0; usable && i < 3; ++i) {
    const Value& number = center.Get(static_cast<int>(i));
    usable = number.IsNumber() && std::isfinite(number.GetNumberAsDouble());
    offset[i] = usable ? number.GetNumberAsDouble() : 0;
  }
  if (!usable) {
    throw Error(ErrorKind::input, document.path + ": extensions.CESIUM_RTC.center", "is not three numbers",
                "export the file again");
  }
  GltfNode above;
  above.name = "CESIUM_RTC";
  above.translation = {offset[0], offset[1], offset[2]};
  above.children = document.roots;
  document.roots = {static_cast<int>(document.nodes.size())};
  document.nodes.push_back(std::move(above));
}

bool leave_undecoded(tinygltf::Image* /*image*/, int /*index*/, std::string* /*error*/, std::string* /*warning*/,
                     int /*width*/, int /*height*/, const unsigned char* /*bytes*/, int /*size*/, void* /*user*/) {
  return true;
}

}  // namespace

GltfDocument parse_gltf(const std::string& path, const CheckedGltf& checked) {
  tinygltf::Model model;
  std::string problem;
  std::string warning;
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(leave_undecoded, nullptr);
  bool parsed = false;
  try {
    parsed = parser.LoadASCIIFromString(&model, &problem, &warning, checked.json.data(),
                                        static_cast<unsigned int>(checked.json.size()), "");
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::runtime, path, "there is not enough memory for its JSON", "make the scene smaller");
  } catch (const std::exception& error) {
    problem = error.what();
  }
  if (!parsed) {
    throw Error(ErrorKind::input, path, "is not valid glTF: " + problem, "check it with the Khronos glTF validator");
  }
  GltfDocument document;
  document.path = path;
  document.images = checked.images;
  document.extensions_used = model.extensionsUsed;
  convert_all(model.bufferViews, document.buffer_views, [](const tinygltf::BufferView& view) {
    return GltfBufferView{view.buffer, view.byteOffset, view.byteLength, view.byteStride};
  });
  convert_all(model.accessors, document.accessors, accessor);
  convert_all(model.meshes, document.meshes, mesh);
  convert_all(model.materials, document.materials, material);
  convert_all(model.nodes, document.nodes, node);
  convert_all(model.samplers, document.samplers, [](const tinygltf::Sampler& sampler) {
    return GltfSampler{sampler.magFilter, sampler.wrapS, sampler.wrapT};
  });
  convert_all(model.textures, document.textures, [](const tinygltf::Texture& texture) {
    const Value* webp = extension(texture.extensions, "EXT_texture_webp");
    return GltfTexture{texture.sampler,
                       static_cast<int>(webp != nullptr ? number(*webp, "source", texture.source) : texture.source)};
  });
  convert_all(model.cameras, document.cameras, camera);
  convert_all(model.lights, document.lights, light);
  convert_all(model.animations, document.animations, animation);
  convert_all(model.skins, document.skins, [](const tinygltf::Skin& skin) {
    return GltfSkin{skin.name, skin.joints, skin.inverseBindMatrices};
  });
  document.roots = scene_roots(model);
  document.scene_count = model.scenes.size();
  document.environment_uri = environment_uri(model);
  add_offset(model, document);
  return document;
}

}  // namespace gazetrace
