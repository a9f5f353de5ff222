// SPDX-License-Identifier: Apache-2.0
// Frames in order, each to its files: what is skipped or done again, the row of timing.csv, the checkpoint. Only the
// history and the timing log outlive a frame.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/stopwatch.hpp"
#include "gazetrace/pipeline.hpp"
#include "output/aovs.hpp"
#include "output/written_file.hpp"
#include "pipeline/clip_rate.hpp"
#include "pipeline/file_journal.hpp"
#include "pipeline/frame_files.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/frame_window.hpp"
#include "pipeline/resume.hpp"
#include "pipeline/time_budget.hpp"
#include "pipeline/timing_log.hpp"
#include "pipeline/timing_row.hpp"
#include "pipeline/traced_file.hpp"

namespace gazetrace {
namespace {

// What a sequence traces in every frame: what its files show of first hits is summed over the samples.
FrameSettings frame_settings(const PipelineSettings& settings, const ColorPipeline& color) {
  FrameSettings frame = settings;
  frame.frames_per_second = static_cast<double>(settings.fps.numerator) / static_cast<double>(settings.fps.denominator);
  frame.display_curve = [&color](double exposure_ev) { return view_display_curve(color, {}, exposure_ev); };
  frame.trace.guides = frame.trace.guides || show_first_hits(settings.output.exr.aovs);
  if (!settings.output.exr.pattern.empty()) {
    frame.layers = layer_settings(settings.output.exr);
  }
  return frame;
}

void keep_bad_samples(const TraceStats& samples, SequenceResult& result) {
  result.bad_samples.insert(result.bad_samples.end(), samples.bad_samples.begin(), samples.bad_samples.end());
}

// Those that get rows of their own in timing.csv.
std::set<std::int32_t> rendered_frames(const FramePlan& plan, const ResumePlan& resume) {
  std::set<std::int32_t> frames;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    if (resume.work[i] == FrameWork::render) {
      frames.insert(plan.frames[i].frame);
    }
  }
  return frames;
}

// A part of the samples: their sums are all that becomes of the frame.
void render_samples(const FrameRenderer& renderer, const FrameRequest& request, const PipelineSettings& settings,
                    KnownLight& light, TimingRow& row, SequenceResult& result) {
  const TracedFrame traced = renderer.trace(request, light);
  add_samples(traced.sparse.stats, traced.first_look, traced.map, row);
  keep_bad_samples(traced.sparse.stats, result);
  add_times(traced.times, row);
  const Stopwatch watch;
  const std::string path = samples_file_name(settings.output.run_directory, request.frame, *settings.trace.samples);
  WrittenFile file = save_samples(path, traced.sparse.unrounded, settings.settings_digest);
  file.frame = request.frame;
  result.files.insert_or_assign(name_in_record(settings.output.run_directory, path), std::move(file));
  row.write_ms += watch.elapsed_ms();
}

// The first half of the stages: what was found is all that becomes of the frame until a run finishes it.
void trace_to_file(const FrameRenderer& renderer, const FrameRequest& request, const PipelineSettings& settings,
                   KnownLight& light, TimingRow& row, SequenceResult& result) {
  const TracedFrame traced = renderer.trace(request, light);
  add_samples(traced.sparse.stats, traced.first_look, traced.map, row);
  keep_bad_samples(traced.sparse.stats, result);
  add_times(traced.times, row);
  add_prediction(traced.prediction, row);
  const Stopwatch watch;
  const std::string path = traced_file_name(settings.output.run_directory, request.frame);
  result.files.insert_or_assign(name_in_record(settings.output.run_directory, path),
                                save_traced(path, request.frame, traced, settings.settings_digest));
  row.write_ms += watch.elapsed_ms();
}

// The second half. The row counts what tracing took, on whatever machine that was.
RenderedFrame finish_from_file(const FrameRenderer& renderer, const FrameRequest& request,
                               const PipelineSettings& settings, TemporalHistory& history, TimingRow& row) {
  TracedFrame traced = load_traced(traced_file_name(settings.output.run_directory, request.frame), request.frame,
                                   settings.settings_digest);
  if (traced.map.width_px != request.width_px || traced.map.height_px != request.height_px) {
    throw Error(ErrorKind::input, traced_file_name(settings.output.run_directory, request.frame),
                "holds a frame of another size", "trace it again");
  }
  row.total_ms += traced.times.plan_ms + traced.times.learn_ms + traced.times.pilot_ms + traced.times.trace_ms;
  return renderer.finish(request, std::move(traced), history);
}

// Found out before anything is rendered: one frame that is not there ends the sequence.
void check_traced_files(const FramePlan& plan, const PipelineSettings& settings, const ResumePlan& resume) {
  std::vector<std::int32_t> missing;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const std::int32_t frame = plan.frames[i].frame;
    if (resume.work[i] != FrameWork::skip &&
        read_traced_digest(traced_file_name(settings.output.run_directory, frame)) != settings.settings_digest) {
      missing.push_back(frame);
    }
  }
  if (!missing.empty()) {
    throw Error(ErrorKind::input, settings.output.run_directory,
                fmt::format("{} frames are not traced under these settings: {}", missing.size(),
                            bounded(format_frame_list(missing), 200)),
                "trace them with `stage` trace");
  }
}

