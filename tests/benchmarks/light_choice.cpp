// SPDX-License-Identifier: Apache-2.0
// What ways of finding light cost and give, beside the default in one run: error times time of a frame at several
// rates.
//   gazetrace_light_choice SCENE.gltf[=SKY.hdr] | lamps:N  [--eye X,Y,Z] [--target X,Y,Z] [--fov DEG] [--size 320x180]
//       [--rows guiding,bsdf-only,guiding+roulette] [--spp 1,4,16,64] [--seeds 16] [--reference 4x256]
//       [--bounces N]
// A row is one or several of the words of kWords.
// The reference is rendered with the default choice: so many scramblings of so many samples, none of them a row's. Rows
// take turns frame by frame, on one thread. Printed for each row and rate:
//   error   mean over the pixels and seeds of the squared error by the squared reference, and of one default sample
//   by      that of the default at the same rate, with its standard error over the seeds; `time` is the median of the
//           ratios of turns and counts everything that PosedScene::trace() does, and train_guiding() before it; `cost`
//           is the product of both
//   typical median over the pixels of the ratio of squared errors
//   top     99.99th percentile over pixels and seeds of a pixel over its reference, by that of the default
//   mean    the frame's mean over the reference's, with its standard error over the seeds
// The floor is what the reference's own noise adds to `error`.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_main.hpp"
#include "core/stopwatch.hpp"
#include "gazetrace/error.hpp"
#include "lamp_city.hpp"
#include "world.hpp"

namespace {

using namespace gazetrace;
using namespace gazetrace::benchmark;

struct Options {
  std::string world;
  Viewpoint from{{8, 2, -0.3}, {-8, 3, -0.3}, 50};
  bool has_viewpoint = false;
  FrameSize size{320, 180};
  std::vector<std::string> rows{"default"};
  std::vector<double> rates{1, 4, 16, 64};
  int seeds = 16;
  int reference_frames = 4;
  std::uint32_t reference_spp = 256;
  TraceSettings settings;
};

Options parse(int argc, char** argv) {
  Options options;
  options.settings.max_bounces = 3;
  options.settings.russian_roulette = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      options.world = name;
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--eye") {
      options.from.eye = parse_point(value);
      options.has_viewpoint = true;
    } else if (name == "--target") {
      options.from.target = parse_point(value);
    } else if (name == "--fov") {
      options.from.fov_deg = std::strtod(value, nullptr);
    } else if (name == "--size") {
      options.size = parse_size(value);
    } else if (name == "--rows") {
      for (std::string& row : parse_names(value)) {
        options.rows.push_back(std::move(row));
      }
    } else if (name == "--spp") {
      options.rates = parse_numbers(value);
    } else if (name == "--seeds") {
      options.seeds = std::atoi(value);
    } else if (name == "--bounces") {
      options.settings.max_bounces = std::atoi(value);
    } else if (name == "--reference") {
      char* rest = nullptr;
      options.reference_frames = static_cast<int>(std::strtol(value, &rest, 10));
      options.reference_spp = static_cast<std::uint32_t>(std::strtoul(rest + 1, nullptr, 10));
    } else {
      throw Error(ErrorKind::usage, name, "is not known", "read the head of light_choice.cpp");
    }
  }
  return options;
}

struct Word {
  std::string_view name;
  void (*set)(TraceSettings&);
};
constexpr Word kWords[] = {
    {"default", [](TraceSettings&) {}},
    {"light-only", [](TraceSettings& s) { s.light_sampling = LightSampling::light_only; }},
    {"bsdf-only", [](TraceSettings& s) { s.light_sampling = LightSampling::bsdf_only; }},
    {"roulette", [](TraceSettings& s) { s.russian_roulette = true; }},
    {"guiding", [](TraceSettings& s) { s.guiding = true; }},
};

