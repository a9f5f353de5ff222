// SPDX-License-Identifier: Apache-2.0
// Two sequences frame by frame: metrics per frame, per band of eccentricity and over the sequence. Nothing but numbers
// is kept of a frame, so sequences may be of any length.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/display.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "gazetrace/metrics.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

// Where bands of eccentricity begin, in degrees between the rays to gaze and pixel; the last one has no end.
inline constexpr std::array<double, 7> kEccentricityBandsDeg{0, 2.6, 5.2, 8.5, 17, 30, 60};
std::string eccentricity_band_name(std::size_t band);  // "0-2.6", ..., "60+"

// The metrics of metrics.hpp and "fovvideovdp".
std::vector<MetricInfo> comparison_metrics();

struct ComparisonSettings {
  std::vector<std::string> metrics;
  MetricSettings metric;
  DisplayPhotometry photometry;  // FovVideoVDP
  bool original_border = true;   // FovVideoVDP
  double frames_per_second = 0;  // FovVideoVDP; 0: every frame is a still
  // Without it there are no bands, no weighted scores and no FovVideoVDP.
  std::optional<PlanarView> view;
  bool want_maps = false;
};

struct FramePair {
  std::int32_t frame = 1;
  MetricPicture reference, test;
  std::optional<Vec2d> gaze_px;  // gaze_true, continuous frame pixels; empty: no gaze
  std::string gaze_class;        // "measured", "held", ...: scored apart as well
};

// A metric over a frame or, with sums carried on, over frames. Values are printed numbers, see metric_value().
struct Scores {
  std::string metric;
  double value = 0;
  // Weighted by areal cortical magnification, 1 / (e + 0.75 deg)^2 (Horton and Hoyt, "The representation of the visual
  // field in human striate cortex", 1991). Empty without gaze and for metrics without a map.
  std::optional<double> weighted;
  // Of the band's pixels; empty where there are none. FovVideoVDP: 10 minus the mean of its local difference map.
  std::array<std::optional<double>, kEccentricityBandsDeg.size()> bands;
};
struct FrameScores {
  std::int32_t frame = 0;
  std::string gaze_class;
  std::vector<Scores> scores;
  std::vector<MapStatistics> statistics;  // of the maps, in the order of the scores; pixels 0: no map
  std::vector<ImageGray> maps;            // only with want_maps
};
struct SequenceScores {
  std::string gaze_class;  // "all" or one class
  std::size_t frames = 0;
  std::vector<Scores> scores;                    // means over frames before roots, decibels and JOD are taken
  std::vector<std::array<double, 3>> quantiles;  // at 5, 50, 95 % of the frames' values
  std::vector<std::int32_t> worst_frame;
};

class Comparison {
 public:
  // Error(usage) for unknown metrics, and for FovVideoVDP without a view.
  Comparison(const ComparisonSettings& settings, int width_px, int height_px);
  ~Comparison();
  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;
  FrameScores add(const FramePair& pair);  // in the order of time
  [[nodiscard]] std::vector<SequenceScores> summary() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// A map as a picture in magma: FLIP as it is, squared errors as roots, SSIM as 1 - v, SMAPE halved, FovVideoVDP's JOD
// over 3.
DisplayImage error_map_picture(const std::string& metric, const ImageGray& map);

// Frames of which a file of this pattern exists, ascending; {0} for the name of a single picture that exists.
std::vector<std::int32_t> find_frames(const std::string& pattern);

// What a frame's file says of itself; empty where it does not.
struct FrameFacts {
  std::optional<double> exposure_ev;
  std::optional<double> frames_per_second;
  std::optional<std::int64_t> t_video_ns;
  std::string settings_digest;
  std::string gaze_state;          // of gaze_true: "measured", "held", "center", "none"
  std::string gaze_event;          // "fixation", "saccade", "blink", ...; "none": not known
  bool is_without_gaze = false;    // the log has none at this time, a policy decided
  std::optional<Vec2d> gaze_uv;    // gaze_true in fractions of the screen; empty for directions and without gaze
  bool gaze_is_direction = false;  // from the head: no place on a screen
};
// Of .exr all; of display images what their note holds: exposure, time, digest.
FrameFacts read_frame_facts(const std::string& path);

// A picture with what it says of itself. .exr: linear light; others: code values.
struct ComparedPicture {
  MetricPicture picture;
  bool is_linear = false;
  FrameFacts facts;
};
ComparedPicture read_compared_picture(const std::string& path);
// Code values of linear light as a view shows it, 8 bits; linear light of code values as a display emits it.
ImageRgb viewed(const ImageRgb& light, const ColorPipeline& color, double exposure_ev, int threads = 0);
ImageRgb emitted(const ImageRgb& code, DisplayResponse response, int threads = 0);

}  // namespace gazetrace
