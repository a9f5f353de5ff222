// SPDX-License-Identifier: Apache-2.0
// KHR_materials_iridescence.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_iridescence(ExtensionReader& from, Material& to) {
  IridescenceParameters& film = to.iridescence;
  film.factor = from.number("iridescenceFactor", 0, 0, 1);
  film.ior = from.number("iridescenceIor", 1.3, 1, 100);
  constexpr double kMost_nm = 1e6;  // there is no interference in a film of a millimetre
  film.thickness_min_nm = from.number("iridescenceThicknessMinimum", 100, 0, kMost_nm);
  film.thickness_max_nm = from.number("iridescenceThicknessMaximum", 400, 0, kMost_nm);
  if (film.factor > 0) {
    film.texture = from.texture("iridescenceTexture", TextureUse::data);
    film.thickness_texture = from.texture("iridescenceThicknessTexture", TextureUse::data);
  }
}

}  // namespace gazetrace
