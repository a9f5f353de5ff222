// SPDX-License-Identifier: Apache-2.0
// The extensions of glTF that are supported, and those that change no picture.
#include <algorithm>
#include <array>
#include <utility>

#include "scene/gltf/check.hpp"
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

const std::vector<std::string>& known_gltf_extensions() {
  static const std::vector<std::string> kKnown = [] {
    std::vector<std::string> names{
        // geometry
        "KHR_mesh_quantization",
        "EXT_mesh_gpu_instancing",
        "EXT_meshopt_compression",
        "KHR_draco_mesh_compression",
        "CESIUM_RTC",
        // pictures
        "KHR_texture_transform",
        "EXT_texture_webp",
        // lights
        "KHR_lights_punctual",
        // materials, beside material_extensions.def
        "KHR_materials_unlit",
    };
    for (const MaterialExtension& extension : material_extension_readers()) {
      names.emplace_back(extension.extension);
    }
    return names;
  }();
  return kKnown;
}

const char* shown_without(std::string_view extension) {
  constexpr const char* kNothingDrawn = "nothing of it is drawn";
  constexpr const char* kNothingMoved = "nothing is moved by it";
  static constexpr std::array<std::pair<std::string_view, const char*>, 25> kShown{{
      {"KHR_materials_variants", "materials are those that stand without a choice"},
      {"KHR_node_visibility", "hidden nodes are left out for good"},
      {"MSFT_lod", "the finest level is shown"},
      {"CESIUM_primitive_outline", "outlines are not drawn"},
      {"KHR_xmp", kNothingDrawn},
      {"KHR_xmp_json_ld", kNothingDrawn},
      {"KHR_node_hoverability", kNothingDrawn},
      {"KHR_node_selectability", kNothingDrawn},
      {"KHR_audio", kNothingDrawn},
      {"KHR_audio_emitter", kNothingDrawn},
      {"EXT_mesh_features", kNothingDrawn},
      {"EXT_instance_features", kNothingDrawn},
      {"EXT_structural_metadata", kNothingDrawn},
      {"FB_ngon_encoding", kNothingDrawn},
      {"AGI_stk_metadata", kNothingDrawn},
      {"GODOT_single_root", kNothingDrawn},
      {"VRM", "it is shown as glTF, without VRM's additions"},
      {"VRMC_vrm", "it is shown as glTF, without VRM's additions"},
      {"AGI_articulations", kNothingMoved},
      {"KHR_interactivity", kNothingMoved},
      {"KHR_physics_rigid_bodies", kNothingMoved},
      {"KHR_implicit_shapes", kNothingDrawn},
      {"OMI_collider", kNothingDrawn},
      {"OMI_physics_body", kNothingMoved},
      {"OMI_physics_shape", kNothingDrawn},
  }};
  const auto* const it =
      std::find_if(kShown.begin(), kShown.end(), [&](const auto& row) { return row.first == extension; });
  return it == kShown.end() ? nullptr : it->second;
}

}  // namespace gazetrace
