// SPDX-License-Identifier: Apache-2.0
// PathTracer: traces tiles in parallel and the batches of a tile in order, and adds up samples without rounding.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>

#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "core/stopwatch.hpp"
#include "gazetrace/trace.hpp"
#include "trace/guides/coverage.hpp"
#include "trace/guides/first_hits.hpp"
#include "trace/guides/guides.hpp"
#include "trace/guiding/learning_pass.hpp"
#include "trace/kernel/kernel.hpp"
#include "trace/motion/surface_motion.hpp"
#include "trace/samples/sample_list.hpp"
#include "trace/samples/sample_sums.hpp"
#include "trace/samples/surface_sums.hpp"
#include "trace/samples/z_order.hpp"

namespace gazetrace {
namespace {

constexpr std::size_t kReportedBadSamples = 16;

struct TileResult {
  KernelCounts counts;
  std::uint64_t samples = 0, non_finite = 0;
  std::vector<BadSample> bad;  // the first ones, in pixel order
  std::vector<RegionTraceStats> regions;
  std::vector<SurfaceSums> surfaces;  // of all sites of the tile, in their order
};

bool before(const BadSample& a, const BadSample& b) {
  return std::tie(a.y_px, a.x_px, a.sample, a.what) < std::tie(b.y_px, b.x_px, b.sample, b.what);
}

void keep_first(std::vector<BadSample>& list, BadSample sample) {
  list.insert(std::upper_bound(list.begin(), list.end(), sample, before), std::move(sample));
  if (list.size() > kReportedBadSamples) {
    list.pop_back();
  }
}

// The sums of one site. Sites are finished one at a time, since the samples of a site follow each other in the list,
// possibly over several batches.
struct SiteSum {
  SiteSums light;
  SiteGuideSums guides;
  std::array<Vec3d, kLightGroups> groups{};  // a site belongs to one thread, which adds its samples in their order
};

void add_guides(const GuideBatch& g, std::size_t i, SiteGuideSums& sums) {
  sums.albedo_red.add(static_cast<double>(g.albedo_r[i]));
  sums.albedo_green.add(static_cast<double>(g.albedo_g[i]));
  sums.albedo_blue.add(static_cast<double>(g.albedo_b[i]));
  sums.normal_x.add(static_cast<double>(g.normal_x[i]));
  sums.normal_y.add(static_cast<double>(g.normal_y[i]));
  sums.normal_z.add(static_cast<double>(g.normal_z[i]));
  sums.depth_m.add(static_cast<double>(g.depth[i]));
  ++sums.hits;
}

void add_light(const Vec3f& radiance, SiteSums& sums) {
  sums.red.add(static_cast<double>(radiance.x));
  sums.green.add(static_cast<double>(radiance.y));
  sums.blue.add(static_cast<double>(radiance.z));
  const double shone = luminance(to_double(radiance));
  // Rounded to float, as all terms of an ExactSum must be. It saturates, since squares exceed float's range from a
  // radiance of 1.8e19 on.
  constexpr double kMost = std::numeric_limits<float>::max();
  sums.square_luminance.add(static_cast<double>(static_cast<float>(std::min(shone * shone, kMost))));
}

void add_groups(const LightGroupBatch& batch, std::size_t i, std::array<Vec3d, kLightGroups>& sums) {
  for (std::size_t group = 0; group < kLightGroups; ++group) {
    sums[group] += to_double(batch.radiance[group].get(i));
  }
}

void store(const SiteSum& sum, std::size_t site, SparseFrame& out) {
  for (std::size_t group = 0; group < kLightGroups && !out.light_groups.empty(); ++group) {
    out.light_groups[site].sum[group] = to_float(sum.groups[group]);
  }
  store_rounded(sum.light, out.guides.empty() ? nullptr : &sum.guides, site, out);
  if (!out.unrounded.sites.empty()) {
    out.unrounded.sites[site] = sum.light;
  }
  if (!out.unrounded.guides.empty()) {
    out.unrounded.guides[site] = sum.guides;
  }
}

Kernel kernel_of(const NamedKernel& variant, DiffuseModel diffuse) {
  switch (diffuse) {
    case DiffuseModel::burley:
      return variant.burley;
    case DiffuseModel::lambert:
      return variant.lambert;
    case DiffuseModel::matte:
      break;
  }
  return variant.matte;
}

// Workspaces are reused from tile to tile, so that memory is allocated only once per thread.
class WorkspacePool {
 public:
  std::unique_ptr<Workspace> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        auto workspace = std::move(free_.back());
        free_.pop_back();
        return workspace;
      }
    }
    return std::make_unique<Workspace>();
  }
  void give(std::unique_ptr<Workspace> workspace) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(workspace));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Workspace>> free_;
};

