// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/inputs.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

struct InspectArguments {
  GazeFileSettings gaze;
  ScreenSettings screen;
  OptionTable table;
  std::string save_columns;
  bool json = false;
};

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

struct GazeReport {
  std::size_t samples = 0, usable = 0, off_screen = 0;
  std::array<std::size_t, 6> by_validity{};
  std::int64_t first_ns = 0, last_ns = 0, longest_gap_ns = 0;
  double median_rate_hz = 0;
  Range u, v;  // of usable samples
};

GazeReport measure(const GazeLog& log) {
  GazeReport report;
  report.samples = log.samples.size();
  report.first_ns = log.samples.front().t_ns;
  report.last_ns = log.samples.back().t_ns;
  std::vector<std::int64_t> steps_ns;
  const GazeSample* before = nullptr;
  const GazeSample* usable_before = nullptr;
  for (const GazeSample& sample : log.samples) {
    ++report.by_validity[static_cast<std::size_t>(sample.validity)];
    if (before != nullptr) {
      steps_ns.push_back(sample.t_ns - before->t_ns);
    }
    before = &sample;
    if (!is_usable(sample.validity)) {
      continue;
    }
    ++report.usable;
    if (usable_before != nullptr) {
      report.longest_gap_ns = std::max(report.longest_gap_ns, sample.t_ns - usable_before->t_ns);
    }
    usable_before = &sample;
    report.u.add(log.kind != GazeKind::direction ? sample.u : sample.direction.x);
    report.v.add(log.kind != GazeKind::direction ? sample.v : sample.direction.y);
  }
  if (!steps_ns.empty()) {
    const auto middle = steps_ns.begin() + static_cast<std::ptrdiff_t>(steps_ns.size() / 2);
    std::nth_element(steps_ns.begin(), middle, steps_ns.end());
    report.median_rate_hz = *middle > 0 ? 1e9 / static_cast<double>(*middle) : 0.0;
  }
  return report;
}

const std::array<GazeValidity, 6> kValidities = {GazeValidity::ok,         GazeValidity::low_confidence,
                                                 GazeValidity::blink,      GazeValidity::lost,
                                                 GazeValidity::off_screen, GazeValidity::interpolated};

std::string geometry_text(const DisplayGeometry& g) {
  const auto size = g.width_cm > 0 ? fmt::format("{:.5g} x {:.5g} cm", g.width_cm, g.height_cm) : "size not stated";
  const auto distance = g.distance_cm > 0 ? fmt::format("at {:.5g} cm", g.distance_cm) : "distance not stated";
  return fmt::format("{} x {} px, {}, {}", g.width_px, g.height_px, size, distance);
}

std::string report_text(const GazeLog& log, const GazeReport& r) {
  const bool is_screen = log.kind != GazeKind::direction;
  std::string text =
      fmt::format("{}\nformat       {} ({:.0f} % sure), {}\n", log.source, log.format, 100 * log.format_confidence,
                  log.kind == GazeKind::direction ? "directions from the head"
                  : log.kind == GazeKind::screen  ? "on a screen"
                                                  : "on a scene camera's picture");
  text += fmt::format("samples      {} in {:.3f} s, median rate {:.2f} Hz\n", r.samples,
                      static_cast<double>(r.last_ns - r.first_ns) * 1e-9, r.median_rate_hz);
  text += fmt::format("time         {} ns to {} ns{}\n", r.first_ns, r.last_ns,
                      log.clock.empty() ? "" : " (clock: " + log.clock + ")");
  text += fmt::format("usable       {} ({:.2f} %), longest gap {:.1f} ms\n", r.usable,
                      100.0 * static_cast<double>(r.usable) / static_cast<double>(r.samples),
                      static_cast<double>(r.longest_gap_ns) * 1e-6);
  for (const GazeValidity validity : kValidities) {
    if (const std::size_t count = r.by_validity[static_cast<std::size_t>(validity)]; count > 0) {
      text += fmt::format("  {:<16}{}\n", to_string(validity), count);
    }
  }
  if (r.usable > 0) {
    text += fmt::format("range        {} {:.4f} to {:.4f}, {} {:.4f} to {:.4f}\n", is_screen ? "u" : "x", r.u.low,
                        r.u.high, is_screen ? "v" : "y", r.v.low, r.v.high);
  }
  text += fmt::format("geometry     {}\n",
                      log.recording_geometry ? geometry_text(*log.recording_geometry) : "not stated by the log");
  for (const GazeFact& fact : log.facts) {
    text += fmt::format("{:<17}{} ({}{}{})\n", fact.what, fact.value, to_string(fact.evidence),
                        fact.detail.empty() ? "" : ": ", fact.detail);
  }
  if (!log.eyes.empty()) {
    text += "eyes         both\n";
  }
  if (!log.head.empty()) {
    text += fmt::format("head         {} poses\n", log.head.size());
  }
  for (const GazeCalibration& calibration : log.calibrations) {
    text += fmt::format("validation   {} eye: {} deg mean, {} deg at most\n", to_string(calibration.eye),
                        calibration.mean_error_deg, calibration.max_error_deg);
  }
  for (const std::string& warning : log.warnings) {
    text += fmt::format("warning      {}\n", warning);
  }
  return text;
}

