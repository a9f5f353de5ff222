// SPDX-License-Identifier: Apache-2.0
// What accumulation over time gives and costs, on a scene under a sky, at equal samples.
//   gazetrace_temporal scene.gltf sky.hdr gaze.csv [--frames N] [--height PX] [--reference-spp N]
//   [--filter NAME,NAME] [--start X,Y,Z] [--only sequences|light|body|seams]
// Two sequences at 24 frames a second, both with the recorded gaze (replay, not viewing): a camera that glides and
// turns, and one that stands still while the gaze moves. References are uniform, of two halves with other seeds, whose
// difference gives the floor below which nothing is claimed; where the camera stands, of 16 times --reference-spp.
//   relmse   mean over frames and pixels of (x - ref)^2 / (ref^2 + 0.01 mean^2), the reference's own taken off
//   bias     mean of x - ref over all frames and pixels, by the mean of ref, percent
//   local    root mean square over pixels of the mean over time of x - ref, by the mean of ref: what does not average
//            out; noise of x and reference is in it
//   flicker  standard deviation over time between 1 Hz and half the frame rate, in excess of the reference's, root mean
//            square over pixels, by the mean of ref
//   seen     the same as an eye sees it: FlickerMeter's excess, in multiples of what is just visible where it is (0.18
//            of a display of 200 cd/m2 shows the mean of ref); beside it that of the pixels beyond 8.5 degrees
// Then: how long a light that goes out (a tenth of the sky) and a body that is gone (its shadow too) are still seen,
// and what a run that begins with frames rendered before its first differs from the whole one.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_main.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze.hpp"
#include "gazetrace/pipeline.hpp"
#include "sequence_measures.hpp"
#include "world.hpp"

namespace {

using namespace gazetrace;
using benchmark::kFps;
using benchmark::Luminances;
using benchmark::Reference;
using benchmark::SeenFlicker;

constexpr std::uint32_t kStillReference = 16;
constexpr std::array kAfter{0, 1, 2, 4, 8, 16};

struct Options {
  std::string scene, sky, gaze, only;
  std::vector<std::string> filters{"linear"};
  Vec3d start{6, 2, -0.3};  // of the camera, which looks towards -x
  int frames = 120, height_px = 90;
  std::uint32_t reference_spp = 128;
};

struct Variant {
  std::string name;
  AccumulateSettings accumulate;
  bool orders = false;  // one of two that differ in their order alone
};

Options parse(int argc, char** argv) {
  Options options;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string_view name = argv[i];
    if (name.substr(0, 2) != "--") {
      files.emplace_back(name);
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (name == "--frames") {
      options.frames = std::atoi(value);
    } else if (name == "--height") {
      options.height_px = std::atoi(value);
    } else if (name == "--reference-spp") {
      options.reference_spp = static_cast<std::uint32_t>(std::atoi(value));
    } else if (name == "--filter") {
      options.filters = benchmark::parse_names(value);
    } else if (name == "--start") {
      options.start = benchmark::parse_point(value);
    } else if (name == "--only") {
      options.only = value;
    } else {
      throw Error(ErrorKind::usage, name, "is not known");
    }
  }
  if (files.size() != 3) {
    throw Error(ErrorKind::usage, "", "give a scene, a sky and a gaze log");
  }
  options.scene = files[0];
  options.sky = files[1];
  options.gaze = files[2];
  return options;
}

std::vector<Variant> make_variants() {
  std::vector<Variant> variants{{"off", {}, false}};
  const auto add = [&](std::string name, double frames, double clip, double blend, AccumulateOrder order) {
    AccumulateSettings settings;
    settings.mode = AccumulateMode::reproject;
    settings.frames = frames;
    settings.clip_sigmas = clip;
    settings.blend = blend;
    settings.order = order;
    variants.push_back({std::move(name), settings, false});
  };
  const AccumulateSettings standard;
  constexpr auto kLater = AccumulateOrder::after;
  add("reproject (the defaults)", standard.frames, standard.clip_sigmas, 0, standard.order);
  add("before the filter", standard.frames, standard.clip_sigmas, 0, AccumulateOrder::before);
  add("after the filter", standard.frames, standard.clip_sigmas, 0, kLater);
  variants[2].orders = variants[3].orders = true;
  add("memory 8", 8, standard.clip_sigmas, 0, kLater);
  add("memory 32", 32, standard.clip_sigmas, 0, kLater);
  add("clip 0", standard.frames, 0, 0, kLater);
  add("clip 2", standard.frames, 2, 0, kLater);
  add("clip 5", standard.frames, 5, 0, kLater);
  add("blend 0.1", standard.frames, standard.clip_sigmas, 0.1, kLater);
  return variants;
}

class Bench {
 public:
  explicit Bench(const Options& options) : options_(options), log_(load_gaze_log(options.gaze, {})) {}

