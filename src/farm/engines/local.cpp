// SPDX-License-Identifier: Apache-2.0
// This machine: run_local() starts the tasks and tries them again, and nothing is handed over.
#include "farm/engine.hpp"

namespace gazetrace {
namespace {

std::map<std::string, std::string> no_files(const FarmPlan& /*plan*/, const std::vector<std::size_t>& /*chunks*/) {
  return {};
}

std::string nothing(const FarmPlan& /*plan*/) {
  return {};
}

}  // namespace

const FarmEngine kFarmEngine_local{no_files, nothing, nothing, "", false, true};

}  // namespace gazetrace
