// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP: what of a video's difference from its reference is seen, given where the eye looks (Mantiuk et al.,
// "FovVideoVDP: A visible difference predictor for wide field-of-view video", ACM Transactions on Graphics 40(4),
// 2021). Written from the formulas of the paper and of its sources, with the parameter values of version 1.2 of the
// authors' program; scores of other versions do not compare.
//
// It sees luminance only, and no uniform differences: black against white scores 10. Scores compare only for the same
// display, frame rate, gaze and version, and scores at different gaze positions do not compare at all.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/metrics.hpp"

namespace gazetrace {

inline constexpr const char* kFovVideoVdpParameters = "FovVideoVDP parameters 1.2";

// From code values to luminance. The default is the metric's standard_4k.
struct DisplayPhotometry {
  DisplayResponse response = DisplayResponse::srgb;
  double peak_cd_m2 = 200;
  double contrast = 1000;  // peak over the display's own black
  double ambient_lux = 250;
  double reflectivity = 0.005;
};
double black_level_cd_m2(const DisplayPhotometry& photometry);  // the display's own and reflected ambient light
// Y = 0.2126729 R + 0.7151522 G + 0.0721750 B with each channel through response, peak and black level.
ImageGray display_luminance(const ImageRgb& code, const DisplayPhotometry& photometry, int threads = 0);
// Light that is linear: `scale` cd/m2 a unit, each channel clamped to 0.005..`most_cd_m2`, then `black_cd_m2` added.
ImageGray linear_luminance(const ImageRgb& light, double scale, double most_cd_m2 = 10000, double black_cd_m2 = 0,
                           int threads = 0);

// The metric's own geometry: a flat display that the picture FILLS, whatever the picture's size in pixels. Angles are
// (azimuth, elevation) pairs and their Euclidean distance, not angles between rays: keep them inside the metric.
// A picture that lies off the eye's perpendicular is one on a display of its own size, so far right and up of it.
struct FovVideoVdpGeometry {
  int width_px = 3840, height_px = 2160;  // of the display
  double width_m = 0.66414056, height_m = 0.37357906, distance_m = 0.7472;
  // Of the middle, from the foot of the eye's perpendicular. The authors' program has no more than 0.
  double right_m = 0, up_m = 0;

  [[nodiscard]] double pixels_per_degree() const;  // at the foot of the eye's perpendicular
  // Degrees right and up of a continuous position in a raster of this size.
  [[nodiscard]] Vec2d view_direction_deg(double x, double y, int raster_width, int raster_height) const;
  // How much more pixels a degree has in this direction than there.
  [[nodiscard]] double magnification(const Vec2d& direction_deg) const;
};
FovVideoVdpGeometry fovvideovdp_geometry(const DisplayGeometry& display);
FovVideoVdpGeometry geometry_from_diagonal(int width_px, int height_px, double diagonal_inches, double distance_m);
FovVideoVdpGeometry geometry_from_horizontal_fov(int width_px, int height_px, double fov_deg, double distance_m = 3);
FovVideoVdpGeometry geometry_from_diagonal_fov(int width_px, int height_px, double fov_deg, double distance_m = 3);

struct FovVideoVdpSettings {
  FovVideoVdpGeometry geometry;
  bool foveated = true;          // false: the fovea's sensitivity everywhere, gaze is ignored
  double frames_per_second = 0;  // 0: a still picture, without temporal channels
  // The authors' program treats the right border of pictures whose width and height differ in parity as if the width
  // had the height's parity: up to 0.05 JOD on small pictures. true: as it does; false: the correct border.
  bool original_border = true;
  int threads = 0;
};

// Q of each spatial band, finest first; transient is empty for stills.
struct FovVideoVdpFrame {
  std::vector<double> sustained, transient;
  double q = 0;   // over bands and channels; a sequence's Q is the mean over frames
  ImageGray map;  // local difference in JOD; empty unless asked for
};

// Spatial frequencies of the bands that are used for a picture, finest first.
std::vector<double> fovvideovdp_bands_cpd(double pixels_per_degree, int width_px, int height_px);

// Just-objectionable differences: 10 is none, 9.5 what 63 % would see, 9 what 75 % would. No lower limit.
double fovvideovdp_jod(double q);

// State: the luminance of the last 250 ms of both sequences. Memory does not grow with time.
class FovVideoVdp {
 public:
  // Error(usage) for a raster of less than 8 pixels a side, frame rates that leave less than two taps.
  FovVideoVdp(const FovVideoVdpSettings& settings, int width_px, int height_px);
  ~FovVideoVdp();
  FovVideoVdp(FovVideoVdp&&) noexcept;
  FovVideoVdp& operator=(FovVideoVdp&&) noexcept;
  FovVideoVdp(const FovVideoVdp&) = delete;
  FovVideoVdp& operator=(const FovVideoVdp&) = delete;

  // A frame from before the first scored one, the oldest first. Without any, the first frame stands still before it.
  void prime(const ImageGray& reference_cd_m2, const ImageGray& test_cd_m2);
  // Frames in their order. `gaze_px` is continuous (pixel centres at + 0.5), of this frame; empty: the middle.
  FovVideoVdpFrame add(const ImageGray& reference_cd_m2, const ImageGray& test_cd_m2, std::optional<Vec2d> gaze_px,
                       bool want_map = false);
  [[nodiscard]] const std::vector<double>& band_frequencies_cpd() const;
  [[nodiscard]] int taps() const;  // frames that a frame's score sees

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gazetrace
