// SPDX-License-Identifier: Apache-2.0
// The path tracer takes a scene, a camera and a sampling map, and returns sums over the samples of each site.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/material.hpp"
#include "gazetrace/motion.hpp"
#include "gazetrace/sample_sums.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

enum class LightSampling : std::uint8_t { mis, light_only, bsdf_only };
enum class PixelFilter : std::uint8_t { box, blackman_harris };
enum class BvhQuality : std::uint8_t { high, medium };

struct TraceSettings {
  int max_bounces = 3;  // scattering events on a path; 0 shows emission only
  // From the third scattering event on, a path survives with probability min(0.95, sqrt(largest channel of its
  // throughput)), and its weight is divided by that probability. The last event that max_bounces allows is not played
  // for.
  bool russian_roulette = false;
  DiffuseModel diffuse = DiffuseModel::burley;
  LightSampling light_sampling = LightSampling::mis;
  // Draws light samples of the environment only where it exceeds half its mean (MIS compensation); has an effect with
  // LightSampling::mis only. This gives less noise in the open, and more where most of the sky is hidden.
  bool compensate_environment = false;
  // Upper bound (radiance, on the largest channel) of each contribution that reaches the camera after more than one
  // scattering event. It removes fireflies, and with them the light that they stand for. 0: off, unbiased.
  double clamp_indirect = 0;
  // At each bounce the ray cone opens by this angle times 1 / sqrt(pi pdf), that is by about the whole angle for a
  // diffuse bounce and hardly at all for a mirror, so that hits after a bounce read coarser texture levels. 0: full
  // resolution.
  double bounce_cone_rad = 0.15;
  // Width of a camera ray's cone in pixels, which chooses the texture level at first hits. 0: full resolution, which
  // the pixel's samples average. Coarser levels save too little time to be worth their blur (Sponza at 960 x 540: a
  // root mean square difference of 12 % per pixel).
  double pixel_cone = 0;
  PixelFilter filter = PixelFilter::box;  // box: half width 0.5 px; blackman_harris: 1.5 px
  std::uint64_t seed = 0;
  bool guides = false;                   // collect albedo, normal and depth of the first hit
  bool surfaces = false;                 // collect SparseFrame::surfaces for the sites that needs_filtering names
  std::optional<PixelIndex> only_pixel;  // trace only the site that holds this pixel
  // Traces only these samples of every site, and keeps their exact sums in SparseFrame::unrounded as well. Rays are
  // then traced one by one instead of in packets, so that a sample does not depend on its neighbours in the packet:
  // within packets about one ray in 1e7 hits the other one of two surfaces that share an edge. This is about an eighth
  // slower.
  std::optional<SampleRange> samples;
};

// How one of many small lights is chosen: in proportion to its power, or by a tree of bounds on what each light can
// contribute to the shaded point. automatic: the tree from four small lights on, where it was measured to pay.
enum class LightChoice : std::uint8_t { automatic, power, tree };

// How the BVH of a mesh that changes its shape is kept up to date. refit: the boxes of the BVH that was built at rest
// are fitted to the new vertices, unless the mesh deforms while the shutter is open; rebuild_*: a new BVH every frame,
// at one of the ray library's three qualities.
enum class MeshUpdate : std::uint8_t { refit, rebuild_low, rebuild_medium, rebuild_high };

struct TracerOptions {
  int threads = 0;  // 0: all cores
  BvhQuality bvh_quality = BvhQuality::high;
  MeshUpdate mesh_update = MeshUpdate::refit;
  LightChoice light_choice = LightChoice::automatic;
  // For measurements: always use the kernel variant that has every feature compiled in.
  bool all_features = false;
};

// Sums over a site's samples; divide by `hits` for the mean. Samples that miss add nothing.
struct GuideSums {
  Vec3f albedo;       // base colour of the first hit (not Guides::albedo, which is a reflectance)
  Vec3f normal;       // shading normal towards the camera, world space
  float depth_m = 0;  // distance along the view axis
  std::uint32_t hits = 0;
};

// Sums over those samples of a site whose first hits lie on one surface: they are of one kind, face about the same way
// and lie about in one plane. A site has at most kMostSurfaces; further samples join the one that fits best.
struct SurfaceSums {
  Vec3f reflected;   // sum of the radiance, without what the first hit itself emits
  Vec3f albedo;      // sum, as Guides::albedo
  Vec3f normal;      // sum of the shading normals
  Vec3f place_m;     // sum of the hit points, relative to the camera, in world axes
  float square = 0;  // sum over the samples of (luminance of `reflected` / luminance of `albedo`)^2
  std::uint32_t count = 0;
  SurfaceKind kind = SurfaceKind::diffuse;
};
inline constexpr std::size_t kMostSurfaces = 3;

