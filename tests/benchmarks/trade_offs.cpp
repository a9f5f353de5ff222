// SPDX-License-Identifier: Apache-2.0
// Every setting that trades accuracy for speed, on a scene under a sky: its cost and its error, in one table.
//   gazetrace_trade_offs scene.gltf sky.hdr [--eye X,Y,Z] [--target X,Y,Z] [--fov DEG] [--seeds N] [--spp N]
//       [--rounds N] [--height PX] [--only TEXT]
//   time    CPU time per sample by that of the default settings: median over rounds that alternate the two
//   noise   mean relative squared error of a pixel at one sample, by that of the default settings, with its standard
//           error over four groups of seeds: a few fireflies decide it, so that it may be wide
//   typical the median over the pixels of their variance by that of the default settings
//   cost    time * noise: CPU time to a given noise
//   mean    change of the frame's mean against the exact settings, with its standard error over the seeds
//   pixel   root mean square over the pixels of the bias against the exact settings, relative to the pixel plus the
//           frame's mean (dark pixels must not decide alone); its square is estimated
//           from two halves of the seeds, which share no noise, so that noise adds nothing ("< x": within two
//           standard errors of nothing)
// The exact settings of a row differ from the row's in what it names alone: full texture detail, 12 bounces for the
// rows of bounces, no clamping. A pixel filter is a choice of what to estimate, so it has no bias.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>

#include "benchmark_main.hpp"
#include "core/half.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"
#include "pixel_statistics.hpp"

namespace {

using namespace gazetrace;
using namespace gazetrace::benchmark;

struct Options {
  std::string scene, sky, only;
  View view{{8, 2, -0.3}, {-8, 3, -0.3}};
  int seeds = 64;
  int rounds = 5;
  std::uint32_t spp = 4;
};

struct Row {
  std::string name;
  TraceSettings settings, exact;
  PathTracer* tracer = nullptr;
  bool biased = true;  // false: estimates the same by construction, or something else by choice
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      (options.scene.empty() ? options.scene : options.sky) = name;
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--eye") {
      options.view.eye = parse_point(value);
    } else if (name == "--target") {
      options.view.target = parse_point(value);
    } else if (name == "--fov") {
      options.view.yfov_rad = std::strtod(value, nullptr) * kRadPerDeg;
    } else if (name == "--height") {
      options.view.height_px = static_cast<int>(std::strtol(value, nullptr, 10));
      options.view.width_px = options.view.height_px * 16 / 9;
    } else if (name == "--seeds") {
      options.seeds = static_cast<int>(std::strtol(value, nullptr, 10));
    } else if (name == "--spp") {
      options.spp = static_cast<std::uint32_t>(std::strtoul(value, nullptr, 10));
    } else if (name == "--rounds") {
      options.rounds = static_cast<int>(std::strtol(value, nullptr, 10));
    } else if (name == "--only") {
      options.only = value;
    } else {
      throw Error(ErrorKind::usage, name, "is not known");
    }
  }
  return options;
}

