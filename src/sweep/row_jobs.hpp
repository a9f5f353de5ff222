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

// A plan, and the frames and threads that the command line gives instead of the plan's.
struct SweepRequest {
  const SweepFile& file;
  const std::optional<FrameList>& frames;
  const std::optional<int>& threads;
  const JobSchema& schema;
};

// The options of [common] and of the scene.
Job shared_job(const SweepRequest& request, const SweepFileScene& scene);
// These options with those of the gaze (nullptr: none) and of the setting of a row.
Job test_job(const SweepRequest& request, const SweepFileScene& scene, const SweepFileGaze* gaze,
             const SweepFileSetting& setting);
// The job of a reference: the options of the row that decide what is rendered, then those of [common] and the scene
// that decide accuracy, then [reference]. Throws Error(input) where rows differ in a value that the reference would
// need.
Job reference_job(const SweepRequest& request, const SweepFileScene& scene, const Job& test,
                  const SweepFileSetting& setting);
// The job of the uniform frames that a test is compared to: the options of the test that matter to them.
Job uniform_job(const Job& test, const JobSchema& schema);
// Whether the gaze matters to them as well.
bool uses_gaze_otherwise(const Job& test);
// Whether an option matters to them.
bool uniform_sees(const Option& option, const Job& test);

// The plan's line that the text of an error is about: that of the option that it names, or of the file; otherwise
// `otherwise`.
std::string place_of_error(const Job& job, const JobSchema& schema, const std::string& otherwise,
                           const std::string& text);

// Runs a check, and puts the plan's line before the message of its error.
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
