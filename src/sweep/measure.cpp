// SPDX-License-Identifier: Apache-2.0
#include "sweep/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/stopwatch.hpp"
#include "gazetrace/build_info.hpp"
#include "sweep/pictures.hpp"
#include "sweep/scorer.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// The high-water mark of resident memory, and resetting it (Linux, proc(5)).
void restart_peak_memory() {
  std::ofstream("/proc/self/clear_refs") << "5";
}
// A program that keeps freed memory would otherwise count what earlier rows, scenes and references have used as this
// row's.
void give_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}
double peak_memory_since_mib() {
  constexpr double kKibPerMib = 1024;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (double kib = 0; word == "VmHWM:" && status >> kib) {
      return kib / kKibPerMib;
    }
  }
  return peak_memory_mib();
}

double render_ms(const TimingRow& row) {
  return row.plan_ms + row.guiding_ms + row.pilot_ms + row.trace_ms + row.guides_ms + row.reconstruct_ms +
         row.temporal_ms;
}

// Adds up the timing of the frames of one run; the scores are added later.
class RunSum {
 public:
  void add(const TimingRow& row, double upscale_ms) {
    run_.samples += static_cast<double>(row.samples);
    run_.rays += static_cast<double>(row.rays_primary + row.rays_bounce + row.rays_shadow);
    run_.pixels += static_cast<double>(row.pixels);
    run_.lost_samples += static_cast<double>(row.rejected_rays + row.non_finite_samples);
    run_.trace_reconstruct_ms += row.guiding_ms + row.pilot_ms + row.trace_ms + row.guides_ms + row.reconstruct_ms;
    stored_.trace_ms += row.trace_ms;
    stored_.trace_cpu_ms += row.trace_cpu_ms;
    const std::vector<std::string>& regions = timing_regions();
    for (std::size_t r = 0; r < regions.size(); ++r) {
      if (row.region_samples.at(r) > 0) {
        run_.region_samples[regions[r]] += static_cast<double>(row.region_samples.at(r));
        stored_.region_cpu_ms[regions[r]] += row.region_cpu_ms.at(r);
      }
    }
    run_.frames.push_back({(render_ms(row) + upscale_ms) * 1e-3, {}});
  }
  void add_output(double ms) { output_ms_ += ms; }
  void peak_of_frame(double mib) { run_.peak_mib = std::max(run_.peak_mib, mib); }
  [[nodiscard]] SweepRun run() const {
    SweepRun run = run_;
    for (const SweepFrameRun& frame : run.frames) {
      run.time_s += frame.time_s / static_cast<double>(run.frames.size());
    }
    if (output_ms_ > 0) {
      run.output_s = output_ms_ * 1e-3 / static_cast<double>(run.frames.size());
    }
    return run;
  }
  [[nodiscard]] const StoredRun& stored() const { return stored_; }

 private:
  SweepRun run_;
  StoredRun stored_;
  double output_ms_ = 0;
};

PipelineSettings settings_of(const PlannedRow& row, int repeat) {
  PipelineSettings settings = row.pipeline;
  settings.trace.seed += static_cast<std::uint64_t>(repeat);
  settings.output = {};
  return settings;
}

// One scorer for each gaze among these rows.
struct GazeScorer {
  std::string gaze;
  Scorer scorer;
};
std::vector<GazeScorer> scorers_of(const std::vector<const PlannedRow*>& rows, const SweepMeasure& measure,
                                   const FramePlan& full_size, const ImageRgb& first_reference, bool want_maps) {
  std::vector<GazeScorer> scorers;
  for (const PlannedRow* row : rows) {
    const auto same = [&](const GazeScorer& one) { return one.gaze == row->row.gaze; };
    if (std::any_of(scorers.begin(), scorers.end(), same)) {
      continue;
    }
    ComparisonSettings settings = comparison_of(measure.comparison, full_size, row->row.frames, row->pipeline.fps);
    settings.want_maps = want_maps && scorers.empty();
    const auto& metrics = settings.metrics;
    if (std::find(metrics.begin(), metrics.end(), "hdr_flip") != metrics.end()) {
      // All rows are scored at the same exposures: otherwise their scores would not be comparable.
      const FlipExposures exposures = flip_exposures(first_reference, settings.metric.hdr_flip);
      settings.metric.hdr_flip.start_ev = exposures.start_ev;
      settings.metric.hdr_flip.stop_ev = exposures.stop_ev;
      settings.metric.hdr_flip.count = exposures.count;
    }
    scorers.push_back({row->row.gaze, Scorer(settings, row->row.frames, row->size.width_px, row->size.height_px)});
  }
  return scorers;
}

