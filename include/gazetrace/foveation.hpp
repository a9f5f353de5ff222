// SPDX-License-Identifier: Apache-2.0
// Where the samples go: settings and gaze make a SamplingMap, a list of sites per tile with the samples of each.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gazetrace/density.hpp"
#include "gazetrace/display.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// Whether a region's number of samples, tau, counts for a whole n x n block or for each of its pixels.
enum class SampleUnit { per_block, per_pixel };
// How the eccentricity at which a region ends becomes a border. cone: by the angle between rays, which is exact off the
// axis, too. disc, disc_by_radius: the paper's eq. (1), r = 2 d R tan(a/2) / S pixels about the gaze point. It does not
// define a: the angle from one side of the region to the other, so that r is a diameter (disc), or the
// eccentricity itself, so that r is a radius (disc_by_radius).
enum class RegionShape { cone, disc, disc_by_radius };

struct UniformSampling {
  static constexpr SamplingTraits kTraits{
      .name = "uniform", .description = "the same number of samples at every pixel", .needs_gaze = false};
};

struct RegionSampling {
  static constexpr SamplingTraits kTraits{
      .name = "regions",
      .description = "three regions about the gaze: fovea per pixel, intermediate and periphery in blocks"};
  std::array<std::uint32_t, 3> samples{32, 16, 8};
  std::array<int, 2> blocks_px{2, 4};  // intermediate, periphery; the fovea is 1 x 1
  std::array<double, 2> eccentricities_deg{2.6, 8.5};
  SampleUnit unit = SampleUnit::per_block;
  RegionShape shape = RegionShape::cone;
};

struct AdaptiveSampling {
  static constexpr SamplingTraits kTraits{
      .name = "adaptive",
      .description = "more samples where a pilot of the frame finds noise that the filter leaves",
      .needs_gaze = false,
      .follows_picture = true,
      .looks_first = true};
};

// Its kTraits describe each of them. DensitySampling is in density.hpp.
using Sampling = std::variant<RegionSampling, UniformSampling, DensitySampling, AdaptiveSampling>;

SamplingTraits traits_of(const Sampling& sampling);  // as it is: a density may follow a picture
std::vector<SamplingTraits> samplings();             // all of them
inline bool is_uniform(const Sampling& sampling) {
  return std::holds_alternative<UniformSampling>(sampling);
}
inline bool follows_picture(const Sampling& sampling) {
  return traits_of(sampling).follows_picture;
}
inline bool looks_first(const Sampling& sampling) {
  return traits_of(sampling).looks_first;
}
// nullptr where there are none.
inline const RegionSampling* regions_of(const Sampling& sampling) {
  return std::get_if<RegionSampling>(&sampling);
}
// The pictures that it reads, as DensitySampling::picture_files; empty: none.
std::string picture_files_of(const Sampling& sampling);

// "uniform", "regions", "regions:shape=disc,unit=pixel", "density", "adaptive". Throws Error(usage).
Sampling parse_sampling(std::string_view text, const std::string& place = "`sampling`");
// Its text, with unusual shapes and units, but without other values of regions and densities.
std::string to_string(const Sampling& sampling);

// A quality from which the number of samples follows. At most one of the members is given; it takes the place of `spp`.
// From `relmse` a FrameRenderer makes the rates of each frame; it is for AdaptiveSampling, whose pilot predicts it.
// From `jod` render_sequence() makes one `spp` for all frames, of any sampling but regions; a FrameRenderer alone does
// not see it.
struct QualityTarget {
  std::optional<double> relmse;  // mean over the frame of squared error over (squared luminance + 0.01)
  std::optional<double> jod;     // of the whole sequence by FovVideoVDP, up to 10
  [[nodiscard]] bool is_given() const { return relmse || jod; }
};

constexpr int kDefaultMaxBlockPx = 16;

struct FoveationSettings {
  Sampling sampling;
  // Scales any sampling so that a frame has this many samples a pixel on average. Empty: regions have their own counts,
  // pictures state theirs, and uniform frames, densities and pilots take kUsualSpp.
  std::optional<double> spp;
  QualityTarget target;
  // Of AdaptiveSampling: the least and the most samples a pixel of any place. Of QualityTarget::jod: of the
  // whole frame.
  double min_spp = 0.0625, max_spp = 65536;
  // Blocks of density models have a side of 1 to max_block_px pixels, a power of two; the smallest one that expects
  // this many samples is taken. 8 is the paper's number for a peripheral block. Where the density is 1, a block is one
  // pixel.
  double block_samples = 8;
  int max_block_px = kDefaultMaxBlockPx;
  // How the density p of any model is made, except for uniform frames and regions:
  //   1  p      = (f(e) / f_disp)^2 cos^3 t, or the model's own density, at most 1
  //   2  p      is raised to at least the least density
  //   3  count  = p times the full rate, or times the rate that meets `spp`. That is always met: then steps 1 and 2
  //   only
  //             say where the samples go.
  // Samplings that follow a picture have p = MapContext::density over its largest value in step 1, and that value, in
  // samples a pixel, is their full rate.
};

// The inputs of a map besides settings, view and gaze.
struct MapContext {
  std::uint64_t seed = 0;  // seed and frame decide which of the sites that expect a fraction of a sample round up
  std::int32_t frame = 0;
  // The picture of models that follow one: samples a pixel, or relative rates where `spp` is given. Of any size,
  // stretched over the frame; see check_density_picture().
  const ImageGray* density = nullptr;
  // Where `density` shows a part of a frame only: the largest value in all of it, so that blocks and the least density
  // are those of the frame. 0: that of `density`.
  double full_rate_spp = 0;
  int threads = 0;  // 0: all cores; the map is the same for any number
};

// Error(input) that names `place` and the first pixel whose value is not a finite number of at least 0, or, without
// `spp`, is more than a pixel can have; and where all values are 0.
void check_density_picture(const ImageGray& density, const FoveationSettings& settings, const std::string& place);
void check_foveation(const FoveationSettings& settings);  // Error(usage) that names the setting that is out of range

// The density at each pixel's centre, from the least density to 1, where 1 is the full rate. Empty for uniform frames
// and for regions.
std::optional<ImageGray> density_image(const FoveationSettings& settings, const PlanarView& view,
                                       const Vec3d& gaze_direction, const MapContext& context = {});

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
  // The sum of tau / n^2 (per_block) or tau (per_pixel) over its pixels; with real-valued rates, of expected samples.
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
  // Of its first pixel in the frame, of which it may be a part. Pixels have the random numbers of their frame.
  int x_px = 0, y_px = 0;
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
// every pixel gets the same, unless the sampling follows a picture. Error(usage) where it is zero or not finite, for
// settings that check_foveation refuses, for models whose picture is missing, and for frames of more than 65535 px a
// side. Regions without pixels stay in the list.
//
// Real-valued rates are rounded to whole counts systematically along the sites: count_k = floor(C_k + u) -
// floor(C_(k-1) + u), where C_k is the expected sum of the first k sites and u is uniform, made from seed and frame.
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
