// SPDX-License-Identifier: Apache-2.0
// Two sequences of files compared: `gazetrace compare`, and compare() in Python. Geometry, gaze and view follow from
// the pictures and the records beside them, where the settings leave them open.
//   CompareJob job;
//   job.reference = "reference/frame.####.exr";
//   job.test = "test/frame.####.exr";
//   const ComparedSequences scores = compare(job);
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/compare.hpp"
#include "gazetrace/metric_options.hpp"
#include "gazetrace/option_schema.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {

struct CompareJob : MetricChoice {
  std::string reference, test;  // patterns, or single pictures
  std::optional<FrameList> frames;
  std::optional<FrameRate> fps;
  std::optional<double> exposure_ev;
  std::optional<std::array<double, 2>> region_eccentricities_deg;
  JobSettings shared;  // screen, gaze, colour: the options that `render` has, under the same names
  // Where the viewer looked, in fractions of the frame: one place for all frames, or one a frame, empty where nobody
  // looked. Takes the place of `gaze` and `gaze-at`.
  std::vector<std::optional<Vec2d>> gaze_in_frame;
  std::string csv, json, maps;  // json may be "-", for the caller to print compare_json()
  std::string pooling_weights;  // a picture, for FovVideoVDP
  std::vector<std::string> fail_above, fail_below;
  bool map_overlay = false;
  bool anyway = false;
  bool overwrite = false;
  bool want_maps = false;  // FrameScores::maps are handed over, whether or not `maps` names a folder
};

// All settings but the two patterns, gaze_in_frame and want_maps.
OptionSchema<CompareJob> compare_schema();

// The settings that the scores depend on, by name, in the order of printing.
using CompareConditions = std::vector<std::pair<std::string, std::string>>;

struct ComparedSequences {
  CompareConditions conditions;
  std::vector<SequenceScores> summary;  // "all" first, then the classes that have frames
  std::vector<FrameScores> frames;      // without maps
  Warnings over_limits;                 // one line for each of fail_above and fail_below that is not kept
};

// Reads, scores and writes the files of the settings. `on_frame` gets each frame's scores before the next one is read;
// it may take the maps out of them. Error(input) where the two sequences differ in frames, size, view, exposure or gaze
// and `anyway` is not set; Error(usage) where a metric lacks the gaze, the time or the light that it needs, and where
// an output would replace an input or, without `overwrite`, anything.
ComparedSequences compare(const CompareJob& job, const std::function<void(FrameScores& scores)>& on_frame = {});

// The results as tables for people, and as JSON.
std::string compare_text(const ComparedSequences& compared);
std::string compare_json(const ComparedSequences& compared);

}  // namespace gazetrace
