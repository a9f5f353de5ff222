// SPDX-License-Identifier: Apache-2.0
#include "trace/scene/layered_material.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "material/layered_surface.hpp"
#include "material/lobes/dielectric.hpp"
#include "material/lobes/dispersion.hpp"
#include "material/lobes/volume.hpp"

namespace gazetrace {
namespace {

bool shares_coordinates(const TextureRef& ref, const TextureRef* shared) {
  return shared != nullptr && ref.uv_set == shared->uv_set && ref.has_transform == shared->has_transform &&
         (!ref.has_transform || ref.transform == shared->transform);
}

ShadingTexture shading_texture(const Scene& scene, const TextureRef& ref, const TextureRef* shared) {
  ShadingTexture out;
  if (!ref.present()) {
    return out;
  }
  out.texture = &scene.textures[static_cast<std::size_t>(ref.texture)];
  const Texture::Level& level = out.texture->levels.front();
  out.half_log2_texels = 0.5F * std::log2(static_cast<float>(level.width_px) * static_cast<float>(level.height_px));
  out.own_uv = !shares_coordinates(ref, shared);
  out.uv_set = ref.uv_set;
  out.transform = ref.transform;
  return out;
}

}  // namespace

bool LayeredMaterial::any_own_uv() const {
  const std::array all{&clearcoat,
                       &clearcoat_roughness,
                       &clearcoat_normal,
                       &sheen_color,
                       &sheen_roughness,
                       &specular,
                       &specular_color,
                       &transmission,
                       &anisotropy,
                       &film,
                       &film_thickness,
                       &diffuse_transmission,
                       &diffuse_transmission_color};
  return std::any_of(all.begin(), all.end(),
                     [](const ShadingTexture* t) { return t->texture != nullptr && t->own_uv; });
}

LayeredMaterials make_layered_materials(const Scene& scene) {
  LayeredMaterials out;
  std::map<float, const DielectricAlbedo*> albedo_of;
  for (const Material& from : scene.materials) {
    const MaterialLayers layers = layers_of(from);
    if (!layers.any()) {
      out.index.push_back(LayeredMaterials::kNoLayers);
      continue;
    }
    out.index.push_back(static_cast<std::uint32_t>(out.materials.size()));
    LayeredMaterial& to = out.materials.emplace_back();
    to.source = &from;
    to.layers = layers;
    to.solid = layers.volume;
    to.transmits = layers.transmission || layers.diffuse_transmission;
    to.coat_is_apart = from.normal_texture.present() || from.clearcoat.normal_texture.present();
    to.absorption_per_m = to.solid ? absorption_per_m(from.volume) : Vec3f{};
    to.f0 = f0_of_ior(from.ior);
    for (int channel = 0; channel < 3; ++channel) {
      const auto c = static_cast<std::size_t>(channel);
      const float ior = layers.dispersion ? dispersed_ior(from.ior, from.dispersion, channel) : from.ior;
      to.ior[c] = std::max(ior, kLeastIor);
      if (to.solid && layers.transmission) {
        const DielectricAlbedo*& known = albedo_of[to.ior[c]];
        if (known == nullptr) {
          out.albedos.push_back(std::make_unique<DielectricAlbedo>(make_dielectric_albedo(to.ior[c])));
          known = out.albedos.back().get();
        }
        to.albedo[c] = known;
      }
    }
    if (layers.anisotropy) {
      if (out.anisotropic == nullptr) {
        out.anisotropic = std::make_unique<AnisotropicAlbedo>(make_anisotropic_albedo());
      }
      to.anisotropic = out.anisotropic.get();
    }
    const TextureRef* shared = shared_coordinates(from);
    const auto read = [&](const TextureRef& ref) { return shading_texture(scene, ref, shared); };
    to.clearcoat = read(from.clearcoat.texture);
    to.clearcoat_roughness = read(from.clearcoat.roughness_texture);
    to.clearcoat_normal = read(from.clearcoat.normal_texture);
    to.sheen_color = read(from.sheen.color_texture);
    to.sheen_roughness = read(from.sheen.roughness_texture);
    to.specular = read(from.specular.texture);
    to.specular_color = read(from.specular.color_texture);
    to.transmission = read(from.transmission.texture);
    to.anisotropy = read(from.anisotropy.texture);
    to.film = read(from.iridescence.texture);
    to.film_thickness = read(from.iridescence.thickness_texture);
    to.diffuse_transmission = read(from.diffuse_transmission.texture);
    to.diffuse_transmission_color = read(from.diffuse_transmission.color_texture);
  }
  return out;
}

}  // namespace gazetrace