// Only the rows that say so are guided.
TraceSettings settings_of(const std::string& row, TraceSettings settings) {
  settings.guiding = false;
  for (std::size_t begin = 0; begin < row.size();) {
    const std::size_t end = std::min(row.find('+', begin), row.size());
    const std::string word = row.substr(begin, end - begin);
    begin = end + 1;
    const Word* known =
        std::find_if(std::begin(kWords), std::end(kWords), [&](const Word& w) { return w.name == word; });
    if (known == std::end(kWords)) {
      throw Error(ErrorKind::usage, word, "is no row", "read the head of light_choice.cpp");
    }
    known->set(settings);
  }
  return settings;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

struct Moments {
  double mean = 0, error = 0;
};
Moments moments(const std::vector<double>& values) {
  const double mean = average(values);
  double spread = 0;
  for (const double value : values) {
    spread += (value - mean) * (value - mean);
  }
  const auto n = static_cast<double>(values.size());
  return {mean, n > 1 ? std::sqrt(spread / (n - 1) / n) : 0};
}

using Picture = std::vector<double>;  // of G

Picture picture_of(const SparseFrame& frame) {
  Picture picture;
  for (std::size_t i = 0; i < frame.sum.size(); ++i) {
    picture.push_back(static_cast<double>(frame.sum[i].y) / std::max(1U, frame.count[i]));
  }
  return picture;
}

struct Reference {
  Picture mean;
  Picture weight;    // what squared errors of a pixel are multiplied by
  double floor = 0;  // mean squared error of `mean` itself
};

struct Row {
  std::string name;
  TraceSettings settings;
  std::vector<double> us, errors, means;  // of each seed
  Picture squares;                        // of each pixel, summed over the seeds
  std::vector<float> ratios;              // of all pixels over their reference
};

SamplingMap map_of(const Camera& camera, const FrameSize& size, std::uint32_t spp) {
  FoveationSettings uniform;
  uniform.spp = spp;
  return make_sampling_map(uniform, view_of_perspective(camera.projection.yfov_rad, size.width_px, size.height_px), {});
}

Reference make_reference(const PosedScene& scene, const Camera& camera, const Options& options) {
  const SamplingMap map = map_of(camera, options.size, options.reference_spp);
  std::vector<Picture> frames;
  TraceSettings settings = options.settings;
  for (int k = 0; k < options.reference_frames; ++k) {
    settings.seed = 1000001U + static_cast<std::uint64_t>(k);
    frames.push_back(picture_of(scene.trace(camera, 0, map, settings)));
  }
  Reference reference;
  const std::size_t pixels = map.sites.size();
  const auto n = static_cast<double>(frames.size());
  for (std::size_t i = 0; i < pixels; ++i) {
    double sum = 0;
    for (const Picture& frame : frames) {
      sum += frame[i];
    }
    reference.mean.push_back(sum / n);
  }
  // Pixels that hardly anything reaches must not decide alone.
  const double typical = average(reference.mean);
  for (std::size_t i = 0; i < pixels; ++i) {
    const double mean = reference.mean[i];
    reference.weight.push_back(1 / (mean * mean + 0.01 * typical * typical));
    double spread = 0;
    for (const Picture& frame : frames) {
      spread += (frame[i] - mean) * (frame[i] - mean);
    }
    reference.floor += spread / ((n - 1) * n) * reference.weight[i] / static_cast<double>(pixels);
  }
  return reference;
}

void take_turn(Row& row, const PosedScene& scene, const Camera& camera, const SamplingMap& map,
               const Reference& reference, std::uint64_t seed) {
  row.settings.seed = seed;
  const std::int64_t begin_ns = thread_cpu_ns();
  if (row.settings.guiding) {
    row.settings.guiding_field = scene.train_guiding(camera, map.width_px, map.height_px, row.settings).field;
  }
  const SparseFrame frame = scene.trace(camera, 0, map, row.settings);
  const std::int64_t end_ns = thread_cpu_ns();
  const Picture picture = picture_of(frame);
  double sum = 0;
  double error = 0;
  row.squares.resize(picture.size());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const double off = picture[i] - reference.mean[i];
    const double square = off * off * reference.weight[i];
    row.squares[i] += square;
    error += square;
    sum += picture[i];
    row.ratios.push_back(static_cast<float>(std::sqrt(picture[i] * picture[i] * reference.weight[i])));
  }
  const auto pixels = static_cast<double>(picture.size());
  const double paths = static_cast<double>(frame.stats.samples);
  row.us.push_back(static_cast<double>(end_ns - begin_ns) * 1e-3 / paths);
  row.errors.push_back(error / pixels);
  row.means.push_back(sum / pixels / average(reference.mean));
}