RunPaths paths_of(const FramePlan& plan, const PipelineSettings& settings) {
  std::vector<std::int32_t> frames;
  for (std::size_t i = static_cast<std::size_t>(settings.preroll); i < plan.frames.size(); ++i) {
    frames.push_back(plan.frames[i].frame);
  }
  const std::vector<std::string> files = output_files(settings, frames);
  return files.empty() ? RunPaths() : RunPaths{files[0], files[1]};
}

// What is left when a sequence was stopped: the frames that were to be rendered and were not.
void list_what_is_left(const FramePlan& plan, const ResumePlan& resume, SequenceResult& result) {
  std::set<std::int32_t> made;
  for (const TimingRow& row : result.rows) {
    made.insert(row.frame);
  }
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    if (resume.work[i] == FrameWork::render && !made.contains(plan.frames[i].frame)) {
      result.left.push_back(plan.frames[i].frame);
    }
  }
}

bool is_same_file(const std::string& a, const std::string& b) {
  std::error_code missing;
  return !a.empty() && !b.empty() && std::filesystem::equivalent(a, b, missing);
}

// Of a history that an interrupted run has carried on beyond its own first frame, what that frame found is gone. Which
// frames had gone into it is known still, and that is enough where the run goes on behind them.
void take_back(std::int32_t first, TemporalHistory& history) {
  if (history.passed.empty() || history.passed.back() < first) {
    return;
  }
  std::vector<std::int32_t> before = std::move(history.passed);
  std::erase_if(before, [&](std::int32_t frame) { return frame >= first; });
  history = {};
  history.passed = std::move(before);
}

bool is_hollow(const TemporalHistory& history) {
  return !history.passed.empty() && history.radiance_sum.pixels.empty() && !history.smoothed_ev;
}

void refuse_hollow_history(const FramePlan& plan, const PipelineSettings& settings, const ResumePlan& resume,
                           const TemporalHistory& history) {
  const auto needed =
      std::find_if(resume.work.begin(), resume.work.end(), [](FrameWork work) { return work != FrameWork::skip; });
  if (needed == resume.work.end()) {
    return;
  }
  throw Error(
      ErrorKind::input, settings.resume_from,
      fmt::format("frame {} must be made again, and the history after frame {} is gone: this run's own "
                  "checkpoint has taken its place",
                  plan.frames[static_cast<std::size_t>(needed - resume.work.begin())].frame, history.passed.back()),
      "begin from an earlier checkpoint; different names for `checkpoint` and `resume-from` keep both");
}

bool checkpoint_is_due(const PipelineSettings& settings, std::size_t done, std::size_t total) {
  return done == total ||
         (settings.checkpoint_every > 0 && done % static_cast<std::size_t>(settings.checkpoint_every) == 0);
}

// The rate of the whole sequence, and what choosing it took: it is counted in the first row that is rendered.
class JudgedRate {
 public:
  void choose(PathTracer& tracer, const JudgedFrames& judged, const ColorPipeline& color, FrameSettings& settings) {
    rate_ = timed(ms_, [&] {
      return is_noise_alone(settings) && !judged.view_moves ? clip_rate(tracer, judged, settings, color)
                                                            : measured_rate(tracer, judged, settings, color);
    });
    settings.foveation.target = {};
    settings.foveation.budget_spp = rate_->spp;
    if (!rate_->rates.empty()) {
      settings.rates_of = [rates = rate_->rates](const FrameRequest&) { return FrameRates{rates, 0}; };
    }
  }
  [[nodiscard]] std::string text() const { return rate_->text(); }
  void warn(Warnings& warnings) const {
    for (std::string& doubt : rate_->doubts()) {
      warnings.push_back(std::move(doubt));
    }
  }
  void enter(TimingRow& row) {
    if (!rate_) {
      return;
    }
    add_prediction({{}, rate_->predicted_jod}, row);
    rate_->pilot.learning_paths = 0;  // whose time is in pilot_ms with all that the choice took
    add_pilot(rate_->pilot, row);
    row.pilot_ms += ms_;
    row.total_ms += ms_;
    rate_->pilot = {};
    ms_ = 0;
  }

