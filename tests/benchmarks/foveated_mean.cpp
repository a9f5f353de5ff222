// SPDX-License-Identifier: Apache-2.0
// Is a foveated frame unbiased? Before reconstruction, and averaged over seeds, every sampling must have the same
// mean as uniform sampling in every band of eccentricity.
//   gazetrace_foveated_mean SCENE.gltf[=SKY.hdr|=constant:R,G,B] ... [--seeds 256] [--size 160x90] [--spp 4]
//   [--foveal-spp 32]
//       [--uniform-seeds 256] [--uniform-samples 30000] [--margin 0.5] [--gaze U,V] [--models a,b,c] [--eye X,Y,Z
//       --target X,Y,Z --fov DEG]
// A scene is looked at by its first camera or, where it has none, from --eye; the frame is seen as one of 70.848 cm at
// 60 cm. Each model is scaled to --spp samples a pixel on average or, where its fovea would then have less than
// --foveal-spp, to that: else the smallest band would decide nothing. The uniform frames have every pixel for itself
// and whole counts, the same within a band, more where a band is small: --uniform-samples in each.
//
// The estimate of a band is the sum over its sites of pixels x sum / expected count, by the pixels of the band: the
// expectation of a site's count does not depend on the seed, its whole count does. A site belongs to the band of its
// pixels' centroid, and the uniform mean is taken over the very same pixels. Test of equivalence (two one-sided tests)
// on the mean luminance: the 99 % interval of the difference, its level divided after Holm by the number of tests, must
// lie within +-margin % of the band's mean. Seeds are independent scramblings; the interval is Student's by Welch.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_main.hpp"
#include "foveation/sites.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"
#include "pixel_statistics.hpp"
#include "support/sampling_models.hpp"
#include "world.hpp"

namespace {

using namespace gazetrace;
using benchmark::parse_numbers;
using benchmark::parse_point;
using benchmark::World;

constexpr std::array<double, 6> kBandEnds{2.6, 5.2, 8.5, 17, 30, 60};

struct Options {
  std::vector<std::string> scenes;
  std::vector<std::string> models;
  int width_px = 160, height_px = 90;
  int seeds = 256, uniform_seeds = 256;
  double uniform_samples = 30000;
  double spp = 4, foveal_spp = 32;
  double margin = 0.005;
  Vec2d gaze{0.5, 0.5};
  std::optional<Vec3d> eye, target;
  double fov_deg = 50;

  [[nodiscard]] std::optional<benchmark::Viewpoint> viewpoint() const {
    return eye && target ? std::optional(benchmark::Viewpoint{*eye, *target, fov_deg}) : std::nullopt;
  }
};

struct Estimate {
  double mean = 0, variance_of_mean = 0;
  int repeats = 0;
};

Estimate estimate_of(const std::vector<double>& values) {
  Estimate e;
  e.repeats = static_cast<int>(values.size());
  e.mean = benchmark::average(values);
  double square = 0;
  for (const double v : values) {
    square += (v - e.mean) * (v - e.mean);
  }
  e.variance_of_mean = square / (e.repeats - 1) / e.repeats;
  return e;
}

double luminance(const Vec3f& c) {
  return 0.2126 * static_cast<double>(c.x) + 0.7152 * static_cast<double>(c.y) + 0.0722 * static_cast<double>(c.z);
}

std::size_t band_of(double eccentricity_deg) {
  return static_cast<std::size_t>(std::lower_bound(kBandEnds.begin(), kBandEnds.end(), eccentricity_deg) -
                                  kBandEnds.begin());
}

// The band of each site, and of each pixel through its site.
struct Bands {
  std::vector<std::uint8_t> of_site;
  Image<std::uint8_t> of_pixel;
  std::array<double, kBandEnds.size() + 1> pixels{};
};

Bands bands_of(const SamplingMap& map, const PlanarView& view, const Vec3d& gaze) {
  Bands bands;
  bands.of_pixel = Image<std::uint8_t>(map.width_px, map.height_px);
  for (const Site& site : map.sites) {
    double x_sum = 0;
    double y_sum = 0;
    for_each_pixel(map, site, [&](int x, int y) {
      x_sum += x + 0.5;
      y_sum += y + 0.5;
    });
    const std::size_t band = band_of(eccentricity_deg(view, gaze, x_sum / site.pixels, y_sum / site.pixels));
    bands.of_site.push_back(static_cast<std::uint8_t>(band));
    bands.pixels.at(band) += site.pixels;
    for_each_pixel(map, site, [&](int x, int y) { bands.of_pixel(x, y) = static_cast<std::uint8_t>(band); });
  }
  return bands;
}

// Student's quantile by bisection of the incomplete beta function, in the form of a continued fraction (Lentz).
double beta_fraction(double a, double b, double x) {
  double c = 1;
  double d = 1 / std::max(1 - (a + b) * x / (a + 1), 1e-300);
  double h = d;
  for (int m = 1; m < 500; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / (1 + even * d);
    c = 1 + even / c;
    h *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / (1 + odd * d);
    c = 1 + odd / c;
    h *= d * c;
    if (std::abs(d * c - 1) < 1e-14) {
      break;
    }
  }
  return h;
}
double incomplete_beta(double a, double b, double x) {
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a : 1 - front * beta_fraction(b, a, 1 - x) / b;
}
// One-sided: P(T > t).
double student_tail(double t, double freedom) {
  if (t <= 0) {
    return t == 0 ? 0.5 : 1 - student_tail(-t, freedom);
  }
  return 0.5 * incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + t * t));
}
double student_quantile(double tail, double freedom) {
  double low = 0;
  double high = 1000;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (student_tail(middle, freedom) > tail ? low : high) = middle;
  }
  return high;
}

