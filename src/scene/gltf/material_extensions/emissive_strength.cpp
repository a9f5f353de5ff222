// SPDX-License-Identifier: Apache-2.0
// KHR_materials_emissive_strength: emission = emissiveFactor * emissiveStrength * emissiveTexture.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_emissive_strength(ExtensionReader& from, Material& to) {
  to.emission = from.number("emissiveStrength", 1) * to.emission;
}

}  // namespace gazetrace
