// SPDX-License-Identifier: Apache-2.0
// The terms that multiply the density of any model and are numbers; contrast is a picture (picture.hpp).
#pragma once

namespace gazetrace {

// The share of the density that is left while the image moves over the retina at this speed, in (0, 1].
double retinal_velocity_factor(double speed_deg_s);

}  // namespace gazetrace