struct Comparison {
  std::string scene, model;
  std::size_t band = 0;
  double spp = 0, empty_share = 0;                // of the band's sites over all seeds
  double difference = 0, error = 0, freedom = 0;  // relative to the band's mean
  double p = 1;                                   // of the two one-sided tests, the larger
  double half_width = 0;                          // of the 99 % interval without correction
  bool equivalent = false;
};

// Luminance of each pixel for each uniform seed, kept in single precision: every model's bands are sums over them.
std::vector<std::vector<float>> uniform_frames(PathTracer& tracer, const World& world, const Options& options) {
  const PlanarView view = view_of_display(display_by_name("paper"), {}, options.width_px, options.height_px);
  const Vec3d gaze = view.direction(options.gaze.x * options.width_px, options.gaze.y * options.height_px);
  Layout layout;
  layout.region = Image<std::uint8_t>(view.width_px, view.height_px);
  std::array<double, kBandEnds.size() + 1> pixels_of{};
  for (int y = 0; y < view.height_px; ++y) {
    for (int x = 0; x < view.width_px; ++x) {
      const std::size_t band = band_of(eccentricity_deg(view, gaze, x + 0.5, y + 0.5));
      layout.region(x, y) = static_cast<std::uint8_t>(band);
      pixels_of.at(band) += 1;
    }
  }
  for (const double count : pixels_of) {
    const double spp = std::clamp(std::round(options.uniform_samples / std::max(count, 1.0)), 4.0, 1024.0);
    layout.regions.push_back({"band", 1, static_cast<std::uint32_t>(spp), SampleUnit::per_pixel});
  }
  const SamplingMap map = map_from_layout(std::move(layout));
  std::vector<std::vector<float>> frames;
  for (int seed = 0; seed < options.uniform_seeds; ++seed) {
    TraceSettings settings;
    settings.seed = 1'000'000 + static_cast<std::uint64_t>(seed);
    const SparseFrame frame = tracer.at_rest().trace(world.camera, 0, map, settings);
    std::vector<float> pixels(frame.sum.size());
    for (std::size_t i = 0; i < map.sites.size(); ++i) {
      const std::size_t at = static_cast<std::size_t>(map.sites[i].block_y) * static_cast<std::size_t>(map.width_px) +
                             map.sites[i].block_x;
      pixels[at] = static_cast<float>(luminance(frame.sum[i]) / frame.count[i]);
    }
    frames.push_back(std::move(pixels));
  }
  return frames;
}

