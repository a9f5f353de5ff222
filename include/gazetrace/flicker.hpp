// SPDX-License-Identifier: Apache-2.0
// Flicker: contrast over time that a test has in excess of its reference, in multiples of what the eye can just see at
// that place of the visual field.
//
// Luminance is averaged over square cells of four sizes, s = 0..3: n_s = 2^s max(1, round(ppd / 8)) pixels a side, so
// that two cells are one cycle of rho_s = ppd / (2 n_s), about 4, 2, 1 and 0.5 cycles a degree. Of each cell the last
// N = round(fps) frames, one second, are taken apart into frequencies f_k = k fps / N, k = 1 .. N/2, by a discrete
// Fourier transform under a Hann window with the mean taken off first. With P_k the power at f_k of the luminance over
// the reference's mean luminance L of that second,
//   F = max over s of max(0, sum over k of 2 S(rho_s, f_k, L, e)^2 (P_k of the test - P_k of the reference)),
// e the eccentricity of the cell's middle from this frame's gaze. A cell that goes up and down by a contrast of A has
// P = A^2 / 2 at one frequency and so F = (A S)^2: 1 is just seen. The printed number is the root of the mean of F.
//
// S is contrast sensitivity over spatial and temporal frequency, luminance and eccentricity: FovVideoVDP's (section 3.4
// of Mantiuk et al. 2021: the spatio-velocity function of Kelly 1979 and Daly, "Engineering observations from
// spatiovelocity and spatiotemporal visual models", 1998, with the constants of Laird et al. 2006; Wuerger et al. 2020;
// cortical magnification of Dougherty et al. 2003), evaluated at every f_k.
//
// What it leaves out: colour; what is slower than a second or faster than half the frame rate; that the eye may follow
// what moves (cells are fixed to the screen). Two equally noisy sequences do not read 0, as excess is taken cell by
// cell: reference against reference is the floor. A picture that never changes reads 0, however wrong it is: look at
// "temporal_bias" beside it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "gazetrace/display.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// Frames in the window of a second. Error(usage) below 4 frames a second, above 1000, or where it is no number.
int frames_of_a_second(double frames_per_second);

// What can be told of flicker at a frame rate, in Hz. fusion_hz: up to where the model's eye, its gaze on it, sees full
// contrast at this luminance; what lies between highest_hz and that would be seen but is not in the frames, or shows in
// them as something slower.
struct FlickerRange {
  double lowest_hz = 1, highest_hz = 0, fusion_hz = 0;
};
FlickerRange flicker_range(double frames_per_second, double luminance_cd_m2);
// "from 1 to 12 Hz, ...": what is told and what is not, in words for whoever reads the scores.
std::string flicker_range_text(const FlickerRange& range);

struct FlickerSettings {
  PlanarView view;
  double frames_per_second = 0;
  int threads = 0;  // the same bits for any number
};

// State: the cells' last second of both sequences and its spectrum. Memory does not grow with time.
class FlickerMeter {
 public:
  explicit FlickerMeter(const FlickerSettings& settings);  // Error(usage), see frames_of_a_second()
  ~FlickerMeter();
  FlickerMeter(const FlickerMeter&) = delete;
  FlickerMeter& operator=(const FlickerMeter&) = delete;

  // Frames in their order, of the view's size. F at each pixel; empty without gaze, and before there is a whole second.
  std::optional<ImageGray> add(const ImageGray& reference_cd_m2, const ImageGray& test_cd_m2,
                               std::optional<Vec2d> gaze_px);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gazetrace
