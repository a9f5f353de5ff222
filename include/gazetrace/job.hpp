// SPDX-License-Identifier: Apache-2.0
// A job describes one run: its settings and, for each option that was given, who gave it. A job is a plain
// value; no file is loaded and nothing is checked against other files before resolve() (resolve.hpp).
//
// Order of precedence, from the strongest:
//   1  an option that was given itself, on the command line or by set_option() in a program
//   2  an option set by a preset that was given in the same way
//   3  an option in a settings file
//   4  an option set by a preset that a settings file names
//   5  the default
// Between these levels the order in which options are set does not matter; within one level the later value wins. A
// preset on the command line does not undo the preset of a file: a value that the file's preset sets holds unless a
// stronger level sets the same option. Values that were replaced are kept in Job::decisions.
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
  std::string preset;                 // the preset that sets it, for the two origins of presets
  std::string former;                 // the former option that was given, and stands for it; empty: none
};
std::string to_string(const OptionSource& source);  // "preset paper from the command line", "job.toml:3"

// Something that was decided where the settings left a choice, such as ("environment", "the built-in sky, ..."). The
// texts name settings in back quotes, as errors do.
using Decision = std::pair<std::string, std::string>;
using Decisions = std::vector<Decision>;

struct Job {
  JobSettings settings;                         // may also be set directly, which leaves no trace in `sources`
  std::map<std::string, OptionSource> sources;  // of the options that somebody gave a value
  Decisions decisions;                          // which values were replaced by others
  Warnings warnings;                            // files that were found in another place than a settings file says

  // Whether the option was given itself, on the command line or in a settings file, and not by a preset or by default.
  [[nodiscard]] bool is_given(const std::string& option) const;
};

// Sets an option from text, unless a stronger source has set it. A flag takes "true" or "false"; only repeated options
// take several values. Throws Error(usage) for an unknown option and for values that the option does not take; the
// message begins with `place` or, where that is empty, with the option's name.
void set_option(Job& job, const std::string& option, const std::vector<std::string>& values,
                const OptionSource& source = {}, const std::string& place = {}, const JobSchema& schema = job_schema());
void set_option(Job& job, const std::string& option, const std::string& value);
// Options that are given together: on one command line, in one file, in one call. Throws Error(usage), too, where two
// of them contradict each other, as a former option and the one that took its place do, or a density and a sampling
// that takes none. Across calls the later value wins.
struct GivenOption {
  std::string option;
  std::vector<std::string> values;
  OptionSource source;
  std::string place;  // as for set_option()
};
void set_options(Job& job, const std::vector<GivenOption>& given, const JobSchema& schema = job_schema());
// The option's values as canonical text; empty where it is not set. Throws Error(usage) for an unknown option.
std::vector<std::string> option_values(const Job& job, const std::string& option,
                                       const JobSchema& schema = job_schema());
// The same in one text, with ";" between the values of a repeated option.
std::string option_text(const Job& job, const std::string& option, const JobSchema& schema = job_schema());

// Sets options from the text of a settings file, which is TOML with a key for each option. Throws Error(input) with
// path:line.
void add_toml(Job& job, const std::string& text, const std::string& path, const std::string& remedy = {},
              PathsBegin paths = PathsBegin::beside_settings);
Job job_from_toml(const std::string& text, const std::string& path);
// Also throws Error(input) for a file that cannot be read. `confine`: settings by others, whose files must
// lie in the folder of the settings file or in the data set that it belongs to.
Job load_job(const std::string& path, bool confine = false);
std::string read_settings_file(const std::string& path);
// Every option with its value, as TOML; reading the text gives the same settings. Its first line names `title`.
std::string job_as_toml(const Job& job, const std::string& title = "gazetrace render",
                        const JobSchema& schema = job_schema());
// The job of a run, from the run's record; `path` is the path of the record. Throws Error(input), which names the
// version that wrote the record, for options that this version does not know.
Job job_of_record(const RunRecord& record, const std::string& path);

// Named lists of settings, which stand in for the defaults.
struct Preset {
  std::string name, description;
  std::vector<std::pair<std::string, std::string>> settings;  // option and its value
};
const std::vector<Preset>& presets();

// One line for each option that was given a value other than its default but has no effect with the other settings.
Warnings idle_option_warnings(const Job& job, const JobSchema& schema = job_schema());

}  // namespace gazetrace