struct SiteRange {
  std::uint32_t first = 0, count = 0;
};

// Puts the surfaces of all tiles into the order of the sites. On entry first_surface holds the number of surfaces of
// each site.
void join_surfaces(const std::vector<SiteRange>& ranges, std::vector<TileResult>& tiles, SparseFrame& out) {
  std::uint32_t total = 0;
  for (std::uint32_t& entry : out.first_surface) {
    total += std::exchange(entry, total);
  }
  out.surfaces.resize(total);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    std::copy(tiles[t].surfaces.begin(), tiles[t].surfaces.end(),
              out.surfaces.begin() + out.first_surface[ranges[t].first]);
    tiles[t].surfaces = {};
  }
}

// The site that contains a pixel, as a range of one; an empty range where the pixel is outside the frame.
SiteRange site_of_pixel(const SamplingMap& map, const PixelIndex& pixel) {
  if (pixel.x >= map.width_px || pixel.y >= map.height_px) {
    return {};
  }
  const std::uint8_t region = map.region(pixel.x, pixel.y);
  const int block = map.regions[region].block_px;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    const Site& site = map.sites[i];
    if (site.region == region && site.block_x == pixel.x / block && site.block_y == pixel.y / block) {
      return {static_cast<std::uint32_t>(i), 1};
    }
  }
  return {};
}

}  // namespace

struct PathTracer::Impl {
  Impl(const Scene& source, const TracerOptions& tracer_options)
      : scene(&source),
        options(tracer_options),
        render_scene(source, tracer_options),
        lights(source, tracer_options.light_choice) {}

  // Puts the scene into a pose, unless it is in it: empty times are the pose at rest, in which it begins.
  void pose(const std::optional<ShutterTimes>& times) {
    if (is_posed && times == posed) {
      return;
    }
    is_posed = false;  // until it is done: an error leaves the scene between two poses
    render_scene.move_to(*scene, times);
    posed = times;
    is_posed = true;
  }

  // Compensated tables are made when they are first needed. They are used with MIS only, which finds what they leave
  // out.
  const LightSampler& lights_for(const TraceSettings& settings) {
    if (!settings.compensate_environment || settings.light_sampling != LightSampling::mis ||
        !scene->environment.present()) {
      return lights;
    }
    std::call_once(compensated_once, [&] {
      compensated_lights =
          std::make_unique<LightSampler>(*scene, options.light_choice, EnvironmentDensity::compensated);
    });
    return *compensated_lights;
  }

  [[nodiscard]] const NamedKernel& kernel_variant() const {
    return choose_kernel(kernel_features(render_scene.features, render_scene), options.all_features);
  }

  const Scene* scene;
  TracerOptions options;
  RenderScene render_scene;
  LightSampler lights;
  std::once_flag compensated_once;
  std::unique_ptr<LightSampler> compensated_lights;
  std::optional<ShutterTimes> posed;
  bool is_posed = true;

  void trace_sites(const FrameContext& context, Kernel kernel, const PixelFilterSampler& filter, std::int32_t frame,
                   const SamplingMap& map, const ZOrder* z_order, const SiteRange& range, Workspace& work,
                   TileResult& tile, SparseFrame& out) const;
};

