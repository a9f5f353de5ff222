// SPDX-License-Identifier: Apache-2.0
#include "cli/job_help.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <vector>

#include "cli/option_reference.hpp"
#include "gazetrace/job_schema.hpp"

namespace gazetrace {
namespace {

constexpr const char* kFarmPage = "'gazetrace help farm-options'";

const Option* job_option_of(const CLI::Option& option) {
  const std::string name = option.get_lnames().empty() ? option.get_name(true) : option.get_lnames().front();
  return job_schema().find(name);
}

bool is_shown(const CLI::Option& option, CLI::AppFormatMode mode) {
  const Option* const of_job = job_option_of(option);
  if (option.get_group().empty()) {
    return false;  // hidden
  }
  if (of_job == nullptr) {
    return true;  // the command's own
  }
  return mode == CLI::AppFormatMode::All ? of_job->group != kFarmHeading : of_job->is(Trait::everyday);
}

class JobHelp : public CLI::Formatter {
 public:
  explicit JobHelp(std::string example) : example_(std::move(example)) {}

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = make_description(app) + make_usage(app, name);
    text += topic(*app, get_label("Positionals"), true, mode);
    for (const std::string& group : app->get_groups()) {
      text += topic(*app, group, false, mode);
    }
    if (mode != CLI::AppFormatMode::All) {
      const auto& all = job_schema().options();
      const auto count =
          std::count_if(all.begin(), all.end(), [](const auto& one) { return one.group != kFarmHeading; });
      text += fmt::format("\nExample:\n  {}\n\n--help-all prints {} options by topic.\n", example_, count);
    }
    return text + fmt::format("{} prints those of machines that share a sequence.\n", kFarmPage) + make_footer(app);
  }

 private:
  [[nodiscard]] std::string topic(const CLI::App& app, const std::string& heading, bool positional,
                                  CLI::AppFormatMode mode) const {
    const std::vector<const CLI::Option*> options = app.get_options([&](const CLI::Option* option) {
      return option->get_positional() == positional && (positional || option->get_group() == heading) &&
             is_shown(*option, mode);
    });
    return options.empty() ? std::string() : make_group(heading, positional, options);
  }

  std::string example_;
};

}  // namespace

void use_job_help(CLI::App& app, const std::string& example) {
  app.set_help_all_flag("--help-all", "Prints all options, by topic");
  app.formatter(std::make_shared<JobHelp>(example));
}

std::string farm_options_as_text() {
  return "Options of 'render' and 'plan' for machines that share a sequence (docs/farm.md)\n\n" +
         options_as_text(job_schema(), kFarmHeading);
}

}  // namespace gazetrace
