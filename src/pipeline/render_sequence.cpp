// SPDX-License-Identifier: Apache-2.0
// map -> trace -> guides, where the filter needs them -> reconstruct -> accumulate -> exposure -> colour -> files,
// frame by frame. Only the history and the timing log outlive a frame.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/pipeline.hpp"
#include "pipeline/contrast_prepass.hpp"
#include "pipeline/frame_files.hpp"
#include "pipeline/resume.hpp"
#include "pipeline/timing_log.hpp"

namespace gazetrace {
namespace {

void count_trace(const TraceStats& stats, const SamplingMap& map, TimingRow& row) {
  row.samples = stats.samples;
  row.rays_primary = stats.rays_primary;
  row.rays_bounce = stats.rays_bounce;
  row.rays_shadow = stats.rays_shadow;
  row.rejected_rays = stats.rejected_rays;
  row.non_finite_samples = stats.non_finite_samples;
  const std::vector<std::string>& names = timing_regions();
  for (std::size_t i = 0; i < map.regions.size(); ++i) {
    const auto name = std::find(names.begin(), names.end(), map.regions[i].name);
    if (name != names.end()) {
      const auto column = static_cast<std::size_t>(name - names.begin());
      row.region_pixels.at(column) += map.regions[i].pixels;
      row.region_samples.at(column) += stats.regions[i].samples;
      row.region_cpu_ms.at(column) += static_cast<double>(stats.regions[i].cpu_ns) * 1e-6;
    }
    row.trace_cpu_ms += static_cast<double>(stats.regions[i].cpu_ns) * 1e-6;
  }
}

// Samples of the first look belong to no region of the map.
void count_first_look(const TraceStats& stats, TimingRow& row) {
  row.samples += stats.samples;
  row.rays_primary += stats.rays_primary;
  row.rays_bounce += stats.rays_bounce;
  row.rays_shadow += stats.rays_shadow;
  row.rejected_rays += stats.rejected_rays;
  row.non_finite_samples += stats.non_finite_samples;
  for (const RegionTraceStats& region : stats.regions) {
    row.trace_cpu_ms += static_cast<double>(region.cpu_ns) * 1e-6;
  }
}

Frame plain_frame(const SparseFrame& sparse, const SamplingMap& map, const Guides* guides, const FrameRequest& request,
                  const PipelineSettings& settings, TemporalHistory& history, TimingRow& row) {
  Frame dense = timed(row.reconstruct_ms, [&] {
    return Reconstruction(settings.reconstruction).frame(sparse, map, guides, settings.threads);
  });
  return timed(row.temporal_ms,
               [&] { return accumulate(std::move(dense), request, settings.accumulate, history, settings.threads); });
}

Frame reprojected_frame(const PathTracer& tracer, const SparseFrame& sparse, const SamplingMap& map,
                        const Guides* guides, const FrameRequest& request, const PipelineSettings& settings,
                        TemporalHistory& history, TimingRow& row) {
  const Reconstruction reconstruction(settings.reconstruction);
  const bool before = settings.accumulate.order == AccumulateOrder::before && !reconstruction.needs().surfaces;
  const auto filtered = [&](const SparseFrame& sites, const Reconstruction& by) {
    return timed(row.reconstruct_ms, [&] { return by.frame(sites, map, guides, settings.threads); });
  };
  Frame dense = filtered(sparse, before ? Reconstruction({"none", {}}) : reconstruction);
  Frame merged = timed(row.temporal_ms, [&] {
    const EarlierView earlier{history.camera.value_or(request.camera),
                              history.camera ? history.t_video_ns : request.t_video_ns};
    const SurfaceMotion motion = tracer.surface_motion(request.camera, map.width_px, map.height_px, earlier);
    return reproject(std::move(dense), map, motion, request, settings.accumulate, history, settings.threads);
  });
  if (before) {
    merged = filtered(sites_of_frame(merged, sparse, map), reconstruction);
  }
  return merged;
}

struct TracedFrame {
  SamplingMap map;
  SparseFrame sparse;
};

TracedFrame trace_frame(PathTracer& tracer, const FrameRequest& request, const PipelineSettings& settings,
                        TimingRow& row, SequenceResult& result) {
  TracedFrame traced;
  MapContext context = map_context(request, settings.trace.seed, settings.threads);
  ContrastPrepass first_look;
  FoveationSettings foveation = settings.foveation;
  if (settings.foveation.contrast_strength > 0 && request.gaze_direction_render) {
    foveation = less_first_look(foveation, request);
    first_look = timed(row.trace_ms, [&] {
      tracer.move_to({request.shutter_open_ns, request.shutter_close_ns});
      return trace_contrast(tracer, request, settings.trace, settings.foveation.contrast_strength);
    });
    context.contrast = &first_look.multiplier;
  }
  traced.map = timed(
      row.plan_ms, [&] { return make_sampling_map(foveation, request.view, request.gaze_direction_render, context); });
  const TraceSettings trace = Reconstruction(settings.reconstruction).trace_settings(settings.trace);
  traced.sparse = timed(row.trace_ms, [&] {
    tracer.move_to({request.shutter_open_ns, request.shutter_close_ns});
    return tracer.trace(request.camera, request.frame, traced.map, trace);
  });
  const TraceStats& stats = traced.sparse.stats;
  count_trace(stats, traced.map, row);
  count_first_look(first_look.stats, row);
  result.bad_samples.insert(result.bad_samples.end(), stats.bad_samples.begin(), stats.bad_samples.end());
  return traced;
}

RenderedFrame render_frame(PathTracer& tracer, const FrameRequest& request, const PipelineSettings& settings,
                           TemporalHistory& history, TimingRow& row, SequenceResult& result) {
  TracedFrame traced = trace_frame(tracer, request, settings, row, result);
  std::optional<Guides> guides;
  if (const auto wanted = Reconstruction(settings.reconstruction).guide_settings(settings.trace)) {
    guides = timed(row.guides_ms,
                   [&] { return tracer.guides(request.camera, request.width_px, request.height_px, *wanted); });
  }
  const Guides* of_filter = guides ? &*guides : nullptr;
  RenderedFrame rendered;
  rendered.frame =
      settings.accumulate.mode == AccumulateMode::reproject
          ? reprojected_frame(tracer, traced.sparse, traced.map, of_filter, request, settings, history, row)
          : plain_frame(traced.sparse, traced.map, of_filter, request, settings, history, row);
  rendered.map = std::move(traced.map);
  history.passed.push_back(request.frame);
  expose(request, settings, history, rendered, row);
  return rendered;
}

// A part of the samples: their sums are all that becomes of the frame.
void render_samples(PathTracer& tracer, const FrameRequest& request, const PipelineSettings& settings, TimingRow& row,
                    SequenceResult& result) {
  const TracedFrame traced = trace_frame(tracer, request, settings, row, result);
  const Stopwatch watch;
  save_samples(samples_file_name(settings.output.run_directory, request.frame, *settings.trace.samples),
               traced.sparse.unrounded, settings.settings_digest);
  row.write_ms += watch.elapsed_ms();
}

std::string timing_path_of(const FramePlan& plan, const PipelineSettings& settings) {
  std::vector<std::int32_t> frames;
  for (std::size_t i = static_cast<std::size_t>(settings.preroll); i < plan.frames.size(); ++i) {
    frames.push_back(plan.frames[i].frame);
  }
  const std::vector<std::string> files = output_files(settings, frames);
  return files.empty() ? std::string() : files[1];
}

bool checkpoint_is_due(const PipelineSettings& settings, std::size_t done, std::size_t total) {
  return done == total ||
         (settings.checkpoint_every > 0 && done % static_cast<std::size_t>(settings.checkpoint_every) == 0);
}

}  // namespace

TemporalHistory starting_history(const FramePlan& plan, const PipelineSettings& settings, Warnings& warnings) {
  if (plan.frames.empty()) {
    return {};
  }
  const std::int32_t first = plan.frames.front().frame;
  if (settings.resume_from.empty()) {
    if (settings.is_part && first > 1 && settings.preroll == 0 && uses_history(settings)) {
      warnings.push_back(
          fmt::format("--part: frame {} begins without the history of those before it; where the sequence begins "
                      "earlier, this part differs from one run: give --resume-from, or --preroll",
                      first));
    }
    return {};
  }
  TemporalHistory history = load_checkpoint(settings.resume_from, settings.history_digest);
  const std::int32_t last = history.passed.empty() ? 0 : history.passed.back();
  if (last >= first) {
    throw Error(ErrorKind::usage, "--resume-from",
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
  const std::string timing_path = timing_path_of(plan, settings);
  const ResumePlan resume = plan_resume(plan, settings, timing_path, history);
  result.warnings = resume.warnings;
  TimingLog timing(timing_path, resume.kept_rows);
  if (!settings.output.display.pattern.empty() && !plan.frames.empty() && !settings.trace.samples) {
    const FrameRequest& first = plan.frames.front();
    color.prepare(first.width_px, first.height_px, display_image_bits(settings.output.display), settings.threads);
  }

  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const FrameRequest& request = plan.frames[i];
    TimingRow row;
    row.frame = request.frame;
    tell_gaze(request, row);
    row.pixels = static_cast<std::uint64_t>(request.width_px) * static_cast<std::uint64_t>(request.height_px);
    if (resume.work[i] != FrameWork::skip) {
      if (observer.frame_begins) {
        observer.frame_begins(request);
      }
      const Stopwatch total;
      if (settings.trace.samples) {
        render_samples(tracer, request, settings, row, result);
      } else {
        const RenderedFrame rendered = render_frame(tracer, request, settings, history, row, result);
        if (observer.frame_ready) {
          observer.frame_ready(request, rendered.frame, rendered.exposure_ev);
        }
        if (resume.work[i] == FrameWork::render) {
          write_frame_files(request, plan, rendered, color, settings, row, result);
        }
      }
      if (resume.work[i] == FrameWork::render) {
        row.total_ms = total.elapsed_ms();
        row.peak_memory_mib = peak_memory_mib();
        timing.add(row);
        result.rows.push_back(row);
      }
    }
    if (resume.writes_checkpoint && resume.work[i] != FrameWork::skip &&
        checkpoint_is_due(settings, i + 1, plan.frames.size())) {
      save_checkpoint(settings.checkpoint, history, settings.history_digest);
    }
    const bool skipped = resume.work[i] != FrameWork::render;
    if (skipped && i >= static_cast<std::size_t>(settings.preroll)) {
      result.skipped.push_back(request.frame);
    }
    if (observer.frame_done) {
      observer.frame_done(row, skipped);
    }
  }
  timing.finish();
  return result;
}

MapContext map_context(const FrameRequest& request, std::uint64_t seed, int threads) {
  MapContext context;
  context.seed = seed;
  context.frame = request.frame;
  context.uncertainty_deg = request.gaze_uncertainty_deg;
  context.gaze_speed_deg_s = request.eye_speed_deg_s;
  context.in_saccade = request.eye_in_saccade;
  context.threads = threads;
  return context;
}

}  // namespace gazetrace
