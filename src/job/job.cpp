// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/job.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "gazetrace/error.hpp"
#include "gazetrace/former_options.hpp"
#include "job/confine.hpp"
#include "job/preset_by_name.hpp"

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
void note_replaced(Job& job, const Option& option, const OptionSource& winner, const OptionSource& loser,
                   const std::vector<std::string>& lost) {
  // Decisions are recorded, and a place on the log's clock may be a time of day.
  const std::string value = option.is(Trait::clock) ? "" : " = " + joined(lost);
  job.decisions.emplace_back("replaced " + option.name, fmt::format("{} replaces {}{} of {}", to_string(winner),
                                                                    option.name, value, to_string(loser)));
}

void set_one(Job& job, const OptionOf<JobSettings>& option, const std::vector<std::string>& values,
             const OptionSource& source, const std::string& place) {
  const auto before = job.sources.find(option.name);
  if (before != job.sources.end() && before->second.origin > source.origin) {
    JobSettings weaker;
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
  const OptionSource of_preset{source.origin == Origin::file ? Origin::preset_of_file : Origin::preset, source.place,
                               preset.name};
  for (const auto& [set, value] : preset.settings) {
    set_one(job, option_named(schema, set), {value}, of_preset, named);
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

void set_option(Job& job, const std::string& name, const std::vector<std::string>& values, const OptionSource& source,
                const std::string& place, const JobSchema& schema) {
  const std::string named = place.empty() ? "`" + name + "`" : place;
  const CurrentOptions current = current_options(name, values, ErrorKind::usage, named);
  if (!current.notice.empty()) {
    job.warnings.push_back((place.empty() ? "" : place + ": ") + current.notice);
  }
  for (const auto& [option, texts] : current.settings) {
    set_current(job, option, texts, source, place, schema);
  }
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
  for (const TomlSetting& setting : read_toml_settings(text, path, job_schema().list(), remedy, paths)) {
    if (!setting.warning.empty()) {
      job.warnings.push_back(setting.warning);
    }
    set_option(job, setting.name, setting.values, {Origin::file, setting.place, {}},
               setting.place + ": " + setting.name);
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
