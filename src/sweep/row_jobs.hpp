// SPDX-License-Identifier: Apache-2.0
// A sweep's plan put together option by option: the jobs of a row, of its uniform baselines and of its reference. What
// they share follows from what the options touch. Nothing is read but the plan.
#pragma once

#include <optional>
#include <string>

#include "gazetrace/error.hpp"
#include "gazetrace/job.hpp"
#include "sweep/plan_file.hpp"

namespace gazetrace {

// A plan, and what the command line puts in place of its frames and threads.
struct SweepRequest {
  const SweepFile& file;
  const std::optional<FrameList>& frames;
  const std::optional<int>& threads;
  const JobSchema& schema;
};

// [common] and a scene's own.
Job shared_job(const SweepRequest& request, const SweepFileScene& scene);
// These with the gaze (nullptr: none) and the setting of a row.
Job test_job(const SweepRequest& request, const SweepFileScene& scene, const SweepFileGaze* gaze,
             const SweepFileSetting& setting);
// What of the row decides what is pictured, what is true by [common] and the scene, then [reference]. Error(input)
// where rows differ in what the reference would have to know.
Job reference_job(const SweepRequest& request, const SweepFileScene& scene, const Job& test,
                  const SweepFileSetting& setting);
// What uniform frames beside a test share with it.
Job uniform_job(const Job& test, const JobSchema& schema);
// Whether the gaze means anything to them, too.
bool uses_gaze_otherwise(const Job& test);
// Whether an option means anything to them.
bool uniform_sees(const Option& option, const Job& test);

// The plan's line that an error's text is about: of the option that it names, or of the file; else `otherwise`.
std::string place_of_error(const Job& job, const JobSchema& schema, const std::string& otherwise,
                           const std::string& text);

// Runs a check, and puts the plan's line before what it complains of.
template <class Check>
auto with_place(const Job& job, const JobSchema& schema, const std::string& otherwise, const Check& check) {
  try {
    return check();
  } catch (const Error& error) {
    throw Error(error.kind() == ErrorKind::usage ? ErrorKind::input : error.kind(),
                place_of_error(job, schema, otherwise, error.what()), error.what());
  }
}

}  // namespace gazetrace
