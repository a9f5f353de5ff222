// SPDX-License-Identifier: Apache-2.0
// A clear sky with a sun, as an environment.
//
// The sky is the analytic model of A. J. Preetham, P. Shirley and B. Smits, "A Practical Analytic Model for Daylight",
// SIGGRAPH 1999, appendix A.2: luminance and chromaticity of a direction from turbidity and the sun's height. The sun
// is a disc of its true size, whose light the atmosphere attenuates by the transmittances of appendix A.1 for
// molecules and haze at three wavelengths; ozone, mixed gases and water vapour, which take a few per cent, are left
// out. Below the horizon, where the model ends, is a ground that reflects a part of its light.
#pragma once

#include "gazetrace/scene.hpp"

namespace gazetrace {

struct ClearSky {
  double turbidity = 3;           // 2: very clear, 3: clear, 6: hazy; the model was fitted for 2 to 6
  double sun_elevation_deg = 40;  // above the horizon, 0 to 90
  // From +z, where the camera of a scene without cameras stands, towards +x: the sun is at the left behind that camera.
  double sun_azimuth_deg = -30;
  double ground_albedo = 0.2;
};

// Luminance in cd/m2 and CIE chromaticity of the sky in a direction, without the sun. `direction` is of unit length and
// not below the horizon (y >= 0).
struct SkyColor {
  double luminance_cd_m2 = 0, x = 0, y = 0;
};
SkyColor clear_sky_color(const ClearSky& sky, const Vec3d& direction);
// The illuminance of a surface that faces the sun, in lux, for each of the linear Rec.709 primaries.
Vec3d sun_illuminance(const ClearSky& sky);
Vec3d sun_direction(const ClearSky& sky);  // towards it, of unit length

// Radiance 1 stands for this luminance: about that of a white surface which faces the sun.
inline constexpr double kSkyUnit_cd_m2 = 30000;

Environment clear_sky(const ClearSky& sky = {}, double rotation_deg = 0, double exposure_ev = 0);

}  // namespace gazetrace
