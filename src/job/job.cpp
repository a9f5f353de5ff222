// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <tuple>

#include "gazetrace/error.hpp"
#include "gazetrace/former_options.hpp"
#include "job/confine.hpp"
#include "job/preset_by_name.hpp"
#include "job/toml_values.hpp"

namespace gazetrace {
namespace {

const OptionOf<JobSettings>& option_named(const JobSchema& schema, const std::string& name) {
  const OptionOf<JobSettings>* option = schema.find(name);
  if (option == nullptr) {
    throw Error(ErrorKind::usage, "`" + name + "`", unknown_among_many("option", name, names_of(schema.list())));
  }
  return *option;
}

std::string joined(const std::vector<std::string>& values) {
  return values.empty() ? "(not set)" : fmt::format("{}", fmt::join(values, ";"));
}

// Called where `winner` and `loser` gave an option different values.
void note_replaced(Job& job, const OptionOf<JobSettings>& option, const OptionSource& winner, const OptionSource& loser,
                   const std::vector<std::string>& lost) {
  // Decisions are recorded, and a place on the log's clock may be a time of day.
  const std::string value = option.is(Trait::clock) ? "" : " = " + joined(lost);
  job.decisions.emplace_back("replaced " + option.name, fmt::format("{} replaces {}{} of {}", to_string(winner),
                                                                    option.name, value, to_string(loser)));
  const std::vector<std::string> kept = option.values(job.settings);
  if (joined(lost).starts_with(joined(kept) + ":")) {
    job.warnings.push_back(fmt::format("`{}` {} of {} takes the place of {} of {}", option.name, joined(kept),
                                       to_string(winner), joined(lost), to_string(loser)));
  }
}

void set_one(Job& job, const OptionOf<JobSettings>& option, const std::vector<std::string>& values,
             const OptionSource& source, const std::string& place) {
  const auto before = job.sources.find(option.name);
  if (before != job.sources.end() && before->second.origin > source.origin) {
    JobSettings weaker = job.settings;  // in which a density has a value only where it is the sampling
    option.assign(weaker, values, place);
    if (const std::vector<std::string> lost = option.values(weaker); lost != option.values(job.settings)) {
      note_replaced(job, option, before->second, source, lost);
    }
    return;
  }
  const std::vector<std::string> lost = option.values(job.settings);
  option.assign(job.settings, values, place);
  if (before != job.sources.end() && before->second.origin < source.origin && option.values(job.settings) != lost) {
    note_replaced(job, option, source, before->second, lost);
  }
  job.sources[option.name] = source;
}

void set_current(Job& job, const std::string& name, const std::vector<std::string>& values, const OptionSource& source,
                 const std::string& place, const JobSchema& schema) {
  const OptionOf<JobSettings>& option = option_named(schema, name);
  const std::string named = place.empty() ? "`" + name + "`" : place;
  if (values.empty() || (values.size() > 1 && option.shape != OptionShape::repeated)) {
    throw Error(ErrorKind::usage, named, fmt::format("takes one value, not {}", values.size()));
  }
  set_one(job, option, values, source, named);
  if (const auto& [other, value] = option.implies; !other.empty()) {
    set_one(job, option_named(schema, other), {value}, source, named);
  }
  if (name != kPresetOption) {
    return;
  }
  const Preset& preset = preset_by_name(values.front(), named);
  const OptionSource of_preset{
      source.origin == Origin::file ? Origin::preset_of_file : Origin::preset, source.place, preset.name, {}};
  for (const auto& [set, value] : preset.settings) {
    set_one(job, option_named(schema, set), {value}, of_preset, named);
  }
}

// "`spp` 2", and which former option stands for it.
std::string in_words(const GivenOption& given, const std::string& option, const std::string& value) {
  const std::string& by = given.source.former.empty() ? given.option : given.source.former;
  return by == option ? fmt::format("`{}` {}", option, value)
                      : fmt::format("`{}`, which makes `{}` {},", by, option, value);
}

// What is given together says each thing once. The same option given twice is no contradiction: its last value holds.
void check_agreement(const std::vector<GivenOption>& given, const JobSchema& schema) {
  using Said = std::tuple<std::string, std::string, std::string>;  // by which option, the value, in words
  std::map<std::string, Said> all;
  const auto say = [&](const GivenOption& one, const std::string& option, const std::string& value) {
    const std::string by = one.source.former.empty() ? one.option : one.source.former;
    const Said said{by, value, in_words(one, option, value)};
    const auto [before, is_first] = all.try_emplace(option, said);
    const auto& [by_before, value_before, words] = before->second;
    if (!is_first && by_before != by && value_before != value) {
      throw Error(one.source.origin == Origin::file ? ErrorKind::input : ErrorKind::usage, one.place,
                  fmt::format("{} and {} contradict each other: which of them holds?", words, std::get<2>(said)));
    }
    before->second = said;
  };
  for (const GivenOption& one : given) {
    say(one, one.option, joined(one.values));
    if (const OptionOf<JobSettings>* option = schema.find(one.option); option && !option->implies.first.empty()) {
      say(one, option->implies.first, option->implies.second);
    }
  }
}

}  // namespace

std::string to_string(const OptionSource& source) {
  switch (source.origin) {
    case Origin::preset_of_file:
      return fmt::format("preset {} of {}", source.preset, source.place);
    case Origin::preset:
      return fmt::format("preset {} from {}", source.preset, source.place);
    case Origin::file:
    case Origin::given:
      break;
  }
  return source.place;
}

bool Job::is_given(const std::string& option) const {
  const auto found = sources.find(option);
  return found != sources.end() && (found->second.origin == Origin::given || found->second.origin == Origin::file);
}

void set_options(Job& job, const std::vector<GivenOption>& given, const JobSchema& schema) {
  std::vector<OptionText> texts;
  for (const GivenOption& one : given) {
    texts.emplace_back(one.option, one.values);
  }
  std::vector<GivenOption> now;
  for (const GivenOption& one : given) {
    const std::string named = one.place.empty() ? "`" + one.option + "`" : one.place;
    const CurrentOptions current = current_options({one.option, one.values}, texts, ErrorKind::usage, named);
    if (!current.notice.empty()) {
      job.warnings.push_back((one.place.empty() ? "" : one.place + ": ") + current.notice);
    }
    for (const auto& [option, values] : current.settings) {
      now.push_back({option, values, one.source, one.place});
      if (!current.notice.empty()) {  // values that were given without knowing what takes them
        now.back().source.former = one.option;
        now.back().values = values_for(option_named(schema, option), values);
      }
    }
  }
  check_agreement(now, schema);
  for (const GivenOption& one : now) {
    set_current(job, one.option, one.values, one.source, one.place, schema);
  }
}

void set_option(Job& job, const std::string& name, const std::vector<std::string>& values, const OptionSource& source,
                const std::string& place, const JobSchema& schema) {
  set_options(job, {{name, values, source, place}}, schema);
}

void set_option(Job& job, const std::string& option, const std::string& value) {
  set_option(job, option, std::vector{value});
}

std::vector<std::string> option_values(const Job& job, const std::string& option, const JobSchema& schema) {
  return option_named(schema, option).values(job.settings);
}

std::string option_text(const Job& job, const std::string& option, const JobSchema& schema) {
  return fmt::format("{}", fmt::join(option_values(job, option, schema), ";"));
}

void add_toml(Job& job, const std::string& text, const std::string& path, const std::string& remedy, PathsBegin paths) {
  if (job.settings.confine) {
    check_confined(text, path, remedy);
  }
  std::vector<GivenOption> given;
  for (const TomlSetting& setting : read_toml_settings(text, path, job_schema().list(), remedy, paths)) {
    if (!setting.warning.empty()) {
      job.warnings.push_back(setting.warning);
    }
    given.push_back({setting.name,
                     setting.values,
                     {Origin::file, setting.place, {}, setting.former},
                     setting.place + ": " + setting.name});
  }
  if (paths == PathsBegin::beside_settings) {
    set_options(job, given);
    return;
  }
  // A record states every option of its version. Former options, which had to be given, are set last and win.
  std::stable_partition(given.begin(), given.end(), [](const auto& one) { return one.source.former.empty(); });
  for (const GivenOption& one : given) {
    set_option(job, one.option, one.values, one.source, one.place);
  }
}

Job job_from_toml(const std::string& text, const std::string& path) {
  Job job;
  add_toml(job, text, path);
  return job;
}

Job load_job(const std::string& path, bool confine) {
  Job job;
  job.settings.confine = confine;
  add_toml(job, read_settings_file(path), path);
  return job;
}

std::string job_as_toml(const Job& job, const std::string& title, const JobSchema& schema) {
  const auto values_of = [&](const Option& option) { return schema.find(option.name)->values(job.settings); };
  return settings_as_toml(schema.list(), values_of, title);
}

Job job_of_record(const RunRecord& record, const std::string& path) {
  Job job;
  add_toml(job, record.config_toml, path, fmt::format("gazetrace {} wrote it: use that version", record.version),
           PathsBegin::working_folder);
  return job;
}

std::string read_settings_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) {
    throw Error(ErrorKind::input, path, "the settings file cannot be read", "check the path");
  }
  constexpr std::uint64_t kMostBytes = std::uint64_t{16} << 20U;  // the longest of ours have a few kilobytes
  std::error_code unknown;
  if (std::filesystem::file_size(path, unknown) > kMostBytes && !unknown) {
    throw Error(ErrorKind::input, path, "is larger than a settings file can be, which has 16 MiB at most",
                "check the path");
  }
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace gazetrace
