// SPDX-License-Identifier: Apache-2.0
// A sweep's plan put together option by option: the settings of `render` that a row, its uniform baselines and its
// reference have. Nothing is read but the plan.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/option_table.hpp"
#include "cli/settings_options.hpp"
#include "cli/sweep_file.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {

// The table refers to the settings: the two stay where they are.
struct Job {
  JobSettings settings;
  OptionTable table;
  std::map<std::string, std::string> places;  // of the options that were given

  Job() { add_job_options(table, settings); }
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  // Those that are wanted; without `wanted`, all.
  void assign(const std::vector<Assignment>& options, const std::function<bool(const OptionEntry&)>& wanted = {});
  void assign(const std::string& option, const std::string& value);
  // The effective values of another job, those of its presets among them.
  void take(const Job& other, const std::function<bool(const OptionEntry&)>& wanted);
  [[nodiscard]] std::string text_of(const std::string& option) const;  // several values with ";" between them
};

// A plan, and what the command line puts in place of its frames and threads.
struct SweepRequest {
  const SweepFile& file;
  const std::optional<FrameList>& frames;
  const std::optional<int>& threads;
};

// [common] and a scene's own.
void assign_shared(const SweepRequest& request, const SweepFileScene& scene, Job& job);
// These with the gaze (nullptr: none) and the setting of a row.
std::unique_ptr<Job> test_job(const SweepRequest& request, const SweepFileScene& scene, const SweepFileGaze* gaze,
                              const SweepFileSetting& setting);
// What of the row decides what is pictured, what is true by [common] and the scene, then [reference]. Error(input)
// where rows differ in what the reference would have to know.
std::unique_ptr<Job> reference_job(const SweepRequest& request, const SweepFileScene& scene, const Job& test,
                                   const SweepFileSetting& setting);
// What uniform frames beside a test share with it.
std::unique_ptr<Job> uniform_job(const Job& test);
// Whether the gaze means anything to them, too.
bool uses_gaze_otherwise(const Job& test);
// Whether options of a group mean anything to them. A preset is not only of sampling.
bool uniform_sees(const std::string& group, const Job& test);

// The plan's line that an error's text is about: of the option that it names, or of the file; else `otherwise`.
std::string place_of_error(const Job& job, const std::string& otherwise, const std::string& text);

// Runs a check, and puts the plan's line before what it complains of.
template <class Check>
auto with_place(const Job& job, const std::string& otherwise, const Check& check) {
  try {
    return check();
  } catch (const Error& error) {
    const std::string text = with_flags(error.what());
    throw Error(error.kind() == ErrorKind::usage ? ErrorKind::input : error.kind(),
                place_of_error(job, otherwise, text), text);
  }
}

}  // namespace gazetrace
