// SPDX-License-Identifier: Apache-2.0
#include "job/quality_defaults.hpp"

namespace gazetrace {

Job with_quality_defaults(Job job, Decisions* decisions) {
  FoveationSettings& foveation = job.settings.foveation;
  const bool is_open =
      !job.sources.contains("sampling") && to_string(foveation.sampling) == to_string(FoveationSettings().sampling);
  if (foveation.target.is_given() && is_open) {
    foveation.sampling = AdaptiveSampling{};
    if (decisions != nullptr) {
      decisions->emplace_back("sampling", "adaptive, since a quality is stated");
    }
  }
  return job;
}

}  // namespace gazetrace
