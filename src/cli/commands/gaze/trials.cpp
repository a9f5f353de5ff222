// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_privacy.hpp"
#include "gazetrace/gaze_trials.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

struct TrialsArguments {
  GazeFileSettings gaze;
  ScreenSettings screen;
  FrameRate fps;
  bool keep_ids = false;
  JsonOutput json;
};

struct TrialRow {
  GazeTrial trial;
  std::size_t samples = 0, usable = 0;
  std::int64_t frames = 0;
};

TrialRow row_of(const GazeLog& log, const GazeTrial& trial, const FrameRate& fps) {
  TrialRow row{trial, 0, 0, 0};
  for (const GazeSample& sample : log.samples) {
    if (sample.t_ns >= trial.begin_ns && sample.t_ns <= trial.end_ns) {
      ++row.samples;
      row.usable += is_usable(sample.validity) ? 1 : 0;
    }
  }
  // As `plan` counts them: the last frame is the one whose middle is not after the end.
  const double frames = static_cast<double>(trial.end_ns - trial.begin_ns) * 1e-9 * static_cast<double>(fps.numerator) /
                        static_cast<double>(fps.denominator);
  row.frames = static_cast<std::int64_t>(std::max(std::floor(frames + 0.5), 1.0));
  return row;
}

std::string as_json(const std::vector<TrialRow>& rows, bool keep_ids) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::int64_t frames = 0;
  for (const TrialRow& row : rows) {
    nlohmann::ordered_json item{
        {"trial", row.trial.number},  {"block", row.trial.block}, {"begin_ns", row.trial.begin_ns},
        {"end_ns", row.trial.end_ns}, {"samples", row.samples},   {"usable", row.usable},
        {"frames", row.frames}};
    if (keep_ids) {
      item["name"] = row.trial.name;
    }
    frames += row.frames;
    list.push_back(std::move(item));
  }
  const nlohmann::ordered_json json{{"trials", std::move(list)}, {"frames", frames}};
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string as_table(const std::vector<TrialRow>& rows, const FrameRate& fps, std::int64_t first_ns, bool keep_ids) {
  std::string text = fmt::format("{:>6}{:>7}{:>13}{:>13}{:>10}{:>9}{:>9}{}\n", "trial", "block", "begin_s",
                                 "duration_s", "samples", "usable", "frames", keep_ids ? "  name" : "");
  std::int64_t frames = 0;
  for (const TrialRow& row : rows) {
    const double usable =
        row.samples > 0 ? 100.0 * static_cast<double>(row.usable) / static_cast<double>(row.samples) : 0;
    text += fmt::format("{:>6}{:>7}{:>13.3f}{:>13.3f}{:>10}{:>8.1f}%{:>9}{}\n", row.trial.number,
                        row.trial.block > 0 ? std::to_string(row.trial.block) : "-",
                        static_cast<double>(row.trial.begin_ns - first_ns) * 1e-9,
                        static_cast<double>(row.trial.end_ns - row.trial.begin_ns) * 1e-9, row.samples, usable,
                        row.frames, keep_ids ? "  " + bounded(row.trial.name, 60) : "");
    frames += row.frames;
  }
  return text + fmt::format("{} {}, {} frames at {} a second; begin_s counts from the log's first sample\n",
                            rows.size(), rows.size() == 1 ? "trial" : "trials", frames, to_string(fps));
}

int run_trials(const TrialsArguments& arguments) {
  GazeFileSettings whole = arguments.gaze;
  whole.trial.clear();
  GazeLog log = read_gaze_file(whole, arguments.screen);
  print_warnings(log.warnings);
  std::vector<GazeTrial> trials = find_trials(log);
  if (!arguments.gaze.trial.empty()) {
    trials = {trial_by_name(trials, arguments.gaze.trial)};
  }
  std::vector<TrialRow> rows;
  for (const GazeTrial& trial : trials) {
    rows.push_back(row_of(log, trial, arguments.fps));
  }
  const std::int64_t first_ns = log.samples.front().t_ns;
  if (is_wall_clock(log) && !arguments.keep_ids) {
    for (TrialRow& row : rows) {
      row.trial.begin_ns -= first_ns;
      row.trial.end_ns -= first_ns;
    }
    arguments.json.print(as_table(rows, arguments.fps, 0, false), [&] { return as_json(rows, false); });
    return exit_done;
  }
  arguments.json.print(as_table(rows, arguments.fps, first_ns, arguments.keep_ids),
                       [&] { return as_json(rows, arguments.keep_ids); });
  return exit_done;
}

}  // namespace

Command add_gaze_trials_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<TrialsArguments>();
  OptionSchema<TrialsArguments> schema;
  schema.include(gaze_choice_schema(), &TrialsArguments::gaze);
  schema.include(screen_schema(), &TrialsArguments::screen);
  schema.group("Frames");
  schema.value("--fps", &TrialsArguments::fps, "N|N/D", "Frames a second, for the number of frames of each");
  const auto options = std::make_shared<CommandOptions<TrialsArguments>>(std::move(schema));
  options->bind(app, *arguments);
  app.add_option("log", arguments->gaze.path, "Gaze log")->required()->type_name("FILE");
  app.add_flag("--keep-ids", arguments->keep_ids,
               "Also prints the trials' names, which are texts of messages, and times of day");
  add_json_option(app, arguments->json);
  return {[arguments, options] { return run_trials(*arguments); }, {}};
}

}  // namespace gazetrace