  [[nodiscard]] int width_px() const { return options_.height_px * 16 / 9; }

  [[nodiscard]] FramePlan plan(bool glides, int first, int last) const {
    CameraPath path;
    const auto at = [start = options_.start](double s) {
      const Vec3d eye = start + Vec3d{-0.4 * s, 0, 0.2 * std::sin(s)};
      return look_at(eye, eye + Vec3d{-1, 0.06, 0.25 * std::sin(0.7 * s)}, {0, 1, 0});
    };
    Projection projection;
    path = static_camera(at(0), projection);
    if (glides) {
      path.is_static = false;
      path.end_ns = std::int64_t{3600} * 1'000'000'000;
      path.pose_at = [at](std::int64_t t) { return at(static_cast<double>(t) * 1e-9); };
    }
    PlanSettings settings;
    settings.width_px = width_px();
    settings.height_px = options_.height_px;
    settings.display = display_by_name("paper");
    settings.transfer = GazeTransfer::fraction;
    for (int frame = first; frame <= last; ++frame) {
      settings.frames.push_back(frame);
    }
    return plan_frames(path, &log_, settings);
  }

  [[nodiscard]] PipelineSettings settings_of(const AccumulateSettings& accumulate, const std::string& filter) const {
    PipelineSettings settings;
    settings.filter = filter;
    settings.accumulate = accumulate;
    settings.history_digest = "none";
    settings.trace.seed = 1;
    return settings;
  }

  // One frame is worth more samples than each of many.
  [[nodiscard]] std::uint32_t reference_spp(bool still) const {
    return options_.reference_spp * (still ? kStillReference : 1);
  }
  [[nodiscard]] PipelineSettings reference_settings(std::uint64_t seed, bool still) const {
    PipelineSettings settings;
    settings.foveation.falloff = "uniform";
    settings.foveation.uniform_spp = reference_spp(still) / 2;
    settings.trace.seed = seed;
    return settings;
  }

