// SPDX-License-Identifier: Apache-2.0
// Image metrics: how far a test picture is from its reference, as a number per pixel and one for the frame. Every
// metric is a function of two pictures; `gazetrace list metrics` prints them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/image.hpp"

namespace gazetrace {

// The input of a metric. light: linear, Rec.709 primaries. code: display code values, 0..1 per channel.
enum class MetricInput : std::uint8_t { light, code };
enum class MetricDirection : std::uint8_t { lower, higher };  // which way is better

struct MetricInfo {
  std::string name;
  MetricInput input = MetricInput::light;
  MetricDirection better = MetricDirection::lower;
  std::string description;
  bool needs_gaze = false;
};
const std::vector<MetricInfo>& metrics();
const MetricInfo& metric_by_name(const std::string& name);  // Error(usage) with the known names

// How a display turns code values into light. srgb is IEC 61966-2-1; gamma22, gamma24 and linear are pure powers; pq is
// SMPTE ST 2084, whose light is absolute; with linear_hdr the values are themselves in cd/m2.
enum class DisplayResponse : std::uint8_t { srgb, gamma22, gamma24, linear, pq, linear_hdr };
inline constexpr bool is_absolute(DisplayResponse response) {
  return response == DisplayResponse::pq || response == DisplayResponse::linear_hdr;
}
// The light of a code value relative to the peak, 0..1. Codes are clamped to 0..1, absolute light to the peak.
double display_light(DisplayResponse response, double code, double peak_cd_m2 = 200);
// SMPTE ST 2084-2014, eq. 4.1 and 5.2: from a code value 0..1 to cd/m2, and back; clamped to 0..10000 cd/m2.
double pq_luminance(double code);
double pq_code(double cd_m2);

// FLIP's default viewing condition: 0.7 m from a screen that is 3840 pixels and 0.7 m wide (Andersson et al. 2020,
// section 4.1).
inline constexpr double kFlipDefaultPixelsPerDegree = 67.0206451;

// Tone curves of HDR-FLIP (Andersson et al. 2021).
enum class FlipToneMapper : std::uint8_t { aces, hable, reinhard };

// The exposures of HDR-FLIP in stops: `count` of them at equal steps from start to stop, both included.
struct FlipExposures {
  double start_ev = 0, stop_ev = 0;
  int count = 1;
};
// Empty values are computed from the reference picture. Scores compare only where the exposures were the same.
struct FlipExposureSettings {
  FlipToneMapper tone_mapper = FlipToneMapper::aces;
  std::optional<double> start_ev, stop_ev;
  std::optional<int> count;
};

struct MetricSettings {
  double pixels_per_degree = kFlipDefaultPixelsPerDegree;  // FLIP only
  DisplayResponse response = DisplayResponse::srgb;        // of code values
  double peak_cd_m2 = 200;                                 // of the display; used by absolute responses only
  FlipExposureSettings hdr_flip;
  double relmse_epsilon = 0.01;
  int threads = 0;  // the same bits for any number
};

struct MetricPicture {
  ImageRgb light;  // MetricInput::light; empty where no metric reads it
  ImageRgb code;   // MetricInput::code; likewise
};

struct MetricMap {
  ImageGray values;   // a number per pixel; empty for metrics of whole frames
  int margin_px = 0;  // pixels this close to the border are not scored
  // The quantity that is averaged over a frame's pixels and over frames; metric_value() turns it into the printed one.
  double mean = 0;
};

// Error(usage) for an unknown name, and for pictures that are empty, differ in size, or are smaller than the metric
// needs; Error(input) with the pixel where a value is not finite.
MetricMap measure(const std::string& metric, const MetricPicture& reference, const MetricPicture& test,
                  const MetricSettings& settings);

// The printed number for a mean over pixels, bands or frames: its root for RMSE, decibels for PSNR (+Inf at 0), and the
// mean itself for all others.
double metric_value(const std::string& metric, double mean);

// LDR-FLIP (Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020) of linear displayed
// light, which is clamped to 0..1.
ImageGray flip_map(const ImageRgb& reference_light, const ImageRgb& test_light, double pixels_per_degree,
                   int threads = 0);

// HDR-FLIP (Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021): the
// largest FLIP over the exposures. Negative values count as 0. Error(usage) unless count >= 2, or it is 1 and start
// equals stop.
struct HdrFlipMap {
  ImageGray values;
  ImageGray exposure;  // the exposure with the largest error, 0..1 from first to last; 0 where there is no error
};
HdrFlipMap hdr_flip_map(const ImageRgb& reference, const ImageRgb& test, const FlipExposures& exposures,
                        FlipToneMapper tone_mapper, double pixels_per_degree, int threads = 0);
// Fills in the empty settings. start brings the reference's brightest pixel to 0.85 of the tone curve's
// range, stop its median pixel: the upper median of all pixels, or 2^-23 where that is darker, as in FLIP 1.7. An
// all-black reference gives a single exposure of 0.
FlipExposures flip_exposures(const ImageRgb& reference, const FlipExposureSettings& settings);

// Statistics of a map without its margin, with sums in double precision.
struct MapStatistics {
  std::uint64_t pixels = 0;
  double mean = 0, min = 0, max = 0;
  // Quantiles q of 5, 25, 50, 75 and 95 %: element floor(q n) of the n sorted values.
  std::array<double, 5> quantiles{};
  // FLIP's weighted quartiles: the first sorted value at which the running sum exceeds the share q of the total; 0
  // where the whole map is 0.
  std::array<double, 3> weighted_quartiles{};
};
MapStatistics map_statistics(const ImageGray& map, int margin_px = 0);

// Colours for maps as sRGB code values: entry floor(255 v + 0.5) of matplotlib's tables, v clamped to 0..1. FLIP shows
// errors in magma and exposures in viridis.
std::array<std::uint8_t, 3> magma(double value);
std::array<std::uint8_t, 3> viridis(double value);

}  // namespace gazetrace
