// SPDX-License-Identifier: Apache-2.0
// The plan: all that will be rendered, decided before the first ray, as one request per frame that can be printed and
// tested.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze.hpp"
#include "gazetrace/gaze_process.hpp"

namespace gazetrace {

FrameRate parse_frame_rate(std::string_view text);  // "24", "23.976" (2997/125), "24000/1001"; else Error(usage)
std::string to_string(const FrameRate& rate);

// A plan takes about a kilobyte a frame. These are more than nine hours at 30 frames a second.
inline constexpr std::int64_t kMostPlannedFrames = 1'000'000;

// "1-100", "1-100x2" (every second one) or "1,5,9-12". Frames are numbered from 1; the list is sorted and has no
// duplicates. Error(usage) for anything else and for more than kMostPlannedFrames.
std::vector<std::int32_t> parse_frame_list(std::string_view text);
std::string format_frame_list(const std::vector<std::int32_t>& frames);

// When the shutter opens and closes, as fractions 0..1 of the frame's time. Where they are equal the exposure is
// instantaneous and nothing blurs.
struct Shutter {
  double open = 0.5, close = 0.5;
  [[nodiscard]] bool blurs() const { return close > open; }
  friend bool operator==(const Shutter&, const Shutter&) = default;
};
// "0.5": half of the frame's time, about its middle; "180deg": the same, as the angle of a rotary shutter; "0.25,0.75":
// opening and closing; "0": no blur. Error(usage) for anything else.
Shutter parse_shutter(std::string_view text);
std::string to_string(const Shutter& shutter);

// How gaze that was recorded on one screen is carried over to a screen of another size or distance. Velocities, events
// and precision are always those of the recording.
//   fraction  keeps positions: gaze that was at a quarter of the screen's width is there again; angles change
//   angle     keeps the angles from the eye; positions change, and may fall off the screen
enum class GazeTransfer : std::uint8_t { fraction, angle };

struct PlanSettings {
  std::vector<std::int32_t> frames;
  Shutter shutter;
  FrameRate fps;
  std::int32_t first_frame = 1;  // the number of the video's first frame
  std::int64_t start_ns = 0;     // the video time at which it begins
  CameraExtrapolation camera_extrapolation = CameraExtrapolation::error;
  GazeMapping gaze;
  // More frames than this in a row without gaze are refused: most often the log holds several recordings, or the frames
  // go on after its end. 0: any number is planned.
  std::uint64_t most_frames_without_gaze = 0;
  std::int64_t gaze_latency_ns = 0;  // >= 0; gaze_render is the gaze this long before the frame, gaze_true is not
  bool find_events = true;           // detect eye movements with default_event_preset(), in the recording's geometry
  int width_px = 1280, height_px = 720;
  std::optional<DisplayGeometry> display;  // where the frame is watched; required for a screen log
  // Required where the log states a recording screen whose angular size differs from the display's by more than 2 %.
  std::optional<GazeTransfer> transfer;
  FrameRect frame_rect;  // default: the whole display
};

// The view a frame earlier or later at the frame rate, whichever frames are rendered: where things move from and to.
struct NeighborView {
  CameraPose pose;  // the camera's path is held beyond its ends
  std::int64_t t_video_ns = 0;
};

// Where the pixels of a request lie in the frame that is shown, of which it may be a part.
struct FrameWindow {
  int x_px = 0, y_px = 0;  // of the first pixel
  // Of the whole frame, as its projection is; 0: the request is all of it.
  int frame_width_px = 0, frame_height_px = 0;
  Projection projection;
  [[nodiscard]] bool is_part() const { return frame_width_px > 0; }
};

// Everything about one frame: it can be rendered from this and the scene alone, apart from a window's other frames.
struct FrameRequest {
  std::int32_t frame = 1;
  std::int64_t t_video_ns =
      0;  // the middle of the frame, start + (frame - first + 1/2) / fps, rounded down to a nanosecond
  std::int64_t shutter_open_ns = 0, shutter_close_ns = 0;  // video time; equal: no motion blur
  int width_px = 0, height_px = 0;
  FrameWindow window;
  Camera camera;
  NeighborView before, after;
  PlanarView view;         // the eye's view of the frame on the display or, for gaze directions, the camera's frustum
  GazeAtTime gaze_render;  // the gaze that steers the sampling: processed and delayed, if so asked
  GazeAtTime gaze_true;    // the gaze of the unprocessed log at the frame's time; metrics use this one
  // See GazeAges; in video time. Empty without gaze, and where the log does not tell.
  std::optional<std::int64_t> gaze_effective_age_ns;
  // The eye movement by the unprocessed log, at the time of gaze_render, so that no foresight is needed.
  bool eye_in_saccade = false;
  // Also by the unprocessed log: whether the eye was in a saccade, or closed, at any time between the gaze_render of
  // the frame before and that of this frame. Both are often shorter than a frame.
  bool saccade_since_last_frame = false, blink_since_last_frame = false;
  // From the eye, in its frame; empty: no gaze, the frame is rendered uniformly.
  std::optional<Vec3d> gaze_direction_render, gaze_direction_true;
};

// The effective age of the gaze that steers a frame: its age in the middle of the time for which the frame is shown. It
// contains the latency, the time that a sample waits for the next frame and half of the frame's own time. While a frame
// is shown, the age grows from half_frame_ns below this to half_frame_ns above it.
struct GazeAges {
  std::size_t frames = 0, unknown = 0;  // frames whose gaze has a known age; frames whose gaze has none
  std::size_t without = 0;              // frames without gaze, also with a substitute; not part of the ages
  double min_ns = 0, median_ns = 0, mean_ns = 0, p95_ns = 0, max_ns = 0;
  double half_frame_ns = 0;
};

// The frames by which the quality of a whole sequence is judged before it is rendered. They follow from the sequence
// and not from the frames that a run renders, so that all parts of it come to the same judgement.
struct JudgedFrames {
  // Each run is of consecutive frames; the first one begins the sequence. Empty: nothing is to be judged.
  std::vector<std::vector<FrameRequest>> runs;
  std::vector<FrameRequest> around;  // further frames that those read, as FramePlan::around
  std::int32_t sequence_frames = 0;  // how many frames the whole sequence has; 1: a still
  bool view_moves = false;           // camera or scene
  bool gaze_moves = false;           // it is that of a log, so that frames that are not judged may look elsewhere
};

struct FramePlan {
  std::vector<FrameRequest> frames;
  // Further frames in ascending order, none of them among `frames`, that are traced only because those read them
  // (AccumulateMode::window).
  std::vector<FrameRequest> around;
  JudgedFrames judged;                       // for QualityTarget::jod
  std::optional<GazeAges> ages;              // empty: no frame has gaze from a log
  std::int64_t gaze_latency_ns = 0;          // that of the settings
  std::vector<std::string> gaze_processing;  // processing of the log that steers, one line per step
  Warnings warnings;
};

// Without a log (nullptr) every frame is rendered without gaze. `steering` is the log after processing, from which
// gaze_render comes; by default it is the log itself. Both use the clock of the first.
// Error(input) where the camera path does not cover a frame, where a screen log has no display, or was recorded on one
// of another size and no transfer is chosen, where gaze directions meet an orthographic camera, and where
// NoGazePolicy::error meets a gap. Error(usage) for an empty list of frames, frames below 1, a frame rate that is not
// positive, and a negative latency.
FramePlan plan_frames(const CameraPath& camera, const GazeLog* log, const PlanSettings& settings,
                      const ProcessedGaze* steering = nullptr);

// Whether there is such a frame: it is 1 or later, and the camera's path covers it.
bool has_frame(const CameraPath& camera, const PlanSettings& settings, std::int64_t frame);

// One line: "50.0 ms in the median, mean 50.1, ...".
std::string gaze_ages_text(const GazeAges& ages);
std::string plan_as_table(const FramePlan& plan);
std::string plan_as_json(const FramePlan& plan);
// The same text piece by piece, since that of a long plan takes more memory than the plan.
void write_plan_json(const FramePlan& plan, const std::function<void(const std::string& text)>& write);

}  // namespace gazetrace
