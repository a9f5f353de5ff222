// SPDX-License-Identifier: Apache-2.0
// How brightly a triangle with an emissive texture shines on average: a weight for choosing it, not a radiance.
#pragma once

#include <cstddef>

#include "gazetrace/scene.hpp"

namespace gazetrace {

// Mean of material.emission times its texture over the triangle's texture coordinates, from the mip level at which they
// span at most eight texels. Black where that level holds nothing else.
Vec3d average_emission(const Scene& scene, const Material& material, const Geometry& geometry, std::size_t triangle);

}  // namespace gazetrace
