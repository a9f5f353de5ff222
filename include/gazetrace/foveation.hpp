// SPDX-License-Identifier: Apache-2.0
// Where the samples go: settings -> SamplingMap -> explicit sites per tile.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// How an angle of the source paper is read: 5.2 deg as the region's diameter (it ends at 2.6 deg eccentricity), or as
// the eccentricity at which it ends.
enum class AngleReading { full_angle, eccentricity };
// tau counts for a whole n x n block, or for each of its pixels.
enum class SampleUnit { per_block, per_pixel };
// cone: by the angle between rays, exact off-axis. disc: the paper's eq. (1), r = 2 d R tan(a/2) / S pixels about the
// gaze point, with r the diameter (full_angle) or the radius (eccentricity).
enum class RegionShape { cone, disc };

// What a cut-off frequency f(e) is measured against. display: what the pixels can show, p = min(1, (f / f_disp)^2
// cos^3 t), with f_disp half the pixels per degree where the view is met at a right angle and t the angle off that axis
// (a pixel's solid angle shrinks so). relative: the fovea, p = (f / f(0))^2, whatever the display shows.
enum class FalloffNormalization { display, relative };
// Whose visual field, for models that differ between its nasal and temporal side. both: the better of the two eyes.
enum class FalloffEye { both, left, right };

// A density over eccentricity: points (eccentricity in degrees, density), ascending.
struct FalloffTable {
  std::string path;  // where it was read from; empty for one made in a program
  std::vector<Vec2d> points;
};

// The constants of the density models, with their published values.
struct FalloffParameters {
  FalloffNormalization normalization = FalloffNormalization::display;
  Vec3d ramp{5, 25, 0.1};  // linear, quadric: full up to x degrees, z (of 0 to 1) from y degrees on
  double mar_slope = 0.022, mar_foveal_deg = 1.0 / 48;  // mar: degrees a cycle = slope e + foveal
  double contrast = 1;                                  // geisler-perry, csf: of the detail to be seen, up to 1
  double luminance_cd_m2 = 100;                         // csf: that the eye is adapted to
  FalloffEye eye = FalloffEye::both;                    // retina, csf
  double log_polar_sigma = 1.8, log_polar_alpha = 4;    // log-polar: frame over buffer side, exponent of the kernel
  FalloffTable table;                                   // table
};

constexpr int kDefaultMaxBlockPx = 16;
constexpr double kDefaultDensityFloor = 1.0 / 512;

struct FoveationSettings {
  std::string falloff = "regions";  // a name of `falloffs()`
  // Falloff "uniform", frames without gaze, and what a density model gives to a place where its density is 1.
  std::uint32_t uniform_spp = 32;
  std::array<std::uint32_t, 3> region_samples{32, 16, 8};
  std::array<int, 2> region_blocks_px{2, 4};  // intermediate, periphery; the fovea is 1 x 1
  std::array<double, 2> region_angles_deg{5.2, 17.0};
  AngleReading reading = AngleReading::full_angle;
  SampleUnit unit = SampleUnit::per_block;
  RegionShape shape = RegionShape::cone;
  // Over a rim of this many degrees about each border of `regions` the logarithm of the density goes smoothly from one
  // region's to the other's; blocks then follow from the density. 0: the paper's hard border. Regions keep their own
  // rates and blocks: a density_floor of the default or less does not raise a region's rate, and the default of
  // max_block_px does not keep blocks below the largest region's (up to the next power of two).
  double border_blend_deg = 0;

  FalloffParameters parameters;
  // In place of the rates above: any fall-off is scaled until a frame has so many samples, on average for a pixel or in
  // all. One at most.
  std::optional<double> budget_spp;
  std::optional<std::uint64_t> budget_samples;
  // Blocks of density models, 1 to max_block_px pixels a side in powers of two: the smallest that expects this many
  // samples. 8 is what the paper gives a peripheral block. Where the density is 1, a block is a pixel.
  double block_samples = 8;
  int max_block_px = kDefaultMaxBlockPx;
  double density_floor = kDefaultDensityFloor;  // no place has less of the full rate, so that none is out of reach

  // What multiplies the density of any model but the layout of hard regions, in this order:
  //   1  e      less the gaze's uncertainty, not below 0
  //   2  p      = (f(e) / f_disp)^2 cos^3 t, or the model's density; times retinal_velocity; at most 1
  //   3  p      times saccade_density in flight, times contrast: parts of what 2 leaves, also at the gaze itself
  //   4  p      at least density_floor
  //   5  count  = p times uniform_spp, or times what meets the budget. A budget is met whatever 1 to 4 take: they then
  //             only say where its samples go.
  bool retinal_velocity = false;  // the square of what the speed of the image on the retina leaves of acuity
  double saccade_density = 1;     // while the eye is in flight
  // 0: off; 1: where a first look at the frame shows no contrast, a quarter of the density is left.
  double contrast_strength = 0;
};

// What a map depends on beside settings, view and gaze.
struct MapContext {
  std::uint64_t seed = 0;  // seed and frame choose which sites round up where a site expects a fraction of a sample
  std::int32_t frame = 0;
  double uncertainty_deg = 0;   // the gaze may be off by so much: eccentricities count from the nearest such gaze
  double gaze_speed_deg_s = 0;  // for retinal_velocity
  bool in_saccade = false;      // for saccade_density
  const ImageGray* contrast = nullptr;  // multiplies the density; of any size, stretched over the frame
  int threads = 0;
};

