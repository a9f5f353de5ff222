// SPDX-License-Identifier: Apache-2.0
// The light of a picture divided by how it came to the camera. Every contribution of a path is divided by the weights
// of the path itself, so that the groups of a sample add up to its radiance, apart from rounding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gazetrace/math.hpp"

namespace gazetrace {

// By the first surface that the camera sees. Its diffuse lobe is that of the base, reflected or transmitted; all other
// lobes are specular: facets with their repeated scattering, refraction, clear coat and sheen. Where a direction could
// come from several lobes, its light is divided in proportion to their reflection. Direct light meets one surface on
// its way, whether a light sample or a ray found it, and indirect light meets more.
enum class LightGroup : std::uint8_t {
  diffuse_direct,
  diffuse_indirect,
  specular_direct,
  specular_indirect,
  emission,    // surfaces that are seen shining, unlit ones included
  background,  // the environment where it is seen itself
};
inline constexpr std::size_t kLightGroups = 6;

// Names of their AOVs, in this order: "diffuse_direct", ...
const std::vector<std::string>& light_group_names();

// Radiance, summed over a site's samples; one for each group.
struct LightGroupSums {
  std::array<Vec3f, kLightGroups> sum;
};

}  // namespace gazetrace