 private:
  Options options_;
  GazeLog log_;
};

Luminances render(PathTracer& tracer, const FramePlan& plan, const PipelineSettings& settings,
                  double* temporal_ms = nullptr) {
  const ColorPipeline color(ColorSettings{});
  Luminances frames;
  PipelineObserver observer;
  observer.frame_ready = [&](const FrameRequest&, const Frame& frame, double) {
    std::vector<float> luminance;
    luminance.reserve(frame.radiance.pixels.size());
    for (const Vec3f& c : frame.radiance.pixels) {
      luminance.push_back(0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z);
    }
    frames.push_back(std::move(luminance));
  };
  observer.frame_done = [&](const TimingRow& row, bool) {
    if (temporal_ms != nullptr) {
      *temporal_ms += row.temporal_ms;
    }
  };
  Warnings warnings;
  (void)render_sequence(tracer, plan, color, settings, observer, starting_history(plan, settings, warnings));
  return frames;
}

Reference make_reference(PathTracer& tracer, const Bench& bench, const FramePlan& plan, bool still) {
  const FramePlan& all = plan;
  FramePlan one = plan;
  one.frames.resize(1);
  Reference reference;
  const auto half = [&](std::uint64_t seed) {
    Luminances frames = render(tracer, still ? one : all, bench.reference_settings(seed, still));
    frames.resize(all.frames.size(), frames.front());
    return frames;
  };
  reference.a = half(1001);
  reference.b = half(2002);
  reference.mean = reference.a;
  double sum = 0;
  for (std::size_t f = 0; f < reference.a.size(); ++f) {
    for (std::size_t i = 0; i < reference.a[f].size(); ++i) {
      reference.mean[f][i] = 0.5F * (reference.a[f][i] + reference.b[f][i]);
      sum += static_cast<double>(reference.mean[f][i]);
    }
  }
  reference.level = sum / static_cast<double>(reference.a.size() * reference.a[0].size());
  if (!(reference.level > 0)) {
    throw Error(ErrorKind::input, "--start", "the reference is black", "begin where light reaches, not in a wall");
  }
  return reference;
}

void print_row(const std::string& name, const FramePlan& plan, const Luminances& frames, const Reference& reference,
               double temporal_ms) {
  const std::size_t count = frames.size();
  const std::size_t pixels = frames[0].size();
  double relative = 0;
  double floor = 0;
  double bias = 0;
  std::vector<double> local(pixels, 0);
  for (std::size_t f = 0; f < count; ++f) {
    for (std::size_t i = 0; i < pixels; ++i) {
      const auto ref = static_cast<double>(reference.mean[f][i]);
      const double off = static_cast<double>(frames[f][i]) - ref;
      const double halves = 0.5 * static_cast<double>(reference.a[f][i] - reference.b[f][i]);
      const double scale = ref * ref + 0.01 * reference.level * reference.level;
      relative += off * off / scale;
      floor += halves * halves / scale;
      bias += off;
      local[i] += off / static_cast<double>(count);
    }
  }
  const auto n = static_cast<double>(count * pixels);
  double local_square = 0;
  for (const double off : local) {
    local_square += off * off / static_cast<double>(pixels);
  }
  const auto of = [](const Luminances& from) {
    return [&from](std::size_t f, std::size_t i) { return static_cast<double>(from[f][i]); };
  };
  const double own = benchmark::variance_above_1_hz(of(frames), count, pixels);
  const double noise = benchmark::variance_above_1_hz(
      [&](std::size_t f, std::size_t i) { return 0.5 * static_cast<double>(reference.a[f][i] - reference.b[f][i]); },
      count, pixels);
  const double wanted = benchmark::variance_above_1_hz(of(reference.mean), count, pixels) - noise;
  const double excess = own - wanted;
  const SeenFlicker seen = benchmark::seen_flicker(plan, reference.mean, frames, reference.level);
  fmt::print("| {} | {:.4f} | {:+.2f} % | {:.2f} % | {}{:.2f} % | {:.2f} | {:.2f} | {:.2f} |\n", name,
             (relative - floor) / n, 100 * bias / n / reference.level, 100 * std::sqrt(local_square) / reference.level,
             excess < 0 ? "-" : "", 100 * std::sqrt(std::fabs(excess)) / reference.level, seen.all, seen.periphery,
             temporal_ms / static_cast<double>(count));
  std::fflush(stdout);
}

void print_floor(const FramePlan& plan, const Reference& reference) {
  double floor = 0;
  for (std::size_t f = 0; f < reference.a.size(); ++f) {
    for (std::size_t i = 0; i < reference.a[f].size(); ++i) {
      const double halves = 0.5 * static_cast<double>(reference.a[f][i] - reference.b[f][i]);
      const auto ref = static_cast<double>(reference.mean[f][i]);
      floor += halves * halves / (ref * ref + 0.01 * reference.level * reference.level);
    }
  }
  const SeenFlicker seen = benchmark::seen_flicker(plan, reference.a, reference.b, reference.level);
  fmt::print("The reference's own relmse: {:.5f}; flicker seen of one half against the other: {:.2f} ({:.2f}).\n\n",
             floor / static_cast<double>(reference.a.size() * reference.a[0].size()), seen.all, seen.periphery);
}

void compare_variants(PathTracer& tracer, const Bench& bench, const FramePlan& plan, const Reference& reference,
                      const std::string& filter) {
  fmt::print(
      "\nFilter {}\n\n| accumulation | relmse | bias | local | flicker | seen | seen beyond {} deg | ms a frame |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n",
      filter, benchmark::kPeriphery_deg);
  for (const Variant& variant : make_variants()) {
    if (variant.orders && filter_needs_guides(filter)) {
      continue;
    }
    double temporal_ms = 0;
    const Luminances frames = render(tracer, plan, bench.settings_of(variant.accumulate, filter), &temporal_ms);
    print_row(variant.name, plan, frames, reference, temporal_ms);
  }
}

void compare_sequences(PathTracer& tracer, const Bench& bench, const Options& options) {
  for (const bool glides : {true, false}) {
    const FramePlan plan = bench.plan(glides, 1, options.frames);
    const Reference reference = make_reference(tracer, bench, plan, !glides);
    fmt::print("\n{}, {} frames of {}x{}, references of {} spp\n",
               glides ? "The camera glides" : "The camera stands still", options.frames, bench.width_px(),
               options.height_px, bench.reference_spp(!glides));
    print_floor(plan, reference);
    for (const std::string& filter : options.filters) {
      compare_variants(tracer, bench, plan, reference, filter);
    }
  }
}

double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) {
    sum += static_cast<double>(value);
  }
  return sum / static_cast<double>(values.size());
}