std::string report_json(const GazeLog& log, const GazeReport& r) {
  using Json = nlohmann::ordered_json;
  Json json{{"source", log.source},
            {"format", log.format},
            {"format_confidence", log.format_confidence},
            {"kind", to_string(log.kind)},
            {"clock", log.clock},
            {"samples", r.samples},
            {"usable", r.usable},
            {"usable_share", static_cast<double>(r.usable) / static_cast<double>(r.samples)},
            {"first_ns", r.first_ns},
            {"last_ns", r.last_ns},
            {"longest_gap_ns", r.longest_gap_ns},
            {"median_rate_hz", r.median_rate_hz}};
  for (const GazeValidity validity : kValidities) {
    json["validity"][std::string(to_string(validity))] = r.by_validity[static_cast<std::size_t>(validity)];
  }
  if (r.usable > 0) {
    json["range"] = {{"first", {r.u.low, r.u.high}}, {"second", {r.v.low, r.v.high}}};
  }
  if (log.recording_geometry) {
    const DisplayGeometry& g = *log.recording_geometry;
    json["geometry"] = {
        {"px", {g.width_px, g.height_px}}, {"cm", {g.width_cm, g.height_cm}}, {"distance_cm", g.distance_cm}};
  }
  for (const GazeFact& fact : log.facts) {
    json["facts"].push_back(
        {{"what", fact.what}, {"value", fact.value}, {"evidence", to_string(fact.evidence)}, {"detail", fact.detail}});
  }
  json["both_eyes"] = !log.eyes.empty();
  json["head_poses"] = log.head.size();
  json["events"] = log.events.size();
  json["warnings"] = log.warnings;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int run_inspect(const InspectArguments& arguments) {
  if (!arguments.save_columns.empty()) {
    save_gaze_columns(merged_columns(arguments.gaze), arguments.save_columns);
  }
  const GazeLog log = read_gaze_file(arguments.gaze, arguments.screen);
  const GazeReport report = measure(log);
  print_result(arguments.json ? report_json(log, report) : report_text(log, report));
  return exit_done;
}

}  // namespace

Command add_gaze_inspect_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<InspectArguments>();
  add_gaze_file_options(arguments->table, arguments->gaze);
  add_screen_options(arguments->table, arguments->screen);
  bind_options(app, arguments->table);
  app.add_option("log", arguments->gaze.path, "Gaze log")->required()->type_name("FILE");
  app.add_option("--save-columns", arguments->save_columns, "Writes what was declared of the columns as a column map")
      ->type_name("MAP.json");
  app.add_flag("--json", arguments->json, "As JSON");
  return {[arguments] { return run_inspect(*arguments); }, nullptr};
}

}  // namespace gazetrace
