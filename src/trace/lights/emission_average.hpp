// SPDX-License-Identifier: Apache-2.0
// The average emission of a triangle with an emissive texture, as a weight for choosing it, not as a radiance.
#pragma once

#include <cstddef>

#include "gazetrace/scene.hpp"

namespace gazetrace {

// The mean of material.emission times its texture over the triangle's texture coordinates, from the mip level at which
// they span at most eight texels. Black only where that level is black.
Vec3d average_emission(const Scene& scene, const Material& material, const Geometry& geometry, std::size_t triangle);

}  // namespace gazetrace
