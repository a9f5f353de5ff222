// SPDX-License-Identifier: Apache-2.0
#include "job/quality_defaults.hpp"

#include <algorithm>
#include <iterator>
#include <string>

namespace gazetrace {
namespace {

constexpr const char* kOfRegions[] = {"region-samples", "region-blocks", "region-eccentricities"};

}  // namespace

Job with_quality_defaults(Job job, Decisions* decisions) {
  const FoveationSettings& foveation = job.settings.foveation;
  const bool is_open =
      !job.sources.contains("sampling") && to_string(foveation.sampling) == to_string(JobSettings().foveation.sampling);
  const auto choose = [&](const char* sampling, const char* reason) {
    job_schema().find("sampling")->assign(job.settings, {sampling}, "`sampling`");  // which keeps what others are
    if (decisions != nullptr) {
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

}  // namespace gazetrace
