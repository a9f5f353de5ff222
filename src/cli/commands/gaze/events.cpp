// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <utility>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_event_check.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_privacy.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

struct EventsArguments {
  GazeFileSettings gaze;
  ScreenSettings screen;
  std::string method = "auto";
  std::vector<std::string> steps;
  std::optional<GazeDevice> device;
  bool binocular = false;
  std::string output;
  bool keep_ids = false;
  JsonOutput json;
};

EyeEvents find_events(const EventsArguments& arguments, const GazeLog& log) {
  if (arguments.method == "log") {
    if (arguments.binocular) {
      throw Error(ErrorKind::usage, "`binocular`", "is a condition for events that are detected here",
                  "leave it out with `method` log, or name a method");
    }
    return events_of_log(log);
  }
  const EventPreset& preset =
      arguments.method == "auto" ? default_event_preset(log, arguments.device) : event_preset(arguments.method);
  return arguments.binocular ? binocular_events(log, preset, arguments.device)
                             : detect_events(log, preset, arguments.device);
}

// How many of what, for people who write the events to a file.
std::string summary(const EyeEvents& events, const GazeLog& log) {
  std::string text = fmt::format("{}: by {}", log.source, events.preset);
  for (const EyeMovement movement :
       {EyeMovement::fixation, EyeMovement::saccade, EyeMovement::microsaccade, EyeMovement::pursuit,
        EyeMovement::blink, EyeMovement::lost, EyeMovement::unclassified}) {
    std::size_t count = 0;
    for (const EyeEvent& event : events.events) {
      count += event.movement == movement ? 1 : 0;
    }
    if (count == 0 && (movement == EyeMovement::microsaccade || movement == EyeMovement::pursuit)) {
      continue;  // which most methods do not look for
    }
    text += fmt::format(", {} {}", count, to_string(movement));
  }
  return text + "\n";
}

int run_events(const EventsArguments& arguments) {
  arguments.json.check({arguments.output});
  GazeLog log = read_gaze_file(arguments.gaze, arguments.screen);
  complete_recording_geometry(log, arguments.screen);
  print_warnings(log.warnings);
  if (!arguments.keep_ids) {
    auto [without, taken_off_ns] = without_times_of_day(std::move(log));
    log = std::move(without);
    if (taken_off_ns) {
      print_warnings({log.source + ": its stamps are times of day; events count from its first sample, with --keep-ids "
                                   "from where the stamps do"});
    }
  }
  if (!arguments.steps.empty()) {
    ProcessedGaze processed = process_gaze(log, gaze_steps_of(arguments.steps));
    print_warnings(processed.reports);
    log = std::move(processed.log);
  }
  const EyeEvents events = find_events(arguments, log);
  const bool are_stated = arguments.method == "log";
  // Of both eyes, events are those of the left one.
  const GazeLog judged = arguments.binocular ? one_eye(log, Eye::left) : std::move(log);
  const std::vector<EventDoubt> doubts = are_stated ? std::vector<EventDoubt>() : doubt_events(judged, events);
  print_warnings(doubts_in_words(doubts, events, judged));
  const bool json = arguments.output.ends_with(".json");
  const auto as_json = [&] {
    return are_stated ? events_as_json(events, judged) : events_as_json(events, judged, doubts);
  };
  const std::string text = json ? as_json() : events_as_tsv(events, judged);
  if (arguments.output.empty()) {
    arguments.json.print(text, as_json);
  } else {
    write_text_atomically(arguments.output, text);
    arguments.json.print(summary(events, judged), as_json);
  }
  return exit_done;
}

}  // namespace

Command add_gaze_events_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<EventsArguments>();
  OptionSchema<EventsArguments> schema;
  schema.group("Events");
  schema.value(
      "--method", &EventsArguments::method, "NAME",
      "A method with its published constants ('gazetrace list event-methods'), or log: the events that the log "
      "itself states; auto: ivt on a screen, ivt-hmd in a headset, ivt-attention without a head pose");
  schema.value(
      "--device", &EventsArguments::device, "desktop|head-mounted",
      "The device of the recording, where places or directions do not tell it: gaze in degrees from a desktop tracker");
  schema.flag("--binocular", &EventsArguments::binocular,
              "Of a log of both eyes: the events of the left eye, of whose saccades and microsaccades only those stay "
              "that overlap one of the right eye (Engbert & Kliegl 2003)");
  schema.include(gaze_choice_schema(), &EventsArguments::gaze);
  schema.include(screen_schema(), &EventsArguments::screen);
  schema.include(gaze_process_schema().with_headings([](const Option&) { return "Processing"; }),
                 &EventsArguments::steps);
  const auto options = std::make_shared<CommandOptions<EventsArguments>>(std::move(schema));
  options->bind(app, *arguments);
  app.add_option("log", arguments->gaze.path, "Gaze log")->required()->type_name("FILE");
  app.add_option("-o,--output", arguments->output, "Events, .tsv or .json; default: as TSV to stdout")
      ->type_name("FILE");
  app.add_flag("--keep-ids", arguments->keep_ids,
               "Times of day of the log stay; otherwise such times count from its first sample");
  add_json_option(app, arguments->json);
  return {[arguments, options] { return run_events(*arguments); }, {}};
}

}  // namespace gazetrace
