// SPDX-License-Identifier: Apache-2.0
// Farms whose tasks render parts of the samples, and whose end is the sum of these.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "farm/plan.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// Sites by their number of samples, over all frames.
std::map<std::uint32_t, double> sites_by_samples(const ResolvedJob& resolved) {
  std::map<std::uint32_t, double> sites;
  const JobSettings& job = resolved.job.settings;
  for (const FrameRequest& request : resolved.plan.frames) {
    for (const Site& site : planned_sampling_map(job.foveation, request, job.trace.seed, job.threads).sites) {
      sites[site.samples] += 1;
    }
  }
  return sites;
}

// The samples numbered `number` of all sites.
double samples_numbered(const std::map<std::uint32_t, double>& sites, std::uint32_t number) {
  double count = 0;
  for (auto at = sites.upper_bound(number); at != sites.end(); ++at) {
    count += at->second;
  }
  return count;
}

}  // namespace

std::vector<FrameChunk> divide_samples(const ResolvedJob& resolved, std::uint32_t count, FarmPlan& plan) {
  const std::map<std::uint32_t, double> sites = sites_by_samples(resolved);
  const std::uint32_t most = sites.empty() ? 0 : sites.rbegin()->first;
  if (most < count) {
    throw Error(ErrorKind::usage, "`sample-ranges`", fmt::format("no pixel has more than {} samples", most),
                "give no more parts than that");
  }
  std::vector<double> before{0};  // samples with smaller numbers
  for (std::uint32_t number = 0; number < most; ++number) {
    before.push_back(before.back() + samples_numbered(sites, number));
  }
  std::vector<std::int32_t> frames;
  for (const FrameRequest& request : resolved.plan.frames) {
    frames.push_back(request.frame);
  }
  std::vector<FrameChunk> chunks;
  std::uint32_t begin = 0;
  for (std::uint32_t k = 1; k <= count; ++k) {
    const double wanted = before.back() * k / count;
    const auto at = std::lower_bound(before.begin(), before.end(), wanted);
    // No part is empty.
    const std::uint32_t end =
        std::clamp(static_cast<std::uint32_t>(at - before.begin()), begin + 1, most - (count - k));
    plan.ranges.push_back(fmt::format("{}:{}", begin, end));
    chunks.push_back({frames, before[end] - before[begin]});
    begin = end;
  }
  return chunks;
}

}  // namespace gazetrace
