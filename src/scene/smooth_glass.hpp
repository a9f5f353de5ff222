// SPDX-License-Identifier: Apache-2.0
// Light that paths find only by chance.
#pragma once

#include "gazetrace/scene.hpp"

namespace gazetrace {

// One warning where a scene has punctual lights and a used material that transmits light and is smooth somewhere.
// Shadow rays end at everything that transmits, and a path through glass meets a point or a direction only by way of
// the little roughness that there is. Measured under a sun and a sheet: the standard deviation of one sample is 110
// times the mean at a roughness of 0 to 0.05, 38 at 0.1, 7 at 0.2, 1.6 at 0.3.
void warn_of_lights_behind_glass(const Scene& scene, Warnings& warnings);

}  // namespace gazetrace
