// SPDX-License-Identifier: Apache-2.0
// What a reconstruction filter makes of few samples: error against a reference of many, by eccentricity, and time.
//   gazetrace_filters SCENE SKY --reference FILE [--reference-spp 256] [--size 960x540] [--map half|regions|SPP]
//       [--eye X,Y,Z] [--target X,Y,Z] [--fov DEG] [--ev 2] [--ppd 67.02] [--rounds 3] [--edge-rays 4] [--pictures
//       FOLDER]
// FILE keeps the reference between runs; it is rendered (seed 12345) where it is missing. Maps: `half` is 8 samples in
// each 4x4 block everywhere, 0.5 a pixel; `regions` 32 / 16 / 8 about the centre of the paper's display; a number is
// that many samples in every pixel. Pictures are compared as displayed: Reinhard's x / (1 + x) of luminance at the
// given exposure; FLIP at --ppd, FovVideoVDP on the paper's display with the gaze in the centre, relative MSE on linear
// light. "prototype" is the plain guided filter that others are measured by: guides of 2 rays a pixel, block means
// divided by block albedo, 5x5 blocks, bilateral in normal and depth. "linear, equal time" has as many more samples as
// the time of guided's whole frame allows. JOD of a band is 10 less the mean of its local differences.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_main.hpp"
#include "core/image_io.hpp"
#include "core/parallel.hpp"
#include "core/stopwatch.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "gazetrace/metrics.hpp"
#include "gazetrace/reconstruct.hpp"
#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"

namespace {

using namespace gazetrace;

struct Options {
  std::string scene, sky, reference, pictures;
  std::string map = "half";
  int width_px = 960, height_px = 540;
  std::uint32_t reference_spp = 256;
  int rounds = 3, edge_rays = 4;
  Vec3d eye{8, 2, -0.3}, target{-8, 3, -0.3};
  double fov_deg = 50, ev = 2, ppd = kFlipDefaultPixelsPerDegree;
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
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      (options.scene.empty() ? options.scene : options.sky) = name;
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--size") {
      char* rest = nullptr;
      options.width_px = static_cast<int>(std::strtol(value, &rest, 10));
      options.height_px = static_cast<int>(std::strtol(rest + 1, nullptr, 10));
    } else if (name == "--reference") {
      options.reference = value;
    } else if (name == "--reference-spp") {
      options.reference_spp = static_cast<std::uint32_t>(std::strtoul(value, nullptr, 10));
    } else if (name == "--map") {
      options.map = value;
    } else if (name == "--edge-rays") {
      options.edge_rays = std::atoi(value);
    } else if (name == "--rounds") {
      options.rounds = std::atoi(value);
    } else if (name == "--eye") {
      options.eye = parse_point(value);
    } else if (name == "--target") {
      options.target = parse_point(value);
    } else if (name == "--fov") {
      options.fov_deg = std::strtod(value, nullptr);
    } else if (name == "--ev") {
      options.ev = std::strtod(value, nullptr);
    } else if (name == "--ppd") {
      options.ppd = std::strtod(value, nullptr);
    } else if (name == "--pictures") {
      options.pictures = value;
    } else {
      throw Error(ErrorKind::usage, std::string(name), "unknown option", "read the head of filters.cpp");
    }
  }
  return options;
}

struct Bench {
  Options options;
  PlanarView view;
  PosedScene scene;
  Camera camera;
  ImageRgb reference, reference_shown;
  ImageGray eccentricity_deg;
};

ImageRgb shown(const ImageRgb& light, double ev) {
  ImageRgb out = light;
  const auto scale = static_cast<float>(std::exp2(ev));
  for (Vec3f& c : out.pixels) {
    c = c * scale;
    const float y = 0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z;
    c = c * (1.0F / (1.0F + std::max(y, 0.0F)));
    c = {std::clamp(c.x, 0.0F, 1.0F), std::clamp(c.y, 0.0F, 1.0F), std::clamp(c.z, 0.0F, 1.0F)};
  }
  return out;
}

