// SPDX-License-Identifier: Apache-2.0
#include "job/quality_defaults.hpp"

namespace gazetrace {
namespace {

void choose(std::string& setting, const char* option, const char* value, Decisions* decisions) {
  setting = value;
  if (decisions != nullptr) {
    decisions->emplace_back(option, setting + ", since a quality is stated");
  }
}

}  // namespace

Job with_quality_defaults(Job job, Decisions* decisions) {
  JobSettings& settings = job.settings;
  const JobSettings usual;
  const QualityTarget& target = settings.foveation.target;
  const auto is_open = [&](const char* option, const std::string& value, const std::string& usual_value) {
    return !job.sources.contains(option) && value == usual_value;
  };
  if ((target.jod || target.relmse || target.flip) &&
      is_open("falloff", settings.foveation.falloff, usual.foveation.falloff)) {
    choose(settings.foveation.falloff, "falloff", target.flip ? "uniform" : "visible", decisions);
  }
  if (target.flip && is_open("filter", settings.filter, usual.filter)) {
    choose(settings.filter, "filter", "none", decisions);
  }
  return job;
}

}  // namespace gazetrace
