// SPDX-License-Identifier: Apache-2.0
// The material at a hit with its extensions, with textures applied. The z axis of the local frame is the shading normal
// on the viewer's side; its x axis is the direction in which an anisotropic surface is rougher.
#pragma once

#include "material/bsdf.hpp"
#include "material/lobes/anisotropic_albedo.hpp"
#include "material/lobes/dielectric_albedo.hpp"

namespace gazetrace {

struct LayeredSurface {
  Surface base;
  float anisotropy = 0;
  const AnisotropicAlbedo* anisotropic = nullptr;  // set where anisotropy > 0
  // Schlick's reflectances of the dielectric part, with KHR_materials_ior and KHR_materials_specular applied.
  Vec3f f0{kDielectricF0, kDielectricF0, kDielectricF0};
  float f90 = 1;

  float transmission = 0;
  float diffuse_transmission = 0;
  Vec3f diffuse_transmission_color{1, 1, 1};
  bool solid = false;                            // bounds a body, so light refracts; else a sheet without thickness
  bool inside = false;                           // seen from inside the body; its layers are on the other side
  float ior = 1.5F;                              // of the body
  const DielectricAlbedo* dielectric = nullptr;  // for that index; set where solid and transmission > 0

  float film = 0;  // KHR_materials_iridescence
  float film_ior = 1.3F, film_thickness_nm = 400;

  Vec3f sheen_color{0, 0, 0};
  float sheen_roughness = 0;

  float clearcoat = 0, clearcoat_roughness = 0;
  Vec3f clearcoat_normal{0, 0, 1};  // unit, in the local frame; less than 90 degrees from the view
};

// KHR_materials_ior; an index of 0 means a reflectance of 1.
inline float f0_of_ior(float ior) noexcept {
  const float r = ior > 0 ? (ior - 1.0F) / (ior + 1.0F) : 1.0F;
  return ior == 1.5F ? kDielectricF0 : r * r;
}

// KHR_materials_specular: f0 = factor * min(f0(ior) * colour, 1), f90 = factor.
inline Vec3f tinted_f0(float f0, const Vec3f& color, float factor) noexcept {
  return Vec3f{std::min(f0 * color.x, 1.0F), std::min(f0 * color.y, 1.0F), std::min(f0 * color.z, 1.0F)} * factor;
}

}  // namespace gazetrace
