// SPDX-License-Identifier: Apache-2.0
// Warns of light that paths find only by chance.
#pragma once

#include "gazetrace/scene.hpp"

namespace gazetrace {

// Adds one warning where a scene has punctual lights and uses a material that transmits light and is smooth somewhere.
// Shadow rays end at everything that transmits, and a path through glass reaches a light without a size only by the
// little roughness that there is. Measured below a sheet under a sun: the standard deviation of one sample is 110 times
// the mean at a roughness of 0 to 0.05, 38 times at 0.1, 7 times at 0.2, and 1.6 times at 0.3.
void warn_of_lights_behind_glass(const Scene& scene, Warnings& warnings);

}  // namespace gazetrace
