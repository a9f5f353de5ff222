// SPDX-License-Identifier: Apache-2.0
// The archived KHR_materials_pbrSpecularGlossiness, converted to a dielectric of KHR_materials_ior and
// KHR_materials_specular: metalness 0, base colour = diffuse, ior 0 (f0 = 1) times specular colour = specular,
// roughness = 1 - glossiness, whose texture stays in the alpha channel of the specular one. Where a file has both
// descriptions, this one is used, as the extension requires. No parameter is lost. The archived model reflected diffuse
// (1 - max(specular)) at every angle; here the diffuse part gets what the specular reflection leaves, which is the same
// at normal incidence on smooth surfaces and conserves energy at other angles.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_specular_glossiness(ExtensionReader& from, Material& to) {
  to.base_color = from.color_alpha("diffuseFactor", {1, 1, 1, 1});
  to.base_color_texture = from.texture("diffuseTexture", TextureUse::color);
  to.metallic = 0;
  to.roughness = 1.0F - from.number("glossinessFactor", 1, 0, 1);
  to.metallic_roughness_texture = {};
  to.ior = 0;
  to.specular = {};
  to.specular.color = from.color("specularFactor", {1, 1, 1});
  to.specular.color_texture = from.texture("specularGlossinessTexture", TextureUse::color);
  to.specular.color_texture_has_glossiness = to.specular.color_texture.present();
}

}  // namespace gazetrace
