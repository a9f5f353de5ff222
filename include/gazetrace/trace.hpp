// SPDX-License-Identifier: Apache-2.0
// The path tracer takes a scene, a camera and a sampling map, and returns sums over the samples of each site.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/light_groups.hpp"
#include "gazetrace/material.hpp"
#include "gazetrace/motion.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

enum class LightSampling : std::uint8_t { mis, light_only, bsdf_only };
enum class PixelFilter : std::uint8_t { box, blackman_harris };

class GuidingField;  // opaque; made by PosedScene::train_guiding

struct TraceSettings {
  int max_bounces = 16;  // scattering events on a path; 0 shows emission only
  // From the third scattering event on, a path survives with probability min(0.95, sqrt(largest channel of its
  // throughput)), and its weight is divided by that probability; not at the last event that max_bounces allows.
  bool russian_roulette = true;
  DiffuseModel diffuse = DiffuseModel::burley;
  LightSampling light_sampling = LightSampling::mis;
  // Upper bound (radiance, on the largest channel) of each contribution that reaches the camera after more than one
  // scattering event. It removes fireflies, and with them the light that they stand for. 0: off, unbiased.
  double clamp_indirect = 0;
  // Path guiding: training paths find where the light of the frame arrives from, and bounces are drawn towards it
  // (PosedScene::train_guiding). Means do not change. Frames take less samples for the same noise where most of the sky
  // is hidden, and a little more time where it is not.
  // FrameRenderer trains the field; trace() itself only follows `guiding_field`.
  bool guiding = true;
  // trace() draws bounces by it. Empty: by the BSDF alone, even with `guiding`.
  std::shared_ptr<const GuidingField> guiding_field;
  bool show_environment = true;           // false: it gives light, and is black where the camera sees it itself
  PixelFilter filter = PixelFilter::box;  // box: half width 0.5 px; blackman_harris: 1.5 px
  // The pixel filter is this many times as wide, above 0. So a frame of an eighth of the size shows, with 1/8, single
  // pixels of the larger frame, eight apart, and their samples have the noise that they have there.
  double footprint = 1;
  std::uint64_t seed = 0;
  bool guides = false;        // collect albedo, normal and depth of the first hit
  bool light_groups = false;  // collect SparseFrame::light_groups
  bool surfaces = false;      // collect SparseFrame::surfaces
  // Splits the samples of every site into two halves of independent scramblings: sample k is number k / 2 of one of
  // them. Their difference says how far off their mean is (SparseFrame::half_difference). Each half is stratified by
  // itself, so that a mean over both has more noise than one over a single sequence: an eighth to a quarter more
  // squared error with four samples.
  bool halves = false;
  // false: the halves are the even and the odd samples of a single sequence, whose mean is better, and whose difference
  // is larger than the mean's error.
  bool independent_halves = true;
  bool first_half = false;               // with halves: collect SparseFrame::first_half
  std::optional<PixelIndex> only_pixel;  // trace only the site that holds this pixel
  // Asked before every piece of work, from several threads: once it is true, tracing ends with Error(interrupted), and
  // the frame is lost. Empty: never.
  std::function<bool()> stop;
};

// How one of many small lights is chosen: in proportion to its power, or by a tree of bounds on the light that each can
// contribute to the shaded point. automatic: the tree from four small lights on, where it was measured to pay.
enum class LightChoice : std::uint8_t { automatic, power, tree };

// How the BVH of a mesh that changes its shape is kept up to date. refit: the boxes of the BVH that was built at rest
// are fitted to the new vertices, unless the mesh deforms while the shutter is open; rebuild_*: a new BVH every frame,
// at one of the ray library's three qualities.
enum class MeshUpdate : std::uint8_t { refit, rebuild_low, rebuild_medium, rebuild_high };

struct TracerOptions {
  int threads = 0;  // 0: all cores
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
  Vec3f reflected;            // sum of the radiance, without the emission of the first hit
  Vec3f albedo;               // sum, as Guides::albedo
  Vec3f normal;               // sum of the shading normals
  Vec3f position_m;           // sum of the hit points, relative to the camera, in world axes
  float square = 0;           // sum over the samples of (luminance of `reflected` / luminance of `albedo`)^2
  float half_difference = 0;  // as SparseFrame::half_difference, of the mean luminance of `reflected`
  std::uint32_t count = 0;
  SurfaceKind kind = SurfaceKind::diffuse;
  // As SparseFrame::half_difference, of the luminance of `albedo` over *all* samples of the site: the effect of
  // chance on the surface's texture and on the share of the site that it covers.
  float albedo_difference = 0;
};
inline constexpr std::size_t kMostSurfaces = 3;