void write_png(const std::string& path, const ImageRgb& light) {
  std::vector<std::uint8_t> bytes;
  for (const Vec3f& c : light.pixels) {
    for (const float x : {c.x, c.y, c.z}) {
      const float code = x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1 / 2.4F) - 0.055F;
      bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(code, 0.0F, 1.0F))));
    }
  }
  const auto file = encode_image(path, light.width_px, light.height_px, 8, bytes, {});
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(file.data()), std::ssize(file));
}

SamplingMap map_of(const Bench& bench, const std::string& kind, double scale) {
  FoveationSettings settings;
  const auto scaled = [&](std::uint32_t n) { return static_cast<std::uint32_t>(std::lround(n * scale)); };
  for (std::uint32_t& n : std::get<RegionSampling>(settings.sampling).samples) {
    n = scaled(n);
  }
  const Vec3d ahead = bench.view.direction(0.5 * bench.options.width_px, 0.5 * bench.options.height_px);
  if (kind == "half") {  // looking away: all of it is periphery
    return make_sampling_map(settings, bench.view, -ahead);
  }
  if (kind == "regions") {
    return make_sampling_map(settings, bench.view, ahead);
  }
  settings.spp = scaled(static_cast<std::uint32_t>(std::strtoul(kind.c_str(), nullptr, 10)));
  return make_sampling_map(settings, bench.view, std::nullopt);
}

ImageRgb reference_of(const Bench& bench) {
  const Options& o = bench.options;
  ImageRgb image(o.width_px, o.height_px);
  const auto bytes = std::ssize(image.pixels) * std::ptrdiff_t{sizeof(Vec3f)};
  if (std::filesystem::exists(o.reference)) {
    std::ifstream(o.reference, std::ios::binary).read(reinterpret_cast<char*>(image.pixels.data()), bytes);
    return image;
  }
  TraceSettings settings;
  settings.seed = 12345;
  const SamplingMap map = map_of(bench, std::to_string(o.reference_spp), 1);
  image = Reconstruction({"none"}).frame(bench.scene.trace(bench.camera, 0, map, settings), map).radiance;
  std::ofstream(o.reference, std::ios::binary).write(reinterpret_cast<const char*>(image.pixels.data()), bytes);
  return image;
}

// 5x5 blocks, bilateral, on block means of radiance over albedo. Blocks of one size only.
Frame prototype(const SparseFrame& sparse, const SamplingMap& map, const Guides& guides) {
  struct Block {
    Vec3f light, normal;
    float depth = 0, hits = 0;
  };
  const int size = map.regions[map.sites[0].region].block_px;
  const int width = (map.width_px + size - 1) / size;
  const int height = (map.height_px + size - 1) / size;
  Image<Block> blocks(width, height);
  std::vector<PixelIndex> pixels;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    Block block;
    Vec3f albedo;
    pixels_of_site(map, map.sites[i], pixels);
    for (const PixelIndex& p : pixels) {
      albedo += guides.albedo(p.x, p.y);
      block.normal += guides.normal(p.x, p.y);
      const float depth = guides.depth_m(p.x, p.y);
      block.depth += std::isfinite(depth) ? depth : 0.0F;
      block.hits += std::isfinite(depth) ? 1.0F : 0.0F;
    }
    const auto n = static_cast<float>(pixels.size());
    const Vec3f mean = sparse.sum[i] / static_cast<float>(std::max(sparse.count[i], 1U));
    block.light = {mean.x * n / albedo.x, mean.y * n / albedo.y, mean.z * n / albedo.z};
    block.normal = block.normal / std::max(std::sqrt(dot(block.normal, block.normal)), 1e-6F);
    block.depth = block.hits > 0 ? block.depth / block.hits : 1e6F;
    blocks(map.sites[i].block_x, map.sites[i].block_y) = block;
  }
  Frame frame;
  frame.radiance = ImageRgb(map.width_px, map.height_px);
  parallel_for(static_cast<std::size_t>(map.height_px), 0, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < map.width_px; ++x) {
      const float depth = std::isfinite(guides.depth_m(x, y)) ? guides.depth_m(x, y) : 1e6F;
      Vec3f normal = guides.normal(x, y);
      normal = normal / std::max(std::sqrt(dot(normal, normal)), 1e-6F);
      Vec3f sum;
      float weight = 0;
      for (int by = std::max(y / size - 2, 0); by < std::min(y / size + 3, height); ++by) {
        for (int bx = std::max(x / size - 2, 0); bx < std::min(x / size + 3, width); ++bx) {
          const Block& block = blocks(bx, by);
          const float dx = (static_cast<float>(x) + 0.5F) / static_cast<float>(size) - static_cast<float>(bx) - 0.5F;
          const float dy = (static_cast<float>(y) + 0.5F) / static_cast<float>(size) - static_cast<float>(by) - 0.5F;
          const float facing = std::max(dot(normal, block.normal), 0.0F);
          const float near = std::exp(-0.5F * (dx * dx + dy * dy) / 2.25F);
          const float w =
              (near * std::pow(facing, 16.0F) * std::exp(-std::fabs(block.depth - depth) / (0.05F * depth))) +
              (1e-5F * near);
          sum += w * block.light;
          weight += w;
        }
      }
      frame.radiance(x, y) = guides.albedo(x, y) * (sum / weight);
    }
  });
  return frame;
}

