// SPDX-License-Identifier: Apache-2.0
// Adds up parts of the samples, and does with the sums what render_sequence() does after tracing.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string>
#include <vector>

#include "gazetrace/build_info.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/pipeline.hpp"
#include "gazetrace/sample_parts.hpp"
#include "output/aovs.hpp"
#include "pipeline/frame_files.hpp"
#include "pipeline/frame_stages.hpp"
#include "pipeline/timing_row.hpp"

namespace gazetrace {
namespace {

struct FramePart {
  const RunPart* run = nullptr;
  SampleRange range;
};

SampleRange range_of(const RunPart& part) {
  const std::string& text = part.record.samples;
  const char* end = text.data() + text.size();
  SampleRange range;
  const auto begin = std::from_chars(text.data(), end, range.begin);
  if (begin.ec != std::errc() || begin.ptr == end || *begin.ptr != ':' ||
      std::from_chars(begin.ptr + 1, end, range.end).ptr != end || range.begin >= range.end) {
    throw Error(ErrorKind::input, part.timing_path, "'" + text + "' in its run record is no range of samples",
                "render this part again");
  }
  return range;
}

// In the order of their samples.
std::vector<FramePart> parts_of_frame(const std::vector<RunPart>& parts, std::int32_t frame) {
  std::vector<FramePart> found;
  for (const RunPart& part : parts) {
    const std::vector<std::int32_t> frames = parse_frame_list(part.record.frames);
    if (std::find(frames.begin(), frames.end(), frame) != frames.end()) {
      found.push_back({&part, range_of(part)});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const FramePart& a, const FramePart& b) { return a.range.begin < b.range.begin; });
  return found;
}

std::uint32_t most_samples_of_a_site(const SamplingMap& map) {
  std::uint32_t most = 0;
  for (const Site& site : map.sites) {
    most = std::max(most, site.samples);
  }
  return most;
}

// Checks that every sample that a site has is there, and only once.
void check_ranges(const std::vector<FramePart>& parts, std::int32_t frame, std::uint32_t samples) {
  std::uint32_t done = 0;
  for (const FramePart& part : parts) {
    if (part.range.begin < done) {
      throw Error(ErrorKind::input, part.run->timing_path,
                  fmt::format("samples {}:{} of frame {} are in another part as well", part.range.begin,
                              std::min(done, part.range.end), frame),
                  "remove one of the parts");
    }
    if (part.range.begin > done) {
      break;
    }
    done = part.range.end;
  }
  if (done < samples) {
    const auto next = std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.range.begin > done; });
    const std::uint32_t until = next == parts.end() ? samples : std::min(next->range.begin, samples);
    throw Error(ErrorKind::input, "", fmt::format("samples {}:{} of frame {} are missing", done, until, frame),
                fmt::format("render them with `sample-range` {}:{}", done, until));
  }
}

SampleSums load_part(const FramePart& part, std::int32_t frame, const PipelineSettings& settings) {
  const std::string folder = std::filesystem::path(part.run->timing_path).parent_path().string();
  return load_samples(samples_file_name(folder, frame, part.range), settings.settings_digest);
}

SampleSums join_sums(const std::vector<FramePart>& parts, std::int32_t frame, const PipelineSettings& settings) {
  SampleSums sums = load_part(parts.front(), frame, settings);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    add_sums(load_part(parts[i], frame, settings), sums);
  }
  return sums;
}

TimingRow row_of(const std::vector<FramePart>& parts, const FrameRequest& request) {
  TimingRow row = timing_row(request);
  for (const FramePart& part : parts) {
    const auto traced = part.run->rows.find(request.frame);
    if (traced == part.run->rows.end()) {
      throw Error(ErrorKind::input, part.run->timing_path, fmt::format("frame {} is not in it", request.frame),
                  "finish this part with `resume`");
    }
    add_traced(traced->second, row);
  }
  return row;
}

}  // namespace

std::string needs_all_samples(const PipelineSettings& settings) {
  if (uses_history(settings)) {
    return "frames depend on those before them";
  }
  if (settings.accumulate.mode == AccumulateMode::two_sided) {
    return "frames read those around them";
  }
  const Reconstruction reconstruction(settings.reconstruction);
  if (reconstruction.needs().surfaces || reconstruction.needs().guides) {  // sums alone are what parts leave behind
    return fmt::format("the filter '{}' looks at every sample", reconstruction.filter().name);
  }
  if (layer_settings(settings.output.exr).any()) {
    return "some of the AOVs are found by rays of their own, and what joins the parts traces none";
  }
  if (settings.foveation.target.jod) {
    return "the rate needs a pilot of the sequence";
  }
  if (settings.foveation.contrast_strength > 0) {
    return "the sampling map needs a first look at the frame";
  }
  if (settings.foveation.falloff == "visible") {
    return "the sampling map needs a pilot of the frame";
  }
  if (settings.trace.only_pixel) {
    return "only one pixel is traced";
  }
  return {};
}

MergeResult merge_samples(const std::vector<RunPart>& parts, const FramePlan& plan, const ColorPipeline& color,
                          const PipelineSettings& settings) {
  const auto map_of = [&](const FrameRequest& request) {
    return planned_sampling_map(settings.foveation, request, settings.trace.seed, settings.threads);
  };
  std::vector<std::vector<FramePart>> found;
  std::vector<TimingRow> rows;
  std::vector<std::int32_t> frames;
  for (const FrameRequest& request : plan.frames) {
    found.push_back(parts_of_frame(parts, request.frame));
    check_ranges(found.back(), request.frame, most_samples_of_a_site(map_of(request)));
    rows.push_back(row_of(found.back(), request));
    frames.push_back(request.frame);
  }
  const Reconstruction reconstruction(settings.reconstruction);
  SequenceResult written;
  TemporalHistory none;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const FrameRequest& request = plan.frames[i];
    TimingRow& row = rows[i];
    const Stopwatch total;
    RenderedFrame rendered;
    rendered.map = timed(rendered.times.plan_ms, [&] { return map_of(request); });
    const SampleSums sums = join_sums(found[i], request.frame, settings);
    rendered.frame = timed(rendered.times.reconstruct_ms, [&] {
      return reconstruction.frame(sparse_frame_of(sums, rendered.map), rendered.map, nullptr, settings.threads);
    });
    expose(request, settings, none, rendered);
    row.exposure_ev = rendered.exposure_ev;
    add_times(rendered.times, row);
    write_frame_files(request, plan, rendered, color, settings, "", row, written);
    row.total_ms += total.elapsed_ms();
    row.peak_memory_mib = peak_memory_mib();
  }
  MergeResult result;
  for (const RunPart& part : parts) {
    result.parts.push_back(part.timing_path);
  }
  result.frames = format_frame_list(frames);
  if (written.clamped_half_values > 0) {
    result.warnings.push_back(
        fmt::format("{} values were clamped to the range of half floats", written.clamped_half_values));
  }
  if (written.clamped_view_pixels > 0) {
    result.warnings.push_back(
        fmt::format("{} pixels were clamped before the viewing transform", written.clamped_view_pixels));
  }
  RunRecord record = join_records(parts, result.frames, result.warnings);
  record.files = std::move(written.files);
  const RunFiles files = whole_run_files(settings.output);
  write_text_atomically(files.timing, timing_csv_text(rows));
  write_text_atomically(files.record, run_record_json(record));
  return result;
}

}  // namespace gazetrace