 private:
  std::optional<ClipRate> rate_;
  double ms_ = 0;
};

}  // namespace

bool needs_history(const PipelineSettings& settings) {
  return settings.stage != SequenceStage::trace && uses_history(settings);
}

TemporalHistory starting_history(const FramePlan& plan, const PipelineSettings& settings, Warnings& warnings) {
  if (plan.frames.empty()) {
    return {};
  }
  const std::int32_t first = plan.frames.front().frame;
  if (settings.resume_from.empty()) {
    if (settings.is_part && first > 1 && settings.preroll == 0 && needs_history(settings)) {
      warnings.push_back(
          fmt::format("`part`: frame {} begins without the history of those before it; where the sequence begins "
                      "earlier, this part differs from one run: give `resume-from`, or `preroll`",
                      first));
    }
    return {};
  }
  if (settings.settings_digest.empty()) {
    throw Error(ErrorKind::usage, "`resume-from`", "no digest tells a history of these settings from others",
                "resolve the job, or set PipelineSettings::settings_digest");
  }
  TemporalHistory history = load_checkpoint(settings.resume_from, settings.settings_digest);
  if (settings.output.resume && is_same_file(settings.resume_from, settings.checkpoint)) {
    take_back(first, history);
  }
  const std::int32_t last = history.passed.empty() ? 0 : history.passed.back();
  if (last >= first) {
    throw Error(ErrorKind::usage, "`resume-from`",
                fmt::format("{} holds the history after frame {}, the run begins with frame {}", settings.resume_from,
                            last, first),
                fmt::format("begin with frame {}", last + 1));
  }
  if (last + 1 != first) {
    warnings.push_back(
        fmt::format("{} holds the history after frame {}, the run begins with frame {}: those between "
                    "are missing in it",
                    settings.resume_from, last, first));
  }
  return history;
}

