// SPDX-License-Identifier: Apache-2.0
// Compares two sequences frame by frame: metrics per frame, per retinal region and band of eccentricity, and over the
// sequence, separately by eye movement. Only numbers are kept of a frame, so sequences may have any length.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/display.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "gazetrace/metrics.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

// Where the bands of eccentricity begin, in degrees between the rays to gaze and pixel; the last one has no end.
inline constexpr std::array<double, 7> kEccentricityBandsDeg{0, 2.6, 5.2, 8.5, 17, 30, 60};
std::string eccentricity_band_name(std::size_t band);  // "0-2.6", ..., "60+"

// Fovea, intermediate region and periphery, by the eccentricities in degrees at which the first two end.
inline constexpr std::array<const char*, 3> kRetinalRegionNames{"fovea", "intermediate", "periphery"};
struct RetinalRegions {
  std::array<double, 2> end_deg{2.6, 8.5};
};
// The regions of RegionSampling, always as cones, also where sampling used discs. Error(usage) unless
// 0 < first < second.
RetinalRegions retinal_regions(const std::array<double, 2>& eccentricities_deg);

// The eye movement while a frame was shown; each class is scored separately. in_flight: in a saccade, or within
// kAfterSaccadeNs of its end, when little is seen. unclassified: there is gaze, but its movement is not known.
enum class GazeClass : std::uint8_t { fixation, in_flight, blink, no_gaze, unclassified };
inline constexpr std::array<GazeClass, 5> kGazeClasses{GazeClass::fixation, GazeClass::in_flight, GazeClass::blink,
                                                       GazeClass::no_gaze, GazeClass::unclassified};
inline constexpr std::int64_t kAfterSaccadeNs = 100'000'000;
std::string_view to_string(GazeClass gaze_class);  // "fixation", "in-flight", "blink", "no-gaze", "unclassified"
GazeClass gaze_class_of(const GazeAtTime& gaze);

// The metrics of metrics.hpp, and those of whole sequences (src/compare/sequence_metrics.def).
std::vector<MetricInfo> comparison_metrics();
// "dB", "JOD v1.2": scores of other versions of a metric do not compare with it. Empty: a plain number.
std::string metric_unit(const std::string& metric);

struct ComparisonSettings {
  std::vector<std::string> metrics;
  MetricSettings metric;
  RetinalRegions regions;
  DisplayPhotometry photometry;  // FovVideoVDP
  bool original_border = true;   // FovVideoVDP
  double frames_per_second = 0;  // FovVideoVDP; 0: every frame is a still
  ImageGray pooling_weights;     // FovVideoVDP, see FovVideoVdpSettings; the other metrics take none
  // Needed for regions, bands, weighted scores and metrics that need gaze.
  std::optional<PlanarView> view;
  bool want_maps = false;
};
// Error(usage) for pooling weights and other metrics than FovVideoVDP, and that names the setting whose value is out of
// range: peak (above 0), contrast (above 1), ambient light (0 or more), reflectivity (0..1) and relmse's epsilon (above
// 0), all of them finite; and where code values are relative and the room's light makes black as bright as white.
void check_comparison(const ComparisonSettings& settings);
// Enters the settings that follow from others: the peak of the display and how it answers to code values, and from
// the view the pixels per degree.
void complete_settings(ComparisonSettings& settings, int threads);
// Computes those of HDR-FLIP's exposures that the settings leave empty from this reference. Call it with the first
// frame, since frames compare only with the same exposures. Does nothing unless hdr_flip is among the metrics.
void fix_flip_exposures(ComparisonSettings& settings, const ImageRgb& reference_light);

struct FramePair {
  std::int32_t frame = 1;
  MetricPicture reference, test;
  // gaze_true in continuous pixels of the frame; empty without gaze, as in blinks and where the class is no_gaze.
  // Metrics that need gaze do not score such frames, but still take them into their history.
  std::optional<Vec2d> gaze_px;
  GazeClass gaze_class = GazeClass::unclassified;
};

