// SPDX-License-Identifier: Apache-2.0
// Materials with extensions for tests: each with a single extension, white where it has a colour, and one with all of
// them.
#pragma once

#include <string>
#include <vector>

#include "material/layered_bsdf.hpp"

namespace gazetrace::test {

struct LayeredKind {
  std::string name;
  LayeredSurface surface;
};

inline const DielectricAlbedo& glass_albedo() {
  static const DielectricAlbedo table = make_dielectric_albedo(1.5);
  return table;
}

inline const AnisotropicAlbedo& anisotropic_albedo() {
  static const AnisotropicAlbedo table = make_anisotropic_albedo();
  return table;
}

inline LayeredSurface layered(float metallic, float roughness, const Vec3f& color = {1, 1, 1}) {
  LayeredSurface s;
  s.base = {color, metallic, roughness};
  s.anisotropic = &anisotropic_albedo();
  return s;
}

inline std::vector<LayeredKind> layered_kinds(float roughness, float metallic) {
  std::vector<LayeredKind> kinds;
  const auto add = [&](const char* name) -> LayeredSurface& {
    kinds.push_back({name, layered(metallic, roughness)});
    return kinds.back().surface;
  };
  add("plain");
  {
    LayeredSurface& s = add("specular and ior");
    s.f0 = tinted_f0(f0_of_ior(2.0F), {1, 0.5F, 2}, 0.7F);
    s.f90 = 0.7F;
  }
  add("f0 of 1").f0 = {1, 1, 1};
  add("anisotropy").anisotropy = 0.8F;
  {
    LayeredSurface& s = add("smooth clearcoat");
    s.clearcoat = 1;
    s.clearcoat_roughness = 0.03F;
  }
  {
    LayeredSurface& s = add("rough clearcoat");
    s.clearcoat = 0.6F;
    s.clearcoat_roughness = 0.6F;
  }
  {
    LayeredSurface& s = add("sheen");
    s.sheen_color = {1, 1, 1};
    s.sheen_roughness = 0.4F;
  }
  {
    LayeredSurface& s = add("narrow sheen");
    s.sheen_color = {1, 0.5F, 0.2F};
    s.sheen_roughness = 0;
  }
  {
    LayeredSurface& s = add("iridescence");
    s.film = 1;
    s.film_thickness_nm = 350;
  }
  {
    LayeredSurface& s = add("diffuse transmission");
    s.diffuse_transmission = 0.6F;
  }
  add("sheet").transmission = 1;
  {
    LayeredSurface& s = add("half a sheet, coated");
    s.transmission = 0.5F;
    s.clearcoat = 1;
    s.clearcoat_roughness = 0.2F;
  }
  for (const bool inside : {false, true}) {
    LayeredSurface& s = add(inside ? "glass from inside" : "glass");
    s.transmission = 1;
    s.solid = true;
    s.inside = inside;
    s.dielectric = &glass_albedo();
  }
  for (const bool inside : {false, true}) {
    LayeredSurface& s = add(inside ? "everything from inside" : "everything");
    s.transmission = 0.5F;
    s.solid = true;
    s.inside = inside;
    s.dielectric = &glass_albedo();
    s.anisotropy = 0.5F;
    s.film = 0.5F;
    s.clearcoat = 0.5F;
    s.clearcoat_roughness = 0.1F;
    s.sheen_color = {0.3F, 0.2F, 0.1F};
    s.sheen_roughness = 0.5F;
    s.diffuse_transmission = 0.5F;
  }
  return kinds;
}

}  // namespace gazetrace::test
