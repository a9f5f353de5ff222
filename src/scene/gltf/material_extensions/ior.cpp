// SPDX-License-Identifier: Apache-2.0
// KHR_materials_ior: f0 = ((ior - 1) / (ior + 1))^2. 0 is allowed and stands for f0 = 1.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_ior(ExtensionReader& from, Material& to) {
  const float ior = from.number("ior", 1.5, 0, 100);
  to.ior = ior > 0 && ior < 1 ? from.number("ior", 1.5, 1, 100) : ior;  // with the warning of a clamped number
}

}  // namespace gazetrace
