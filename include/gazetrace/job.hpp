// SPDX-License-Identifier: Apache-2.0
// A job is what is asked of one run: its settings, and of each option that was given, by whom. It is a value; nothing
// is loaded or checked against other files before resolve() (resolve.hpp).
//
// Order of precedence, from the strongest:
//   1  an option that was given by itself: on the command line, or by set_option() in a program
//   2  what a preset sets that was given so
//   3  an option of a settings file
//   4  what a preset sets that such a file names
//   5  the default
// Between these the order in which options are set does not matter; within one of them the later wins. Another preset
// on the command line does not undo that of a file: what the file's preset sets and nothing stronger does still holds.
// What was replaced by another value is kept in Job::decisions.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "gazetrace/job_schema.hpp"
#include "gazetrace/job_settings.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

// Who gave an option its value, from the weakest to the strongest.
enum class Origin : std::uint8_t { preset_of_file, file, preset, given };

struct OptionSource {
  Origin origin = Origin::given;
  std::string place = "the program";  // "job.toml:3", "the command line"
  std::string preset;                 // whose setting it is, with the two origins of presets
};
std::string to_string(const OptionSource& source);  // "preset paper from the command line", "job.toml:3"

// Something that was decided where the settings left a choice: ("environment", "the built-in sky, ..."). Texts name
// settings in back quotes, as errors do.
using Decision = std::pair<std::string, std::string>;
using Decisions = std::vector<Decision>;

struct Job {
  JobSettings settings;                         // may be set directly as well, which leaves no trace in `sources`
  std::map<std::string, OptionSource> sources;  // of the options that somebody gave a value
  Decisions decisions;                          // what replaced what

  // By itself, on the command line or in a settings file: not by a preset, not by default.
  [[nodiscard]] bool is_given(const std::string& option) const;
};

// Sets an option from text, unless somebody stronger has. A flag takes "true" or "false"; only repeated options take
// several values. Error(usage) with `place` at its head for an unknown option and for values that it does not take;
// without a place the option's name stands there.
void set_option(Job& job, const std::string& option, const std::vector<std::string>& values,
                const OptionSource& source = {}, const std::string& place = {}, const JobSchema& schema = job_schema());
void set_option(Job& job, const std::string& option, const std::string& value);
// Canonical text; empty: not set. Error(usage) for an unknown option.
std::vector<std::string> option_values(const Job& job, const std::string& option,
                                       const JobSchema& schema = job_schema());
// The same in one text, with ";" between the values of a repeated option.
std::string option_text(const Job& job, const std::string& option, const JobSchema& schema = job_schema());

// Sets options from a settings file's text: TOML, a key for each option. Error(input) with path:line.
void add_toml(Job& job, const std::string& text, const std::string& path, const std::string& remedy = {});
Job job_from_toml(const std::string& text, const std::string& path);
Job load_job(const std::string& path);  // Error(input) for a file that cannot be read as well
std::string read_settings_file(const std::string& path);
// Every option with its value; reading it gives the same settings. `title` is named in its first line.
std::string job_as_toml(const Job& job, const std::string& title = "gazetrace render",
                        const JobSchema& schema = job_schema());
// The job of a run, from its record; `path` is that of the record. Error(input), with the version that wrote the
// record, for options that this version does not know.
Job job_of_record(const RunRecord& record, const std::string& path);

// Named lists of settings, which stand in for the defaults.
struct Preset {
  std::string name, description;
  std::vector<std::pair<std::string, std::string>> settings;  // option and its value
};
const std::vector<Preset>& presets();

// Lines about options that were given another value than their default and that do nothing beside the others.
Warnings idle_option_warnings(const Job& job, const JobSchema& schema = job_schema());

}  // namespace gazetrace
