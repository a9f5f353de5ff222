// SPDX-License-Identifier: Apache-2.0
#include "foveation_gain/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <utility>

#include "core/stopwatch.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze.hpp"
#include "gazetrace/output.hpp"
#include "support/sampling_models.hpp"

namespace gazetrace::gain {
namespace {

// Of an arm's samples: rivals share none, and neither do gazes, nor references with any (theirs are low numbers). Were
// there one uniform picture for all gazes, its noise would not show in how the gazes differ, and intervals would be too
// narrow. Models share theirs at a gaze.
enum class Seeds : int { models = 1, uniform, low_resolution, in_blocks, foveal_rate };
int seed_of(Seeds whose, int seed, std::size_t gaze) {
  return 1'000'000 * static_cast<int>(whose) + 1000 * seed + static_cast<int>(gaze);
}

using Settings = std::vector<std::pair<std::string, std::string>>;

// What is seen, from where.
Settings view_of(const StudySettings& settings) {
  Settings view{{"scene", settings.scene}};
  if (settings.viewpoint) {
    const auto& [eye, target, fov_deg] = *settings.viewpoint;
    view.emplace_back("viewpoint",
                      fmt::format("{} {} {} {} {} {} {}", eye.x, eye.y, eye.z, target.x, target.y, target.z, fov_deg));
  }
  return view;
}

// What else scores depend on, but for the program: references by their bytes, since files are made anew under old
// names.
Settings judgement_of(const StudySettings& settings) {
  Settings judgement = view_of(settings);
  for (const std::string& path : settings.reference) {
    std::ifstream file(path, std::ios::binary);
    judgement.emplace_back("reference", std::string(std::istreambuf_iterator<char>(file), {}));
  }
  for (const Gaze& gaze : settings.gazes) {
    judgement.emplace_back("gaze", fmt::format("{} {:.9g} {:.9g}", gaze.name, gaze.at.x, gaze.at.y));
  }
  for (const std::string& metric : settings.metrics) {
    judgement.emplace_back("metric", metric);
  }
  return judgement;
}

std::string short_digest(const Settings& settings) {
  return digest_settings(settings).substr(0, 12);
}

// Of stills nothing is said.
std::string clip_text(int frames) {
  return frames > 1 ? fmt::format(" clips of {} frames", frames) : std::string();
}

StageTimes stage_times(const Traced& traced, const Picture& picture) {
  return {traced.plan_ms, picture.guides_ms, traced.trace_ms, picture.reconstruct_ms, picture.temporal_ms};
}

class Study {
 public:
  explicit Study(const StudySettings& settings)
      : settings_(settings),
        world_(load(settings)),
        tracer_(world_.scene, {}),
        renderer_(tracer_, world_.camera, settings.size, settings.clip_frames),
        small_(tracer_, world_.camera, {(settings.size.width_px + 1) / 2, (settings.size.height_px + 1) / 2},
               settings.clip_frames),
        rows_(settings.csv) {
    for (const std::string& name : all_models()) {
      if (name != "uniform" && (settings_.models.empty() || std::find(settings_.models.begin(), settings_.models.end(),
                                                                      name) != settings_.models.end())) {
        models_.push_back(name);
      }
    }
    for (const std::string& filter : settings_.filters) {
      surfaces_ = surfaces_ || Reconstruction({filter}).needs().surfaces;
    }
  }

  void measure_errors();
  void measure_times();

 private:
  static benchmark::World load(const StudySettings& settings) {
    benchmark::World world = benchmark::load_world(settings.scene, settings.viewpoint);
    if (settings.viewpoint) {
      world.camera = benchmark::camera_at(*settings.viewpoint);
    }
    return world;
  }

  [[nodiscard]] Row row_of(const std::string& kind, const std::string& arm, const std::string& filter, int seed) const {
    Row row;
    row.kind = kind;
    row.scene = world_.name;
    row.arm = arm;
    row.filter = filter;
    row.seed = seed;
    return row;
  }
  // Scores an arm through every filter at these gazes, as far as the file lacks them. Its picture does not depend on
  // which of the gazes is scored.
  void arm(Judge& judge, Renderer& renderer, const std::string& name, int seed, const std::vector<std::size_t>& gazes,
           const std::function<Traced()>& trace);
  void errors_at(Judge& judge, int seed, std::size_t gaze);
  void errors_of_seed(Judge& judge, int seed);
  void times_of_round(int round, const std::vector<Gaze>& gazes);
  void time_arm(const std::string& name, const Gaze& gaze, const FoveationSettings& settings, int round);

