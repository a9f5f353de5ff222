// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/check.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

#include "core/json_problem.hpp"
#include "gazetrace/error.hpp"
#include "scene/gltf/estimate.hpp"
#include "scene/gltf/json.hpp"
#include "scene/gltf/material_extension.hpp"
#include "scene/gltf/walker.hpp"

namespace gazetrace {
namespace {

constexpr int kMostNesting = 200;
constexpr std::uint64_t kNodeShare = 16;  // nodes may take one part in so many of the memory
constexpr std::uint64_t kMaxIndex = std::numeric_limits<std::int32_t>::max();

using Step = Walker::Step;

std::string remedy_for_extension(const std::string& name) {
  if (name == "KHR_texture_basisu") {
    return "convert its textures to PNG or WebP, for example with gltf-transform";
  }
  return "export the file without it";
}

void check_asset(Walker& walker, const Json& root, const std::string& path) {
  const Json* asset = walker.object(root, "asset");
  if (asset == nullptr) {
    throw Error(ErrorKind::input, path, "'asset' is missing, so this is not a glTF 2.0 file");
  }
  const Step step(walker, "asset");
  walker.text(*asset, "version", true);
  walker.text(*asset, "minVersion");
  const auto version = (*asset)["version"].get<std::string>();
  const auto minimum = asset->value("minVersion", std::string("2.0"));
  if (!version.starts_with("2.") || minimum != "2.0") {
    walker.fail("glTF version " + (version.starts_with("2.") ? minimum : version) + " cannot be read", "export as 2.0");
  }
  const auto& known = known_gltf_extensions();
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    const Json* list = walker.find(root, key);
    if (list == nullptr) {
      continue;
    }
    if (!list->is_array() ||
        !std::all_of(list->begin(), list->end(), [](const Json& value) { return value.is_string(); })) {
      throw Error(ErrorKind::input, path + ": " + key, "is not an array of names");
    }
    for (const Json& item : *list) {
      const auto name = item.get<std::string>();
      if (std::string_view(key) == "extensionsRequired" && shown_without(name) == nullptr &&
          std::find(known.begin(), known.end(), name) == known.end()) {
        throw Error(ErrorKind::input, path, "requires the extension " + name + ", which is not supported",
                    remedy_for_extension(name));
      }
    }
  }
}

void check_accessors(Walker& walker, const Json& root) {
  walker.each_object(root, "bufferViews", [&](const Json& view) {
    walker.reference(view, "buffer", "buffers", true);
    walker.whole(view, "byteOffset");
    walker.whole(view, "byteLength", true);
    walker.whole(view, "byteStride", false, 252);
  });
  walker.each_object(root, "accessors", [&](const Json& accessor) {
    walker.reference(accessor, "bufferView", "bufferViews");
    walker.whole(accessor, "byteOffset");
    walker.whole(accessor, "count", true, std::numeric_limits<std::uint32_t>::max());
    walker.text(accessor, "type", true);
    const auto component = walker.whole(accessor, "componentType", true);
    if (component < 5120U || component > 5126U || component == 5124U) {
      walker.fail("componentType " + std::to_string(*component) + " does not exist");
    }
    if (const Json* sparse = walker.object(accessor, "sparse")) {
      const Step step(walker, "sparse");
      walker.whole(*sparse, "count", true, kMaxIndex);
      for (const char* part : {"indices", "values"}) {
        const Json* object = walker.object(*sparse, part);
        if (object == nullptr) {
          walker.fail("'" + std::string(part) + "' is missing");
        }
        const Step inner(walker, part);
        walker.reference(*object, "bufferView", "bufferViews", true);
        walker.whole(*object, "byteOffset", false, kMaxIndex);
        walker.whole(*object, "componentType", std::string_view(part) == "indices", kMaxIndex);
      }
    }
  });
}

void check_meshes(Walker& walker, const Json& root) {
  walker.each_object(root, "meshes", [&](const Json& mesh) {
    walker.text(mesh, "name");
    std::optional<std::size_t> targets;  // the same for all primitives (glTF 2.0 section 3.7.2.2)
    walker.each_object(mesh, "primitives", [&](const Json& primitive) {
      walker.reference_map(primitive, "attributes", "accessors", true);
      walker.reference(primitive, "indices", "accessors");
      walker.reference(primitive, "material", "materials");
      walker.whole(primitive, "mode", false, 6);
      std::size_t count = 0;
      walker.each_object(primitive, "targets", [&](const Json& target) {
        ++count;
        for (const auto& [name, value] : target.items()) {
          const Step attribute(walker, name);
          walker.reference_value(value, "accessors");
        }
      });
      if (targets && *targets != count) {
        walker.fail("has " + std::to_string(count) + " morph targets, the primitives before it have " +
                    std::to_string(*targets));
      }
      targets = count;
    });
    if (targets.value_or(0) > 0) {
      walker.numbers(mesh, "weights", *targets);
    }
  });
}

void check_texture_info(Walker& walker, const Json& parent, const char* key) {
  const Json* info = walker.object(parent, key);
  if (info == nullptr) {
    return;
  }
  const Step step(walker, key);
  walker.reference(*info, "index", "textures", true);
  walker.whole(*info, "texCoord", false, 255);
  walker.number(*info, "scale");
  if (const Json* extensions = walker.object(*info, "extensions")) {
    if (const Json* transform = walker.object(*extensions, "KHR_texture_transform")) {
      const Step inner(walker, "extensions.KHR_texture_transform");
      walker.numbers(*transform, "offset", 2);
      walker.numbers(*transform, "scale", 2);
      walker.number(*transform, "rotation");
      walker.whole(*transform, "texCoord", false, 255);
    }
  }
}

void check_materials(Walker& walker, const Json& root) {
  walker.each_object(root, "materials", [&](const Json& material) {
    walker.text(material, "name");
    walker.text(material, "alphaMode");
    walker.number(material, "alphaCutoff");
    walker.numbers(material, "emissiveFactor", 3);
    check_texture_info(walker, material, "normalTexture");
    check_texture_info(walker, material, "emissiveTexture");
    if (const Json* pbr = walker.object(material, "pbrMetallicRoughness")) {
      const Step step(walker, "pbrMetallicRoughness");
      walker.numbers(*pbr, "baseColorFactor", 4);
      walker.number(*pbr, "metallicFactor");
      walker.number(*pbr, "roughnessFactor");
      check_texture_info(walker, *pbr, "baseColorTexture");
      check_texture_info(walker, *pbr, "metallicRoughnessTexture");
    }
    if (const Json* extensions = walker.object(material, "extensions")) {
      for (const MaterialExtension& known : material_extension_readers()) {
        if (const Json* extension = walker.object(*extensions, known.extension)) {
          const std::string place = "extensions." + std::string(known.extension);
          const Step step(walker, place);
          for (const auto& [key, value] : extension->items()) {
            if (value.is_object() && value.contains("index")) {
              check_texture_info(walker, *extension, key.c_str());
            }
          }
        }
      }
    }
  });
  walker.each_object(root, "textures", [&](const Json& texture) {
    walker.reference(texture, "source", "images");
    walker.reference(texture, "sampler", "samplers");
    if (const Json* extensions = walker.object(texture, "extensions")) {
      if (const Json* webp = walker.object(*extensions, "EXT_texture_webp")) {
        const Step step(walker, "extensions.EXT_texture_webp");
        walker.reference(*webp, "source", "images");
      }
    }
  });
  walker.each_object(root, "samplers", [&](const Json& sampler) {
    for (const char* key : {"magFilter", "minFilter", "wrapS", "wrapT"}) {
      walker.whole(sampler, key, false, 65535);
    }
  });
}

std::size_t light_count(Walker& walker, const Json& root) {
  const Json* extensions = walker.object(root, "extensions");
  const Json* lights = extensions != nullptr ? walker.object(*extensions, "KHR_lights_punctual") : nullptr;
  if (lights == nullptr) {
    return 0;
  }
  const Step step(walker, "extensions.KHR_lights_punctual");
  std::size_t count = 0;
  walker.each_object(*lights, "lights", [&](const Json& light) {
    ++count;
    walker.text(light, "type", true);
    const auto type = light["type"].get<std::string>();
    if (type != "directional" && type != "point" && type != "spot") {
      walker.fail("'" + type + "' is not a kind of light", "use directional, point or spot");
    }
    walker.numbers(light, "color", 3);
    walker.number(light, "intensity");
    walker.number(light, "range");
    const Json* spot = walker.object(light, "spot");
    if (type == "spot" && spot == nullptr) {
      walker.fail("'spot' is missing");
    }
    if (spot != nullptr) {
      const Step inner(walker, "spot");
      walker.number(*spot, "innerConeAngle");
      walker.number(*spot, "outerConeAngle");
    }
  });
  return count;
}

void check_node_extensions(Walker& walker, const Json& node, std::size_t lights) {
  const Json* extensions = walker.object(node, "extensions");
  if (extensions == nullptr) {
    return;
  }
  const Step step(walker, "extensions");
  if (const Json* light = walker.object(*extensions, "KHR_lights_punctual")) {
    const Step inner(walker, "KHR_lights_punctual");
    if (walker.whole(*light, "light", true).value_or(0) >= lights) {
      walker.fail("'light' is not an index into the " + std::to_string(lights) + " lights");
    }
  }
  if (const Json* instancing = walker.object(*extensions, "EXT_mesh_gpu_instancing")) {
    const Step inner(walker, "EXT_mesh_gpu_instancing");
    walker.reference_map(*instancing, "attributes", "accessors", true);
  }
}

void check_nodes(Walker& walker, const Json& root) {
  const std::size_t lights = light_count(walker, root);
  walker.each_object(root, "nodes", [&](const Json& node) {
    walker.text(node, "name");
    walker.reference(node, "mesh", "meshes");
    walker.reference(node, "camera", "cameras");
    walker.reference(node, "skin", "skins");
    walker.references(node, "children", "nodes");
    walker.numbers(node, "matrix", 16);
    walker.numbers(node, "translation", 3);
    walker.numbers(node, "rotation", 4);
    walker.numbers(node, "scale", 3);
    check_node_extensions(walker, node, lights);
  });
  walker.each_object(root, "scenes", [&](const Json& scene) { walker.references(scene, "nodes", "nodes"); });
  walker.reference(root, "scene", "scenes");
  walker.each_object(root, "skins", [&](const Json& skin) {
    walker.text(skin, "name");
    walker.references(skin, "joints", "nodes");
    const Json* joints = walker.find(skin, "joints");
    if (joints == nullptr || joints->empty()) {
      walker.fail("has no joints");
    }
    walker.reference(skin, "inverseBindMatrices", "accessors");
  });
}

void check_cameras_and_animations(Walker& walker, const Json& root) {
  walker.each_object(root, "cameras", [&](const Json& camera) {
    walker.text(camera, "name");
    walker.text(camera, "type", true);
    const auto type = camera["type"].get<std::string>();
    if (type != "perspective" && type != "orthographic") {
      walker.fail("'" + type + "' is not a kind of camera", "use perspective or orthographic");
    }
    const Json* lens = walker.object(camera, type.c_str());
    if (lens == nullptr) {
      walker.fail("'" + type + "' is missing");
    }
    const Step step(walker, type);
    walker.number(*lens, type == "perspective" ? "yfov" : "ymag", true);
    walker.number(*lens, type == "perspective" ? "aspectRatio" : "xmag");
    walker.number(*lens, "znear", true);
    walker.number(*lens, "zfar", type == "orthographic");
  });
  walker.each_object(root, "animations", [&](const Json& animation) {
    walker.text(animation, "name");
    std::size_t samplers = 0;
    walker.each_object(animation, "samplers", [&](const Json& sampler) {
      ++samplers;
      walker.reference(sampler, "input", "accessors", true);
      walker.reference(sampler, "output", "accessors", true);
      walker.text(sampler, "interpolation");
    });
    walker.each_object(animation, "channels", [&](const Json& channel) {
      if (walker.whole(channel, "sampler", true).value_or(0) >= samplers) {
        walker.fail("'sampler' is not an index into the " + std::to_string(samplers) + " samplers");
      }
      if (const Json* target = walker.object(channel, "target")) {
        const Step step(walker, "target");
        walker.reference(*target, "node", "nodes");
        walker.text(*target, "path", true);
      } else {
        walker.fail("'target' is missing");
      }
    });
  });
}

// Takes out what EXT_meshopt_compression and KHR_draco_mesh_compression pack, so that the parser gets plain bufferViews
// and primitives. The values themselves are checked where they are decoded.
void take_compression(Walker& walker, Json& root, CheckedGltf& checked) {
  int view_index = 0;
  walker.each_object(root, "bufferViews", [&](const Json& view) {
    const Json* extensions = walker.object(view, "extensions");
    const Json* meshopt = extensions != nullptr ? walker.object(*extensions, "EXT_meshopt_compression") : nullptr;
    if (meshopt != nullptr) {
      const Step step(walker, "extensions.EXT_meshopt_compression");
      walker.reference(*meshopt, "buffer", "buffers", true);
      walker.text(*meshopt, "mode", true);
      walker.text(*meshopt, "filter");
      MeshoptView packed;
      packed.view = view_index;
      packed.buffer = (*meshopt)["buffer"].get<int>();
      packed.offset = walker.whole(*meshopt, "byteOffset").value_or(0);
      packed.length = walker.whole(*meshopt, "byteLength", true).value_or(0);
      packed.stride = walker.whole(*meshopt, "byteStride", true, 256).value_or(0);
      packed.count = walker.whole(*meshopt, "count", true, std::numeric_limits<std::uint32_t>::max()).value_or(0);
      packed.mode = (*meshopt)["mode"].get<std::string>();
      packed.filter = meshopt->value("filter", std::string("NONE"));
      checked.meshopt_views.push_back(std::move(packed));
    }
    ++view_index;
  });
  int mesh_index = 0;
  walker.each_object(root, "meshes", [&](const Json& mesh) {
    int primitive_index = 0;
    walker.each_object(mesh, "primitives", [&](const Json& primitive) {
      const Json* extensions = walker.object(primitive, "extensions");
      const Json* draco = extensions != nullptr ? walker.object(*extensions, "KHR_draco_mesh_compression") : nullptr;
      if (draco != nullptr) {
        const Step step(walker, "extensions.KHR_draco_mesh_compression");
        walker.reference(*draco, "bufferView", "bufferViews", true);
        DracoPrimitive packed{mesh_index, primitive_index, (*draco)["bufferView"].get<int>(), {}};
        const Json* attributes = walker.object(*draco, "attributes");
        if (attributes == nullptr) {
          walker.fail("'attributes' is missing");
        }
        const Step inner(walker, "attributes");
        for (const auto& [name, value] : attributes->items()) {
          packed.attributes[name] = walker.whole(*attributes, name.c_str(), true, kMaxIndex).value_or(0);
          if (!primitive["attributes"].contains(name)) {
            walker.fail("the primitive itself has no attribute " + name);
          }
        }
        checked.draco_primitives.push_back(std::move(packed));
      }
      ++primitive_index;
    });
    ++mesh_index;
  });
  for (const MeshoptView& packed : checked.meshopt_views) {
    root["bufferViews"][static_cast<std::size_t>(packed.view)].erase("extensions");
  }
  for (const DracoPrimitive& packed : checked.draco_primitives) {
    Json& primitive =
        root["meshes"][static_cast<std::size_t>(packed.mesh)]["primitives"][static_cast<std::size_t>(packed.primitive)];
    primitive.erase("extensions");
    primitive.erase("indices");  // mostly without a bufferView, which the parser refuses; the stream has its own
  }
}

// Takes out buffers and pictures, since the parser wants buffers of the exact size, decodes pictures one by one and
// refuses empty ones. It gets one byte in place of each.
void take_binary_sources(Walker& walker, Json& root, CheckedGltf& checked) {
  walker.each_object(root, "buffers", [&](const Json& buffer) {
    walker.text(buffer, "uri");
    GltfBufferSource source;
    source.byte_length = walker.whole(buffer, "byteLength", true).value_or(0);
    source.uri = buffer.value("uri", std::string());
    if (const Json* extensions = walker.object(buffer, "extensions")) {
      const Json* meshopt = walker.object(*extensions, "EXT_meshopt_compression");
      source.fallback = meshopt != nullptr && meshopt->contains("fallback") && (*meshopt)["fallback"] == true;
    }
    checked.buffers.push_back(std::move(source));
  });
  walker.each_object(root, "images", [&](const Json& image) {
    walker.text(image, "name");
    walker.text(image, "uri");
    walker.reference(image, "bufferView", "bufferViews");
    GltfImageSource source;
    source.name = image.value("name", std::string());
    source.uri = image.value("uri", std::string());
    source.buffer_view = image.value("bufferView", -1);
    checked.images.push_back(std::move(source));
  });
  for (std::size_t i = 0; i < checked.buffers.size(); ++i) {
    root["buffers"][i] = {{"byteLength", 1}, {"uri", "data:application/octet-stream;base64,AA=="}};
  }
  for (std::size_t i = 0; i < checked.images.size(); ++i) {
    root["images"][i] = {{"uri", "data:image/png;base64,AA=="}};
  }
}

}  // namespace

