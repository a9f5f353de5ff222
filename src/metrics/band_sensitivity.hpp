// SPDX-License-Identifier: Apache-2.0
// What FovVideoVDP multiplies the contrasts of a band by, and how it pools what comes of them: the steps that do not
// depend on whether the error is known or only expected. Section numbers are those of the paper.
#pragma once

#include <optional>
#include <vector>

#include "gazetrace/fovvideovdp.hpp"

namespace gazetrace {

inline constexpr float kLeastBackground = 0.1F;  // cd/m2
inline constexpr double kPoolSpace = 1.52134;
inline constexpr double kPoolChannels = 0.666092;
inline constexpr double kTransientWeight = 0.25;

// The factor of a band's contrasts: the pyramid halves them in all bands but the finest.
inline float band_contrast_gain(std::size_t band) {
  return band == 0 ? 1.0F : 2.0F;
}

// The directions of the columns and rows of a raster, and log2 of a band's frequency at each of its pixels.
struct BandGeometry {
  std::vector<float> azimuth_deg, elevation_deg;
  ImageGray log2_rho;  // empty where the metric is not foveated: the frequency of the centre holds everywhere
  float log2_rho_centre = 0;
};
BandGeometry band_geometry(const FovVideoVdpGeometry& geometry, bool foveated, double rho_cpd, int width_px,
                           int height_px, int threads);

// The corrected sensitivities of both channels along row y, for these luminances in cd/m2 (section 3.4). Without gaze
// the fovea's hold everywhere. The results have the background's size.
void band_sensitivity(const BandGeometry& band, const std::optional<Vec2f>& gaze_deg, int y,
                      const std::vector<float>& background, std::vector<float>& sustained,
                      std::vector<float>& transient);

// Q of a frame from that of its bands (section 3.6): a sum over the bands, then the channels.
double pooled_over_bands(const std::vector<double>& sustained, const std::vector<double>& transient);

}  // namespace gazetrace
