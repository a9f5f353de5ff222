// SPDX-License-Identifier: Apache-2.0
// How far a test picture is from its reference: a number a pixel, and one for the frame. Every metric is a function of
// two pictures; `gazetrace list metrics` prints them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/image.hpp"

namespace gazetrace {

// What a metric reads. light: linear, Rec.709 primaries. code: display code values, 0..1 per channel.
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

// How a display turns code values into light: srgb is IEC 61966-2-1, gamma22 to linear are pure powers; pq is SMPTE
// ST 2084, whose light is absolute; of linear_hdr the values are cd/m2 themselves.
enum class DisplayResponse : std::uint8_t { srgb, gamma22, gamma24, linear, pq, linear_hdr };
inline constexpr bool is_absolute(DisplayResponse response) {
  return response == DisplayResponse::pq || response == DisplayResponse::linear_hdr;
}
// Relative light 0..1 of a code value; codes are clamped to 0..1, absolute light to the display's peak.
double display_light(DisplayResponse response, double code, double peak_cd_m2 = 200);
// SMPTE ST 2084-2014, eq. 4.1 and 5.2: cd/m2 of a code value 0..1, and the other way; clamped to 0..10000 cd/m2.
double pq_luminance(double code);
double pq_code(double cd_m2);

// FLIP's own default: 0.7 m from a screen of 3840 pixels and 0.7 m. FLIP, section 4.1 of Andersson et al. 2020.
inline constexpr double kFlipDefaultPixelsPerDegree = 67.0206451;

// Tone curves of HDR-FLIP (Andersson et al. 2021).
enum class FlipToneMapper : std::uint8_t { aces, hable, reinhard };

// Exposures of HDR-FLIP in stops: `count` of them from start to stop, both included.
struct FlipExposures {
  double start_ev = 0, stop_ev = 0;
  int count = 1;
};
// What is empty is found from the reference picture. Two sequences compare only with the same exposures.
struct FlipExposureSettings {
  FlipToneMapper tone_mapper = FlipToneMapper::aces;
  std::optional<double> start_ev, stop_ev;
  std::optional<int> count;
};

struct MetricSettings {
  double pixels_per_degree = kFlipDefaultPixelsPerDegree;  // FLIP only
  DisplayResponse response = DisplayResponse::srgb;        // of code values
  double peak_cd_m2 = 200;                                 // of the display; absolute responses only
  FlipExposureSettings hdr_flip;
  double relmse_epsilon = 0.01;
  int threads = 0;  // the same bits for any number
};

struct MetricPicture {
  ImageRgb light;  // empty where no metric of the run reads it
  ImageRgb code;
};

struct MetricMap {
  ImageGray values;   // a number a pixel; empty for metrics of whole frames
  int margin_px = 0;  // pixels this near to the border are not scored
  // What is averaged over a frame's pixels and over frames; metric_value() makes the printed number of it.
  double mean = 0;
};

// Error(usage) for an unknown name, for pictures of different or no size, of fewer pixels than the metric needs;
// Error(input) with the pixel where a value is not finite.
MetricMap measure(const std::string& metric, const MetricPicture& reference, const MetricPicture& test,
                  const MetricSettings& settings);

// The printed number of a mean over pixels, bands or frames: the root for RMSE, decibels for PSNR (+Inf at 0), the mean
// itself for others.
double metric_value(const std::string& metric, double mean);

// LDR-FLIP (Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020) of linear light as
// displayed, clamped to 0..1.
ImageGray flip_map(const ImageRgb& reference_light, const ImageRgb& test_light, double pixels_per_degree,
                   int threads = 0);

// HDR-FLIP (Andersson et al., "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021): the
// largest FLIP over the exposures. Negative values count as 0. Error(usage) unless count >= 2, or 1 with start = stop.
struct HdrFlipMap {
  ImageGray values;
  ImageGray exposure;  // 0..1 from the first to the last: where the error is largest; 0 where there is none
};
HdrFlipMap hdr_flip_map(const ImageRgb& reference, const ImageRgb& test, const FlipExposures& exposures,
                        FlipToneMapper tone_mapper, double pixels_per_degree, int threads = 0);
// Start: the reference's brightest pixel comes to 0.85 of the curve's range; stop: its median pixel. The median is
// taken over pixels of positive luminance; an all-black reference gives one exposure of 0.
FlipExposures flip_exposures(const ImageRgb& reference, const FlipExposureSettings& settings);

// Statistics of a map without its margin; sums in double precision.
struct MapStatistics {
  std::uint64_t pixels = 0;
  double mean = 0, min = 0, max = 0;
  // At 5, 25, 50, 75 and 95 %: element floor(q n) of the sorted values.
  std::array<double, 5> quantiles{};
  // FLIP's weighted quartiles: the first sorted value at which the running sum exceeds q of the total; 0 for zero maps.
  std::array<double, 3> weighted_quartiles{};
};
MapStatistics map_statistics(const ImageGray& map, int margin_px = 0);

// Pictures of maps: entry floor(255 v + 0.5) of matplotlib's tables, v clamped to 0..1, sRGB code values. FLIP shows
// errors in magma and exposures in viridis.
std::array<std::uint8_t, 3> magma(double value);
std::array<std::uint8_t, 3> viridis(double value);

}  // namespace gazetrace