SequenceResult render_sequence(PathTracer& tracer, const FramePlan& plan, const ColorPipeline& color,
                               const PipelineSettings& settings, const PipelineObserver& observer,
                               TemporalHistory history) {
  SequenceResult result;
  const RunPaths paths = paths_of(plan, settings);
  ResumePlan resume = plan_resume(plan, settings, paths, history);
  if (resume.taken_up) {
    history = std::move(*resume.taken_up);
  }
  result.warnings = resume.warnings;
  if (is_hollow(history)) {
    refuse_hollow_history(plan, settings, resume, history);
  }
  if (settings.stage == SequenceStage::finish) {
    check_traced_files(plan, settings, resume);
  }
  FrameSettings own = frame_settings(settings, color);
  JudgedRate judged;
  if ((own.foveation.target.jod || own.foveation.target.flip) &&
      std::any_of(resume.work.begin(), resume.work.end(), [](FrameWork work) { return work != FrameWork::skip; })) {
    try {
      if (observer.stop_before_frame && observer.stop_before_frame(0)) {
        result.interrupted = true;
      } else {
        judged.choose(tracer, plan.judged, color, own);
        result.facts.emplace_back("rate", judged.text());
        judged.warn(result.warnings);
      }
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::interrupted) {
        throw;
      }
      result.interrupted = true;
    }
  }
  const FrameRenderer renderer(tracer, own);
  std::optional<FrameWindow> window;
  if (settings.accumulate.mode == AccumulateMode::two_sided) {
    window.emplace(renderer, plan, rendered_frames(plan, resume));
  }
  std::optional<TimeBudget> time_budget;
  if (own.foveation.target.time_s) {
    time_budget.emplace(tracer, own, settings.output);
  }
  KnownLight light;
  TimingLog timing(paths.timing, resume.kept_rows);
  FileJournal journal(paths.record, resume.kept_files);
  if (!settings.output.display.pattern.empty() && !plan.frames.empty() && !settings.trace.samples) {
    const FrameRequest& first = plan.frames.front();
    color.prepare(first.width_px, first.height_px, display_image_bits(settings.output.display), settings.threads);
  }

  const auto render_one = [&](const FrameRequest& request) {
    if (time_budget) {
      // Budgets change nothing of what is learned.
      const FrameSettings within = time_budget->settings_for(request, history, light);
      return FrameRenderer(tracer, within).render(request, history, light);
    }
    return window ? window->render(request, history) : renderer.render(request, history, light);
  };
  // The frame's files and its row. Error(interrupted) leaves both as they were, and the history as well: a frame is
  // given up only while it is traced.
  const auto make_frame = [&](const FrameRequest& request, FrameWork work, TimingRow& row) {
    const Stopwatch total;
    RenderedFrame rendered;
    result.files.clear();
    if (settings.trace.samples) {
      render_samples(renderer, request, settings, light, row, result);
    } else if (settings.stage == SequenceStage::trace) {
      trace_to_file(renderer, request, settings, light, row, result);
    } else {
      const std::string behind = uses_history(settings) ? history_text(history.passed) : std::string();
      rendered = settings.stage == SequenceStage::finish ? finish_from_file(renderer, request, settings, history, row)
                                                         : render_one(request);
      add_samples(rendered.samples, rendered.first_look, rendered.map, row);
      add_others(rendered.others, row);
      keep_bad_samples(rendered.samples, result);
      add_times(rendered.times, row);
      add_prediction(rendered.prediction, row);
      if (work == FrameWork::render) {
        judged.enter(row);
      }
      row.exposure_ev = rendered.exposure_ev;
      if (observer.frame_ready) {
        observer.frame_ready(request, rendered.frame, rendered.exposure_ev);
      }
      if (work == FrameWork::render) {
        write_frame_files(request, plan, rendered, color, settings, behind, row, result);
      }
    }
    if (time_budget) {
      time_budget->learn(row);
    }
    row.total_ms += total.elapsed_ms();
    if (time_budget) {
      time_budget->check(row);
    }
    if (work == FrameWork::render) {
      journal.add(result.files);
      row.peak_memory_mib = peak_memory_mib();
      timing.add(row);
      result.rows.push_back(row);
    }
    return rendered;
  };

  bool checkpoint_is_old = false;  // frames have passed since it was written
  double made_ms = 0;
  int made = 0;
  for (std::size_t i = 0; i < plan.frames.size() && !result.interrupted; ++i) {
    const FrameRequest& request = plan.frames[i];
    const FrameWork work = resume.work[i];
    TimingRow row = timing_row(request);
    RenderedFrame rendered;
    if (work != FrameWork::skip) {
      if (observer.stop_before_frame && observer.stop_before_frame(made == 0 ? 0 : made_ms / made)) {
        result.interrupted = true;
        break;
      }
      if (observer.frame_begins) {
        observer.frame_begins(request);
      }
      const Stopwatch own_time;  // without the choice of the rate, which the first row counts
      try {
        rendered = make_frame(request, work, row);
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::interrupted) {
          throw;
        }
        result.interrupted = true;
        break;
      }
      made_ms += own_time.elapsed_ms();
      ++made;
      checkpoint_is_old = true;
    }
    if (resume.writes_checkpoint && checkpoint_is_old && checkpoint_is_due(settings, i + 1, plan.frames.size())) {
      save_checkpoint(settings.checkpoint, history, settings.settings_digest);
      checkpoint_is_old = false;
    }
    const bool skipped = work != FrameWork::render;
    if (skipped && i >= static_cast<std::size_t>(settings.preroll)) {
      result.skipped.push_back(request.frame);
    }
    if (observer.frame_done) {
      observer.frame_done(row, skipped);
    }
    if (observer.take_frame && !skipped && !rendered.frame.radiance.empty()) {
      observer.take_frame(request, std::move(rendered), row);
    }
  }
  if (result.interrupted) {
    if (resume.writes_checkpoint && checkpoint_is_old) {
      save_checkpoint(settings.checkpoint, history, settings.settings_digest);
    }
    list_what_is_left(plan, resume, result);
  }
  if (time_budget && !time_budget->warning().empty()) {
    result.warnings.push_back(time_budget->warning());
  }
  timing.finish();
  result.files = journal.files();
  return result;
}

}  // namespace gazetrace