CheckedGltf check_gltf_json(const std::string& path, std::string_view json_text, std::uint64_t memory_bytes) {
  if (is_nested_too_deep(json_text, kMostNesting)) {
    throw Error(ErrorKind::input, path,
                "the JSON is nested more than " + std::to_string(kMostNesting) + " deep, which is the limit",
                "export the file again");
  }
  Json root;
  try {
    root = Json::parse(json_text);
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::input, path, "is not valid JSON: " + json_problem(error.what()),
                "is it a .gltf or .glb file, complete?");
  }
  if (!root.is_object()) {
    throw Error(ErrorKind::input, path, "is not a glTF file: its JSON is not an object");
  }
  const auto nodes = root.find("nodes");
  const std::uint64_t most_nodes = memory_bytes / (kNodeShare * kNodeBytes);
  if (nodes != root.end() && nodes->is_array() && nodes->size() > most_nodes) {
    throw Error(ErrorKind::input, path + ": nodes",
                "there are " + std::to_string(nodes->size()) + " nodes; the limit is " + std::to_string(most_nodes),
                "join bodies that stand still, or raise `max-memory`");
  }
  tidy_numbers(root);
  Walker walker(path, root);
  check_asset(walker, root, path);
  check_accessors(walker, root);
  check_meshes(walker, root);
  check_materials(walker, root);
  check_nodes(walker, root);
  check_cameras_and_animations(walker, root);
  CheckedGltf checked;
  take_compression(walker, root, checked);
  take_binary_sources(walker, root, checked);
  checked.json = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  return checked;
}

}  // namespace gazetrace
