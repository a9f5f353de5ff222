// SPDX-License-Identifier: Apache-2.0
// FovVideoVDP: how much of the difference between a video and its reference is visible, given where the eye looks
// (Mantiuk et al., "FovVideoVDP: A visible difference predictor for wide field-of-view video", ACM Transactions on
// Graphics 40(4), 2021). Written from the formulas of the paper and of its sources, with the parameter values of
// version 1.2 of the authors' program; scores do not compare with those of other versions.
//
// It considers luminance only, and does not see uniform differences: black against white scores 10. Scores compare only
// for the same display, frame rate, gaze and version; scores at different gaze positions do not compare at all.
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
inline constexpr const char* kFovVideoVdpUnit = "JOD v1.2";  // stands beside each score

// How code values become luminance. The default is the metric's display "standard_4k".
struct DisplayPhotometry {
  DisplayResponse response = DisplayResponse::srgb;
  double peak_cd_m2 = 200;
  double contrast = 1000;  // peak divided by the display's own black
  double ambient_lux = 250;
  double reflectivity = 0.005;
};
double black_level_cd_m2(const DisplayPhotometry& photometry);  // the display's own black plus reflected ambient light
// Luminance in cd/m2: Y = 0.2126729 R + 0.7151522 G + 0.0721750 B, with response, peak and black level applied to each
// channel.
ImageGray display_luminance(const ImageRgb& code, const DisplayPhotometry& photometry, int threads = 0);
// The luminance of linear light of `scale` cd/m2 per unit: each channel is clamped to 0.005..`most_cd_m2`, then
// `black_cd_m2` is added.
ImageGray linear_luminance(const ImageRgb& light, double scale, double most_cd_m2 = 10000, double black_cd_m2 = 0,
                           int threads = 0);

// The metric's own geometry: a flat display that the picture always *fills*, at any size in pixels. Its angles
// are pairs (azimuth, elevation) with Euclidean distances between them, not angles between rays; use them for this
// metric only. A picture that covers a part of a display is described as a display of the picture's size whose middle
// is right_m and up_m off the perpendicular from the eye.
struct FovVideoVdpGeometry {
  int width_px = 3840, height_px = 2160;  // of the display
  double width_m = 0.66414056, height_m = 0.37357906, distance_m = 0.7472;
  // The display's middle, counted from the foot of the perpendicular from the eye. The authors' program knows 0 only.
  double right_m = 0, up_m = 0;

  [[nodiscard]] double pixels_per_degree() const;  // at the foot of the perpendicular from the eye
  // Degrees right and up of a continuous position in a raster of this size that fills the display.
  [[nodiscard]] Vec2d view_direction_deg(double x, double y, int raster_width, int raster_height) const;
  // Pixels per degree in this direction, relative to pixels_per_degree().
  [[nodiscard]] double magnification(const Vec2d& direction_deg) const;
};
FovVideoVdpGeometry fovvideovdp_geometry(const DisplayGeometry& display);
// A display of the frame's own pixels, size and position, at a distance of 1 m: the metric's input where a frame
// covers a part of its display, since it takes a picture to fill it.
FovVideoVdpGeometry fovvideovdp_geometry(const PlanarView& view);
FovVideoVdpGeometry geometry_from_diagonal(int width_px, int height_px, double diagonal_inches, double distance_m);
FovVideoVdpGeometry geometry_from_horizontal_fov(int width_px, int height_px, double fov_deg, double distance_m = 3);
FovVideoVdpGeometry geometry_from_diagonal_fov(int width_px, int height_px, double fov_deg, double distance_m = 3);

struct FovVideoVdpSettings {
  FovVideoVdpGeometry geometry;
  bool foveated = true;          // false: the fovea's sensitivity holds everywhere, and gaze is ignored
  double frames_per_second = 0;  // 0: a still picture, without temporal channels
  // Where a picture's width and height differ in parity, the authors' program treats its right border as if the width
  // had the height's parity, which changes scores by up to 0.05 JOD on small pictures. true: as their program; false:
  // the correct border.
  bool original_border = true;
  // Of each pixel in the means over a frame, in the frames' size; 0 or more and not all 0. In coarser bands it is the
  // mean of those of the pixels beneath. Empty: all count alike. Where only some windows of a frame are known, and the
  // rest of test and reference is the same, the weight of a window's pixels is the area that the window stands for over
  // its own, so that Q is estimated of the whole frame before it becomes a score.
  ImageGray pooling_weights;
  int threads = 0;
};

// The scores of one frame.
struct FovVideoVdpFrame {
  std::vector<double> sustained, transient;  // Q of each spatial band, finest first; transient is empty for stills
  double q = 0;   // pooled over bands and channels; the Q of a sequence is the mean over its frames
  ImageGray map;  // local difference in JOD; empty unless asked for
};

// The spatial frequencies of the bands that are used for a picture of this size, finest first.
std::vector<double> fovvideovdp_bands_cpd(double pixels_per_degree, int width_px, int height_px);

// The score in just-objectionable differences: 10 means no visible difference, 9.5 one that 63 % of viewers see, 9 one
// that 75 % see. There is no lower limit.
double fovvideovdp_jod(double q);
// The visible difference Q that has this score, 10 or less.
double fovvideovdp_q(double jod);

// Scores two sequences frame by frame. Its state is the luminance of the last 250 ms of both, so that its memory does
// not grow with time.
class FovVideoVdp {
 public:
  // Error(usage) for pictures of less than 8 pixels a side, for pooling weights of another size or that are no weights,
  // and for frame rates so low that the temporal filter would have less than two taps.
  FovVideoVdp(const FovVideoVdpSettings& settings, int width_px, int height_px);
  ~FovVideoVdp();
  FovVideoVdp(FovVideoVdp&&) noexcept;
  FovVideoVdp& operator=(FovVideoVdp&&) noexcept;
  FovVideoVdp(const FovVideoVdp&) = delete;
  FovVideoVdp& operator=(const FovVideoVdp&) = delete;

  // Adds a frame from before the first scored one; the oldest comes first. Without any, the first scored frame is taken
  // to have stood still before.
  void prime(const ImageGray& reference_cd_m2, const ImageGray& test_cd_m2);
  // Scores the next frame. `gaze_px` is the gaze in this frame, in continuous coordinates (pixel centres at + 0.5);
  // empty: the middle of the picture.
  FovVideoVdpFrame add(const ImageGray& reference_cd_m2, const ImageGray& test_cd_m2, std::optional<Vec2d> gaze_px,
                       bool want_map = false);
  [[nodiscard]] const std::vector<double>& band_frequencies_cpd() const;
  [[nodiscard]] int taps() const;  // the number of frames that a frame's score depends on

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gazetrace