// The scores of one metric for a frame, or over many frames. Values are the printed numbers, see metric_value().
struct Scores {
  std::string metric;
  std::optional<double> value;  // empty: not scored, because gaze or enough earlier frames are missing
  // Weighted by areal cortical magnification, 1 / (e + 0.75 deg)^2 (Horton and Hoyt, "The representation of the visual
  // field in human striate cortex", 1991). Empty without gaze and for metrics without a map.
  std::optional<double> weighted;
  // Over the band's pixels; empty where there are none. FovVideoVDP: 10 minus the mean of its local difference map.
  std::array<std::optional<double>, kEccentricityBandsDeg.size()> bands;
  std::array<std::optional<double>, kRetinalRegionNames.size()> regions;  // the same over the region's pixels
};
struct FrameScores {
  std::int32_t frame = 0;
  GazeClass gaze_class = GazeClass::unclassified;
  std::vector<Scores> scores;
  std::vector<MapStatistics> statistics;  // of the maps, in the order of the scores; pixels is 0 where there is no map
  std::vector<ImageGray> maps;            // only with want_maps
};
struct SequenceScores {
  std::string gaze_class;  // "all", or to_string() of one class
  std::size_t frames = 0;
  // One entry per metric in each. A metric may have scored fewer frames than there are; where it scored none, its score
  // is empty, the quantiles are NaN and there is no worst frame.
  std::vector<Scores> scores;  // averaged over frames before roots, decibels and JOD are taken
  std::vector<std::size_t> scored_frames;
  std::vector<std::array<double, 3>> quantiles;  // at 5, 50, 95 % of the frames' values
  std::vector<std::optional<std::int32_t>> worst_frame;
};
// The scores to quote: those of fixations where there are any, else those of all frames.
const SequenceScores& headline(const std::vector<SequenceScores>& summary);

class Comparison {
 public:
  // Error(usage) for unknown metrics, for settings that check_comparison() refuses, and for metrics that need gaze
  // where there is no view.
  Comparison(const ComparisonSettings& settings, int width_px, int height_px);
  ~Comparison();
  Comparison(const Comparison&) = delete;
  Comparison& operator=(const Comparison&) = delete;
  // Adds a frame; frames come in the order of time. Error(input) with frame and metric where a score is not a number.
  FrameScores add(const FramePair& pair);
  [[nodiscard]] std::vector<SequenceScores> summary() const;  // "all" first, then the classes that have frames

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// A map as a picture in the colours of magma: FLIP as it is, roots of squared errors, SSIM as 1 - v, SMAPE halved.
// FovVideoVDP and flicker are shown as heat over the reference in grey: blue, green, yellow and red stand for
// 0.75, 1.5, 2.25 and 3 JOD, or for 2.5, 5, 7.5 and 10 times the visible threshold. Without the reference's code values
// the grey is black.
DisplayImage error_map_picture(const std::string& metric, const ImageGray& map, const ImageRgb& reference_code = {});
// Draws the borders of the regions and a cross at the gaze, in white with a black rim. Parts outside the picture are
// cut off.
void draw_gaze(DisplayImage& picture, const PlanarView& view, const Vec2d& gaze_px, const RetinalRegions& regions);

// The data in the header of a frame's file; empty where it has none.
struct FrameFacts {
  std::optional<double> exposure_ev;
  std::optional<double> frames_per_second;
  std::optional<std::int64_t> t_video_ns;
  std::string settings_digest;
  std::optional<GazeAtTime> gaze_true;  // state, position, movement, time since the last saccade
  bool gaze_is_direction = false;       // a direction from the head, without a position on a screen
};
// Display images state all of this but the frame rate; DPX files leave out the gaze, too.
FrameFacts read_frame_facts(const std::string& path);

// A picture with the data of its header. Floats are linear light, everything else is code values.
struct ComparedPicture {
  MetricPicture picture;
  bool is_linear = false;
  std::array<int, 2> first_px{};  // the pixel of the picture plane at which its display window begins, of an EXR
  FrameFacts facts;
};
ComparedPicture read_compared_picture(const std::string& path);
// The red channel of a picture, as ComparisonSettings::pooling_weights. Error(input) where it cannot be read.
ImageGray read_pooling_weights(const std::string& path);
// The code values, at 8 bits, of linear light as a view shows it.
ImageRgb viewed(const ImageRgb& light, const ColorPipeline& color, double exposure_ev, int threads = 0);
// The light that a display emits for code values, relative to its peak.
ImageRgb emitted(const ImageRgb& code, DisplayResponse response, double peak_cd_m2, int threads = 0);
// The PQ code values of light in cd/m2, clamped to the display's peak.
ImageRgb pq_codes(const ImageRgb& light_cd_m2, double peak_cd_m2, int threads = 0);

}  // namespace gazetrace