std::vector<Row> make_rows(PathTracer& tracer, double frame_mean) {
  std::vector<Row> rows;
  TraceSettings usual;
  usual.max_bounces = 3;
  usual.russian_roulette = false;
  const auto add = [&](std::string name, bool biased, const std::function<void(TraceSettings&, TraceSettings&)>& set) {
    Row row{std::move(name), usual, usual, &tracer, biased};
    set(row.settings, row.exact);
    rows.push_back(std::move(row));
  };
  for (const int bounces : {1, 2, 3, 4, 6}) {
    add(fmt::format("--bounces {}", bounces), true, [&](auto& settings, auto& reference) {
      settings.max_bounces = bounces;
      reference.max_bounces = 12;
    });
  }
  add("--bounces 8", false, [](auto& settings, auto&) { settings.max_bounces = 8; });
  add("--bounces 8 --russian-roulette", false, [](auto& settings, auto&) {
    settings.max_bounces = 8;
    settings.russian_roulette = true;
  });
  for (const double means : {100.0, 10.0, 3.0, 1.0}) {
    const double limit = means * frame_mean;
    add(fmt::format("--clamp-indirect {:.3g} ({} means)", limit, means), true,
        [&](auto& settings, auto&) { settings.clamp_indirect = limit; });
  }
  add("--light-sampling light", false,
      [](auto& settings, auto&) { settings.light_sampling = LightSampling::light_only; });
  add("--light-sampling bsdf", false,
      [](auto& settings, auto&) { settings.light_sampling = LightSampling::bsdf_only; });
  add("--pixel-filter blackman-harris", false,
      [](auto& settings, auto&) { settings.filter = PixelFilter::blackman_harris; });
  add("--diffuse lambert", false, [](auto& settings, auto&) { settings.diffuse = DiffuseModel::lambert; });
  return rows;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Ratio {
  double value = 0, error = 0;
};

// Of two estimators' noise: each group of seeds gives one ratio, measured with the same random numbers for both.
Ratio noise_ratio(const Row& row, PathTracer& plain, const std::vector<double>& truth, const Options& options) {
  constexpr int kGroups = 4;
  const int seeds = std::max(2, options.seeds / kGroups);
  std::vector<double> ours;
  std::vector<double> theirs;
  for (int group = 0; group < kGroups; ++group) {
    const int first = 1 + group * seeds;
    ours.push_back(
        relative_mse(measure(row.tracer->at_rest(), row.settings, options.view, seeds, options.spp, first), truth, 1));
    theirs.push_back(relative_mse(measure(plain.at_rest(), {}, options.view, seeds, options.spp, first), truth, 1));
  }
  const double ratio = average(ours) / average(theirs);
  double spread = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const double off = (ours[i] - ratio * theirs[i]) / average(theirs);
    spread += off * off;
  }
  return {ratio, std::sqrt(spread / (kGroups - 1) / kGroups)};
}

double typical_ratio(const PixelStatistics& ours, const PixelStatistics& theirs) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < ours.variance.size(); ++i) {
    if (theirs.variance[i] > 0) {
      ratios.push_back(ours.variance[i] / theirs.variance[i]);
    }
  }
  return ratios.empty() ? 0 : median(std::move(ratios));
}

struct Bias {
  double mean = 0, mean_error = 0;      // of the frame's mean, relative
  double square = 0, square_error = 0;  // of a pixel, relative, mean over the pixels
};

Bias bias_of(const Row& row, const Options& options) {
  const int half = options.seeds / 2;
  std::vector<double> changes;
  std::vector<std::vector<double>> difference(2);
  std::vector<double> truth;
  double whole = 0;
  for (int part = 0; part < 2; ++part) {
    const int first = 1001 + part * half;
    const PixelStatistics ours = measure(row.tracer->at_rest(), row.settings, options.view, half, options.spp, first);
    const PixelStatistics exact = measure(row.tracer->at_rest(), row.exact, options.view, half, options.spp, first);
    for (std::size_t i = 0; i < ours.frame_means.size(); ++i) {
      changes.push_back(ours.frame_means[i] - exact.frame_means[i]);
    }
    truth.resize(exact.mean.size());
    for (std::size_t i = 0; i < exact.mean.size(); ++i) {
      difference[static_cast<std::size_t>(part)].push_back(ours.mean[i] - exact.mean[i]);
      truth[i] += 0.5 * exact.mean[i];
    }
    whole += 0.5 * average(exact.frame_means);
  }
  Bias bias;
  const double mean = average(changes);
  double spread = 0;
  for (const double change : changes) {
    spread += (change - mean) * (change - mean);
  }
  const auto n = static_cast<double>(changes.size());
  bias.mean = mean / whole;
  bias.mean_error = std::sqrt(spread / (n - 1) / n) / whole;
  std::vector<double> squares;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    squares.push_back(difference[0][i] * difference[1][i] / ((truth[i] + whole) * (truth[i] + whole)));
  }
  bias.square = average(squares);
  double deviation = 0;
  for (const double square : squares) {
    deviation += (square - bias.square) * (square - bias.square);
  }
  const auto pixels = static_cast<double>(squares.size());
  bias.square_error = std::sqrt(deviation / (pixels - 1) / pixels);
  return bias;
}

