// SPDX-License-Identifier: Apache-2.0
// Where the samples go: settings and gaze make a SamplingMap, a list of sites per tile with the samples of each.
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

// How an angle of the source paper is read: as the region's diameter (5.2 deg: the region ends at an eccentricity of
// 2.6 deg), or as the eccentricity at which the region ends.
enum class AngleReading { full_angle, eccentricity };
// The share of an angle, read so, that is an eccentricity: half of a diameter, the whole of an eccentricity. This is
// the only place where angles of regions are halved.
constexpr double eccentricity_share(AngleReading reading) {
  return reading == AngleReading::full_angle ? 0.5 : 1.0;
}
// Whether a region's number of samples, tau, counts for a whole n x n block or for each of its pixels.
enum class SampleUnit { per_block, per_pixel };
// cone: by the angle between rays, which is exact off the axis, too. disc: the paper's eq. (1), r = 2 d R tan(a/2) / S
// pixels about the gaze point, where r is the diameter (full_angle) or the radius (eccentricity).
enum class RegionShape { cone, disc };

// How a cut-off frequency f(e) becomes a density p. display: relative to what the pixels can show, p = min(1,
// (f / f_disp)^2 cos^3 t), where f_disp is half the pixels per degree where the view's axis meets it at a right angle,
// and t the angle off that axis (a pixel's solid angle shrinks by cos^3 t). relative: to the fovea, p = (f / f(0))^2,
// whatever the display can show.
enum class FalloffNormalization { display, relative };
// Whose visual field counts, for models whose nasal and temporal sides differ. both: at each place the better eye.
enum class FalloffEye { both, left, right };

// A density over eccentricity: points (eccentricity in degrees, density 0..1) in ascending order.
struct FalloffTable {
  std::string path;  // the file it was read from; empty for one made in a program
  std::vector<Vec2d> points;
};

// The constants of the density models, with their published values.
struct FalloffParameters {
  FalloffNormalization normalization = FalloffNormalization::display;
  Vec3d ramp{5, 25, 0.1};  // linear, quadric: density 1 up to x degrees, z (0..1) from y degrees on
  double mar_slope = 0.022, mar_foveal_deg = 1.0 / 48;  // mar: degrees per cycle = slope e + foveal
  double contrast = 1;                                  // geisler-perry, csf: of the detail to be seen; > 0, up to 1
  double luminance_cd_m2 = 100;                         // csf: to which the eye is adapted
  FalloffEye eye = FalloffEye::both;                    // retina, csf
  double log_polar_sigma = 1.8, log_polar_alpha = 4;    // log-polar: frame over buffer side, exponent of the kernel
  FalloffTable table;                                   // table
};

// A quality from which the number of samples follows. At most one of the members is given; it takes the place of a
// budget. From `relmse` a FrameRenderer makes the rates of each frame; it is for the fall-off `visible`, whose pilot
// predicts it. From `jod` render_sequence() makes one budget for all frames, of any fall-off but `regions`; a
// FrameRenderer alone does not see it.
struct QualityTarget {
  std::optional<double> relmse;  // mean over the frame of squared error over (squared luminance + 0.01)
  std::optional<double> jod;     // of the whole sequence by FovVideoVDP, up to 10
  [[nodiscard]] bool is_given() const { return relmse || jod; }
};

constexpr int kDefaultMaxBlockPx = 16;
constexpr double kDefaultDensityFloor = 1.0 / 512;

struct FoveationSettings {
  std::string falloff = "regions";  // a name of `falloffs()`
  // Samples per pixel of the fall-off "uniform", of frames without gaze, and of a density model where the density is 1.
  std::uint32_t uniform_spp = 32;
  std::array<std::uint32_t, 3> region_samples{32, 16, 8};
  std::array<int, 2> region_blocks_px{2, 4};  // intermediate, periphery; the fovea is 1 x 1
  std::array<double, 2> region_angles_deg{5.2, 17.0};
  AngleReading reading = AngleReading::full_angle;
  SampleUnit unit = SampleUnit::per_block;
  RegionShape shape = RegionShape::cone;

