// SPDX-License-Identifier: Apache-2.0
// Accumulation over frames: what other frames have to say about a pixel.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gazetrace/motion.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace {

// What the pixels of the last frame showed, to tell whether a later one shows the same. Only reprojection keeps it.
struct HistorySurfaces {
  ImageGray depth_m;            // as SurfaceMotion
  ImageRgb normal;              // as SurfaceMotion
  Image<std::uint32_t> object;  // as SurfaceMotion
  ImageGray footprint_px;       // side of the square that the sums of a pixel were spread over, count-weighted
  // Luminance of a past that was looked up between pixels, minus that of the frame that it then joined; 0: there was no
  // such past.
  ImageGray residual;
};

// All state that outlives a frame and reaches into later pictures. It is passed as an argument and never global.
struct TemporalHistory {
  // Sums weighted by effective sample counts, in double.
  Image<Vec3d> radiance_sum;
  Image<double> count_sum;
  Image<double> variance_weight_sum;  // sum of count^2 * variance
  HistorySurfaces surfaces;
  std::optional<Camera> camera;       // of the last frame in the sums
  std::int64_t t_video_ns = 0;        // of the last frame in the sums
  std::int32_t frames = 0;            // since the last reset
  std::vector<std::int32_t> passed;   // numbers of the frames that went into it, in their order
  std::optional<double> smoothed_ev;  // exposure smoothing
  std::int64_t smoothed_ev_t_ns = 0;
};

// off: every frame stands for itself. running: the mean over frames while the camera stands still. reproject: what a
// pixel shows is looked up where it was in the frame before, and used where it was the same surface. two_sided: frames
// before and after are read: their samples where nothing moves (FrameRenderer::at_rest), under filters that work on
// surfaces also where only the view does (FrameRenderer::only_views_move), else what each shows by itself; nothing is
// accumulated from frame to frame. Frames that are still to come are known only where whole sequences are rendered, so
// this is not causal: nobody could be shown such a picture while looking.
enum class AccumulateMode : std::uint8_t { off, running, reproject, two_sided };
// Whether frames are accumulated before or after the reconstruction filter. Filters that need sums per surface
// (ReconstructionNeeds::surfaces) always come first, since an accumulated site no longer holds them.
enum class AccumulateOrder : std::uint8_t { before, after };

// With a smaller share of the current frame the past's share would be 1 in all digits that pictures have, and its
// counts would leave the range of numbers.
inline constexpr double kLeastBlend = 1e-6;

struct AccumulateSettings {
  AccumulateMode mode = AccumulateMode::off;

  // Only two_sided uses this: so many frames before a frame and after it are read.
  std::int32_t window = 4;
  // Only two_sided uses this, where nothing moves in the whole window: so many consecutive frames, counted from frame 1
  // on, show one sum of those that are in the windows of all of them, which is filtered once. 0: (window + 1) / 3, at
  // least 1. More than window + 1 counts as that.
  std::int32_t hold = 0;
  // Only reproject uses this.
  AccumulateOrder order = AccumulateOrder::after;

  // The rest is for reproject and two_sided. What two_sided joins before the filter is neither forgotten nor clipped.
  // Memory in frames: each frame multiplies the counts of the past by 1 - 1/frames, so that a pixel gathers this many
  // times a frame's samples. 0: nothing is forgotten. two_sided: so it does for each frame that lies between.
  double frames = 16;
  // Share of the current frame wherever there is history (the classic exponential average), whatever the counts say;
  // at least kLeastBlend. 0: the weights follow the counts.
  double blend = 0;
  // History is clipped to within this many standard deviations of the current frame's neighborhood. Where it was off
  // by r such limits, it keeps the share r^-4 of its count. 0: history is never clipped.
  double clip_sigmas = 3;
  // A frame uses nothing of the past if the eye made a saccade, or was closed, at any time since the frame before it
  // (FrameRequest::saccade_since_last_frame, blink_since_last_frame). two_sided: nor do those before it use anything of
  // it or of what follows.
  bool reset_at_saccades = false, reset_at_blinks = false;
};

// running: the mean, weighted by samples, of all frames since the last change of camera or size; the first frame comes
// out with its own bits. AOV images stay those of the current frame. Frames must carry different samples, since the
// same ones added again would raise the count without adding information. The exposure's part of the history is not
// touched.
Frame accumulate(Frame frame, const FrameRequest& request, const AccumulateSettings& settings, TemporalHistory& history,
                 int threads);

// A cut: the history is of another size or projection, or of a camera that has since turned by more than this angle or
// moved by more than this share of the median depth. Nothing of the past is used then.
inline constexpr double kCutTurnDeg = 20;
inline constexpr double kCutMoveShare = 0.5;
bool is_cut(const TemporalHistory& history, const Camera& camera, int width_px, int height_px);

// reproject: each pixel looks up the sums at the place where its surface was (`motion`, relative to the history's
// camera and time). It takes up to four pixels with bilinear weights, and of those only the ones that showed the same
// object, on the plane of the surface and with its normal. Where all sixteen pixels around the place did, each sampled
// on its own, it takes Catmull-Rom weights, which blur texture less. The counts of these pixels say what the history is
// worth. That worth shrinks with age; by the ratio of areas where the history was coarser than this frame's site; where
// resampling has blurred it by more than noise explains, or is likely to, since texture is finer than the pixels; where
// the edge of another surface slides or slid over the pixel; and where clipping moves it. The result is the mean
// weighted by counts. It is never worth less than the frame alone, and has the frame's own bits where there is no
// history.
Frame reproject(Frame frame, const SamplingMap& map, const SurfaceMotion& motion, const FrameRequest& request,
                const AccumulateSettings& settings, TemporalHistory& history, int threads);

// Turns an accumulated frame, which was made of these sites by the filter none, back into sums per site, so that
// another filter can follow (AccumulateOrder::before). First-hit sums are those of `traced`, scaled to the new counts.
SparseFrame sites_of_frame(const Frame& frame, const SparseFrame& traced, const SamplingMap& map);

}  // namespace gazetrace
