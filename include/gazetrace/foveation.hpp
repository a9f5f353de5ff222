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

struct FoveationSettings {
  std::string falloff = "regions";  // a name of `falloffs()`
  std::uint32_t uniform_spp = 32;   // falloff "uniform", and frames without gaze
  std::array<std::uint32_t, 3> region_samples{32, 16, 8};
  std::array<int, 2> region_blocks_px{2, 4};  // intermediate, periphery; the fovea is 1 x 1
  std::array<double, 2> region_angles_deg{5.2, 17.0};
  AngleReading reading = AngleReading::full_angle;
  SampleUnit unit = SampleUnit::per_block;
  RegionShape shape = RegionShape::cone;
};

struct FalloffInfo {
  std::string name;
  std::string description;
};
std::vector<FalloffInfo> falloffs();
void check_foveation(const FoveationSettings& settings);  // Error(usage)
// With every region ending `by_deg` of eccentricity farther out: for a gaze that may be off by as much.
FoveationSettings widened(const FoveationSettings& settings, double by_deg);

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
  std::string name;  // "fovea", "intermediate", "periphery", "uniform"
  int block_px = 1;
  std::uint64_t pixels = 0;
  std::uint64_t sites = 0;
  std::uint64_t samples = 0;   // traced: the sum over its sites
  double nominal_samples = 0;  // tau / n^2 for every pixel (per_block), tau for every pixel (per_pixel)
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
  [[nodiscard]] std::uint64_t samples() const;
};

// gaze_direction: in the eye's frame, of any length, also beside or behind the frame; empty renders `uniform_spp`
// everywhere. Error(usage) when it is zero or not finite, for settings that check_foveation refuses and for frames
// beyond 65535 px. A region without pixels stays in the list.
SamplingMap make_sampling_map(const FoveationSettings& settings, const PlanarView& view,
                              const std::optional<Vec3d>& gaze_direction);

// The pixels of a site, row by row. Appends nothing else; `out` is cleared first.
struct PixelIndex {
  std::uint16_t x, y;
};
void pixels_of_site(const SamplingMap& map, const Site& site, std::vector<PixelIndex>& out);

// Average samples per pixel at each pixel (site samples / site pixels), and degrees from the gaze: AOVs.
ImageGray samples_per_pixel(const SamplingMap& map);
ImageGray eccentricity_image(const PlanarView& view, const Vec3d& gaze_direction);

}  // namespace gazetrace
