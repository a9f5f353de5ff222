// SPDX-License-Identifier: Apache-2.0
// KHR_materials_transmission.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_transmission(ExtensionReader& from, Material& to) {
  to.transmission.factor = from.number("transmissionFactor", 0, 0, 1);
  if (to.transmission.factor > 0) {
    to.transmission.texture = from.texture("transmissionTexture", TextureUse::data);
  }
}

}  // namespace gazetrace
