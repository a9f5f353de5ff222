// SPDX-License-Identifier: Apache-2.0
#include "job/quality_defaults.hpp"

namespace gazetrace {

Job with_quality_defaults(Job job, Decisions* decisions) {
  const FoveationSettings& foveation = job.settings.foveation;
  const bool is_open =
      !job.sources.contains("sampling") && to_string(foveation.sampling) == to_string(FoveationSettings().sampling);
  if (foveation.target.is_given() && is_open) {
    job_schema().find("sampling")->assign(job.settings, {"adaptive"}, "`sampling`");  // which keeps what others are
    if (decisions != nullptr) {
      decisions->emplace_back("sampling", "adaptive, since a quality is stated");
    }
  }
  return job;
}

}  // namespace gazetrace
