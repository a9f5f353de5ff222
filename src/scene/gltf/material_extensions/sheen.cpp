// SPDX-License-Identifier: Apache-2.0
// KHR_materials_sheen.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_sheen(ExtensionReader& from, Material& to) {
  SheenLayer& sheen = to.sheen;
  sheen.color = from.color("sheenColorFactor", {0, 0, 0});
  sheen.roughness = from.number("sheenRoughnessFactor", 0, 0, 1);
  if (sheen.color == Vec3f{0, 0, 0}) {
    return;
  }
  sheen.color_texture = from.texture("sheenColorTexture", TextureUse::color);
  sheen.roughness_texture = from.texture("sheenRoughnessTexture", TextureUse::data);
}

}  // namespace gazetrace
