// SPDX-License-Identifier: Apache-2.0
// What `compare` is asked, and the frames, geometry and gaze that follow from it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/inputs.hpp"
#include "cli/option_table.hpp"
#include "gazetrace/compare.hpp"

namespace gazetrace {

struct CompareJob {
  std::string reference, test;
  std::vector<std::string> metrics;
  std::optional<FrameList> frames;
  std::optional<FrameRate> fps;
  std::optional<double> exposure_ev;
  std::optional<std::array<double, 2>> region_angles_deg;
  AngleReading reading = AngleReading::full_angle;  // of region_angles_deg
  JobSettings shared;  // screen, gaze, colour: the options that `render` has, under the same names
  bool correct_border = false;
  ComparisonSettings settings;
  std::string csv, json, maps;
  std::vector<std::string> fail_above, fail_below;
  bool map_overlay = false;
  bool anyway = false;
};

struct CompareInputs {
  std::vector<std::int32_t> frames;                    // {0}: single pictures
  std::optional<JobSettings> reference_run, test_run;  // from the run records beside the pictures
  std::string reference_view, test_view;               // as those name them
  std::optional<DisplayGeometry> screen;
  FrameRect frame_rect;
  RetinalRegions regions;
  std::optional<GazeLog> gaze_log;
  std::vector<EyeMovement> movements;  // of the log's samples, where it knows angles
  double frames_per_second = 0;
};

// The options of the command, but the two patterns. The table refers to `job`.
void add_compare_options(OptionTable& table, CompareJob& job);

CompareInputs load_compare_inputs(const CompareJob& job);
// Error(input) where the two differ in what decides how they look, unless told --anyway.
void check_comparable(const CompareJob& job, const CompareInputs& inputs, const ComparedPicture& reference,
                      const ComparedPicture& test, const std::string& reference_path, const std::string& test_path);
std::optional<PlanarView> compare_view(const CompareInputs& inputs, int width_px, int height_px);
// Whether any frame has one.
bool knows_gaze(const CompareJob& job, const CompareInputs& inputs);
// gaze_true in frame pixels, and its class.
struct ComparedGaze {
  std::optional<Vec2d> px;
  GazeClass gaze_class = GazeClass::no_gaze;
};
ComparedGaze compared_gaze(const CompareJob& job, const CompareInputs& inputs, const FrameFacts& facts,
                           std::int32_t frame, int width_px, int height_px);

}  // namespace gazetrace
