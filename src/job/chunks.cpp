// SPDX-License-Identifier: Apache-2.0
#include "job/chunks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <numeric>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "core/atomic_file.hpp"
#include "gazetrace/error.hpp"
#include "job/outputs.hpp"

namespace gazetrace {
namespace {

// A frame costs about as much as so many samples a pixel even where it has fewer: first hits, filter, view and files.
constexpr double kSamplesOfAPixel = 1;

// Maps of more frames than this are not made: every n-th stands for those after it.
constexpr std::size_t kMostMaps = 240;

std::vector<std::int32_t> numbers_of(const FramePlan& plan) {
  std::vector<std::int32_t> frames;
  for (const FrameRequest& request : plan.frames) {
    frames.push_back(request.frame);
  }
  return frames;
}

// Samples that a pilot or a target decides are not known before the frame is rendered.
bool samples_are_known(const FoveationSettings& foveation) {
  return !looks_first(foveation.sampling) && !foveation.target.is_given();
}

FrameChunk chunk_of(const std::vector<std::int32_t>& frames, const std::vector<double>& samples, std::size_t begin,
                    std::size_t end) {
  const auto at = [](const auto& list, std::size_t i) { return list.begin() + static_cast<std::ptrdiff_t>(i); };
  return {{at(frames, begin), at(frames, end)}, std::accumulate(at(samples, begin), at(samples, end), 0.0)};
}

struct FrameCosts {
  std::vector<double> samples;  // 0 where they are not known
  std::vector<double> costs;
};

FrameCosts predict(const JobSettings& job, const FramePlan& plan) {
  FrameCosts predicted{std::vector<double>(plan.frames.size(), 0), std::vector<double>(plan.frames.size(), 1)};
  if (!samples_are_known(job.foveation)) {
    return predicted;
  }
  const std::size_t step = plan.frames.size() / kMostMaps + 1;
  double samples = 0;
  for (std::size_t i = 0; i < plan.frames.size(); ++i) {
    const FrameRequest& request = plan.frames[i];
    if (i % step == 0) {
      samples =
          static_cast<double>(planned_sampling_map(job.foveation, request, job.trace.seed, job.threads).samples());
    }
    predicted.samples[i] = samples;
    predicted.costs[i] = samples + kSamplesOfAPixel * request.width_px * request.height_px;
  }
  return predicted;
}

// The border before chunk k is where the frames before it come nearest to k / count of the whole cost; no chunk is
// empty while there are frames for all.
std::vector<FrameChunk> balanced(const std::vector<std::int32_t>& frames, const FrameCosts& predicted,
                                 std::uint32_t count) {
  const std::vector<double>& costs = predicted.costs;
  const double whole = std::accumulate(costs.begin(), costs.end(), 0.0);
  std::vector<FrameChunk> chunks;
  std::size_t begin = 0;
  double before = 0;
  for (std::size_t k = 1; k <= count; ++k) {
    const double wanted = whole * static_cast<double>(k) / count;
    const std::size_t later = count - k;
    std::size_t end = begin;
    while (end < frames.size() &&
           (end == begin || k == count || (before + costs[end] / 2 <= wanted && frames.size() - end > later))) {
      before += costs[end++];
    }
    chunks.push_back(chunk_of(frames, predicted.samples, begin, end));
    begin = end;
  }
  return chunks;
}

std::string digest_of_borders(const JobSettings& job, const std::vector<std::int32_t>& frames) {
  std::vector<std::pair<std::string, std::string>> parts{{"frames", format_frame_list(frames)},
                                                         {"division", std::to_string(job.chunk->count)}};
  for (const OptionOf<JobSettings>& option : job_schema().options()) {
    if (option.decides != Decides::nothing) {
      parts.emplace_back(option.name, fmt::format("{}", fmt::join(option.values(job), "\n")));
    }
  }
  return digest_settings(parts);
}

// The name holds a digest, so that another job in the folder has a file of its own, and none is ever replaced.
std::string borders_path(const JobSettings& job, const std::string& digest) {
  const std::string run = output_settings(job).run_name;
  return run.empty() ? std::string()
                     : (std::filesystem::path(folder_of_run(run)) /
                        fmt::format("chunks.{}.{}.json", job.chunk->count, digest.substr(0, 8)))
                           .string();
}

std::vector<FrameChunk> chunks_in(const ChunkFile& file) {
  std::vector<FrameChunk> chunks;
  for (std::size_t i = 0; i < file.chunks.size(); ++i) {
    const std::string& list = file.chunks[i];
    chunks.push_back({list.empty() ? std::vector<std::int32_t>() : parse_frame_list(list), file.samples.at(i)});
  }
  return chunks;
}

// What an earlier task wrote; nothing where there is no such file, or a damaged one.
std::optional<std::vector<FrameChunk>> written_chunks(const std::string& path, const std::string& digest) {
  std::error_code missing;
  if (path.empty() || !std::filesystem::exists(path, missing)) {
    return std::nullopt;
  }
  try {
    const ChunkFile file = read_chunk_file(path);
    return file.digest == digest ? std::optional(chunks_in(file)) : std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;  // it is made again
  }
}

std::string words_for(const JobSettings& job, const ChunkBorders& borders) {
  if (borders.text.empty() && !borders.path.empty()) {
    return "as written in " + borders.path;
  }
  return samples_are_known(job.foveation) ? "balanced by the samples of the plan"
                                          : "of equally many frames, since pilots decide the samples";
}

}  // namespace

std::vector<FrameChunk> balanced_chunks(const JobSettings& job, const FramePlan& plan, std::uint32_t count) {
  return balanced(numbers_of(plan), predict(job, plan), count);
}

DividedFrames divide_frames(const JobSettings& job, const FramePlan& whole) {
  const std::vector<std::int32_t> frames = numbers_of(whole);
  const std::string digest = digest_of_borders(job, frames);
  DividedFrames divided;
  divided.borders.path = borders_path(job, digest);
  if (auto written = written_chunks(divided.borders.path, digest)) {
    divided.chunks = std::move(*written);
    return divided;
  }
  divided.chunks = balanced_chunks(job, whole, job.chunk->count);
  ChunkFile file{digest, format_frame_list(frames), {}, {}};
  for (const FrameChunk& chunk : divided.chunks) {
    file.chunks.push_back(chunk.frames.empty() ? std::string() : format_frame_list(chunk.frames));
    file.samples.push_back(chunk.samples);
  }
  divided.borders.text = chunk_file_text(file);
  return divided;
}

void write_down(const ChunkBorders& borders) {
  const std::string& text = borders.text;
  if (text.empty() || borders.path.empty() ||
      create_file_once(borders.path, std::as_bytes(std::span(text.data(), text.size())))) {
    return;
  }
  ChunkFile first;
  try {
    first = read_chunk_file(borders.path);
  } catch (const Error&) {
    write_text_atomically(borders.path, text);  // damaged
    return;
  }
  if (chunk_file_text(first) != text) {
    throw Error(ErrorKind::runtime, borders.path, "another task has just written down other borders",
                "start this task again: it will keep to them");
  }
}

ChosenChunk choose_chunk(const JobSettings& job, const FramePlan& whole) {
  DividedFrames divided = divide_frames(job, whole);
  const std::vector<FrameChunk>& chunks = divided.chunks;
  const std::uint32_t number = job.chunk->number;
  if (number > chunks.size() || chunks[number - 1].frames.empty()) {
    throw Error(ErrorKind::nothing_to_do, "`chunk`",
                fmt::format("chunk {} has none of the {} frames", number, whole.frames.size()));
  }
  ChosenChunk chosen;
  chosen.borders = std::move(divided.borders);
  chosen.frames = chunks[number - 1].frames;
  chosen.decision = fmt::format("chunk {} of {}, {}", number, chunks.size(), words_for(job, chosen.borders));
  return chosen;
}

}  // namespace gazetrace