// Two scenes, the history handed over by a checkpoint: from the next frame on everything is the second one's.
Luminances across_a_change(PathTracer& before, PathTracer& after, const Bench& bench, const Variant& variant,
                           const std::string& filter, int first_after) {
  PipelineSettings settings = bench.settings_of(variant.accumulate, filter);
  settings.checkpoint = (std::string(std::getenv("TMPDIR") != nullptr ? std::getenv("TMPDIR") : "/tmp") +
                         "/gazetrace_temporal_benchmark.bin");
  (void)render(before, bench.plan(false, 1, first_after - 1), settings);
  settings.resume_from = settings.checkpoint;
  settings.checkpoint.clear();
  Luminances frames = render(after, bench.plan(false, first_after, first_after + kAfter.back()), settings);
  std::remove(settings.resume_from.c_str());
  return frames;
}

// How much more than the new light is seen, relative to how much there was more before.
void light_goes_out(PathTracer& tracer, const Scene& scene, const Bench& bench, const std::string& filter) {
  constexpr int kFirst = 33;
  Scene dark = scene;
  for (Vec3f& radiance : dark.environment.radiance.pixels) {
    radiance = radiance * 0.1F;
  }
  PathTracer dark_tracer(dark, {});
  fmt::print("\nA light that goes out: what is left of it after so many frames\n\n| accumulation |");
  for (const int after : kAfter) {
    fmt::print(" {} |", after);
  }
  fmt::print("\n| --- |{}\n", " --- | --- | --- | --- | --- | --- |");
  for (const Variant& variant : make_variants()) {
    const Luminances frames = across_a_change(tracer, dark_tracer, bench, variant, filter, kFirst);
    const Luminances alone =
        render(dark_tracer, bench.plan(false, kFirst, kFirst + kAfter.back()), bench.settings_of({}, filter));
    double level = 0;
    for (const auto& frame : alone) {
      level += mean_of(frame) / static_cast<double>(alone.size());
    }
    fmt::print("| {} |", variant.name);
    for (const int after : kAfter) {
      fmt::print(" {:.1f} % |", 100 * (mean_of(frames[static_cast<std::size_t>(after)]) - level) / (9 * level));
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
}

// A board that stands before the camera is gone: where it was seen, and where its shadow or light was.
void body_is_gone(PathTracer& tracer, const Scene& scene, const Bench& bench, const Options& options,
                  const std::string& filter) {
  constexpr int kFirst = 33;
  Scene with_board = scene;
  Geometry board;
  for (const Vec3d& corner : {Vec3d{-2.5, -1.4, -0.7}, {-2.5, -1.4, 0.7}, {-2.5, 0.4, 0.7}, {-2.5, 0.4, -0.7}}) {
    board.positions.push_back(to_float(options.start + corner));
  }
  board.normals.assign(4, {1, 0, 0});
  board.triangles = {{0, 1, 2}, {0, 2, 3}};
  Material white;
  white.metallic = 0;
  white.base_color = {0.8F, 0.8F, 0.8F, 1};
  with_board.materials.push_back(white);
  board.material = static_cast<std::int32_t>(with_board.materials.size()) - 1;
  with_board.meshes.push_back({"board", {board}});
  with_board.instances.push_back({static_cast<std::int32_t>(with_board.meshes.size()) - 1, {}});
  PathTracer board_tracer(with_board, {});
  const FramePlan one = bench.plan(false, kFirst, kFirst);
  const SurfaceMotion seen =
      board_tracer.surface_motion(one.frames[0].camera, bench.width_px(), options.height_px, {one.frames[0].camera, 0});
  const auto board_object = static_cast<std::uint32_t>(with_board.instances.size());
  const auto truth = [&](PathTracer& of) {
    const auto a = render(of, one, bench.reference_settings(1001, true));
    const auto b = render(of, one, bench.reference_settings(2002, true));
    std::vector<float> mean = a[0];
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] = 0.5F * (mean[i] + b[0][i]);
    }
    return mean;
  };
  const std::vector<float> now = truth(tracer);
  const std::vector<float> then = truth(board_tracer);
  for (const bool uncovered : {true, false}) {
    // Of the rest only what the board changed by more than a fifth.
    std::vector<std::size_t> region;
    for (std::size_t i = 0; i < now.size(); ++i) {
      const bool on_board = seen.object.pixels[i] == board_object;
      const bool changed = std::fabs(then[i] - now[i]) > 0.2F * now[i];
      if (on_board == uncovered && (uncovered || changed)) {
        region.push_back(i);
      }
    }
    fmt::print(
        "\nA body that is gone, {} ({} pixels): what is left of the change after so many frames\n\n| accumulation |",
        uncovered ? "where it was" : "its shadow", region.size());
    for (const int after : kAfter) {
      fmt::print(" {} |", after);
    }
    fmt::print("\n| --- |{}\n", " --- | --- | --- | --- | --- | --- |");
    for (const Variant& variant : make_variants()) {
      const Luminances frames = across_a_change(board_tracer, tracer, bench, variant, filter, kFirst);
      fmt::print("| {} |", variant.name);
      for (const int after : kAfter) {
        // The part of the old picture in the new one, by least squares.
        double product = 0;
        double square = 0;
        for (const std::size_t i : region) {
          const double change = static_cast<double>(then[i] - now[i]);
          product +=
              (static_cast<double>(frames[static_cast<std::size_t>(after)][i]) - static_cast<double>(now[i])) * change;
          square += change * change;
        }
        fmt::print(" {:.1f} % |", 100 * product / square);
      }
      fmt::print("\n");
      std::fflush(stdout);
    }
  }
}

