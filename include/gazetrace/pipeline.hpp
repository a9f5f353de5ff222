// SPDX-License-Identifier: Apache-2.0
// Sequences: requests in, files and timing out. Frames are those of FrameRenderer.
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
#include "gazetrace/trace.hpp"

namespace gazetrace {

// Settings of every frame, and the fate of the frames.
struct PipelineSettings : FrameSettings {
  OutputSettings output;  // without any pattern nothing is written, not even timing and run record
  FrameRate fps;
  // The digest of all that decides about pixels, but not of which frames there are or how the sequence was divided.
  std::string settings_digest;
  // The same without the seed and, where pictures are plain means of equally many samples a pixel, without their
  // number: pictures of one such digest and different seeds estimate the same light, and merge_means() takes their
  // mean.
  std::string mean_digest;
  // The plan is a part of a longer sequence: the names of its timing and record carry the range of frames.
  bool is_part = false;
};

// Called from the rendering thread. Any of them may be empty.
struct PipelineObserver {
  std::function<void(const FrameRequest&)> frame_begins;
  // The finished linear frame and its exposure in stops, before its files are written.
  std::function<void(const FrameRequest&, const Frame&, double exposure_ev)> frame_ready;
  // `skipped`: the frame was there already.
  std::function<void(const TimingRow&, bool skipped)> frame_done;
  // Called after frame_done for frames that were not skipped, with everything that was found out about the frame, to be
  // moved out where it is to outlive the call.
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
  // Camera rays of this run, and those of them that hit the back of a face whose material is not double-sided.
  std::uint64_t camera_rays = 0, seen_backs = 0;
  std::size_t dark_pictures = 0;                           // display pictures of which half is below 2 % of white
  std::vector<std::pair<std::string, std::string>> facts;  // decided while rendering; for RunRecord::facts
  Warnings warnings;
};

// Renders the frames of a plan in order. With OutputSettings::resume, frames are skipped whose files carry this
// settings digest, and have the content that was written. timing.csv grows by a row with each finished frame, so that a
// killed run keeps its measurements.
SequenceResult render_sequence(PathTracer& tracer, const FramePlan& plan, const ColorPipeline& color,
                               const PipelineSettings& settings, const PipelineObserver& observer);

// Removes the journal of a run, once its record lists the files.
void finish_files(const std::string& record_path);

// Frames of the plan that were finished under other settings or from other inputs, and that rendering would replace.
std::vector<std::int32_t> frames_of_others(const FramePlan& plan, const PipelineSettings& settings);

// Every file that rendering these frames would write, in order; run record and timing come first.
std::vector<std::string> output_files(const PipelineSettings& settings, const std::vector<std::int32_t>& frames);

}  // namespace gazetrace
