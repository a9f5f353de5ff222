// SPDX-License-Identifier: Apache-2.0
#include "job/defaults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "gazetrace/error.hpp"
#include "job/outputs.hpp"
#include "job/schema/idle_rules.hpp"

namespace gazetrace {
namespace {

constexpr const char* kOfRegions[] = {"region-samples", "region-blocks", "region-eccentricities"};
constexpr double kUsualMeanSpp = 2;
constexpr double kMostWindowPixels = 1 << 24;

bool is_longer_than_a_frame(const JobSettings& job, const ViewInputs& inputs) {
  try {
    return frames_of_sequence(job, inputs).size() > 1;
  } catch (const Error&) {  // longer than any plan, which the frames that are named do not mind
    return true;
  }
}

}  // namespace

Job with_default_sampling(Job job, Decisions* decisions) {
  const FoveationSettings& foveation = job.settings.foveation;
  const bool is_open =
      !job.sources.contains("sampling") && to_string(foveation.sampling) == to_string(JobSettings().foveation.sampling);
  const auto choose = [&](const char* sampling, const char* reason) {
    job_schema().find("sampling")->assign(job.settings, {sampling}, "`sampling`");  // which keeps what others are
    if (decisions != nullptr && (has_gaze(job.settings) || follows_picture(job.settings.foveation.sampling))) {
      decisions->emplace_back("sampling", std::string(sampling) + ", since " + reason);
    }
  };
  if (is_open && foveation.target.is_given()) {
    choose("adaptive", "a quality is stated");
  } else if (is_open && std::any_of(std::begin(kOfRegions), std::end(kOfRegions),
                                    [&](const char* option) { return job.is_given(option); })) {
    choose("regions", "their counts, blocks or eccentricities are stated");
  }
  return job;
}

void settle_rate(const GazeLog* log, JobSettings& job) {
  const auto* const density = std::get_if<DensitySampling>(&job.foveation.sampling);
  const bool is_open = density != nullptr && !density->from_picture && density->full_rate_spp == kUsualSpp &&
                       !job.foveation.spp && !job.foveation.target.is_given();
  if (log != nullptr && is_open) {
    job.foveation.spp = kUsualMeanSpp;
  }
}

void settle_accumulation(const ViewInputs& inputs, const std::vector<std::int32_t>& frames, Job& whole_job,
                         Decisions& decisions) {
  JobSettings& job = whole_job.settings;
  if (job.accumulate.mode != AccumulateMode::automatic) {
    return;
  }
  // Raw samples are asked for as they are: by `none` for references, and by other denoisers. How many samples a quality
  // takes was measured of frames by themselves. A frame that a chunk names is one of many.
  const bool joins =
      filter_of(job).name != "none" && !job.foveation.target.is_given() &&
      (frames.size() > 1 || (job.chunk && job.frames) || (job.frames && is_longer_than_a_frame(job, inputs)));
  job.accumulate.mode = joins ? AccumulateMode::window : AccumulateMode::off;
  if (!joins) {
    return;
  }
  const double most = std::max(std::floor((kMostWindowPixels / job.size.width / job.size.height - 1) / 2), 1.0);
  const auto most_ns = static_cast<std::int64_t>(
      std::ceil(most * 1e9 * static_cast<double>(job.fps.denominator) / static_cast<double>(job.fps.numerator)));
  for (const auto& [option, time] :
       {std::pair("accumulate-past", &job.accumulate_past), std::pair("accumulate-future", &job.accumulate_future)}) {
    time->ns = whole_job.is_given(option) ? time->ns : std::min(time->ns, most_ns);
  }
  const AccumulateSettings window = accumulate_of(job);
  decisions.emplace_back("accumulate", fmt::format("window: each frame joins {} before it and {} after it",
                                                   window.past_frames, window.future_frames));
}

}  // namespace gazetrace
