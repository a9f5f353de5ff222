// SPDX-License-Identifier: Apache-2.0
// Accumulation over frames.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gazetrace/motion.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {

// What the pixels of the last frame showed, to tell whether a later one shows the same. Of reprojection only.
struct HistorySurfaces {
  ImageGray depth_m;            // as SurfaceMotion
  ImageRgb normal;              // as SurfaceMotion
  Image<std::uint32_t> object;  // as SurfaceMotion
  ImageGray footprint_px;       // side of the square that the sums of a pixel were spread over, count-weighted
  ImageGray residual;           // luminance of a past looked up between pixels minus that of the frame it then joined;
                                // 0: there was none
};

// All state that outlives a frame and reaches into pictures. Passed in the open; never global.
struct TemporalHistory {
  // Sums weighted by effective sample counts, in double.
  Image<Vec3d> radiance_sum;
  Image<double> count_sum;
  Image<double> variance_weight_sum;  // sum of count^2 * variance
  HistorySurfaces surfaces;
  std::optional<Camera> camera;       // of the last frame in the sums
  std::int64_t t_video_ns = 0;        // of the last frame in the sums
  std::int32_t frames = 0;            // since the last reset
  std::vector<std::int32_t> passed;   // numbers of the frames that passed through, as they came
  std::optional<double> smoothed_ev;  // exposure smoothing
  std::int64_t smoothed_ev_t_ns = 0;
};

// off: every frame for itself. running: the mean while the camera stands still. reproject: what was seen before is
// looked up where it was then, and checked.
enum class AccumulateMode : std::uint8_t { off, running, reproject };
// Of accumulation, relative to the reconstruction filter. Filters that need guides take samples apart by surfaces,
// which an accumulated site no longer holds: theirs is `after`.
enum class AccumulateOrder : std::uint8_t { before, after };

// Below, the past's share is 1 in all digits that pictures have, and its counts leave what numbers can hold.
inline constexpr double kLeastBlend = 1e-6;

struct AccumulateSettings {
  AccumulateMode mode = AccumulateMode::off;

  // The rest is heeded by reproject only.
  AccumulateOrder order = AccumulateOrder::after;
  // Memory in frames: with each one the counts of the past shrink by 1 - 1/frames, so that a pixel gathers this many
  // times a frame's samples. 0: nothing is forgotten.
  double frames = 16;
  // Share of the current frame where there is history (the classic exponential average), whatever the counts say;
  // at least kLeastBlend. 0: weights follow the counts.
  double blend = 0;
  // History is brought to within this many standard deviations of the current frame's neighborhood, and keeps
  // the inverse fourth power of what it was off by, in limits, of its count. 0: never.
  double clip_sigmas = 3;
  // Nothing of the past is used in frames since whose predecessor the eye made a saccade or was closed
  // (FrameRequest::saccade_since_last_frame, blink_since_last_frame).
  bool reset_at_saccades = false, reset_at_blinks = false;
};

// running: the sample-weighted mean of all frames since the last change of camera or size; the first frame passes
// through bit-equal. Guides stay those of the current frame. Frames are to carry different samples: the same ones
// added again raise the count, not the worth. Leaves the exposure's part of the history alone.
Frame accumulate(Frame frame, const FrameRequest& request, const AccumulateSettings& settings, TemporalHistory& history,
                 int threads);

// A cut: history of another size or projection, or from a camera that has turned by more than this since, or moved by
// more than this share of the median depth. Nothing of the past is used.
inline constexpr double kCutTurnDeg = 20;
inline constexpr double kCutMoveShare = 0.5;
bool is_cut(const TemporalHistory& history, const Camera& camera, int width_px, int height_px);

// reproject. Each pixel looks up the sums where its surface was (`motion`, from the history's camera and time), in up
// to four pixels by bilinear weights; of those that showed the same object, on the plane of the surface and with its
// normal. Where sixteen around the place did, each a pixel of its own, Catmull-Rom weights blur texture less. Their
// counts are the history's worth; it shrinks with age, where the history was coarser than this frame's site (by the
// ratio of areas), where resampling has blurred it by more than noise explains, and where clipping moves it. The result
// is the mean weighted by counts: never worth less than the frame alone, and equal to it to the bit where there is no
// history.
Frame reproject(Frame frame, const SamplingMap& map, const SurfaceMotion& motion, const FrameRequest& request,
                const AccumulateSettings& settings, TemporalHistory& history, int threads);

// Site by site what a frame made of these sites (filter none) and accumulated holds: AccumulateOrder::before filters it
// again. Guides are those of `traced`.
SparseFrame sites_of_frame(const Frame& frame, const SparseFrame& traced, const SamplingMap& map);

}  // namespace gazetrace
