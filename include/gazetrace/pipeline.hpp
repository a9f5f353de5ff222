// SPDX-License-Identifier: Apache-2.0
// Sequences: requests in; files, timing and a history that can be taken up again out. Frames are those of
// FrameRenderer.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/temporal.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// Which stages of a frame a run does. Where frames depend on those before them, many machines can trace at the same
// time and write what they found (traced_frame_file.hpp); one run then finishes all frames in their order, with the
// bits of a run that does both.
enum class SequenceStage : std::uint8_t { whole, trace, finish };

// What every frame is made with, and what becomes of the frames.
struct PipelineSettings : FrameSettings {
  OutputSettings output;  // without any pattern nothing is written, not even timing and run record
  FrameRate fps;
  // The digest of all that decides about pixels, but not of which frames there are or how the sequence was divided.
  // What history a frame had is in the header of that frame's picture.
  std::string settings_digest;
  // The same without the seed and, where pictures are plain means of equally many samples a pixel, without their
  // number: pictures of one such digest and different seeds estimate the same light, and merge_means() takes their
  // mean.
  std::string mean_digest;
  // History (accumulation, smoothed exposure) that is kept in files and taken up again.
  std::string checkpoint;             // a file for the history after the last frame; empty: none
  std::int32_t checkpoint_every = 0;  // also write it after every so many frames; 0: only at the end
  std::string resume_from;            // a checkpoint whose last frame comes before the plan's first; empty: no history
  std::int32_t preroll = 0;           // so many frames at the plan's beginning are rendered for their history alone
  // The plan is a part of a longer sequence: the names of its timing and record carry the range of frames.
  bool is_part = false;
  SequenceStage stage = SequenceStage::whole;
};

// Whether a frame of this run depends on those before it: uses_history(), unless it is only traced.
bool needs_history(const PipelineSettings& settings);

// Called from the rendering thread. Any of them may be empty.
struct PipelineObserver {
  std::function<void(const FrameRequest&)> frame_begins;
  // The finished linear frame and its exposure in stops, before its files are written; also for frames that are
  // rendered for their history alone.
  std::function<void(const FrameRequest&, const Frame&, double exposure_ev)> frame_ready;
  // `skipped`: no file was written, since it was there already or the frame was rendered for its history alone.
  std::function<void(const TimingRow&, bool skipped)> frame_done;
  // Called after frame_done for frames that were not skipped, with everything that was found out about the frame, to be
  // moved out where it is to outlive the call. Not called where frames are only traced.
  std::function<void(const FrameRequest&, RenderedFrame&&, const TimingRow&)> take_frame;
  // Asked before a frame, with the mean time of those before it, ms (0: there was none): true ends the sequence there.
  // TraceSettings::stop gives up a frame in the middle.
  std::function<bool(double frame_ms)> stop_before_frame;
};

struct SequenceResult {
  std::vector<TimingRow> rows;        // of this run, skipped frames left out
  std::vector<std::int32_t> skipped;  // frames that were complete before this run began
  std::vector<BadSample> bad_samples;
  WrittenFiles files;  // of all finished frames, those of earlier runs included
  // Whether it was stopped, and which frames were then neither rendered nor finished before.
  bool interrupted = false;
  std::vector<std::int32_t> left;
  std::uint64_t clamped_half_values = 0, clamped_view_pixels = 0;
  std::vector<std::pair<std::string, std::string>> facts;  // decided while rendering; for RunRecord::facts
  Warnings warnings;
};

// The history that PipelineSettings::resume_from holds, or an empty one. Error(usage) unless it ends before the plan's
// first frame. Where an interrupted run that is resumed has put its own checkpoint in the place of that file, the
// result is hollow: it says which frames were in the history (`passed`), and holds nothing of them. It warns where
// frames are missing in between, and where a part of a sequence begins without the history of the frames before it.
TemporalHistory starting_history(const FramePlan& plan, const PipelineSettings& settings, Warnings& warnings);

// Renders the frames of a plan in order. With OutputSettings::resume, frames are skipped whose files carry this
// settings digest and history, and have the content that was written. Where history (accumulation, exposure smoothing)
// needs them they are rendered again without being written, and so are all frames where a checkpoint is asked for that
// is not there. timing.csv grows by a row with each finished frame, so that a killed run keeps what it measured.
// `history` is that of the frames before, see starting_history(). A sequence that is stopped leaves its checkpoint
// after the last finished frame.
SequenceResult render_sequence(PathTracer& tracer, const FramePlan& plan, const ColorPipeline& color,
                               const PipelineSettings& settings, const PipelineObserver& observer,
                               TemporalHistory history = {});

// Removes the journal of a run, once its record lists the files.
void finish_files(const std::string& record_path);

// Frames of the plan that were finished under other settings, from other inputs or with another history, and that
// rendering would replace.
std::vector<std::int32_t> frames_of_others(const FramePlan& plan, const PipelineSettings& settings,
                                           const TemporalHistory& history);

// For the run record; `history` is what the plan's first frame finds.
RecordedHistory recorded_history(const FramePlan& plan, const PipelineSettings& settings,
                                 const TemporalHistory& history);

// Every file that rendering these frames would write, in order; run record and timing come first.
std::vector<std::string> output_files(const PipelineSettings& settings, const std::vector<std::int32_t>& frames);

}  // namespace gazetrace