// The first hits of all samples of a site, through lens, shutter and transparency, and their distance from the view of
// a pinhole at the middle of the frame's time.
struct FirstHitSums {
  Vec3f shone;                 // sum of the radiance that is seen directly: emission, unlit surfaces, the environment
  float shone_difference = 0;  // as SparseFrame::half_difference, of the mean luminance of `shone`
  // Sum of the squared distances (px^2) between a sample's place in the frame and the place of its hit by the pinhole.
  // Without a lens and without motion while the shutter is open this is 0. A distance counts as kMostShiftPx at most.
  float square_shift_px2 = 0;
  std::uint32_t blended = 0;  // how many samples hit a surface of AlphaMode::blend
};
inline constexpr float kMostShiftPx = 1000;

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
  std::uint64_t training_paths = 0;  // of PosedScene::train_guiding(): no samples, and nothing else here counts them
  std::uint64_t rays_primary = 0, rays_bounce = 0, rays_shadow = 0;
  std::uint64_t rejected_rays = 0;
  std::uint64_t seen_backs = 0;          // samples whose camera ray hit the back of a face that is not double-sided
  std::uint64_t non_finite_samples = 0;  // such samples count as black and are always reported here
  std::vector<BadSample> bad_samples;    // the first 16, in pixel order
  std::vector<RegionTraceStats> regions;
  std::string kernel;  // name of the kernel variant that was used
};

// The guiding field that was trained for a frame.
struct TrainedGuiding {
  std::shared_ptr<const GuidingField> field;  // empty where it would not pay, and with LightSampling::light_only
  std::uint64_t paths = 0;                    // that it took, which are discarded
};

// Sum over those samples of a site that are one of its halves.
struct HalfSum {
  Vec3f radiance;
  std::uint32_t count = 0;  // of those that are numbers
};

// The tracer's result: one entry per site of the map, in the map's order.
struct SparseFrame {
  int width_px = 0, height_px = 0;
  std::vector<Vec3f> sum;                    // radiance, summed over the site's samples
  std::vector<float> sum_square_luminance;   // squared luminance (Rec.709) of each sample, summed, for the variance;
                                             // saturates at float's largest value
  std::vector<std::uint32_t> count;          // of samples
  std::vector<GuideSums> guides;             // empty unless TraceSettings::guides
  std::vector<LightGroupSums> light_groups;  // empty unless TraceSettings::light_groups; they add up to `sum`
  // Of each site, (a - b) sqrt(n_a n_b) / (n_a + n_b), where a and b are the mean luminances of its halves and n_a and
  // n_b their numbers of samples. Its expectation is 0, and that of its square is the variance of the mean of all
  // samples: it is a replica of that mean's error. 0 where a half has no samples; empty unless TraceSettings::halves.
  std::vector<float> half_difference;
  std::vector<HalfSum> first_half;  // empty unless TraceSettings::first_half
  // The surfaces of site i are surfaces[first_surface[i]] up to, not including, surfaces[first_surface[i + 1]]. Samples
  // that miss, or hit an unlit surface, belong to none. Both are empty unless TraceSettings::surfaces.
  std::vector<SurfaceSums> surfaces;
  std::vector<std::uint32_t> first_surface;
  // Of each site that filters change, beside its surfaces; empty unless TraceSettings::surfaces.
  std::vector<FirstHitSums> first_hits;
  TraceStats stats;
};

// When the shutter opens and closes, in video time; the two are equal for an instantaneous exposure.
struct ShutterTimes {
  std::int64_t open_ns = 0, close_ns = 0;
  friend bool operator==(const ShutterTimes&, const ShutterTimes&) = default;
};

struct TracerMemory {
  std::uint64_t bvh_bytes = 0;  // as Embree reports it to the device's memory monitor
  double build_s = 0;           // time that building the scene took
};

// The first hit of one ray of a camera.
struct RayHit {
  std::uint32_t object = 0;    // 1 + index into Scene::instances; 0: nothing, the environment
  std::uint32_t material = 0;  // 1 + index into Scene::materials; 0: nothing
  double distance_m = 0;       // from the camera along the ray; +Inf where nothing is hit
  Vec3d position_m;            // in the world; NaN where nothing is hit
};

class PosedScene;
struct SurfaceIds;  // coverage.hpp
struct CoverageSettings;
struct Coverage;

