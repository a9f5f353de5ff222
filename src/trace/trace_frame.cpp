// SPDX-License-Identifier: Apache-2.0
#include "trace/trace_frame.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/parallel.hpp"
#include "core/stopwatch.hpp"
#include "gazetrace/error.hpp"
#include "trace/kernel/workspace_pool.hpp"
#include "trace/samples/bad_samples.hpp"
#include "trace/samples/pixel_filter.hpp"
#include "trace/samples/sample_list.hpp"
#include "trace/samples/site_ranges.hpp"
#include "trace/samples/site_summer.hpp"
#include "trace/samples/surface_sums.hpp"

namespace gazetrace {
namespace {

SparseFrame untraced_frame(const SamplingMap& map, const TraceSettings& settings) {
  const std::size_t sites = map.sites.size();
  SparseFrame out;
  out.width_px = map.width_px;
  out.height_px = map.height_px;
  out.sum.resize(sites);
  out.sum_square_luminance.resize(sites);
  out.count.resize(sites);
  out.guides.resize(settings.guides ? sites : 0);
  out.light_groups.resize(settings.light_groups ? sites : 0);
  out.half_difference.resize(settings.halves ? sites : 0);
  out.first_half.resize(settings.halves && settings.first_half ? sites : 0);
  out.first_surface.resize(settings.surfaces ? sites + 1 : 0);
  out.first_hits.resize(settings.surfaces ? sites : 0);
  out.stats.regions.resize(map.regions.size());
  return out;
}

// How many of a batch's samples lie in each region.
void count_by_region(const SampleBatch& samples, std::size_t count, const SamplingMap& map,
                     std::vector<std::uint64_t>& in_region) {
  std::fill(in_region.begin(), in_region.end(), 0);
  for (std::size_t i = 0; i < count; ++i) {
    ++in_region[map.sites[samples.site[i]].region];
  }
}

struct RangeResult {
  KernelCounts counts;
  std::vector<RegionTraceStats> regions;
  SummedRange summed;
};

class RangeTracer {
 public:
  // Keeps references to `context`, `map` and `out`.
  RangeTracer(const FrameContext& context, Kernel kernel, std::int32_t frame, const SamplingMap& map, SparseFrame& out)
      : context_(context),
        kernel_(kernel),
        frame_(frame),
        map_(map),
        filter_(context.settings.filter, context.settings.footprint),
        out_(out) {}

  // Threads may trace different ranges at once.
  [[nodiscard]] RangeResult trace(const SiteRange& range, Workspace& work) const {
    RangeResult result;
    result.regions.resize(map_.regions.size());
    std::vector<std::uint64_t> in_region(map_.regions.size());
    SampleList list = samples_of(range);
    SiteSummer summer(context_, frame_, range.first, out_);
    for (;;) {
      const std::int64_t begin_ns = thread_cpu_ns();
      const int count = list.next(filter_, work.samples);
      if (count == 0) {
        break;
      }
      kernel_(context_, work, count, result.counts);
      summer.add(work, static_cast<std::size_t>(count));
      count_by_region(work.samples, static_cast<std::size_t>(count), map_, in_region);
      const std::int64_t spent_ns = thread_cpu_ns() - begin_ns;
      for (std::size_t region = 0; region < in_region.size(); ++region) {
        result.regions[region].samples += in_region[region];
        result.regions[region].cpu_ns += spent_ns * static_cast<std::int64_t>(in_region[region]) / count;
      }
    }
    result.summed = summer.finish();
    return result;
  }

 private:
  [[nodiscard]] SampleList samples_of(const SiteRange& range) const {
    const TraceSettings& settings = context_.settings;
    return {map_, range.first, range.count, settings.seed, frame_, settings.halves, settings.independent_halves};
  }

  const FrameContext& context_;
  Kernel kernel_;
  std::int32_t frame_;
  const SamplingMap& map_;
  PixelFilterSampler filter_;
  SparseFrame& out_;
};

void add_stats(const RangeResult& range, TraceStats& stats) {
  stats.rays_primary += range.counts.rays_primary;
  stats.rays_bounce += range.counts.rays_bounce;
  stats.rays_shadow += range.counts.rays_shadow;
  stats.rejected_rays += range.counts.rejected;
  stats.seen_backs += range.counts.backs;
  stats.non_finite_samples += range.summed.non_finite;
  for (const BadSample& bad : range.summed.bad) {
    keep_first(stats.bad_samples, bad);
  }
  for (std::size_t region = 0; region < range.regions.size(); ++region) {
    stats.samples += range.regions[region].samples;
    stats.regions[region].samples += range.regions[region].samples;
    stats.regions[region].cpu_ns += range.regions[region].cpu_ns;
  }
}

}  // namespace

SparseFrame trace_frame(const FrameContext& context, Kernel kernel, std::int32_t frame, const SamplingMap& map,
                        int threads) {
  const TraceSettings& settings = context.settings;
  SparseFrame out = untraced_frame(map, settings);
  const RangeTracer tracer(context, kernel, frame, map, out);
  const std::vector<SiteRange> ranges = site_ranges(map, settings.only_pixel);
  std::vector<RangeResult> results(ranges.size());
  WorkspacePool pool;
  parallel_for(ranges.size(), threads, [&](std::size_t i) {
    if (settings.stop && settings.stop()) {
      throw Error(ErrorKind::interrupted, "", "the frame was given up");
    }
    const FlushDenormals flush;
    auto work = pool.take();
    results[i] = tracer.trace(ranges[i], *work);
    pool.give(std::move(work));
  });
  std::vector<std::vector<SurfaceSums>> surfaces;
  surfaces.reserve(results.size());
  for (RangeResult& range : results) {
    add_stats(range, out.stats);
    surfaces.push_back(std::move(range.summed.surfaces));
  }
  join_surfaces(std::move(surfaces), out);
  return out;
}

}  // namespace gazetrace