std::string bias_text(const Row& row, const Options& options) {
  if (!row.biased) {
    return fmt::format("{:>22} {:>9}", "-", "-");
  }
  const Bias bias = bias_of(row, options);
  const bool seen = bias.square > 2 * bias.square_error;
  const double shown = std::sqrt(std::max(seen ? bias.square : 2 * bias.square_error, 0.0));
  return fmt::format("{:8.3f} +- {:5.3f} % {:>3}{:5.2f} %", 100 * bias.mean, 100 * bias.mean_error, seen ? "" : "<",
                     100 * shown);
}

// What storage as half floats does to a picture, on the values of this one.
void print_half(const PixelStatistics& plain) {
  double sum = 0;
  for (const double value : plain.mean) {
    const auto exact = static_cast<float>(value);
    const double off = value > 0 ? static_cast<double>(half_to_float(float_to_half(exact))) / value - 1 : 0;
    sum += off * off;
  }
  fmt::print(
      "half instead of float pixels: {:.3f} % root mean square of the relative rounding, {} bytes a pixel less\n",
      100 * std::sqrt(sum / static_cast<double>(plain.mean.size())), 3 * (sizeof(float) - sizeof(std::uint16_t)));
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  Scene scene = load_scene(options.scene);
  scene.environment = options.sky.empty() ? builtin_sky() : load_environment(options.sky);
  TracerOptions one_thread;
  one_thread.threads = 1;
  PathTracer tracer(scene, one_thread);
  const PixelStatistics plain = measure(tracer.at_rest(), {}, options.view, options.seeds, options.spp);
  fmt::print("{}, {} x {}, {} seeds of {} spp; default {:.3f} us/sample, mean {:.4g}, relative MSE at 1 spp {:.3f}\n",
             scene.source, options.view.width_px, options.view.height_px, options.seeds, options.spp,
             plain.us_per_sample, average(plain.mean), relative_mse(plain, plain.mean, 1));
  fmt::print("tree: {:.2f} s, {:.1f} MiB\n", tracer.memory().build_s,
             static_cast<double>(tracer.memory().bvh_bytes) * 0x1p-20);
  print_half(plain);
  fmt::print("{:<32} {:>6} {:>16} {:>7} {:>6} {:>22} {:>9}\n", "setting", "time", "noise", "typical", "cost", "mean",
             "pixel");
  for (const Row& row : make_rows(tracer, average(plain.mean))) {
    if (row.name.find(options.only) == std::string::npos) {
      continue;
    }
    const PixelStatistics measured =
        measure(row.tracer->at_rest(), row.settings, options.view, options.seeds, options.spp);
    std::vector<double> ratios;
    for (int round = 0; round < options.rounds; ++round) {
      const int seeds = std::max(1, options.seeds / 8);
      const double with = measure(row.tracer->at_rest(), row.settings, options.view, seeds, options.spp).us_per_sample;
      ratios.push_back(with / measure(tracer.at_rest(), {}, options.view, seeds, options.spp).us_per_sample);
    }
    const double time = median(ratios);
    const Ratio noise = noise_ratio(row, tracer, plain.mean, options);
    fmt::print("{:<32} {:6.3f} {:7.3f} +- {:5.3f} {:7.3f} {:6.3f} {}\n", row.name, time, noise.value, noise.error,
               typical_ratio(measured, plain), time * noise.value, bias_text(row, options));
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
