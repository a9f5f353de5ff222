// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/compare_job.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"

namespace gazetrace {
namespace {

struct CompareArguments {
  CompareJob job;
  CommandOptions<CompareJob> options{compare_schema()};
};

int run_compare(const CompareJob& job) {
  const ComparedSequences compared = compare(job);
  print_result(job.json == "-" ? compare_json(compared) : compare_text(compared));
  print_warnings(compared.over_limits);
  return compared.over_limits.empty() ? exit_done : exit_over_threshold;
}

}  // namespace

Command add_compare_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<CompareArguments>();
  CompareJob& job = arguments->job;
  arguments->options.bind(app, job);
  app.add_option("reference", job.reference, "Picture, or sequence as name.####.exr")->required()->type_name("PATTERN");
  app.add_option("test", job.test, "The picture or sequence that is measured against it")
      ->required()
      ->type_name("PATTERN");
  app.footer(std::string(kConfigHelp) + kExitCodesHelp);
  return {[arguments] { return run_compare(arguments->job); },
          [arguments](const std::string& path) { arguments->options.read_config(arguments->job, "compare", path); }};
}

}  // namespace gazetrace
