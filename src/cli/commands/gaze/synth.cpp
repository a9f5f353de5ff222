// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/gaze_synth.hpp"
#include "gazetrace/gaze_write.hpp"
#include "gazetrace/output.hpp"
#include "gazetrace/resolve.hpp"

namespace gazetrace {
namespace {

struct SynthArguments {
  SynthSettings synth;
  ScreenSettings screen;
  DurationNs duration{10'000'000'000};
  DurationNs fixation{300'000'000};
  bool head = false;
  std::string output, truth;
  JsonOutput json;
};

int run_synth(const SynthArguments& arguments) {
  arguments.json.check({arguments.output, arguments.truth});
  SynthSettings settings = arguments.synth;
  settings.duration_ns = arguments.duration.ns;
  settings.fixation_s = static_cast<double>(arguments.fixation.ns) * 1e-9;
  settings.kind = arguments.head ? GazeKind::direction : GazeKind::screen;
  settings.display = screen_geometry(arguments.screen).value_or(settings.display);
  const SynthGaze synth = synthesize_gaze(settings);
  write_gaze_csv(synth.log, arguments.output);
  if (!arguments.truth.empty()) {
    const bool json = arguments.truth.ends_with(".json");
    write_text_atomically(arguments.truth,
                          json ? events_as_json(synth.truth, synth.log) : events_as_tsv(synth.truth, synth.log));
  }
  arguments.json.print("", [&] {
    const nlohmann::ordered_json json{{"log", arguments.output},
                                      {"truth", arguments.truth},
                                      {"samples", synth.log.samples.size()},
                                      {"events", synth.truth.events.size()}};
    return json.dump(2) + "\n";
  });
  return exit_done;
}

}  // namespace

Command add_gaze_synth_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<SynthArguments>();
  OptionSchema<SynthArguments> schema;
  schema.group("Synthetic gaze");
  schema.value("--duration", &SynthArguments::duration, "DURATION", "How long");
  schema.value("--rate", at(&SynthArguments::synth, &SynthSettings::rate_hz), "HZ", "Samples a second");
  schema.value("--seed", at(&SynthArguments::synth, &SynthSettings::seed), "N", "Same seed, same gaze");
  schema.flag("--head", &SynthArguments::head, "Directions from the head instead of places on a screen");
  schema.value("--fixation", &SynthArguments::fixation, "DURATION", "Mean duration of a fixation");
  schema.value("--amplitude", at(&SynthArguments::synth, &SynthSettings::amplitude_deg), "DEG",
               "Mean amplitude of a saccade, from 1 deg on");
  schema.value("--drift", at(&SynthArguments::synth, &SynthSettings::drift_deg), "DEG",
               "Root mean square of the slow wandering in fixations");
  schema.value("--pursuit-share", at(&SynthArguments::synth, &SynthSettings::pursuit_share), "SHARE",
               "Of the fixations that follow something instead");
  schema.value("--pursuit-speed", at(&SynthArguments::synth, &SynthSettings::pursuit_deg_s), "DEG/S", "How fast");
  schema.value("--noise", at(&SynthArguments::synth, &SynthSettings::noise_deg), "DEG",
               "Standard deviation of white noise in azimuth and in elevation");
  schema.value("--lost-share", at(&SynthArguments::synth, &SynthSettings::lost_share), "SHARE",
               "Of the samples that are lost, four at a time");
  schema.value("--blinks", at(&SynthArguments::synth, &SynthSettings::blinks_per_min), "N", "Blinks a minute");
  schema.include(screen_schema(), &SynthArguments::screen);
  const auto options = std::make_shared<CommandOptions<SynthArguments>>(std::move(schema));
  options->bind(app, *arguments);
  app.add_option("-o,--output", arguments->output, "gazetrace CSV")->required()->type_name("OUT.csv");
  app.add_option("--truth", arguments->truth, "The true events, in the format of 'gaze events': .tsv or .json")
      ->type_name("FILE");
  add_json_option(app, arguments->json);
  return {[arguments, options] { return run_synth(*arguments); }, {}};
}

}  // namespace gazetrace