  FalloffParameters parameters;
  // Of the fall-off `map`: the file that MapContext::density is read from, or a pattern of files with a place for the
  // frame's number (frame_file_name()).
  std::string density_map;
  // Of the fall-off `visible`: the least and the most samples a pixel of any place. Of QualityTarget::jod: of the whole
  // frame.
  double min_spp = 0.0625, max_spp = 65536;
  QualityTarget target;
  // A budget replaces the rates above: any fall-off is scaled so that a frame has this many samples, per pixel on
  // average or in total. At most one of the two may be given.
  std::optional<double> budget_spp;
  std::optional<std::uint64_t> budget_samples;
  // Blocks of density models have a side of 1 to max_block_px pixels, a power of two; the smallest one that expects
  // this many samples is taken. 8 is what the paper gives a peripheral block. Where the density is 1, a block is one
  // pixel.
  double block_samples = 8;
  int max_block_px = kDefaultMaxBlockPx;
  double density_floor = kDefaultDensityFloor;  // the least density anywhere, so that every place gets some samples

  // How the density p of any model is made, except for the layouts "uniform" and `regions`:
  //   1  p      = (f(e) / f_disp)^2 cos^3 t, or the model's own density, at most 1
  //   2  p      is raised to at least density_floor
  //   3  count  = p times uniform_spp, or times the rate that meets the budget. A budget is always met: then steps 1
  //             and 2 only say where its samples go.
  // Models that follow a picture (FalloffInfo::from_picture) have p = MapContext::density over its largest value in
  // step 1, and that value, in samples a pixel, is their full rate. They need no gaze.
};

// What a map depends on besides settings, view and gaze.
struct MapContext {
  std::uint64_t seed = 0;  // seed and frame decide which of the sites that expect a fraction of a sample round up
  std::int32_t frame = 0;
  // What models that follow a picture follow: samples a pixel, or relative rates where there is a budget. Of any size,
  // stretched over the frame; see check_density_picture().
  const ImageGray* density = nullptr;
  // Where `density` shows a part of a frame only: the largest value in all of it, so that blocks and the least density
  // are those of the frame. 0: that of `density`.
  double full_rate_spp = 0;
  int threads = 0;  // 0: all cores; the map is the same for any number
};

struct FalloffInfo {
  std::string name;
  std::string description;
  bool from_picture = false;  // its rates are MapContext::density
};
std::vector<FalloffInfo> falloffs();
bool follows_picture(const FoveationSettings& settings);
// Whether frames without gaze are sampled as the fall-off says, instead of uniformly.
bool works_without_gaze(const FoveationSettings& settings);
// Error(input) that names `place` and the first pixel whose value is not a finite number of at least 0, or, without a
// budget, is more than a pixel can have; and where all values are 0.
void check_density_picture(const ImageGray& density, const FoveationSettings& settings, const std::string& place);
void check_foveation(const FoveationSettings& settings);  // Error(usage) that names the setting that is out of range

// The highest spatial frequency, in cycles per degree, that the eye sees at an eccentricity according to the model. The
// meridian is the direction from the gaze in the visual field: 0 right, 90 up, 180 left. Infinite at 0 degrees for
// "mar" without a foveal term; empty for models that state a density instead.
std::optional<double> falloff_cutoff_cpd(const FoveationSettings& settings, double eccentricity_deg,
                                         double meridian_deg = 0);
// The density at each pixel's centre, in [density_floor, 1], where 1 is the full rate. Empty for layouts: "uniform",
// and "regions" with hard borders.
std::optional<ImageGray> falloff_density(const FoveationSettings& settings, const PlanarView& view,
                                         const Vec3d& gaze_direction, const MapContext& context = {});

