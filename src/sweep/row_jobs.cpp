// SPDX-License-Identifier: Apache-2.0
#include "sweep/row_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "gazetrace/resolve.hpp"
#include "job/defaults.hpp"

namespace gazetrace {
namespace {

constexpr int kFirstSppOfAuto = 16;  // of each scrambling: enough to tell how many it will take

// Options that do not affect a uniform frame. The preset is among them, although it sets more than the sampling,
// because its effective values are taken one by one.
bool is_of_sampling_or_gaze(const Option& option) {
  return option.touches.has(Touch::sampling) || option.touches.has(Touch::gaze);
}

// Options about samples after they were traced. A reference has neither a filter nor a window.
bool is_after_sampling(const Option& option) {
  return option.touches.has(Touch::filter) || option.touches.has(Touch::window);
}

void assign(Job& job, const std::vector<Assignment>& options, const JobSchema& schema,
            const std::function<bool(const Option&)>& wanted = {}) {
  std::vector<GivenOption> together;
  for (const Assignment& given : options) {
    if (!given.warning.empty()) {
      job.warnings.push_back(given.warning);
    }
    if (!wanted || wanted(*schema.find(given.option))) {
      together.push_back({given.option,
                          given.values,
                          {Origin::file, given.place, {}, given.former},
                          given.place + ": " + given.option});
    }
  }
  set_options(job, together, schema);
}

// The effective values of another job, including those that its presets set.
void take(Job& job, const Job& other, const JobSchema& schema, const std::function<bool(const Option&)>& wanted) {
  for (const OptionOf<JobSettings>& option : schema.options()) {
    const std::vector<std::string> values = option.values(other.settings);
    if (!values.empty() && values != option.defaults && wanted(option)) {
      const auto source = other.sources.find(option.name);
      const std::string place = source == other.sources.end() ? std::string() : source->second.place;
      set_option(job, option.name, values, {Origin::file, place, {}, {}}, option.name, schema);
    }
  }
}

// A reference has as many samples as its plan says, in every picture and on every machine.
void check_reference_has_no_target(const Job& reference, const std::vector<Assignment>& options) {
  if (!reference.settings.foveation.target.is_given()) {
    return;
  }
  constexpr std::array kTargets{"target-relmse", "target-jod"};
  for (const Assignment& given : options) {
    if (is_among(kTargets, given.option)) {
      throw Error(ErrorKind::input, given.place, fmt::format("a reference cannot follow '{}'", given.option),
                  "give 'spp'");
    }
  }
}

void check_truth_is_known(const Job& reference, const SweepFileSetting& setting, const JobSchema& schema) {
  for (const Assignment& given : setting.options) {
    if (schema.find(given.option)->is(Trait::needs_truth) && !reference.is_given(given.option)) {
      throw Error(ErrorKind::input, given.place,
                  fmt::format("'{}' varies, and the reference does not know which value is right", given.option),
                  fmt::format("give '{}' in [reference]", given.option));
    }
  }
}

}  // namespace

Job shared_job(const SweepRequest& request, const SweepFileScene& scene) {
  Job job;
  // Few frames are measured, and those around them would be most of the cost: rows join where the plan says so.
  job.settings.accumulate.mode = AccumulateMode::off;
  assign(job, request.file.common, request.schema);
  if (request.frames) {
    job.settings.frames = request.frames;
  }
  if (request.threads) {
    job.settings.threads = *request.threads;
  }
  assign(job, scene.options, request.schema);
  job.settings.quiet = true;
  return job;
}

Job test_job(const SweepRequest& request, const SweepFileScene& scene, const SweepFileGaze* gaze,
             const SweepFileSetting& setting) {
  Job job = shared_job(request, scene);
  if (gaze != nullptr) {
    assign(job, gaze->options, request.schema);
  }
  assign(job, setting.options, request.schema);
  job = with_default_sampling(std::move(job));
  // The row's baselines use the same one.
  job.settings.filter = filter_of(job.settings).name;
  return job;
}

Job reference_job(const SweepRequest& request, const SweepFileScene& scene, const Job& test,
                  const SweepFileSetting& setting) {
  const JobSchema& schema = request.schema;
  const auto is_trade_off = [](const Option& option) { return option.is(Trait::trade_off); };
  Job job;
  take(job, test, schema, [&](const Option& option) {
    return !is_of_sampling_or_gaze(option) && !is_after_sampling(option) && !is_trade_off(option) &&
           !option.is(Trait::own_seed);
  });
  assign(job, request.file.common, schema, is_trade_off);
  assign(job, scene.options, schema, is_trade_off);
  for (const auto& [option, value] :
       {std::pair("sampling", "uniform"), std::pair("spp", "256"), std::pair("filter", "none"),
        std::pair("accumulate", "off"), std::pair("russian-roulette", "false"), std::pair("clamp-indirect", "0"),
        std::pair("guiding", "false")}) {
    set_option(job, option, {value}, {Origin::file, {}, {}, {}}, option, schema);
  }
  if (request.file.reference.is_auto) {
    set_option(job, "spp", {std::to_string(kFirstSppOfAuto)}, {Origin::file, {}, {}, {}}, "spp", schema);
  }
  assign(job, request.file.reference.options, schema);
  check_reference_has_no_target(job, request.file.reference.options);
  job.settings.frames = test.settings.frames;
  job.settings.threads = test.settings.threads;
  if (test.settings.camera_from_gaze) {
    job.settings.camera_from_gaze = true;
    job.settings.gaze = test.settings.gaze;
    take(job, test, schema, [](const Option& option) { return option.is(Trait::clock); });
  }
  check_truth_is_known(job, setting, schema);
  if (job.settings.trace.max_bounces < test.settings.trace.max_bounces) {
    throw Error(ErrorKind::input, place_of(request.file, "bounces"),
                fmt::format("the reference has {} bounces, and a row {}: light would be missing",
                            job.settings.trace.max_bounces, test.settings.trace.max_bounces),
                "give `bounces` in [reference]");
  }
  return job;
}

Job uniform_job(const Job& test, const JobSchema& schema) {
  Job job;
  take(job, test, schema, [](const Option& option) { return !is_of_sampling_or_gaze(option); });
  return job;
}

bool uses_gaze_otherwise(const Job& test) {
  return test.settings.camera_from_gaze;
}

bool uniform_sees(const Option& option, const Job& test) {
  return option.touches.without(Touch::sampling).any() &&
         (!option.touches.has(Touch::gaze) || uses_gaze_otherwise(test));
}

std::string place_of_error(const Job& job, const JobSchema& schema, const std::string& otherwise,
                           const std::string& text) {
  if (text.starts_with('`')) {
    const auto found = job.sources.find(text.substr(1, text.find('`', 1) - 1));
    return found == job.sources.end() || found->second.place.empty() ? otherwise : found->second.place;
  }
  std::string place = otherwise;
  for (const OptionOf<JobSettings>& option : schema.options()) {
    const auto source = job.sources.find(option.name);
    if (option.decides == Decides::file && source != job.sources.end()) {
      const std::string file = option_text(job, option.name, schema);
      if (!file.empty() && text.starts_with(file)) {
        place = source->second.place;
      }
    }
  }
  return place;
}

}  // namespace gazetrace
