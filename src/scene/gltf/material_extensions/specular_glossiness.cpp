// SPDX-License-Identifier: Apache-2.0
// KHR_materials_pbrSpecularGlossiness, archived, as the dielectric that KHR_materials_ior and KHR_materials_specular
// describe: metalness 0, base colour = diffuse, ior 0 (f0 = 1) times specular colour = specular, roughness = 1 -
// glossiness, whose texture keeps its place in the alpha channel of the specular one. A file with both descriptions is
// shown by this one, as the extension demands.
// What is lost: nothing of the parameters. The archived model reflected diffuse (1 - max(specular)) under every angle;
// here the diffuse part gets what the reflection leaves, which is the same at normal incidence on smooth surfaces and
// keeps the energy under the others.
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