constexpr std::array<double, 7> kBandEdgesDeg{0, 2.6, 5.2, 8.5, 17, 30, 60};
constexpr double kNoDifferenceJod = 10;

struct Run {
  double trace_ms = 1e30, guides_ms = 0, filter_ms = 1e30;
  double samples = 0;
  Frame frame;
};

void print_scores(const Bench& bench, const std::string& name, const Run& run) {
  const ImageRgb test = shown(run.frame.radiance, bench.options.ev);
  const ImageGray flip = flip_map(bench.reference_shown, test, bench.options.ppd);
  const MetricMap relative = measure("relmse", {bench.reference, {}}, {run.frame.radiance, {}}, {});
  FovVideoVdpSettings settings;
  settings.geometry = fovvideovdp_geometry(display_by_name("paper"));
  FovVideoVdp vdp(settings, bench.options.width_px, bench.options.height_px);
  const FovVideoVdpFrame seen =
      vdp.add(linear_luminance(bench.reference_shown, 200), linear_luminance(test, 200), std::nullopt, true);
  struct Band {
    double flip = 0, relative = 0, seen_jod = 0, pixels = 0;
  };
  std::array<Band, kBandEdgesDeg.size()> bands;  // the first one is the frame
  for (std::size_t i = 0; i < flip.pixels.size(); ++i) {
    const double e = static_cast<double>(bench.eccentricity_deg.pixels[i]);
    std::size_t band = 1;
    while (band + 1 < kBandEdgesDeg.size() && e >= kBandEdgesDeg[band]) {
      ++band;
    }
    for (const std::size_t b : {std::size_t{0}, band}) {
      bands[b].flip += static_cast<double>(flip.pixels[i]);
      bands[b].relative += static_cast<double>(relative.values.pixels[i]);
      bands[b].seen_jod += static_cast<double>(seen.map.pixels[i]);
      bands[b].pixels += 1;
    }
  }
  const double mean_ratio = [&] {
    Vec3d a;
    Vec3d b;
    for (std::size_t i = 0; i < bench.reference.pixels.size(); ++i) {
      a += to_double(run.frame.radiance.pixels[i]);
      b += to_double(bench.reference.pixels[i]);
    }
    return (a.x + a.y + a.z) / (b.x + b.y + b.z);
  }();
  fmt::print("{:<22} {:5.2f} spp {:7.1f} {:6.1f} {:6.1f} ms | FLIP {:.4f} relMSE {:.4f} JOD {:.3f} mean {:.4f} |", name,
             run.samples / static_cast<double>(flip.pixels.size()), run.trace_ms, run.guides_ms, run.filter_ms,
             bands[0].flip / bands[0].pixels, bands[0].relative / bands[0].pixels, fovvideovdp_jod(seen.q), mean_ratio);
  for (std::size_t b = 1; b < bands.size(); ++b) {
    const Band& band = bands.at(b);
    if (band.pixels > 0) {
      fmt::print(" {}-{}: {:.4f} {:.4f} {:.3f}", kBandEdgesDeg.at(b - 1), kBandEdgesDeg.at(b), band.flip / band.pixels,
                 band.relative / band.pixels, kNoDifferenceJod - (band.seen_jod / band.pixels));
    }
  }
  fmt::print("\n");
  std::fflush(stdout);
  if (!bench.options.pictures.empty()) {
    std::string file = name;
    std::replace(file.begin(), file.end(), ' ', '_');
    write_png(bench.options.pictures + "/" + file + ".png", test);
  }
}

