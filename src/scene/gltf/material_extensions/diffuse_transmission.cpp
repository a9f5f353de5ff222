// SPDX-License-Identifier: Apache-2.0
// KHR_materials_diffuse_transmission.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_diffuse_transmission(ExtensionReader& from, Material& to) {
  DiffuseTransmissionParameters& through = to.diffuse_transmission;
  through.factor = from.number("diffuseTransmissionFactor", 0, 0, 1);
  through.color = from.color("diffuseTransmissionColorFactor", {1, 1, 1});
  if (through.factor > 0) {
    through.texture = from.texture("diffuseTransmissionTexture", TextureUse::data);
    through.color_texture = from.texture("diffuseTransmissionColorTexture", TextureUse::color);
  }
}

}  // namespace gazetrace
