// SPDX-License-Identifier: Apache-2.0
// KHR_materials_clearcoat.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_clearcoat(ExtensionReader& from, Material& to) {
  ClearcoatLayer& coat = to.clearcoat;
  coat.factor = from.number("clearcoatFactor", 0, 0, 1);
  coat.roughness = from.number("clearcoatRoughnessFactor", 0, 0, 1);
  if (!(coat.factor > 0)) {
    return;
  }
  coat.texture = from.texture("clearcoatTexture", TextureUse::data);
  coat.roughness_texture = from.texture("clearcoatRoughnessTexture", TextureUse::data);
  coat.normal_texture = from.texture("clearcoatNormalTexture", TextureUse::normal);
  coat.normal_scale = from.texture_scale("clearcoatNormalTexture");
}

}  // namespace gazetrace
