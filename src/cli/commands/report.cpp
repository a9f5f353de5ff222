// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/report.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::string results, output, plots, csv;
  ReportSettings settings;
  bool overwrite = false;
  JsonOutput json;
};

void make_folder(const std::string& folder) {
  std::error_code problem;
  if (!fs::is_directory(folder) && !fs::create_directories(folder, problem)) {
    throw Error(ErrorKind::usage, "--plots", "cannot make the folder '" + folder + "': " + problem.message());
  }
}

int run_report(const ReportArguments& arguments) {
  if (!(arguments.settings.max_mib > 0)) {
    throw Error(ErrorKind::usage, "--max-mib", "must be above 0");
  }
  const Results data = read_results(arguments.results);
  const std::string output =
      arguments.output.empty() ? (fs::path(data.directory) / "report.html").string() : arguments.output;
  check_output_file(output, arguments.overwrite);
  arguments.json.check();
  using Json = nlohmann::ordered_json;
  Json json;
  std::string said;
  if (!arguments.csv.empty()) {
    check_output_file(arguments.csv, arguments.overwrite);
  }
  if (!arguments.plots.empty()) {
    const std::vector<ReportPlot> plots = report_plots(data);
    make_folder(arguments.plots);
    for (const ReportPlot& plot : plots) {
      const std::string stem = (fs::path(arguments.plots) / plot.name).string();
      write_text_atomically(stem + ".svg", plot.svg);
      write_text_atomically(stem + ".csv", plot.csv);
    }
    said += fmt::format("{} diagrams in {}\n", plots.size(), arguments.plots);
    json["plots"] = Json::array();
    for (const ReportPlot& plot : plots) {
      json["plots"].push_back((fs::path(arguments.plots) / (plot.name + ".svg")).string());
    }
  }
  if (!arguments.csv.empty()) {
    write_text_atomically(arguments.csv, results_csv(data));
  }
  const ReportPage page = report_page(data, arguments.settings);
  print_warnings(page.warnings);
  write_text_atomically(output, page.html);
  said += fmt::format("{}: {} runs, {:.2f} MiB\n", output, data.rows.size(),
                      static_cast<double>(page.html.size()) / (1024.0 * 1024.0));
  json["page"] = output;
  json["runs"] = data.rows.size();
  json["bytes"] = page.html.size();
  json["warnings"] = page.warnings;
  arguments.json.print(said, [&] { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; });
  return exit_done;
}

}  // namespace

Command add_report_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<ReportArguments>();
  app.add_option("results", arguments->results, "results.json of a sweep, or its folder")
      ->required()
      ->type_name("PATH");
  app.add_option("-o,--output", arguments->output, "The page; default: report.html beside the results")
      ->type_name("FILE");
  app.add_option("--plots", arguments->plots, "Writes every diagram as .svg and its numbers as .csv; replaces them")
      ->type_name("DIR");
  app.add_option("--csv", arguments->csv, "Writes a row for each run, metric and band")->type_name("FILE");
  app.add_option("--max-mib", arguments->settings.max_mib,
                 "Limit of the page: pictures are reduced, then left out, to stay below; the page says how")
      ->type_name("MIB")
      ->capture_default_str();
  app.add_option("--threads", arguments->settings.threads, "0: as many as the machine has")->type_name("N");
  app.add_flag("--overwrite", arguments->overwrite, "Replaces outputs that are there");
  add_json_option(app, arguments->json);
  app.footer(kExitCodesHelp);
  return {[arguments] { return run_report(*arguments); }, {}};
}

}  // namespace gazetrace
