// SPDX-License-Identifier: Apache-2.0
// What a camera sample costs, against the limit: the CPU time that the ray library alone needs for the very same rays.
//   gazetrace_cost_per_sample Sponza.gltf sky.hdr [--size 1920x1080] [--spp 32] [--bounces 3] [--rounds 7]
//       [--share 16] [--all] [--eye X,Y,Z] [--target X,Y,Z] [--fov DEG]
// One thread; every `share`-th tile of the frame; rounds of both measurements interleaved; medians are printed.
#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_main.hpp"
#include "core/stopwatch.hpp"
#include "gazetrace/error.hpp"
#include "trace/kernel/kernel.hpp"
#include "trace/samples/sample_list.hpp"

namespace {

using namespace gazetrace;

struct Options {
  std::string scene, sky;
  int width_px = 1920, height_px = 1080;
  std::uint32_t spp = 32;
  int rounds = 7;
  std::size_t share = 16;
  bool all = false;
  Vec3d eye{8, 2, -0.3}, target{-8, 3, -0.3};
  double fov_deg = 50;
  TraceSettings settings;
};

Vec3d parse_point(const char* text) {
  char* rest = nullptr;
  const double x = std::strtod(text, &rest);
  const double y = std::strtod(rest + 1, &rest);
  const double z = std::strtod(rest + 1, &rest);
  return {x, y, z};
}

Options parse(int argc, char** argv) {
  Options options;
  options.settings.max_bounces = 3;
  options.settings.russian_roulette = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    if (name == "--all") {
      options.all = true;
      continue;
    }
    if (name.substr(0, 2) != "--") {
      (options.scene.empty() ? options.scene : options.sky) = name;
      continue;
    }
    ++i;
    if (name == "--size") {
      char* rest = nullptr;
      options.width_px = static_cast<int>(std::strtol(value, &rest, 10));
      options.height_px = static_cast<int>(std::strtol(rest + 1, nullptr, 10));
    } else if (name == "--spp") {
      options.spp = static_cast<std::uint32_t>(std::strtoul(value, nullptr, 10));
    } else if (name == "--bounces") {
      options.settings.max_bounces = std::atoi(value);
    } else if (name == "--rounds") {
      options.rounds = std::atoi(value);
    } else if (name == "--share") {
      options.share = std::strtoul(value, nullptr, 10);
    } else if (name == "--eye") {
      options.eye = parse_point(value);
    } else if (name == "--target") {
      options.target = parse_point(value);
    } else if (name == "--fov") {
      options.fov_deg = std::strtod(value, nullptr);
    } else {
      throw Error(ErrorKind::usage, name, "unknown option", "read the head of cost_per_sample.cpp");
    }
  }
  return options;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  Scene scene = load_scene(options.scene);
  if (!options.sky.empty()) {
    scene.environment = load_environment(options.sky);
  }
  TracerOptions tracer_options;
  tracer_options.threads = 0;
  const RenderScene render_scene(scene, tracer_options);
  const LightSampler lights(scene);
  Camera camera;
  camera.pose = look_at(options.eye, options.target, {0, 1, 0});
  camera.projection.yfov_rad = options.fov_deg * kRadPerDeg;
  const CameraRays rays(camera, options.height_px);
  FoveationSettings uniform;
  uniform.spp = options.spp;
  const SamplingMap map = make_sampling_map(
      uniform, view_of_perspective(camera.projection.yfov_rad, options.width_px, options.height_px), {});
  const PixelFilterSampler filter(PixelFilter::box);
  FrameContext context = make_frame_context(scene, render_scene, lights, rays, options.settings);
  const NamedKernel& kernel = choose_kernel(render_scene, options.all);

  const FlushDenormals flush;
  const auto work = std::make_unique<Workspace>();
  KernelCounts counts;
  std::uint64_t samples = 0;
  const auto trace = [&] {
    counts = {};
    samples = 0;
    double sum = 0;
    for (std::size_t t = options.share / 2; t < map.tiles.size(); t += options.share) {
      SampleList list(map, map.tiles[t].first_site, map.tiles[t].site_count, 0, 1);
      while (const int count = list.next(filter, work->samples)) {
        kernel.run(context, *work, count, counts);
        samples += static_cast<std::uint64_t>(count);
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
          sum += static_cast<double>(work->radiance.g[i]);
        }
      }
    }
    return sum / static_cast<double>(samples);
  };

  RayRecorder recorder;
  context.recorder = &recorder;
  const double mean = trace();
  context.recorder = nullptr;

  std::vector<double> ours;
  std::vector<double> limit;
  std::vector<double> ratio;
  for (int round = 0; round < options.rounds; ++round) {
    const std::int64_t begin_ns = thread_cpu_ns();
    static_cast<void>(trace());
    const std::int64_t middle_ns = thread_cpu_ns();
    const std::uint64_t found = recorder.replay(*render_scene.rays);
    const std::int64_t end_ns = thread_cpu_ns();
    static_cast<void>(found);
    const auto n = static_cast<double>(samples);
    ours.push_back(static_cast<double>(middle_ns - begin_ns) * 1e-3 / n);
    limit.push_back(static_cast<double>(end_ns - middle_ns) * 1e-3 / n);
    ratio.push_back(ours.back() / limit.back());
  }
  const auto per_sample = [&](std::uint64_t rays_of_kind) {
    return static_cast<double>(rays_of_kind) / static_cast<double>(samples);
  };
  fmt::print("{}, kernel \"{}\", {} x {}, {} spp, {} bounces, {} samples in {} of {} tiles, mean radiance {:.6f}\n",
             render_scene.rays->library(), kernel.name, options.width_px, options.height_px, options.spp,
             options.settings.max_bounces, samples, map.tiles.size() / options.share, map.tiles.size(), mean);
  fmt::print("rays per sample: {:.3f} primary, {:.3f} bounce, {:.3f} shadow\n", per_sample(counts.rays_primary),
             per_sample(counts.rays_bounce), per_sample(counts.rays_shadow));
  fmt::print("ours {:.3f} us/sample, ray library alone {:.3f} us/sample, ratio {:.3f} (medians of {} rounds)\n",
             median(ours), median(limit), median(ratio), options.rounds);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
