// SPDX-License-Identifier: Apache-2.0
// CPU time per 3840x2160 frame of what foveation adds around tracing: the sampling map, the filters.
#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "gazetrace/foveation.hpp"
#include "gazetrace/reconstruct.hpp"
#include "gazetrace/temporal.hpp"

namespace gazetrace {
namespace {

// The paper's angles as diameters and as radii.
constexpr std::array<double, 2> kDiameter{2.6, 8.5};
constexpr std::array<double, 2> kRadius{5.2, 17};

SamplingMap paper_map(bool foveated, const std::array<double, 2>& ends_deg) {
  const PlanarView view = view_of_display(display_by_name("paper"), {}, 3840, 2160);
  FoveationSettings settings;
  std::get<RegionSampling>(settings.sampling).eccentricities_deg = ends_deg;
  return make_sampling_map(settings, view, foveated ? std::optional(view.direction(1700.3, 900.7)) : std::nullopt);
}

SparseFrame sparse_frame(const SamplingMap& map) {
  SparseFrame sparse;
  sparse.width_px = map.width_px;
  sparse.height_px = map.height_px;
  for (const Site& site : map.sites) {
    const auto n = static_cast<float>(site.samples);
    const float value = 0.001F * static_cast<float>((site.block_x * 7 + site.block_y * 3) % 1000);
    sparse.sum.push_back(Vec3f{n * value, n * value, n});
    sparse.sum_square_luminance.push_back(n);
    sparse.count.push_back(site.samples);
  }
  return sparse;
}

void bench_map(benchmark::State& state, bool foveated, const std::array<double, 2>& ends_deg) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(paper_map(foveated, ends_deg));
  }
}

void bench_filter(benchmark::State& state, bool foveated, const std::array<double, 2>& ends_deg, const char* filter) {
  const SamplingMap map = paper_map(foveated, ends_deg);
  const SparseFrame sparse = sparse_frame(map);
  const Reconstruction reconstruction({filter});
  for (auto _ : state) {
    benchmark::DoNotOptimize(reconstruction.frame(sparse, map, nullptr, 1));
  }
}

BENCHMARK_CAPTURE(bench_map, diameter, true, kDiameter)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bench_map, radius, true, kRadius)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bench_map, uniform, false, kDiameter)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bench_filter, none_diameter, true, kDiameter, "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bench_filter, linear_diameter, true, kDiameter, "linear")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bench_filter, linear_radius, true, kRadius, "linear")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bench_filter, linear_uniform, false, kDiameter, "linear")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gazetrace
