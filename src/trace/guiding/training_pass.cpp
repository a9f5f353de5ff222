// SPDX-License-Identifier: Apache-2.0
#include "trace/guiding/training_pass.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "trace/samples/sample_list.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kTrainingTag = 0x6c6561726e696e67ULL;

// Cells of about square shape, one path each.
struct Grid {
  std::uint64_t columns = 1, rows = 1;
};

Grid grid_of(double paths, int width_px, int height_px) {
  const double cell_px = std::sqrt(static_cast<double>(width_px) * height_px / std::max(1.0, paths));
  const auto cells = [cell_px](int side_px) {
    return static_cast<std::uint64_t>(std::max(1.0, std::floor(static_cast<double>(side_px) / cell_px)));
  };
  return {cells(width_px), cells(height_px)};
}

void fill(std::uint64_t first, int count, const Grid& grid, std::uint64_t seed, int width_px, int height_px,
          SampleBatch& out) {
  for (int k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const std::uint64_t path = first + i;
    const SampleKey key = make_sample_key(seed, 0, path);
    const Vec2f u = sample_2d(key, 0, dimension_of(PathDimension::pixel));
    const std::uint64_t column = path % grid.columns;
    const std::uint64_t row = path / grid.columns;
    const double x =
        (static_cast<double>(column) + static_cast<double>(u.x)) / static_cast<double>(grid.columns) * width_px;
    const double y = (static_cast<double>(row) + static_cast<double>(u.y)) / static_cast<double>(grid.rows) * height_px;
    out.site[i] = 0;
    out.sample[i] = 0;
    out.half[i] = 0;
    out.key[i] = key;
    out.index[i] = 0;
    out.x[i] = static_cast<float>(x - 0.5 * width_px);
    out.y[i] = static_cast<float>(y - 0.5 * height_px);
    out.pixel_x[i] = static_cast<std::uint16_t>(std::min(x, width_px - 1.0));
    out.pixel_y[i] = static_cast<std::uint16_t>(std::min(y, height_px - 1.0));
  }
}

void keep(const Workspace& work, std::uint64_t first, std::vector<TrainingRecord>& out) {
  for (const BounceFound& bounce : work.bounces) {
    const std::size_t slot = bounce.slot;
    const float end = luminance(Vec3f{work.radiance.r[slot], work.radiance.g[slot], work.radiance.b[slot]});
    const float found = end - bounce.shone_before;
    if (work.radiance.rejected[slot] != 0 || !(bounce.throughput > 0) || !std::isfinite(found)) {
      continue;
    }
    TrainingRecord record = bounce.record;
    record.radiance = std::max(0.0F, found) / bounce.throughput;
    record.path = static_cast<std::uint32_t>(first + slot);
    if (std::isfinite(record.radiance)) {
      out.push_back(record);
    }
  }
}

// The training paths of a frame.
class TrainingPaths {
 public:
  TrainingPaths(FrameContext context, Kernel kernel, int width_px, int height_px, int threads)
      : context_(std::move(context)), kernel_(kernel), width_px_(width_px), height_px_(height_px), threads_(threads) {
    context_.records_bounces = true;
    context_.settings.guides = context_.settings.surfaces = context_.settings.light_groups = false;
    context_.single_rays = true;
  }

  // About so many more of them, spread evenly. `round` chooses their scrambling, and `so_far` is what they follow.
  void trace(double about, std::uint64_t round, const GuidingField& so_far) {
    context_.guiding_field = so_far.pays() ? &so_far : nullptr;
    const std::uint64_t seed = hash_combine(hash_combine(context_.settings.seed, kTrainingTag), round);
    const Grid grid = grid_of(about, width_px_, height_px_);
    const std::uint64_t paths = grid.columns * grid.rows;
    const std::uint64_t batches = (paths + kBatchSize - 1) / kBatchSize;
    const auto ranges = static_cast<std::size_t>(std::min<std::uint64_t>(batches, kMostRanges));
    std::vector<std::vector<TrainingRecord>> found(ranges);
    parallel_for(ranges, threads_, [&](std::size_t range) {
      const FlushDenormals flush;
      const auto work = std::make_unique<Workspace>();
      KernelCounts unused;
      const std::uint64_t end = batches * (range + 1) / ranges;
      for (std::uint64_t batch = batches * range / ranges; batch < end; ++batch) {
        if (context_.settings.stop && context_.settings.stop()) {
          throw Error(ErrorKind::interrupted, "", "the frame was given up");
        }
        const std::uint64_t first = batch * kBatchSize;
        const int count = static_cast<int>(std::min<std::uint64_t>(kBatchSize, paths - first));
        fill(first, count, grid, seed, width_px_, height_px_, work->samples);
        work->bounces.clear();
        kernel_(context_, *work, count, unused);
        keep(*work, first, found[range]);
      }
    });
    for (std::size_t range = 0; range < ranges; ++range) {
      records_.insert(records_.end(), found[range].begin(), found[range].end());
      found[range] = {};
    }
    paths_ += paths;
  }

  [[nodiscard]] GuidingField field() const { return {records_, threads_}; }
  [[nodiscard]] std::uint64_t paths() const { return paths_; }

 private:
  static constexpr std::uint64_t kMostRanges = 64;

  FrameContext context_;
  Kernel kernel_;
  int width_px_, height_px_, threads_;
  std::vector<TrainingRecord> records_;
  std::uint64_t paths_ = 0;
};

}  // namespace

TrainedGuiding train_guiding(const FrameContext& context, Kernel kernel, int width_px, int height_px, int threads) {
  const double paths = std::min(kMostTrainingPaths, static_cast<double>(width_px) * height_px / kPixelsPerTrainingPath);
  const double glimpse = std::min(kGlimpsePaths, paths);
  TrainingPaths training(context, kernel, width_px, height_px, threads);
  training.trace(glimpse, 0, {});
  GuidingField field = training.field();
  if (paths > glimpse && field.promises()) {
    training.trace(paths - glimpse, 1, field);
    field = training.field();
  }
  return {field.pays() ? std::make_shared<const GuidingField>(std::move(field)) : nullptr, training.paths()};
}

}  // namespace gazetrace