class PathTracer {
 public:
  // Keeps a reference to `scene`, which must outlive it.
  PathTracer(const Scene& scene, const TracerOptions& options);
  ~PathTracer();
  PathTracer(PathTracer&&) noexcept;
  PathTracer& operator=(PathTracer&&) noexcept;
  PathTracer(const PathTracer&) = delete;
  PathTracer& operator=(const PathTracer&) = delete;

  // The scene at a time: everything that moves is where it is then, and everything that deforms has its shape. With an
  // open shutter, rays see the whole motion, as straight lines between 17 equally spaced times; a deforming mesh uses 5
  // or 2 times where that keeps its vertices within a thousandth of the mesh's size. It costs nothing in a scene
  // without motions. Emitters that move are found by rays only, so LightSampling::light_only does not see them.
  [[nodiscard]] PosedScene at(const ShutterTimes& times);
  // The scene as its file places it when no animation plays.
  [[nodiscard]] PosedScene at_rest();

  // Whether anything in the scene moves or deforms, at any time.
  [[nodiscard]] bool moves() const;

  [[nodiscard]] const Scene& scene() const;
  [[nodiscard]] TracerMemory memory() const;
  // "Embree 3.13.5 avx512" and the like, for the run record.
  [[nodiscard]] std::string ray_library() const;

 private:
  friend class PosedScene;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// A scene in one pose. Rays can only be traced through it, so that no picture is ever of a pose that nobody named.
//
// It names the pose and holds no copy of the scene: the tracer, which must outlive it, has one ray tracing tree. That
// tree is put into the pose when it is asked for, and back into it where another pose was used in between. So the
// results of these functions depend on the pose and their arguments alone, and have the same bits for any number of
// threads. The tree cannot be in two poses at once: threads of the caller may share one pose, but must not use two at a
// time.
class PosedScene {
 public:
  // TraceSettings::seed and `frame` together seed the samples.
  [[nodiscard]] SparseFrame trace(const Camera& camera, std::int32_t frame, const SamplingMap& map,
                                  const TraceSettings& settings) const;

  // Traces up to one path for every eight pixels, at most 65536: first 4096 of them, and the others only where those
  // promise a gain. Trains on them for each place from where light arrives (Müller, Gross and Novák, "Practical Path
  // Guiding for Efficient Light-Transport Simulation", 2017). The result depends on the pose, the arguments and the
  // seed, not on the samples traced with it: frames between which nothing moves train the same field.
  [[nodiscard]] TrainedGuiding train_guiding(const Camera& camera, int width_px, int height_px,
                                             const TraceSettings& settings) const;

  // First hits of every pixel, for filters. Error(usage) for numbers of rays out of range.
  [[nodiscard]] Guides guides(const Camera& camera, int width_px, int height_px, const GuideSettings& settings) const;

  // First hits of single rays through places of the frame (continuous pixel coordinates, which may lie beside it), by
  // a pinhole in the middle of the shutter's time. Alpha masks are cut out; whether a ray hits a blended surface is
  // decided by a hash of its index, so that many rays through one place hit it as often as it is opaque.
  [[nodiscard]] std::vector<RayHit> first_hits(const Camera& camera, int width_px, int height_px,
                                               const std::vector<Vec2d>& places_px) const;

  // How much of each pixel each surface covers (coverage.hpp), one result for each way of naming surfaces. Rays go
  // through the camera's lens, at the times of an open shutter and through transparent surfaces as those of samples do;
  // `frame` and the seed decide their random numbers. Error(usage) for numbers out of range.
  [[nodiscard]] std::vector<Coverage> coverage(const Camera& camera, std::int32_t frame, int width_px, int height_px,
                                               const std::vector<SurfaceIds>& surfaces,
                                               const CoverageSettings& settings) const;

  // The surfaces that the pixels' centres see in this pose, and their places in another view, earlier or later.
  [[nodiscard]] SurfaceMotion surface_motion(const Camera& camera, int width_px, int height_px,
                                             const OtherView& other) const;

  // The surfaces that the pixels' centres see in this pose, which is that of `view`'s time.
  [[nodiscard]] PixelHits pixel_hits(const OtherView& view, int width_px, int height_px) const;
  // Where that is in another view. It costs least in a pose of either view's time. Keeps a reference to `seen`.
  [[nodiscard]] HitPlaces places_of(const PixelHits& seen, const OtherView& other) const;

 private:
  friend class PathTracer;
  PosedScene(PathTracer::Impl& tracer, const std::optional<ShutterTimes>& times);

  PathTracer::Impl* tracer_;
  std::optional<ShutterTimes> times_;  // empty: at rest
};

}  // namespace gazetrace