FrameHeader header_of(const FrameRequest& request, double ev) {
  FrameHeader header;
  header.frame = request.frame;
  header.t_video_ns = request.t_video_ns;
  header.exposure_ev = ev;
  header.gaze_true = request.gaze_true;
  header.gaze_render = request.gaze_render;
  return header;
}

// Into a folder within the sweep's own.
struct PictureFolder {
  const std::string& sweep;
  const std::string& name;

  [[nodiscard]] std::string file(const char* pattern, std::int32_t frame) const {
    return frame_file_name(name + "/" + pattern, frame);
  }
};

void write_pictures(const SweepMeasure& measure, const PictureFolder& folder, const FrameRequest& request,
                    const MetricPicture& picture, double ev, WrittenFiles& written) {
  const FrameHeader header = header_of(request, ev);
  if (measure.write_png) {
    const std::string name = folder.file("frame.####.png", request.frame);
    written[name] = write_display_image(folder.sweep + "/" + name, display_image_of(picture.code), header, {});
  }
  if (measure.write_exr) {
    Frame frame;
    frame.radiance = picture.light;
    const std::string name = folder.file("frame.####.exr", request.frame);
    written[name] = write_frame_exr(folder.sweep + "/" + name, frame, nullptr, header, {}).file;
  }
}

[[noreturn]] void interrupted() {
  throw Error(ErrorKind::interrupted, "", "asked to end before all was measured", "call again to go on");
}

}  // namespace

void render_or_stop(PathTracer& tracer, const FramePlan& plan, const ColorPipeline& color, PipelineSettings settings,
                    PipelineObserver pipeline, const SweepObserver& observer) {
  settings.trace.stop = observer.stop_now;
  pipeline.stop_before_frame = observer.stop_before_frame;
  if (render_sequence(tracer, plan, color, settings, pipeline).interrupted) {
    interrupted();
  }
}

void stop_if_asked(const SweepObserver& observer) {
  if (observer.stop_before_frame && observer.stop_before_frame(0)) {
    interrupted();
  }
}

StoredRun measure_rows(const MeasuredScene& scene, const std::vector<const PlannedRow*>& rows, int repeat,
                       const SweepMeasure& measure, const std::string& directory, const std::string& folder) {
  const PlannedRow& first = *rows.front();
  const PipelineSettings settings = settings_of(first, repeat);
  const bool write = repeat == 0 && (measure.write_png || measure.write_exr);
  if (write) {
    fs::create_directories(fs::path(directory) / folder);
  }
  give_back_freed_memory();
  RunSum sum;
  WrittenFiles written;
  std::vector<GazeScorer> scorers;
  std::vector<std::vector<ScoreTable>> frame_scores;
  double upscale_ms = 0;
  PipelineObserver observer;
  observer.frame_begins = [](const FrameRequest&) { restart_peak_memory(); };
  observer.frame_ready = [&](const FrameRequest& request, const Frame& frame, double) {
    sum.peak_of_frame(peak_memory_since_mib());
    ImageRgb light;
    upscale_ms = 0;
    if (frame.radiance.width_px != first.size.width_px || frame.radiance.height_px != first.size.height_px) {
      const Stopwatch watch;
      light = upscaled(frame.radiance, first.size.width_px, first.size.height_px, settings.threads);
      upscale_ms = watch.elapsed_ms();
    } else {
      light = frame.radiance;
    }
    const double ev = scene.reference.ev.at(request.frame);
    const Stopwatch view_watch;
    const MetricPicture test = metric_picture(std::move(light), scene.color, ev, settings.threads);
    if (write) {
      sum.add_output(view_watch.elapsed_ms());
    }
    const MetricPicture reference =
        metric_picture(read_exr_rgb(scene.reference.mean_path(request.frame)), scene.color, ev, settings.threads);
    if (scorers.empty()) {
      // Scores are taken at full size, whatever the size at which the row was rendered.
      scorers = scorers_of(rows, measure, resized(first.plan, first.size), reference.light, write);
      frame_scores.resize(scorers.size());
    }
    for (std::size_t s = 0; s < scorers.size(); ++s) {
      frame_scores[s].push_back(scorers[s].scorer.add(reference, test));
    }
    if (write) {
      const PictureFolder place{directory, folder};
      const Stopwatch file_watch;
      write_pictures(measure, place, request, test, ev, written);
      sum.add_output(file_watch.elapsed_ms());
      const ImageGray* const flip = scorers.front().scorer.map_of("flip");
      if (measure.write_png && flip != nullptr) {
        const std::string name = place.file("flip.####.png", request.frame);
        written[name] =
            write_display_image(directory + "/" + name, error_map_picture("flip", *flip), header_of(request, ev), {});
      }
    }
  };
  observer.frame_done = [&](const TimingRow& row, bool) {
    sum.add(row, upscale_ms);
    if (write) {
      sum.add_output(row.exposure_ms);
    }
  };
  render_or_stop(scene.tracer, first.plan, scene.color, settings, observer, scene.observer);

  StoredRun stored = sum.stored();
  stored.png = write && measure.write_png ? folder + "/frame.####.png" : "";
  stored.files = std::move(written);
  for (std::size_t s = 0; s < scorers.size(); ++s) {
    SweepRun run = sum.run();
    run.scores = scorers[s].scorer.over_scored_frames();
    for (std::size_t f = 0; f < run.frames.size(); ++f) {
      run.frames[f].scores = frame_scores[s][f];
    }
    stored.by_gaze[scorers[s].gaze] = std::move(run);
  }
  return stored;
}

