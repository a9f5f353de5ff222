// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/material.hpp"

namespace gazetrace {

MaterialLayers layers_of(const Material& material) {
  MaterialLayers layers;
  if (material.unlit) {
    return layers;
  }
  const auto positive = [](const Vec3f& c) { return c.x > 0 || c.y > 0 || c.z > 0; };
  const bool dielectric = material.metallic < 1 || material.metallic_roughness_texture.present();
  layers.clearcoat = material.clearcoat.factor > 0;
  layers.sheen = positive(material.sheen.color);
  layers.specular = dielectric && (material.specular.factor != 1 || !(material.specular.color == Vec3f{1, 1, 1}) ||
                                   material.specular.texture.present() || material.specular.color_texture.present());
  layers.ior = dielectric && material.ior != 1.5F;
  layers.transmission = dielectric && material.transmission.factor > 0;
  layers.diffuse_transmission = dielectric && material.diffuse_transmission.factor > 0;
  layers.volume = material.volume.present() && (layers.transmission || layers.diffuse_transmission);
  layers.anisotropy = material.anisotropy.strength > 0;
  layers.iridescence = material.iridescence.factor > 0;
  layers.dispersion = layers.volume && layers.transmission && material.dispersion > 0;
  return layers;
}

MaterialLayers operator|(const MaterialLayers& a, const MaterialLayers& b) {
  return {.clearcoat = a.clearcoat || b.clearcoat,
          .sheen = a.sheen || b.sheen,
          .specular = a.specular || b.specular,
          .ior = a.ior || b.ior,
          .transmission = a.transmission || b.transmission,
          .volume = a.volume || b.volume,
          .anisotropy = a.anisotropy || b.anisotropy,
          .iridescence = a.iridescence || b.iridescence,
          .diffuse_transmission = a.diffuse_transmission || b.diffuse_transmission,
          .dispersion = a.dispersion || b.dispersion};
}

std::array<const TextureRef*, 13> layer_textures(const Material& m) {
  return {&m.clearcoat.texture,
          &m.clearcoat.roughness_texture,
          &m.clearcoat.normal_texture,
          &m.sheen.color_texture,
          &m.sheen.roughness_texture,
          &m.specular.texture,
          &m.specular.color_texture,
          &m.transmission.texture,
          &m.anisotropy.texture,
          &m.iridescence.texture,
          &m.iridescence.thickness_texture,
          &m.diffuse_transmission.texture,
          &m.diffuse_transmission.color_texture};
}

}  // namespace gazetrace