template <class Function>
auto timed(double& ms, const Function& function) {
  const Stopwatch watch;
  auto result = function();
  ms = watch.elapsed_ms();
  return result;
}

Run run_filter(const Bench& bench, const std::string& filter, const SamplingMap& map) {
  const bool proto = filter == "prototype";
  TraceSettings settings;
  const Reconstruction reconstruction({proto ? "none" : filter});
  settings = reconstruction.trace_settings(settings);
  Run best;
  for (int round = 0; round < bench.options.rounds; ++round) {
    Run run;
    const SparseFrame sparse = timed(run.trace_ms, [&] { return bench.scene.trace(bench.camera, 0, map, settings); });
    run.samples = static_cast<double>(sparse.stats.samples);
    Guides guides;
    if (proto || settings.surfaces) {
      const GuideSettings guide_settings{.spp = proto ? 2 : 1, .edge_rays = proto ? 0 : bench.options.edge_rays};
      guides = timed(run.guides_ms,
                     [&] { return bench.scene.guides(bench.camera, map.width_px, map.height_px, guide_settings); });
    }
    run.frame = timed(run.filter_ms, [&] {
      return proto ? prototype(sparse, map, guides) : reconstruction.frame(sparse, map, &guides);
    });
    if (run.trace_ms + run.guides_ms + run.filter_ms < best.trace_ms + best.guides_ms + best.filter_ms) {
      best = std::move(run);
    }
  }
  return best;
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  Scene scene = load_scene(options.scene);
  if (!options.sky.empty()) {
    scene.environment = options.sky == "sky" ? builtin_sky() : load_environment(options.sky);
  }
  PathTracer tracer(scene, {});
  Bench bench{options,
              view_of_display(display_by_name("paper"), {}, options.width_px, options.height_px),
              tracer.at_rest(),
              {},
              {},
              {},
              {}};
  bench.camera.pose = look_at(options.eye, options.target, {0, 1, 0});
  bench.camera.projection.yfov_rad = options.fov_deg * kRadPerDeg;
  bench.reference = reference_of(bench);
  bench.reference_shown = shown(bench.reference, options.ev);
  bench.eccentricity_deg =
      eccentricity_image(bench.view, bench.view.direction(0.5 * options.width_px, 0.5 * options.height_px));
  if (!options.pictures.empty()) {
    write_png(options.pictures + "/reference.png", bench.reference_shown);
  }
  fmt::print("filter, samples a pixel, ms of trace, guides, filter | of the frame | FLIP, relMSE and JOD by degrees\n");
  const SamplingMap map = map_of(bench, options.map, 1);
  std::vector<std::string> filters{"linear"};
  if (options.map == "half") {
    filters.emplace_back("prototype");
  }
  double linear_ms = 0;
  for (const std::string& filter : filters) {
    const Run result = run_filter(bench, filter, map);
    linear_ms = filter == "linear" ? result.trace_ms + result.filter_ms : linear_ms;
    print_scores(bench, filter, result);
  }
  const Run guided = run_filter(bench, "guided", map);
  print_scores(bench, "guided", guided);
  const double more = (guided.trace_ms + guided.guides_ms + guided.filter_ms) / linear_ms;
  fmt::print("guided takes {:.3f} of linear's time\n", more);
  print_scores(bench, "linear, equal time", run_filter(bench, "linear", map_of(bench, options.map, more)));
  for (const char* uniform : {"4", "32"}) {
    print_scores(bench, std::string("uniform ") + uniform, run_filter(bench, "none", map_of(bench, uniform, 1)));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