// Reads a CSV with the header line `ecc_deg,density`: eccentricities 0..180 in ascending order, densities in [0, 1].
// Error(input) with file:line.
FalloffTable load_falloff_table(const std::string& path);

// A site: those pixels of one grid-aligned block that lie in one region. The block grid is anchored at the image's
// origin; a block that straddles borders has one site for each region in it. The samples are stratified over the site's
// pixels, and its value belongs at their centroid. A part of a block gets the block's full tau (per_block), so that it
// is sampled as well as its neighbours; traced counts therefore exceed nominal ones slightly (by 0.15 % at 4K).
struct Site {
  std::uint16_t block_x = 0, block_y = 0;  // in blocks of the region: the first pixel is block * block_px
  std::uint32_t samples = 0;
  std::uint16_t pixels = 0;  // how many pixels of the block belong to it
  std::uint8_t region = 0;
};

struct MapRegion {
  // "fovea", "intermediate", "periphery"; "uniform"; for density models "block_1", "block_2", ... by the side in pixels
  std::string name;
  int block_px = 1;
  std::uint64_t pixels = 0;
  std::uint64_t sites = 0;
  std::uint64_t samples = 0;  // traced: the sum over its sites
  // The sum of tau / n^2 (per_block) or tau (per_pixel) over its pixels; with real-valued rates, what its sites expect.
  double nominal_samples = 0;
};

// A rectangle of the frame, and the sites whose block begins in it, in a fixed order along a Z-curve. Its side is about
// 64 px, and a multiple of all block sizes where there is one of at most 128 px; otherwise blocks may extend over its
// right and lower edges.
struct MapTile {
  int x_px = 0, y_px = 0, width_px = 0, height_px = 0;
  std::uint32_t first_site = 0, site_count = 0;
  std::uint64_t samples = 0;
};

struct SamplingMap {
  int width_px = 0, height_px = 0;
  Image<std::uint8_t> region;  // index into `regions` for each pixel
  std::vector<MapRegion> regions;
  std::vector<Site> sites;  // in order of the tiles
  std::vector<MapTile> tiles;
  // Where rates are not whole: the expectation of each site's count over all seeds, also where the count is 0 now. An
  // unbiased estimate divides a site's sum by it. Empty where every count is certain.
  std::vector<float> expected_samples;
  [[nodiscard]] double expected(std::size_t site) const {
    return expected_samples.empty() ? sites[site].samples : static_cast<double>(expected_samples[site]);
  }
  [[nodiscard]] std::uint64_t samples() const;
};

// `gaze_direction` is in the eye's frame, of any length, and may point beside or behind the frame; where it is empty,
// every pixel gets `uniform_spp` or its share of the budget, unless the model follows a picture. Error(usage) where it
// is zero or not finite, for settings that check_foveation refuses, for models whose picture is missing, and for frames
// of more than 65535 px a side. Regions without pixels stay in the list.
//
// Real-valued rates are rounded to whole counts systematically along the sites: count_k = floor(C_k + u) -
// floor(C_(k-1) + u), where C_k is the sum of what the first k sites expect and u is uniform, made from seed and frame.
// Each count is unbiased and within 1 of its expectation; the total is within 1 of the sum of expectations.
SamplingMap make_sampling_map(const FoveationSettings& settings, const PlanarView& view,
                              const std::optional<Vec3d>& gaze_direction, const MapContext& context = {});

// Replaces the content of `out` by the pixels of a site, row by row.
struct PixelIndex {
  std::uint16_t x, y;
};
void pixels_of_site(const SamplingMap& map, const Site& site, std::vector<PixelIndex>& out);

// The AOVs: samples per pixel at each pixel (samples of the site over its pixels), and degrees from the gaze.
ImageGray samples_per_pixel(const SamplingMap& map);
ImageGray eccentricity_image(const PlanarView& view, const Vec3d& gaze_direction);

}  // namespace gazetrace