void compare_model(PathTracer& tracer, const World& world, const Options& options, const std::string& model,
                   FoveationSettings settings, const std::vector<std::vector<float>>& uniform,
                   std::vector<Comparison>& out) {
  const PlanarView view = view_of_display(display_by_name("paper"), {}, options.width_px, options.height_px);
  const Vec3d gaze = view.direction(options.gaze.x * options.width_px, options.gaze.y * options.height_px);
  constexpr std::size_t kBands = kBandEnds.size() + 1;
  const ImageGray probe = samples_per_pixel(make_sampling_map(settings, view, gaze));
  const auto probe_spp = static_cast<double>(*std::max_element(probe.pixels.begin(), probe.pixels.end()));
  if (probe_spp < options.foveal_spp) {
    settings.spp = *settings.spp * options.foveal_spp / probe_spp;
  }
  std::array<std::vector<double>, kBands> foveated;
  std::array<double, kBands> empty{};
  std::array<double, kBands> sites{};
  Bands bands;
  double samples = 0;
  for (int seed = 0; seed < options.seeds; ++seed) {
    MapContext context;
    context.seed = static_cast<std::uint64_t>(seed);
    const SamplingMap map = make_sampling_map(settings, view, gaze, context);
    if (seed == 0) {
      bands = bands_of(map, view, gaze);
    }
    TraceSettings trace;
    trace.seed = static_cast<std::uint64_t>(seed);
    const SparseFrame frame = tracer.at_rest().trace(world.camera, 0, map, trace);
    std::array<double, kBands> sums{};
    for (std::size_t i = 0; i < map.sites.size(); ++i) {
      const std::size_t band = bands.of_site[i];
      sums.at(band) += map.sites[i].pixels * luminance(frame.sum[i]) / map.expected(i);
      empty.at(band) += frame.count[i] == 0 ? 1 : 0;
      sites.at(band) += 1;
    }
    samples += static_cast<double>(map.samples());
    for (std::size_t b = 0; b < kBands; ++b) {
      foveated.at(b).push_back(sums.at(b) / bands.pixels.at(b));
    }
  }
  for (std::size_t b = 0; b < kBands; ++b) {
    if (bands.pixels.at(b) == 0) {
      continue;
    }
    std::vector<double> reference;
    for (const std::vector<float>& frame : uniform) {
      double sum = 0;
      for (std::size_t i = 0; i < frame.size(); ++i) {
        sum += bands.of_pixel.pixels[i] == b ? static_cast<double>(frame[i]) : 0.0;
      }
      reference.push_back(sum / bands.pixels.at(b));
    }
    const Estimate a = estimate_of(foveated.at(b));
    const Estimate u = estimate_of(reference);
    if (!(u.mean > 0)) {
      throw Error(ErrorKind::input, world.name, fmt::format("band {} is black: no share of its mean can be told", b),
                  "look from another place");
    }
    Comparison c;
    c.scene = world.name;
    c.model = model;
    c.band = b;
    c.spp = samples / options.seeds / (static_cast<double>(options.width_px) * options.height_px);
    c.empty_share = empty.at(b) / sites.at(b);
    c.difference = (a.mean - u.mean) / u.mean;
    const double variance = a.variance_of_mean + u.variance_of_mean;
    c.error = std::sqrt(variance) / u.mean;
    c.freedom = variance * variance /
                (a.variance_of_mean * a.variance_of_mean / (a.repeats - 1) +
                 u.variance_of_mean * u.variance_of_mean / (u.repeats - 1));
    c.p = student_tail((options.margin - std::abs(c.difference)) / c.error, c.freedom);
    c.half_width = student_quantile(0.005, c.freedom) * c.error;
    out.push_back(c);
  }
}

// Holm 1979: the smallest p against level / m, the next against level / (m - 1), until one fails. Each equivalence is
// two one-sided tests at 0.5 %, which is the same as the 99 % interval lying within the margin.
void judge(std::vector<Comparison>& all) {
  constexpr double kLevel = 0.005;
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return all[a].p < all[b].p; });
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    if (all[order[rank]].p > kLevel / static_cast<double>(order.size() - rank)) {
      break;
    }
    all[order[rank]].equivalent = true;
  }
}

std::string band_name(std::size_t band) {
  return fmt::format("{}-{}", band == 0 ? 0.0 : kBandEnds.at(band - 1),
                     band < kBandEnds.size() ? kBandEnds.at(band) : 180.0);
}

