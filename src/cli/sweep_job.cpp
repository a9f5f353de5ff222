// SPDX-License-Identifier: Apache-2.0
#include "cli/sweep_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "cli/inputs.hpp"

namespace gazetrace {
namespace {

// Headings of settings_options.cpp: what a uniform frame does not see.
constexpr const char* kPresets = "Presets";
constexpr std::array kSampling{"Where the samples go", "Density models ('gazetrace list falloffs')", kPresets};
constexpr std::array kGaze{"Gaze in time", "Gaze log"};
// Of these, what decides where a camera that follows the head is.
constexpr std::array kClock{"gaze-offset", "gaze-scale", "gaze-start", "gaze-anchor"};
constexpr std::array kAfterSampling{"Between the samples", "Over time"};
// What makes rendering cheaper and less true: a reference takes these from [common] and [reference], not from rows.
constexpr std::array kTradeOffs{"bounces",        "russian-roulette", "light-sampling", "compensate-environment",
                                "clamp-indirect", "pixel-cone",       "bounce-cone",    "seed"};
// Of these none is right by itself.
constexpr std::array kNeedTruth{"bounces", "pixel-cone", "bounce-cone"};

void check_truth_is_known(const Job& reference, const SweepFileSetting& setting) {
  for (const char* const option : kNeedTruth) {
    const auto row = std::find_if(setting.options.begin(), setting.options.end(),
                                  [&](const Assignment& given) { return given.option == option; });
    if (row != setting.options.end() && !reference.places.contains(option)) {
      throw Error(ErrorKind::input, row->place,
                  fmt::format("'{}' varies, and the reference does not know which value is right", option),
                  fmt::format("give '{}' in [reference]", option));
    }
  }
}

}  // namespace

void Job::assign(const std::vector<Assignment>& options, const std::function<bool(const OptionEntry&)>& wanted) {
  for (const Assignment& option : options) {
    const OptionEntry& entry = *table.find(option.option);
    if (!wanted || wanted(entry)) {
      entry.assign(option.values, option.place + ": " + option.option);
      places[option.option] = option.place;
    }
  }
}

void Job::assign(const std::string& option, const std::string& value) {
  table.find(option)->assign({value}, option);
}

void Job::take(const Job& other, const std::function<bool(const OptionEntry&)>& wanted) {
  for (const OptionEntry& entry : other.table.entries()) {
    const std::vector<std::string> values = entry.values();
    if (!values.empty() && values != entry.defaults && wanted(entry)) {
      table.find(entry.name)->assign(values, entry.name);
      const auto place = other.places.find(entry.name);
      places[entry.name] = place == other.places.end() ? std::string() : place->second;
    }
  }
}

std::string Job::text_of(const std::string& option) const {
  return fmt::format("{}", fmt::join(table.find(option)->values(), ";"));
}

void assign_shared(const SweepRequest& request, const SweepFileScene& scene, Job& job) {
  job.assign(request.file.common);
  if (request.frames) {
    job.settings.frames = request.frames;
  }
  if (request.threads) {
    job.settings.threads = *request.threads;
  }
  job.assign(scene.options);
  job.settings.quiet = true;
}

std::unique_ptr<Job> test_job(const SweepRequest& request, const SweepFileScene& scene, const SweepFileGaze* gaze,
                              const SweepFileSetting& setting) {
  auto job = std::make_unique<Job>();
  assign_shared(request, scene, *job);
  if (gaze != nullptr) {
    job->assign(gaze->options);
  }
  job->assign(setting.options);
  // Its baselines go through the same one.
  job->settings.filter = filter_of(job->settings);
  return job;
}

std::unique_ptr<Job> reference_job(const SweepRequest& request, const SweepFileScene& scene, const Job& test,
                                   const SweepFileSetting& setting) {
  auto job = std::make_unique<Job>();
  job->take(test, [](const OptionEntry& entry) {
    return !is_among(kSampling, entry.group) && !is_among(kAfterSampling, entry.group) &&
           !is_among(kTradeOffs, entry.name) && !is_among(kGaze, entry.group);
  });
  const auto is_trade_off = [](const OptionEntry& entry) {
    return is_among(kTradeOffs, entry.name) && entry.name != "seed";
  };
  job->assign(request.file.common, is_trade_off);
  job->assign(scene.options, is_trade_off);
  for (const auto& [option, value] :
       {std::pair("falloff", "uniform"), std::pair("spp", "256"), std::pair("filter", "none"),
        std::pair("accumulate", "off"), std::pair("russian-roulette", "false"), std::pair("clamp-indirect", "0")}) {
    job->assign(option, value);
  }
  job->assign(request.file.reference.options);
  job->settings.frames = test.settings.frames;
  job->settings.threads = test.settings.threads;
  if (test.settings.camera_from_gaze) {
    job->settings.camera_from_gaze = true;
    job->settings.gaze = test.settings.gaze;
    job->take(test, [](const OptionEntry& entry) { return is_among(kClock, entry.name); });
  }
  check_truth_is_known(*job, setting);
  return job;
}

std::unique_ptr<Job> uniform_job(const Job& test) {
  auto job = std::make_unique<Job>();
  job->take(test, [](const OptionEntry& entry) {
    return !is_among(kSampling, entry.group) && !is_among(kGaze, entry.group);
  });
  return job;
}

bool uses_gaze_otherwise(const Job& test) {
  const AccumulateSettings& accumulate = test.settings.accumulate;
  return test.settings.camera_from_gaze || accumulate.reset_at_saccades || accumulate.reset_at_blinks;
}

bool uniform_sees(const std::string& group, const Job& test) {
  return (group == kPresets || !is_among(kSampling, group)) && (!is_among(kGaze, group) || uses_gaze_otherwise(test));
}

std::string place_of_error(const Job& job, const std::string& otherwise, const std::string& text) {
  if (text.starts_with("--")) {
    const auto found = job.places.find(text.substr(2, text.find(':') - 2));
    return found == job.places.end() ? otherwise : found->second;
  }
  std::string place = otherwise;
  for (const char* option : {"scene", "env", "gaze", "camera-path"}) {
    if (job.places.contains(option) && !job.text_of(option).empty() && text.starts_with(job.text_of(option))) {
      place = job.places.at(option);
    }
  }
  return place;
}

}  // namespace gazetrace