struct BadSample {
  std::int32_t frame = 0;
  int x_px = 0, y_px = 0;
  std::uint32_t sample = 0;
  std::string what;  // "non-finite radiance", "rejected ray"
};

struct RegionTraceStats {
  std::uint64_t samples = 0;
  std::int64_t cpu_ns = 0;  // thread time; a batch that spans several regions is divided by their samples
};

struct TraceStats {
  std::uint64_t samples = 0;
  std::uint64_t rays_primary = 0, rays_bounce = 0, rays_shadow = 0;
  std::uint64_t rejected_rays = 0;
  std::uint64_t non_finite_samples = 0;  // such samples count as black and are always reported here
  std::vector<BadSample> bad_samples;    // the first 16, in pixel order
  std::vector<RegionTraceStats> regions;
  std::string kernel;  // name of the kernel variant that was used
};

// What the tracer found: one entry per site of the map, in the map's order.
struct SparseFrame {
  int width_px = 0, height_px = 0;
  std::vector<Vec3f> sum;                   // radiance, summed over the site's samples
  std::vector<float> sum_square_luminance;  // squared luminance (Rec.709) of each sample, summed, for the variance;
                                            // saturates at float's largest value
  std::vector<std::uint32_t> count;         // of samples
  std::vector<GuideSums> guides;            // empty unless TraceSettings::guides
  // The surfaces of site i are surfaces[first_surface[i]] up to, not including, surfaces[first_surface[i + 1]]. Samples
  // that miss, or hit an unlit surface, belong to none. Both are empty unless TraceSettings::surfaces.
  std::vector<SurfaceSums> surfaces;
  std::vector<std::uint32_t> first_surface;
  SampleSums unrounded;  // empty unless TraceSettings::samples
  TraceStats stats;
};

// Adds the sums of other samples of the same sites. Error(runtime) where the numbers of sites differ.
void add_sums(const SampleSums& from, SampleSums& to);
// What trace() would have returned for the samples that were added up, bit for bit, but without surfaces and stats.
// Error(runtime) where the number of sums is not the map's number of sites.
SparseFrame sparse_frame_of(const SampleSums& sums, const SamplingMap& map);

// Whether a guided filter changes a site: it filters sites of several pixels, and single pixels that expect fewer
// samples than the map's enough_samples (uniform frames, and what a small budget leaves even at the gaze). All other
// sites keep their own mean, bit for bit. The expectation decides and not the count: of pixels that expect 15.5 samples
// half have 16, and it is a different half in every frame.
bool needs_filtering(const SamplingMap& map, std::size_t site);

// When the shutter opens and closes, in video time; the two are equal for an instantaneous exposure.
struct ShutterTimes {
  std::int64_t open_ns = 0, close_ns = 0;
};

struct TracerMemory {
  std::uint64_t bvh_bytes = 0;  // as Embree reports it to the device's memory monitor
  double build_s = 0;           // time that building the scene took
};

class PathTracer {
 public:
  // Keeps a reference to `scene`, which must outlive it.
  PathTracer(const Scene& scene, const TracerOptions& options);
  ~PathTracer();
  PathTracer(PathTracer&&) noexcept;
  PathTracer& operator=(PathTracer&&) noexcept;
  PathTracer(const PathTracer&) = delete;
  PathTracer& operator=(const PathTracer&) = delete;

  // Puts everything that moves where it is at that time, and everything that deforms into its shape. With an open
  // shutter, rays see the whole motion, as straight lines between 17 equally spaced times; a deforming mesh uses 5 or 2
  // times where that keeps its vertices within a thousandth of the mesh's size. Until it is called, everything is at
  // rest. It costs nothing in a scene without motions. Emitters that move are found by rays only, so
  // LightSampling::light_only does not see them.
  void move_to(const ShutterTimes& times);

  // A pure function of its arguments and the last move_to: the same bits for any number of threads. TraceSettings::seed
  // and `frame` together seed the samples.
  [[nodiscard]] SparseFrame trace(const Camera& camera, std::int32_t frame, const SamplingMap& map,
                                  const TraceSettings& settings) const;

  // First hits of every pixel, for filters and reprojection. A pure function of its arguments and the last move_to.
  // Error(usage) for numbers of rays out of range.
  [[nodiscard]] Guides guides(const Camera& camera, int width_px, int height_px, const GuideSettings& settings) const;

  // What the pixels' centres see as things stand after the last move_to, and where that was in an earlier view.
  [[nodiscard]] SurfaceMotion surface_motion(const Camera& camera, int width_px, int height_px,
                                             const EarlierView& earlier) const;

  [[nodiscard]] TracerMemory memory() const;
  // "Embree 3.13.5 avx512" and the like, for the run record.
  [[nodiscard]] std::string ray_library() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gazetrace
