// SPDX-License-Identifier: Apache-2.0
// Flicker: temporal contrast that a test sequence has in excess of its reference, in multiples of the least that the
// eye can see at that place of the visual field.
//
// Luminance is averaged over square patches of four sizes, s = 0..3: n_s = 2^s max(1, round(ppd / 8)) pixels a side, so
// that two patches are one cycle of rho_s = ppd / (2 n_s), about 4, 2, 1 and 0.5 cycles per degree. For each patch a
// discrete Fourier transform of the last N = round(fps) frames (one second), with the mean subtracted and under a Hann
// window, gives the frequencies f_k = k fps / N, k = 1 .. N/2. With P_k the power at f_k of the luminance divided by
// the reference's mean luminance L in that second (at least 0.1 cd/m2),
//   F = max over s of max(0, sum over k of 2 S(rho_s, f_k, L, e)^2 (P_k of the test - P_k of the reference)),
// where e is the eccentricity of the patch's middle from this frame's gaze. A patch whose luminance oscillates with a
// contrast (amplitude over mean) of A has P = A^2 / 2 at one frequency, and so F = (A S)^2: a value of 1 is just
// visible. The printed number is the root of the mean of F.
//
// S is contrast sensitivity over spatial and temporal frequency, luminance and eccentricity: FovVideoVDP's (section 3.4
// of Mantiuk et al. 2021: the spatio-velocity function of Kelly 1979 and Daly, "Engineering observations from
// spatiovelocity and spatiotemporal visual models", 1998, with the constants of Laird et al. 2006; Wuerger et al. 2020;
// cortical magnification of Dougherty et al. 2003), evaluated at every f_k.
//
// It leaves out colour, changes slower than a second or faster than half the frame rate, and that the eye may follow
// moving objects (patches are fixed to the screen). Two equally noisy sequences do not score 0, since the excess is
// taken patch by patch; the score of one reference against another is the noise floor. A picture that never changes
// scores 0 however wrong it is: read it together with "temporal_bias".
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "gazetrace/display.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// The number of frames in the window of one second. Error(usage) below 4 and above 1000 frames per second, and for NaN.
int frames_of_a_second(double frames_per_second);

// The range of flicker that can be measured at a frame rate, in Hz. fusion_hz is the highest frequency at which the
// model's eye, looking straight at it, sees full contrast at this luminance. Flicker between highest_hz and fusion_hz
// would be visible, but is missing from the frames or aliased to something slower.
struct FlickerRange {
  double lowest_hz = 1, highest_hz = 0, fusion_hz = 0;
};
FlickerRange flicker_range(double frames_per_second, double luminance_cd_m2);
// The range in words, for readers of the scores: "from 1 to 12 Hz, ...".
std::string flicker_range_text(const FlickerRange& range);

struct FlickerSettings {
  PlanarView view;
  double frames_per_second = 0;
  int threads = 0;  // the same bits for any number
};

// Its state is the last second of every patch in both sequences, with its spectrum, so that its memory does not grow
// with time.
class FlickerMeter {
 public:
  explicit FlickerMeter(const FlickerSettings& settings);  // Error(usage), see frames_of_a_second()
  ~FlickerMeter();
  FlickerMeter(const FlickerMeter&) = delete;
  FlickerMeter& operator=(const FlickerMeter&) = delete;

  // Adds the next frame, of the view's size, and returns F at each pixel; empty without gaze (continuous pixel
  // coordinates), and before there is a whole second.
  std::optional<ImageGray> add(const ImageGray& reference_cd_m2, const ImageGray& test_cd_m2,
                               std::optional<Vec2d> gaze_px);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gazetrace