StoredRun time_row(PathTracer& tracer, const ColorPipeline& color, const PlannedRow& row, int repeat,
                   const SweepObserver& sweep, std::size_t frames) {
  FramePlan plan = row.plan;
  if (frames > 0 && frames < plan.frames.size()) {
    plan.frames.resize(frames);
  }
  RunSum sum;
  PipelineObserver observer;
  observer.frame_done = [&](const TimingRow& timing, bool) { sum.add(timing, 0); };
  render_or_stop(tracer, plan, color, settings_of(row, repeat), observer, sweep);
  StoredRun stored = sum.stored();
  stored.by_gaze[row.row.gaze] = sum.run();
  return stored;
}

RateSearch find_rate(double target_s, const std::vector<std::pair<double, double>>& known, double least_spp,
                     double most_spp, const std::function<double(double spp)>& time_s) {
  RateSearch search;
  std::vector<std::pair<double, double>> points = known;
  const auto error_of = [&](const auto& point) { return std::fabs(std::log(point.second / target_s)); };
  const auto nearer = [&](const auto& a, const auto& b) { return error_of(a) < error_of(b); };
  const auto next_guess = [&] {
    // The nearest point below the target, and the nearest above.
    const std::pair<double, double>* below = nullptr;
    const std::pair<double, double>* above = nullptr;
    for (const auto& point : points) {
      if (point.second <= target_s && (below == nullptr || point.second > below->second)) {
        below = &point;
      }
      if (point.second > target_s && (above == nullptr || point.second < above->second)) {
        above = &point;
      }
    }
    double spp = 1;
    if (below != nullptr && above != nullptr) {
      spp = below->first + (above->first - below->first) * (target_s - below->second) / (above->second - below->second);
    } else if (below != nullptr || above != nullptr) {
      const auto& one = below != nullptr ? *below : *above;
      spp = one.first * std::clamp(target_s / one.second, 0.25, 4.0);
    }
    return std::clamp(spp, least_spp, most_spp);
  };
  for (int step = 0; step < kRateTries; ++step) {
    if (!points.empty() && error_of(*std::min_element(points.begin(), points.end(), nearer)) <= kRateTolerance) {
      break;
    }
    const double spp = next_guess();
    if (std::any_of(points.begin(), points.end(), [&](const auto& point) { return point.first == spp; })) {
      break;  // at a bound that has been tried before
    }
    search.tried.emplace_back(spp, time_s(spp));
    points.push_back(search.tried.back());
  }
  search.spp = std::min_element(points.begin(), points.end(), nearer)->first;
  return search;
}

std::string scoring_digest(const SweepMeasure& measure, const std::vector<ResultFrame>& frames) {
  const ComparisonSettings& c = measure.comparison;
  const auto optional = [](const auto& value) { return value ? fmt::format("{}", *value) : std::string("auto"); };
  NamedValues parts{{"metrics", fmt::format("{}", fmt::join(c.metrics, ","))},
                    {"response", std::to_string(static_cast<int>(c.metric.response))},
                    {"relmse epsilon", fmt::format("{}", c.metric.relmse_epsilon)},
                    {"flip tone mapper", std::to_string(static_cast<int>(c.metric.hdr_flip.tone_mapper))},
                    {"flip start", optional(c.metric.hdr_flip.start_ev)},
                    {"flip stop", optional(c.metric.hdr_flip.stop_ev)},
                    {"flip count", optional(c.metric.hdr_flip.count)},
                    {"photometry", fmt::format("{} {} {} {}", c.photometry.peak_cd_m2, c.photometry.contrast,
                                               c.photometry.ambient_lux, c.photometry.reflectivity)},
                    {"original border", c.original_border ? "yes" : "no"},
                    {"pictures", fmt::format("{} {}", measure.write_png, measure.write_exr)}};
  for (const ResultFrame& frame : frames) {
    parts.emplace_back(
        std::to_string(frame.index),
        frame.gaze_px ? fmt::format("{} {} {}", frame.event, frame.gaze_px->x, frame.gaze_px->y) : frame.event);
  }
  return digest_settings(parts);
}

}  // namespace gazetrace
