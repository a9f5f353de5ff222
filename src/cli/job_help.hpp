// SPDX-License-Identifier: Apache-2.0
// Help for commands with the options of a job, of which there are far more than anybody reads: the everyday ones by
// default, all of them by topic on request, and those for many machines on a page of their own.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace gazetrace {

// `example`: a whole command, which the short help ends with.
void use_job_help(CLI::App& app, const std::string& example);
// The page of the options for many machines.
std::string farm_options_as_text();

}  // namespace gazetrace
