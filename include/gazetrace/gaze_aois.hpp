// SPDX-License-Identifier: Apache-2.0
// Areas of interest (AOIs): shapes on the display, or objects of the scene. From fixations to visits, dwell times and
// transitions, as Holmqvist et al., "Eye tracking: a comprehensive guide to methods and measures", 2011, ch. 6 and 12,
// define them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_log.hpp"
#include "gazetrace/gaze_objects.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

enum class AoiShape : std::uint8_t { rectangle, ellipse, polygon, object };

struct Aoi {
  std::string name;
  AoiShape shape = AoiShape::rectangle;
  // Fractions of the display. rectangle: left top and right bottom; ellipse: centre and radii; polygon: its corners.
  std::vector<Vec2d> points;
  // object: patterns with * and ? of the names of glTF nodes and materials; empty: any.
  std::string node, material;
};

// Reads a TOML or JSON file:
//   unit = "px"                          # of the display below; or "fraction", the default
//   display-px = [1920, 1080]            # default: the display of the log
//   [[aoi]]
//   name = "face"
//   rectangle = [700, 100, 1100, 500]    # left, top, right, bottom
//   [[aoi]]
//   name = "clock"
//   ellipse = [1500, 200, 90, 90]        # centre, radii
//   [[aoi]]
//   name = "sign"
//   polygon = [[10, 10], [200, 40], [60, 300]]
//   [[aoi]]
//   name = "vase"
//   node = "vase"                        # or material = "glaze", or both
// `display` turns pixels into fractions. Throws Error(input) with file:line for anything but an AOI, names that are
// given twice, and pixels of a display that is not known.
std::vector<Aoi> load_aois(const std::string& path, const std::optional<DisplayGeometry>& display);

// On the border counts as inside. Objects hold no place.
bool contains(const Aoi& aoi, const Vec2d& place);

// A fixation with the AOI that it counts for.
struct AoiFixation {
  EyeEvent event;
  std::int64_t duration_ns = 0;    // as in the tables of events
  std::optional<std::size_t> aoi;  // an index into Aois::areas; empty: none
  // The part of its cone (see gaze_cone) that falls on the AOI; NaN where the tracker's errors are not known.
  double share = 0;
};

// Times in ms. A visit is a run of fixations on one AOI, from the beginning of the first to the end of the last.
struct AoiFigures {
  std::size_t fixations = 0, visits = 0;
  double fixation_ms = 0;           // durations of the fixations, added up
  double dwell_ms = 0;              // durations of the visits, added up
  double first_fixation_at_ms = 0;  // from the beginning of the log or its trial; NaN where there was none
  double first_fixation_ms = 0;     // its duration; NaN where there was none
};

struct AoiAnalysis {
  std::vector<Aoi> areas;
  std::vector<AoiFixation> fixations;
  std::vector<AoiFigures> figures;  // one for each area, and one for none of them
  // transitions[a][b]: how often a visit to b follows one to a; the last row and column are fixations on none.
  std::vector<std::vector<std::size_t>> transitions;
  double fixation_ms = 0;  // of all fixations
};

// A fixation counts for the first shape of the list that contains its mean place. Where none does, it counts for the
// object with the largest share, if that share is larger than that of all other objects together: `objects`, the frames
// within the fixation, is needed where an AOI is an object. `uncertainty` gives the shares of shapes. Throws
// Error(input) for shapes and a log that is not of a screen, and Error(usage) for objects without `objects`.
AoiAnalysis analyse_aois(const GazeLog& log, const EyeEvents& events, std::vector<Aoi> areas,
                         const std::optional<GazeUncertainty>& uncertainty, const GazeObjects* objects);

// The same for the gaze of a job. Its scene is loaded only where an AOI is an object of it. `method` is the name of an
// event preset, "auto" or "log"; where `uncertainty` is NaN, the log's is taken. Warnings are those of the job.
struct AoisOfJob {
  AoiAnalysis analysis;
  Warnings warnings;
};
AoisOfJob aois_of_job(const Job& job, const std::string& aoi_file, const std::string& method,
                      const GazeUncertainty& uncertainty);

std::string aoi_fixations_as_tsv(const AoiAnalysis& analysis);
std::string aoi_figures_as_tsv(const AoiAnalysis& analysis);
std::string aoi_transitions_as_tsv(const AoiAnalysis& analysis);
std::string aois_as_json(const AoiAnalysis& analysis);

}  // namespace gazetrace