void print(const std::vector<Comparison>& all, const Options& options) {
  std::map<std::string, std::vector<const Comparison*>> rows;
  std::vector<std::string> order;
  for (const Comparison& c : all) {
    const std::string key = fmt::format("| {} | {} | {:.3f} |", c.scene, c.model, c.spp);
    if (!rows.contains(key)) {
      order.push_back(key);
    }
    rows[key].push_back(&c);
  }
  fmt::print(
      "difference of the means in per cent of the band's mean +- half of the 99 % interval (share of sites without "
      "a sample);\n* equivalent within +-{:.2g} % after Holm over {} tests, ! not shown\n\n| scene | model | spp |",
      100 * options.margin, all.size());
  std::size_t last_band = 0;
  for (const Comparison& c : all) {
    last_band = std::max(last_band, c.band);
  }
  for (std::size_t b = 0; b <= last_band; ++b) {
    fmt::print(" {} |", band_name(b));
  }
  fmt::print("\n| --- | --- | ---");
  for (std::size_t b = 0; b <= last_band; ++b) {
    fmt::print(" | ---");
  }
  fmt::print(" |\n");
  for (const std::string& key : order) {
    fmt::print("{}", key);
    for (std::size_t b = 0; b <= last_band; ++b) {
      const auto& list = rows[key];
      const auto found = std::find_if(list.begin(), list.end(), [&](const Comparison* c) { return c->band == b; });
      if (found == list.end()) {
        fmt::print(" |");
        continue;
      }
      const Comparison& c = **found;
      fmt::print(" {:+.3f} +- {:.3f}{}{} |", 100 * c.difference, 100 * c.half_width,
                 c.empty_share > 0 ? fmt::format(" ({:.0f} %)", 100 * c.empty_share) : "", c.equivalent ? " *" : " !");
    }
    fmt::print("\n");
  }
  const auto failed = std::count_if(all.begin(), all.end(), [](const Comparison& c) { return !c.equivalent; });
  fmt::print("\n{} of {} equivalent\n", all.size() - static_cast<std::size_t>(failed), all.size());
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      options.scenes.emplace_back(name);
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--seeds") {
      options.seeds = std::atoi(value);
    } else if (name == "--uniform-seeds") {
      options.uniform_seeds = std::atoi(value);
    } else if (name == "--uniform-samples") {
      options.uniform_samples = std::strtod(value, nullptr);
    } else if (name == "--foveal-spp") {
      options.foveal_spp = std::strtod(value, nullptr);
    } else if (name == "--spp") {
      options.spp = std::strtod(value, nullptr);
    } else if (name == "--margin") {
      options.margin = 0.01 * std::strtod(value, nullptr);
    } else if (name == "--size") {
      const benchmark::FrameSize size = benchmark::parse_size(value);
      options.width_px = size.width_px;
      options.height_px = size.height_px;
    } else if (name == "--gaze") {
      const std::vector<double> list = parse_numbers(value);
      options.gaze = {list.at(0), list.at(1)};
    } else if (name == "--models") {
      options.models = benchmark::parse_names(value);
    } else if (name == "--eye") {
      options.eye = parse_point(value);
    } else if (name == "--target") {
      options.target = parse_point(value);
    } else if (name == "--fov") {
      options.fov_deg = std::strtod(value, nullptr);
    } else {
      throw Error(ErrorKind::usage, name, "unknown option", "read the head of foveated_mean.cpp");
    }
  }
  return options;
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  if (options.scenes.empty()) {
    throw Error(ErrorKind::usage, "", "no scene was given", "read the head of foveated_mean.cpp");
  }
  std::vector<Comparison> all;
  for (const std::string& text : options.scenes) {
    const World world = benchmark::load_world(text, options.viewpoint());
    PathTracer tracer(world.scene, {});
    const auto uniform = uniform_frames(tracer, world, options);
    for (const std::string& name : all_models()) {
      if (!options.models.empty() &&
          std::find(options.models.begin(), options.models.end(), name) == options.models.end()) {
        continue;
      }
      FoveationSettings settings = model_relative_to_fovea(name);
      settings.spp = options.spp;
      compare_model(tracer, world, options, name, settings, uniform, all);
    }
  }
  judge(all);
  print(all, options);
  return std::all_of(all.begin(), all.end(), [](const Comparison& c) { return c.equivalent; }) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