float top_ratio(std::vector<float> ratios) {
  const auto at = static_cast<std::ptrdiff_t>(static_cast<double>(ratios.size()) * 0.9999);
  std::nth_element(ratios.begin(), ratios.begin() + at, ratios.end());
  return ratios[static_cast<std::size_t>(at)];
}

void print_row(const Row& row, const Row& plain, int spp, double floor) {
  std::vector<double> times;
  std::vector<double> turns;
  const double base = average(plain.errors) - floor;
  for (std::size_t k = 0; k < row.us.size(); ++k) {
    times.push_back(row.us[k] / plain.us[k]);
    turns.push_back(row.errors[k] - floor);
  }
  const Moments error = moments(turns);
  const Moments base_error = moments(plain.errors);
  const double by = error.mean / base;
  const double by_error = by * std::hypot(error.error / error.mean, base_error.error / base);
  std::vector<double> typical;
  for (std::size_t i = 0; i < row.squares.size(); ++i) {
    if (plain.squares[i] > 0) {
      typical.push_back(row.squares[i] / plain.squares[i]);
    }
  }
  const Moments mean = moments(row.means);
  const double time = median(times);
  fmt::print("{:<28} {:>3} {:10.5f} {:6.3f} +- {:5.3f} {:7.3f} {:7.3f} {:7.3f} {:6.3f} {:6.3f} {:9.5f} +- {:7.5f}\n",
             row.name, spp, error.mean, by, by_error, median(typical), median(row.us), time, by * time,
             static_cast<double>(top_ratio(row.ratios) / top_ratio(plain.ratios)), mean.mean, mean.error);
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  constexpr std::string_view kLamps = "lamps:";
  World world;
  if (options.world.starts_with(kLamps)) {
    world = {options.world, city(std::atoi(options.world.c_str() + kLamps.size()), false),
             camera_at({{14, 7, 16}, {0, 0.5, 0}, 50})};
  } else {
    world = load_world(options.world, options.from);
    if (options.has_viewpoint) {
      world.camera = camera_at(options.from);
    }
  }
  TracerOptions tracer_options;
  tracer_options.threads = 1;
  PathTracer tracer(world.scene, tracer_options);
  const PosedScene scene = tracer.at_rest();
  const Reference reference = make_reference(scene, world.camera, options);
  fmt::print("{}, {} x {}, {} bounces, {} seeds; reference {} x {} spp, mean {:.5g}, floor {:.6f}\n", world.name,
             options.size.width_px, options.size.height_px, options.settings.max_bounces, options.seeds,
             options.reference_frames, options.reference_spp, average(reference.mean), reference.floor);
  fmt::print("{:<28} {:>3} {:>10} {:>15} {:>7} {:>7} {:>7} {:>6} {:>6} {:>20}\n", "row", "spp", "error", "by",
             "typical", "us", "time", "cost", "top", "mean");
  for (const double rate : options.rates) {
    const auto spp = static_cast<std::uint32_t>(rate);
    const SamplingMap map = map_of(world.camera, options.size, spp);
    std::vector<Row> rows;
    for (const std::string& name : options.rows) {
      rows.push_back({name, settings_of(name, options.settings), {}, {}, {}, {}, {}});
    }
    for (int seed = 1; seed <= options.seeds; ++seed) {
      for (Row& row : rows) {
        take_turn(row, scene, world.camera, map, reference, static_cast<std::uint64_t>(seed));
      }
    }
    for (const Row& row : rows) {
      print_row(row, rows.front(), static_cast<int>(spp), reference.floor);
    }
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
