// SPDX-License-Identifier: Apache-2.0
// KHR_materials_specular: f0 = factor * min(f0(ior) * colour, 1), f90 = factor, of the dielectric part alone.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_specular(ExtensionReader& from, Material& to) {
  to.specular.factor = from.number("specularFactor", 1, 0, 1);
  to.specular.color = from.color("specularColorFactor", {1, 1, 1}, std::numeric_limits<float>::max());
  to.specular.texture = from.texture("specularTexture", TextureUse::data);
  to.specular.color_texture = from.texture("specularColorTexture", TextureUse::color);
}

}  // namespace gazetrace
