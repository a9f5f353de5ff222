// SPDX-License-Identifier: Apache-2.0
// The frames, geometry and gaze that follow from the settings of compare(), for it and for videos.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/compare_job.hpp"
#include "gazetrace/recorded_run.hpp"

namespace gazetrace {

// The source of the frames' gaze.
struct GazeSource {
  std::string words;        // empty: no frame has a gaze on a screen
  bool is_of_test = false;  // gaze_true of the test's pictures, as no frame of the reference has one
};

struct CompareInputs {
  std::vector<std::int32_t> frames;                    // {0}: single pictures
  std::optional<RecordedRun> reference_run, test_run;  // where their records lie beside the pictures
  std::optional<DisplayGeometry> screen;
  FrameRect frame_rect;
  RetinalRegions regions;
  std::optional<ResolvedJob> gaze_log;  // the log that is given, with its clock
  std::vector<EyeMovement> movements;   // of the log's samples, where it knows angles
  std::optional<double> stated_fps;     // by option, pictures or run records, for any number of frames
  double frames_per_second = 0;         // 0: a single picture, or not known
  GazeSource gaze;
};

CompareInputs load_compare_inputs(const CompareJob& job);
std::string picture_path(const std::string& pattern, std::int32_t frame);
// Error(input) where the two differ in settings of their look, unless told `anyway`.
void check_comparable(const CompareJob& job, const CompareInputs& inputs, const ComparedPicture& reference,
                      const ComparedPicture& test, const std::string& reference_path, const std::string& test_path);
// As given, else as the reference was shown.
ColorSettings compare_color(const CompareJob& job, const CompareInputs& inputs);
std::optional<PlanarView> compare_view(const CompareInputs& inputs, int width_px, int height_px);
GazeSource compared_gaze_source(const CompareJob& job, const CompareInputs& inputs);
// Error(input) where both have a gaze and look at different places, unless a gaze is given or told --anyway.
void check_same_gaze(const CompareJob& job, const CompareInputs& inputs, const FrameFacts& reference,
                     const FrameFacts& test, const std::string& test_path);
// The gaze in frame pixels, and its class.
struct ComparedGaze {
  std::optional<Vec2d> px;
  GazeClass gaze_class = GazeClass::no_gaze;
};
// Error(usage) with a log and pictures of which the time is not known.
ComparedGaze compared_gaze(const CompareJob& job, const CompareInputs& inputs, const FrameFacts& reference,
                           const FrameFacts& test, std::int32_t frame, int width_px, int height_px);
// Pictures, their records, and the other files that the job names.
std::vector<std::string> compared_files(const CompareJob& job, const CompareInputs& inputs);
// check_outputs() for tables and error maps.
void check_compare_outputs(const CompareJob& job, const CompareInputs& inputs, const std::vector<std::string>& metrics);
// Of a metric's error maps.
std::string map_pattern(const CompareJob& job, const std::string& metric);

// frame,gaze,metric,value,weighted,map_min,...,map_max and one column a band and a region.
std::string compare_csv_header();
std::string compare_csv_rows(const FrameScores& frame);

}  // namespace gazetrace