void seams(PathTracer& tracer, const Bench& bench, const std::string& filter) {
  constexpr int kLast = 60;
  const Variant variant = make_variants()[1];
  const Luminances whole = render(tracer, bench.plan(true, 1, kLast), bench.settings_of(variant.accumulate, filter));
  fmt::print(
      "\nA run that begins at frame {}, with frames rendered before it for their history\n\n"
      "| before | root mean square of the difference to one run, by the mean | the same of a frame's own noise |\n"
      "| --- | --- | --- |\n",
      kLast);
  const auto difference = [&](const std::vector<float>& a, const std::vector<float>& b) {
    double square = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      square += std::pow(static_cast<double>(a[i] - b[i]), 2) / static_cast<double>(a.size());
    }
    return 100 * std::sqrt(square) / mean_of(whole.back());
  };
  PipelineSettings other = bench.settings_of(variant.accumulate, filter);
  other.trace.seed = 77;
  const Luminances other_seed = render(tracer, bench.plan(true, 1, kLast), other);
  for (const int preroll : {0, 8, 16, 32, 48}) {
    PipelineSettings settings = bench.settings_of(variant.accumulate, filter);
    settings.preroll = preroll;
    const Luminances some = render(tracer, bench.plan(true, kLast - preroll, kLast), settings);
    fmt::print("| {} | {:.3f} % | {:.3f} % |\n", preroll, difference(some.back(), whole.back()),
               difference(other_seed.back(), whole.back()) / std::sqrt(2.0));
  }
}

int run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  Scene scene = load_scene(options.scene);
  scene.environment = load_environment(options.sky);
  PathTracer tracer(scene, {});
  const Bench bench(options);
  const auto wanted = [&](const char* part) { return options.only.empty() || options.only == part; };
  for (const std::string& filter : options.filters) {
    if (options.only != "sequences") {
      fmt::print("\n## {}\n", filter);
    }
    if (wanted("seams")) {
      seams(tracer, bench, filter);
    }
    if (wanted("light")) {
      light_goes_out(tracer, scene, bench, filter);
    }
    if (wanted("body")) {
      body_is_gone(tracer, scene, bench, options, filter);
    }
  }
  if (wanted("sequences")) {
    compare_sequences(tracer, bench, options);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