struct FalloffInfo {
  std::string name;
  std::string description;
};
std::vector<FalloffInfo> falloffs();
void check_foveation(const FoveationSettings& settings);  // Error(usage)
// With every region ending `by_deg` of eccentricity farther out: for a gaze that may be off by as much.
FoveationSettings widened(const FoveationSettings& settings, double by_deg);

// The highest spatial frequency, in cycles per degree, that the model lets the eye see at an eccentricity. The meridian
// is the direction from the gaze in the visual field: 0 right, 90 up, 180 left. Infinite for "mar" without a foveal
// term at 0 degrees; empty for models that are given by a density.
std::optional<double> falloff_cutoff_cpd(const FoveationSettings& settings, double eccentricity_deg,
                                         double meridian_deg = 0);
// Density at each pixel's centre in [floor, 1], of 1 = the full rate. Empty for layouts: "uniform", and
// "regions" with hard borders.
std::optional<ImageGray> falloff_density(const FoveationSettings& settings, const PlanarView& view,
                                         const Vec3d& gaze_direction, const MapContext& context = {});

// CSV `ecc_deg,density` with that line at its head: eccentricities ascend, densities are in [0, 1]. Error(input) with
// file:line.
FalloffTable load_falloff_table(const std::string& path);

// Pixels of one grid-aligned block that lie inside one region. The block grid is anchored at the image's origin; a
// block that straddles a border or the frame's edge has one site per region in it. Its samples are stratified over the
// site's pixels, and its value sits at their centroid. Each such part gets the block's full tau (per_block), so that it
// is sampled as well as its neighbours; traced counts therefore exceed nominal ones slightly (0.15 % at 4K).
struct Site {
  std::uint16_t block_x = 0, block_y = 0;  // in blocks of the region: pixel origin is block * block_px
  std::uint32_t samples = 0;
  std::uint16_t pixels = 0;  // how many pixels of the block belong to it
  std::uint8_t region = 0;
};

struct MapRegion {
  // "fovea", "intermediate", "periphery"; "uniform"; of density models "block_1", "block_2", ... by the side in pixels
  std::string name;
  int block_px = 1;
  std::uint64_t pixels = 0;
  std::uint64_t sites = 0;
  std::uint64_t samples = 0;  // traced: the sum over its sites
  // tau / n^2 for every pixel (per_block), tau for every pixel (per_pixel); with real-valued rates, what its sites
  // expect
  double nominal_samples = 0;
};

// A rectangle of the frame and the sites whose block origin lies in it, in a fixed order (along a Z-curve of blocks).
// About 64 px, and a multiple of the block sizes where one of at most 128 px exists; otherwise blocks may reach over
// its right and lower edge.
struct MapTile {
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;
  std::uint32_t first_site = 0, site_count = 0;
  std::uint64_t samples = 0;
};

struct SamplingMap {
  int width_px = 0, height_px = 0;
  Image<std::uint8_t> region;  // of each pixel, by its own centre
  std::vector<MapRegion> regions;
  std::vector<Site> sites;  // in order of the tiles
  std::vector<MapTile> tiles;
  // Where rates are not whole: what each site's count is on average over the seeds, also where it is 0 now. An unbiased
  // estimate divides a site's sum by it. Empty where every count is certain.
  std::vector<float> expected_samples;
  // Samples a pixel where the density is 1, and in the fovea of a layout; 0 in frames that are uniform.
  double full_rate_spp = 0;
  [[nodiscard]] double expected(std::size_t site) const {
    return expected_samples.empty() ? sites[site].samples : static_cast<double>(expected_samples[site]);
  }
  [[nodiscard]] std::uint64_t samples() const;
};

// gaze_direction: in the eye's frame, of any length, also beside or behind the frame; empty renders `uniform_spp`
// or the budget everywhere. Error(usage) when it is zero or not finite, for settings that check_foveation refuses and
// for frames beyond 65535 px. A region without pixels stays in the list.
//
// Whole counts from real-valued rates are rounded systematically along the sites: count_k = floor(C_k + u) -
// floor(C_(k-1) + u), C_k the sum of what the first k sites expect and u uniform from (seed, frame). Each count is
// within 1 of its expectation and unbiased, the total within 1 of the sum.
SamplingMap make_sampling_map(const FoveationSettings& settings, const PlanarView& view,
                              const std::optional<Vec3d>& gaze_direction, const MapContext& context = {});

// The pixels of a site, row by row. Appends nothing else; `out` is cleared first.
struct PixelIndex {
  std::uint16_t x, y;
};
void pixels_of_site(const SamplingMap& map, const Site& site, std::vector<PixelIndex>& out);

// Average samples per pixel at each pixel (site samples / site pixels), and degrees from the gaze: AOVs.
ImageGray samples_per_pixel(const SamplingMap& map);
ImageGray eccentricity_image(const PlanarView& view, const Vec3d& gaze_direction);

}  // namespace gazetrace
