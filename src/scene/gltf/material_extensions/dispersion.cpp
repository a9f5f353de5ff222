// SPDX-License-Identifier: Apache-2.0
// KHR_materials_dispersion: 20 / Abbe number; 0 means none.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_dispersion(ExtensionReader& from, Material& to) {
  constexpr double kMost = 1000;  // an Abbe number of 0.02, far below that of any real body
  to.dispersion = from.number("dispersion", 0, 0, kMost);
}

}  // namespace gazetrace
