// SPDX-License-Identifier: Apache-2.0
// The options of a job for people who look one up, from their definitions.
#pragma once

#include <string>

#include "gazetrace/job_schema.hpp"

namespace gazetrace {

// A page of the manual: a section for each heading, and in it every option with its value, default, range, what it
// touches, what it needs and when it does nothing.
std::string options_as_markdown(const JobSchema& schema);
// A line for each option under its heading.
// `only`: of one heading; empty: all.
std::string options_as_text(const JobSchema& schema, const std::string& only = {});
// The same facts as on the page, as a JSON array.
std::string options_as_json(const JobSchema& schema);

// What took the place of options that are no more.
std::string former_options_as_text();

}  // namespace gazetrace