void PathTracer::Impl::trace_sites(const FrameContext& context, Kernel kernel, const PixelFilterSampler& filter,
                                   std::int32_t frame, const SamplingMap& map, const ZOrder* z_order,
                                   const SiteRange& range, Workspace& work, TileResult& tile, SparseFrame& out) const {
  tile.regions.resize(map.regions.size());
  const bool surfaces = context.settings.surfaces;
  const PassThrough pass_through(map, context.settings.pass_through_samples);
  SurfaceSorter sorter(std::sqrt(dot(context.camera->placement().up_step, context.camera->placement().up_step)),
                       context.camera->is_perspective());
  HalfSums halves;
  FirstHitSummer first_hits;
  const auto finish_site = [&](std::size_t site) {
    if (!out.half_difference.empty()) {
      out.half_difference[site] = halves.difference();
    }
    halves = {};
    if (surfaces) {
      const std::size_t before = tile.surfaces.size();
      sorter.finish_site(first_hits.samples(), tile.surfaces);
      out.first_surface[site] = static_cast<std::uint32_t>(tile.surfaces.size() - before);
    }
    if (!out.first_hits.empty()) {
      out.first_hits[site] = first_hits.finish_site();
    }
  };
  SampleList list(map, range.first, range.count, context.settings.seed, frame,
                  context.settings.samples.value_or(kAllSamples), z_order, context.settings.halves);
  SiteSum sum;
  std::uint32_t current = range.first;
  std::vector<std::uint64_t> in_region(map.regions.size());
  for (;;) {
    const std::int64_t begin_ns = thread_cpu_ns();
    const int count = list.next(filter, work.samples);
    if (count == 0) {
      break;
    }
    kernel(context, work, count, tile.counts);

    std::fill(in_region.begin(), in_region.end(), 0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (work.samples.site[i] != current) {
        store(sum, current, out);
        finish_site(current);
        sum = {};
        current = work.samples.site[i];
      }
      ++in_region[map.sites[current].region];
      ++sum.light.count;
      const auto report = [&](const char* what) {
        keep_first(tile.bad, {frame, work.samples.pixel_x[i], work.samples.pixel_y[i], work.samples.sample[i], what});
      };
      if (work.radiance.rejected[i] != 0) {
        report("rejected ray");
      }
      if (!out.guides.empty() && work.guides.hit[i] != 0) {
        add_guides(work.guides, i, sum.guides);
      }
      const float r = work.radiance.r[i];
      const float g = work.radiance.g[i];
      const float b = work.radiance.b[i];
      if (!std::isfinite(r) || !std::isfinite(g) || !std::isfinite(b)) {
        ++tile.non_finite;
        report("non-finite radiance");
        continue;
      }
      add_light({r, g, b}, sum.light);
      if (!out.light_groups.empty()) {
        add_groups(work.groups, i, sum.groups);
      }
      halves.add(luminance(to_double(Vec3f{r, g, b})), work.samples.half[i]);
      if (surfaces && pass_through.needs_filtering(current)) {
        sorter.add(work.surfaces, i, {r, g, b}, work.samples.half[i]);
        if (!out.first_hits.empty()) {
          first_hits.add(work.surfaces, i, work.samples.half[i]);
        }
      }
    }
    const std::int64_t spent_ns = thread_cpu_ns() - begin_ns;
    for (std::size_t region = 0; region < in_region.size(); ++region) {
      tile.regions[region].samples += in_region[region];
      tile.regions[region].cpu_ns += spent_ns * static_cast<std::int64_t>(in_region[region]) / count;
    }
    tile.samples += static_cast<std::uint64_t>(count);
  }
  if (sum.light.count > 0) {
    store(sum, current, out);
    finish_site(current);
  }
}

PathTracer::PathTracer(const Scene& scene, const TracerOptions& options)
    : impl_(std::make_unique<Impl>(scene, options)) {}
PathTracer::~PathTracer() = default;
PathTracer::PathTracer(PathTracer&&) noexcept = default;
PathTracer& PathTracer::operator=(PathTracer&&) noexcept = default;

bool PathTracer::moves() const {
  return !(impl_->scene->motions.empty() && impl_->scene->deformations.empty());
}

PosedScene PathTracer::at(const ShutterTimes& times) {
  return {*impl_, times};
}

PosedScene PathTracer::at_rest() {
  return {*impl_, std::nullopt};
}

PosedScene::PosedScene(PathTracer::Impl& tracer, const std::optional<ShutterTimes>& times)
    : tracer_(&tracer), times_(times) {
  tracer_->pose(times_);
}

