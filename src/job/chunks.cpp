// SPDX-License-Identifier: Apache-2.0
#include "job/chunks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "gazetrace/error.hpp"
#include "job/outputs.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

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

// Samples that a pilot, a first look or a clock decides are not known before the frame is rendered.
bool samples_are_known(const FoveationSettings& foveation) {
  return foveation.falloff != "visible" && !(foveation.contrast_strength > 0) && !foveation.target.is_given();
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
  for (std::uint32_t k = 1; k <= count; ++k) {
    const double wanted = whole * k / count;
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
                                                         {"count", std::to_string(job.chunk->count)}};
  for (const OptionOf<JobSettings>& option : job_schema().options()) {
    if (option.decides != Decides::nothing) {
      parts.emplace_back(option.name, fmt::format("{}", fmt::join(option.values(job), "\n")));
    }
  }
  return digest_settings(parts);
}

std::string borders_path(const JobSettings& job) {
  const std::string folder = output_settings(job).run_directory;
  return folder.empty() ? std::string()
                        : (std::filesystem::path(folder) / fmt::format("chunks.{}.json", job.chunk->count)).string();
}

// The borders that an earlier task wrote for the same frames and settings; nothing where there are none.
std::vector<std::vector<std::int32_t>> written_borders(const JobSettings& job,
                                                       const std::vector<std::int32_t>& frames) {
  const std::string path = borders_path(job);
  std::ifstream file(path);
  if (path.empty() || !file) {
    return {};
  }
  std::vector<std::vector<std::int32_t>> chunks;
  try {
    const Json json = Json::parse(file);
    if (json.at("digest") != digest_of_borders(job, frames)) {
      return {};
    }
    for (const Json& list : json.at("chunks")) {
      const auto text = list.get<std::string>();
      chunks.push_back(text.empty() ? std::vector<std::int32_t>() : parse_frame_list(text));
    }
  } catch (const std::exception&) {
    return {};  // damaged: they are computed again, and are the same
  }
  return chunks.size() == job.chunk->count ? chunks : std::vector<std::vector<std::int32_t>>();
}

}  // namespace

std::vector<FrameChunk> balanced_chunks(const JobSettings& job, const FramePlan& plan, std::uint32_t count) {
  return balanced(numbers_of(plan), predict(job, plan), count);
}

std::vector<std::int32_t> frames_of_chunk(const JobSettings& job, const FramePlan& whole, std::string& decision) {
  const std::vector<std::int32_t> frames = numbers_of(whole);
  const std::uint32_t number = job.chunk->number;
  std::vector<std::int32_t> chosen;
  if (job.chunk_frames > 0) {
    const auto length = static_cast<std::size_t>(job.chunk_frames);
    const std::size_t begin = std::min(frames.size(), (number - 1) * length);
    const std::size_t end = std::min(frames.size(), begin + length);
    chosen.assign(frames.begin() + static_cast<std::ptrdiff_t>(begin),
                  frames.begin() + static_cast<std::ptrdiff_t>(end));
    decision = fmt::format("chunk {} of {} frames each", number, length);
  } else if (const auto written = written_borders(job, frames); !written.empty()) {
    chosen = written[number - 1];
    decision = fmt::format("chunk {} of {}, as written in {}", number, job.chunk->count, borders_path(job));
  } else {
    chosen = balanced_chunks(job, whole, job.chunk->count)[number - 1].frames;
    decision =
        fmt::format("chunk {} of {}, {}", number, job.chunk->count,
                    samples_are_known(job.foveation) ? "balanced by the samples of the plan"
                                                     : "of equally many frames, since pilots decide the samples");
  }
  if (chosen.empty()) {
    throw Error(ErrorKind::nothing_to_do, "`chunk`",
                fmt::format("chunk {} has none of the {} frames", number, frames.size()));
  }
  return chosen;
}

ChunkBorders chunk_borders(const JobSettings& job, const FramePlan& whole) {
  ChunkBorders borders;
  if (!job.chunk || job.chunk_frames > 0) {
    return borders;
  }
  const std::vector<std::int32_t> frames = numbers_of(whole);
  borders.path = borders_path(job);
  if (borders.path.empty() || !written_borders(job, frames).empty()) {
    return {};
  }
  Json lists = Json::array();
  Json samples = Json::array();
  for (const FrameChunk& chunk : balanced_chunks(job, whole, job.chunk->count)) {
    lists.push_back(chunk.frames.empty() ? std::string() : format_frame_list(chunk.frames));
    samples.push_back(chunk.samples);
  }
  borders.text = Json{{"digest", digest_of_borders(job, frames)},
                      {"frames", format_frame_list(frames)},
                      {"chunks", lists},
                      {"samples", samples}}
                     .dump(2) +
                 "\n";
  return borders;
}

}  // namespace gazetrace