  StudySettings settings_;
  benchmark::World world_;
  PathTracer tracer_;
  Renderer renderer_, small_;
  RowFile rows_;
  std::vector<std::string> models_;
  bool surfaces_ = false;
};

void Study::arm(Judge& judge, Renderer& renderer, const std::string& name, int seed,
                const std::vector<std::size_t>& gazes, const std::function<Traced()>& trace) {
  std::optional<Traced> traced;
  std::string note;
  const Stopwatch watch;
  double score_ms = 0;
  for (const std::string& filter : settings_.filters) {
    std::vector<std::pair<std::size_t, Row>> missing;
    for (const std::size_t g : gazes) {
      Row row = row_of("score", name, filter, seed);
      row.gaze = settings_.gazes[g].name;
      row.u = settings_.gazes[g].at.x;
      row.v = settings_.gazes[g].at.y;
      if (!rows_.has(row)) {
        missing.emplace_back(g, std::move(row));
      }
    }
    if (missing.empty()) {
      continue;
    }
    if (!traced) {
      traced = trace();
      note = fmt::format("{:.4f} spp, trace {:.0f} ms", traced->spp(), traced->trace_ms);
    }
    Picture picture = renderer.filtered(*traced, filter);
    note += fmt::format(", {} {:.0f} ms", filter, picture.reconstruct_ms);
    if (picture.light.width_px != settings_.size.width_px) {
      picture.light = enlarged(picture.light, settings_.size.width_px, settings_.size.height_px);
    }
    note += fmt::format(" mean {:.4f}", judge.mean_ratio(picture.light));
    const Stopwatch scoring;
    const ScoreMaps maps = judge.maps_of(picture.light);
    for (auto& [g, row] : missing) {
      judge.score(maps, g, row);
      row.spp = traced->spp();
      row.time = stage_times(*traced, picture);
      rows_.add(row);
    }
    score_ms += scoring.elapsed_ms();
  }
  if (traced) {
    fmt::print("{} seed {}{}, {}: {}, scores {:.0f} ms, all {:.0f} ms\n", world_.name, seed,
               gazes.size() == 1 ? ", " + settings_.gazes[gazes[0]].name : std::string(), name, note, score_ms,
               watch.elapsed_ms());
    std::fflush(stdout);
  }
}

void Study::errors_at(Judge& judge, int seed, std::size_t g) {
  const Gaze& gaze = settings_.gazes[g];
  const Gaze ahead{"", {0.5, 0.5}};
  const double budget = settings_.spp;
  const double pixels = static_cast<double>(settings_.size.width_px) * settings_.size.height_px;
  const double small_pixels = static_cast<double>(small_.view().width_px) * small_.view().height_px;
  for (const double rate : kUniformRates) {
    arm(judge, renderer_, uniform_arm(rate), seed, {g}, [&] {
      return renderer_.trace(uniform_settings(rate * budget), std::nullopt, seed_of(Seeds::uniform, seed, g),
                             surfaces_);
    });
  }
  arm(judge, small_, kLowResolution, seed, {g}, [&] {
    return small_.trace(uniform_settings(budget * pixels / small_pixels), std::nullopt,
                        seed_of(Seeds::low_resolution, seed, g), surfaces_);
  });
  arm(judge, renderer_, kInBlocks, seed, {g}, [&] {  // the same wherever one looks
    return renderer_.trace(blocks_settings(budget), ahead, seed_of(Seeds::in_blocks, seed, g), surfaces_);
  });
  for (const std::string& model : models_) {
    arm(judge, renderer_, model, seed, {g}, [&] {
      return renderer_.trace(model_settings(model, budget), gaze, seed_of(Seeds::models, seed, g), surfaces_);
    });
  }
  arm(judge, renderer_, kPaper, seed, {g},
      [&] { return renderer_.trace(paper_settings(), gaze, seed_of(Seeds::models, seed, g), surfaces_); });
}

void Study::errors_of_seed(Judge& judge, int seed) {
  std::vector<std::size_t> all(settings_.gazes.size());
  for (std::size_t g = 0; g < all.size(); ++g) {
    all[g] = g;
    errors_at(judge, seed, g);
  }
  // One for all gazes: only foveae are looked at, which hardly ever share a pixel.
  arm(judge, renderer_, kFovealRate, seed, all, [&] {
    return renderer_.trace(uniform_settings(std::get<RegionSampling>(paper_settings().sampling).samples[0]),
                           std::nullopt, seed_of(Seeds::foveal_rate, seed, 0), surfaces_);
  });
}

void Study::measure_errors() {
  Judge judge(settings_.reference, renderer_.view(), settings_.ev, settings_.gazes, settings_.metrics);
  const std::string setup = fmt::format("{}x{}{} budget {} ev {} references {} inputs {}", settings_.size.width_px,
                                        settings_.size.height_px, clip_text(settings_.clip_frames), settings_.spp,
                                        judge.ev(), settings_.reference.size(), short_digest(judgement_of(settings_)));
  fmt::print("{}: {}, {:.2f} pixels per degree\n", world_.name, setup, judge.pixels_per_degree());
  rows_.claim("setup", world_.name, setup);
  for (Row& row : judge.floor()) {
    row.scene = world_.name;
    if (!rows_.has(row)) {
      rows_.add(row);
    }
  }
  for (int seed = 1; seed <= settings_.seeds; ++seed) {
    errors_of_seed(judge, seed);
  }
}

void Study::time_arm(const std::string& name, const Gaze& gaze, const FoveationSettings& settings, int round) {
  std::optional<Gaze> steering;
  if (gaze.name != kAnyGaze) {
    steering = gaze;
  }
  std::optional<Traced> traced[2];  // without and with sums per surface: a filter pays for what it needs
  for (const std::string& filter : settings_.filters) {
    Row row = row_of("time", name, filter, round);
    row.gaze = gaze.name;
    row.u = gaze.at.x;
    row.v = gaze.at.y;
    if (rows_.has(row)) {
      continue;
    }
    const bool surfaces = Reconstruction({filter}).needs().surfaces;
    std::optional<Traced>& of_filter = traced[surfaces ? 1 : 0];
    if (!of_filter) {
      of_filter = renderer_.trace(settings, steering, round, surfaces);
    }
    const Picture picture = renderer_.filtered(*of_filter, filter);
    row.spp = of_filter->spp();
    row.time = stage_times(*of_filter, picture);
    rows_.add(row);
  }
}

void Study::times_of_round(int round, const std::vector<Gaze>& gazes) {
  renderer_.forget_first_hits();
  for (const double rate : kUniformRates) {
    time_arm(uniform_arm(rate), {kAnyGaze, {0.5, 0.5}}, uniform_settings(rate * settings_.spp), round);
  }
  for (const Gaze& gaze : gazes) {
    for (const std::string& model : models_) {
      time_arm(model, gaze, model_settings(model, settings_.spp), round);
    }
  }
}

void Study::measure_times() {
  std::vector<Gaze> gazes;
  for (const Gaze& gaze : settings_.gazes) {
    if (gaze.name == "centre" || gaze.name == "corner") {
      gazes.push_back(gaze);
    }
  }
  if (gazes.empty()) {
    gazes.push_back(settings_.gazes.front());
  }
  rows_.claim("timed", world_.name,
              fmt::format("{}x{}{} budget {} inputs {}", settings_.size.width_px, settings_.size.height_px,
                          clip_text(settings_.clip_frames), settings_.spp, short_digest(view_of(settings_))));
  // Memory that the first frame asks the system for is there afterwards.
  renderer_.filtered(renderer_.trace(uniform_settings(settings_.spp), std::nullopt, 0, surfaces_),
                     settings_.filters.back());
  for (int round = 1; round <= settings_.time_rounds; ++round) {
    const Stopwatch watch;
    times_of_round(round, gazes);
    fmt::print("{}: times, round {}: {:.1f} s\n", world_.name, round, watch.elapsed_ms() * 1e-3);
    std::fflush(stdout);
  }
}

}  // namespace

std::string uniform_arm(double rate) {
  return fmt::format("uniform {}", rate);
}

std::vector<Gaze> gaze_grid() {
  const DisplayGeometry display = display_by_name("paper");
  constexpr double kRightDeg = 10;
  const double right = display.distance_cm * std::tan(kRightDeg * kRadPerDeg) / display.width_cm;
  return {{"centre", {0.5, 0.5}}, {"right", {0.5 + right, 0.5}}, {"edge", {0.98, 0.5}}, {"corner", {0.02, 0.97}}};
}

std::vector<Gaze> drawn_fixations(const std::string& text) {
  const std::size_t second = text.find_last_of(':');
  const std::size_t first = second == std::string::npos || second == 0 ? second : text.find_last_of(':', second - 1);
  if (first == std::string::npos || second == first) {
    throw Error(ErrorKind::usage, "--fixations", text + " is not understood", "write LOG.csv:COUNT:SEED");
  }
  const std::string path = text.substr(0, first);
  const std::size_t count = std::strtoul(&text[first + 1], nullptr, 10);
  std::mt19937_64 random(std::strtoull(&text[second + 1], nullptr, 10));
  const GazeLog log = load_gaze_log(path, {});
  std::vector<Vec2d> places;
  for (const EyeEvent& event : detect_events(log, default_event_preset(log)).events) {
    if (event.movement == EyeMovement::fixation && event.u >= 0 && event.u <= 1 && event.v >= 0 && event.v <= 1) {
      places.push_back({event.u, event.v});
    }
  }
  if (places.size() < count) {
    throw Error(ErrorKind::input, path, fmt::format("has {} fixations on its display", places.size()),
                "draw no more than that");
  }
  std::vector<Gaze> gazes;
  for (std::size_t i = 0; i < count; ++i) {  // the same everywhere, as a library's shuffle is not
    std::swap(places[i], places[i + random() % (places.size() - i)]);
    gazes.push_back({fmt::format("fixation {}", i + 1), places[i]});
  }
  return gazes;
}

void run_study(const StudySettings& settings) {
  Study study(settings);
  settings.time_rounds > 0 ? study.measure_times() : study.measure_errors();
}

}  // namespace gazetrace::gain