SparseFrame PosedScene::trace(const Camera& camera, std::int32_t frame, const SamplingMap& map,
                              const TraceSettings& settings) const {
  tracer_->pose(times_);
  const CameraRays rays(camera, map.height_px);
  const PixelFilterSampler filter(settings.filter, settings.footprint);
  const NamedKernel& variant = tracer_->kernel_variant();
  FrameContext context =
      make_frame_context(*tracer_->scene, tracer_->render_scene, tracer_->lights_for(settings), rays, settings);
  context.learned = settings.learned.get();

  SparseFrame out;
  out.width_px = map.width_px;
  out.height_px = map.height_px;
  out.sum.resize(map.sites.size());
  out.sum_square_luminance.resize(map.sites.size());
  out.count.resize(map.sites.size());
  out.guides.resize(settings.guides ? map.sites.size() : 0);
  out.light_groups.resize(settings.light_groups ? map.sites.size() : 0);
  out.half_difference.resize(settings.halves ? map.sites.size() : 0);
  out.unrounded.sites.resize(settings.samples ? map.sites.size() : 0);
  out.unrounded.guides.resize(settings.samples && settings.guides ? map.sites.size() : 0);
  out.first_surface.resize(settings.surfaces ? map.sites.size() + 1 : 0);
  out.first_hits.resize(settings.surfaces ? map.sites.size() : 0);
  out.stats.kernel = variant.name;
  out.stats.regions.resize(map.regions.size());

  std::vector<SiteRange> ranges;
  if (settings.only_pixel) {
    ranges.push_back(site_of_pixel(map, *settings.only_pixel));
  } else {
    // A frame of few tiles keeps all cores busy in parts of them.
    constexpr std::uint32_t kLeastRanges = 16, kLeastSites = 64;
    const auto tiles = static_cast<std::uint32_t>(map.tiles.size());
    const std::uint32_t parts = tiles == 0 ? 1 : (kLeastRanges + tiles - 1) / tiles;
    for (const MapTile& tile : map.tiles) {
      const std::uint32_t step = std::max(kLeastSites, (tile.site_count + parts - 1) / parts);
      for (std::uint32_t begin = 0; begin < tile.site_count; begin += step) {
        ranges.push_back({tile.first_site + begin, std::min(step, tile.site_count - begin)});
      }
    }
  }
  std::vector<TileResult> results(ranges.size());
  WorkspacePool pool;
  std::optional<ZOrder> z_order;
  if (settings.sample_pattern == SamplePattern::z_order) {
    z_order.emplace(map);
  }
  const Kernel kernel = kernel_of(variant, settings.diffuse);
  parallel_for(ranges.size(), tracer_->options.threads, [&](std::size_t i) {
    if (settings.stop && settings.stop()) {
      throw Error(ErrorKind::interrupted, "", "the frame was given up");
    }
    const FlushDenormals flush;
    auto work = pool.take();
    tracer_->trace_sites(context, kernel, filter, frame, map, z_order ? &*z_order : nullptr, ranges[i], *work,
                         results[i], out);
    pool.give(std::move(work));
  });

  TraceStats& stats = out.stats;
  for (TileResult& tile : results) {
    stats.samples += tile.samples;
    stats.rays_primary += tile.counts.rays_primary;
    stats.rays_bounce += tile.counts.rays_bounce;
    stats.rays_shadow += tile.counts.rays_shadow;
    stats.rejected_rays += tile.counts.rejected;
    stats.non_finite_samples += tile.non_finite;
    for (BadSample& bad : tile.bad) {
      keep_first(stats.bad_samples, std::move(bad));
    }
    for (std::size_t region = 0; region < tile.regions.size(); ++region) {
      stats.regions[region].samples += tile.regions[region].samples;
      stats.regions[region].cpu_ns += tile.regions[region].cpu_ns;
    }
  }
  if (settings.surfaces) {
    join_surfaces(ranges, results, out);
  }
  return out;
}

LightLearning PosedScene::learn_light(const Camera& camera, int width_px, int height_px,
                                      const TraceSettings& settings) const {
  tracer_->pose(times_);
  if (settings.light_sampling == LightSampling::light_only) {
    return {};
  }
  const CameraRays rays(camera, height_px);
  const FrameContext context =
      make_frame_context(*tracer_->scene, tracer_->render_scene, tracer_->lights_for(settings), rays, settings);
  return gazetrace::learn_light(context, kernel_of(tracer_->kernel_variant(), settings.diffuse), width_px, height_px,
                                tracer_->options.threads);
}

Guides PosedScene::guides(const Camera& camera, int width_px, int height_px, const GuideSettings& settings) const {
  tracer_->pose(times_);
  return trace_guides(tracer_->render_scene, tracer_->lights, CameraRays(camera, height_px), width_px, height_px,
                      settings, tracer_->options.threads);
}

std::vector<RayHit> PosedScene::first_hits(const Camera& camera, int width_px, int height_px,
                                           const std::vector<Vec2d>& places_px) const {
  tracer_->pose(times_);
  return trace_first_hits(*tracer_->scene, tracer_->render_scene, CameraRays(camera, height_px), width_px, height_px,
                          places_px, tracer_->options.threads);
}

std::vector<Coverage> PosedScene::coverage(const Camera& camera, std::int32_t frame, int width_px, int height_px,
                                           const std::vector<SurfaceIds>& surfaces,
                                           const CoverageSettings& settings) const {
  tracer_->pose(times_);
  return trace_coverage(*tracer_->scene, tracer_->render_scene, CameraRays(camera, height_px), frame, width_px,
                        height_px, surfaces, settings, tracer_->options.threads);
}

SurfaceMotion PosedScene::surface_motion(const Camera& camera, int width_px, int height_px,
                                         const OtherView& other) const {
  tracer_->pose(times_);
  return trace_surface_motion(*tracer_->scene, tracer_->render_scene, camera, width_px, height_px, other,
                              tracer_->options.threads);
}

const Scene& PathTracer::scene() const {
  return *impl_->scene;
}

TracerMemory PathTracer::memory() const {
  return {impl_->render_scene.rays->bytes(), impl_->render_scene.build_s};
}

std::string PathTracer::ray_library() const {
  return impl_->render_scene.rays->library();
}

}  // namespace gazetrace
