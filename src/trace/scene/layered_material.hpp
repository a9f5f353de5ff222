// SPDX-License-Identifier: Apache-2.0
// Materials with extensions, in the form that the inner loop reads. Materials without any have no entry.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "gazetrace/scene.hpp"
#include "material/lobes/anisotropic_albedo.hpp"
#include "material/lobes/dielectric_albedo.hpp"
#include "trace/scene/texture.hpp"

namespace gazetrace {

struct LayeredMaterial {
  const Material* source = nullptr;
  MaterialLayers layers;
  bool solid = false;          // bounds a body
  bool transmits = false;      // somewhere on it light may leave on the other side
  bool coat_is_apart = false;  // the coat's normal differs from the base's, since one of them has a normal map
  Vec3f absorption_per_m{0, 0, 0};
  float f0 = 0.04F;                                 // from the index of refraction, not yet tinted
  std::array<float, 3> ior{1.5F, 1.5F, 1.5F};       // for red, green and blue; all equal without dispersion
  std::array<const DielectricAlbedo*, 3> albedo{};  // for these indices; set where solid and transmissive
  const AnisotropicAlbedo* anisotropic = nullptr;   // set where anisotropic

  ShadingTexture clearcoat, clearcoat_roughness, clearcoat_normal, sheen_color, sheen_roughness, specular,
      specular_color, transmission, anisotropy, film, film_thickness, diffuse_transmission, diffuse_transmission_color;

  [[nodiscard]] bool any_own_uv() const;
};

struct LayeredMaterials {
  std::vector<LayeredMaterial> materials;
  std::vector<std::uint32_t> index;  // for each material of the scene, its index into `materials`; kNoLayers: none
  std::vector<std::unique_ptr<DielectricAlbedo>> albedos;
  std::unique_ptr<AnisotropicAlbedo> anisotropic;

  static constexpr std::uint32_t kNoLayers = 0xffffffffU;
  [[nodiscard]] const LayeredMaterial* of(std::uint32_t material) const {
    const std::uint32_t i = index[material];
    return i == kNoLayers ? nullptr : &materials[i];
  }
};

// The result keeps pointers into `scene`.
LayeredMaterials make_layered_materials(const Scene& scene);

}  // namespace gazetrace
