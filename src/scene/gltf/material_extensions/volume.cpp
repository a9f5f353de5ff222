// SPDX-License-Identifier: Apache-2.0
// KHR_materials_volume. The thickness texture is not read: it tells rasterisers how far light travels inside, which
// rays find by themselves. A missing attenuation distance is infinite.
#include "scene/gltf/material_extension.hpp"

namespace gazetrace {

void read_volume(ExtensionReader& from, Material& to) {
  to.volume.thickness = from.number("thicknessFactor", 0);
  to.volume.attenuation_color = from.color("attenuationColor", {1, 1, 1});
  const double never = std::numeric_limits<double>::infinity();
  to.volume.attenuation_distance_m = from.number("attenuationDistance", never, std::numeric_limits<float>::min());
}

}  // namespace gazetrace
