// SPDX-License-Identifier: Apache-2.0
#include "job/schema/idle_rules.hpp"
#include "job/schema/parts.hpp"

namespace gazetrace {
namespace {

constexpr auto gaze_read(auto member) {
  return at(&GazeFileSettings::read, member);
}
constexpr auto column(auto member) {
  return at(&GazeFileSettings::read, &GazeReadOptions::columns, member);
}

void add_clock_options(JobSchema& schema) {
  schema
      .value("--gaze-offset", &JobSettings::gaze_offset, "DURATION", Touch::gaze,
             "t_video = scale (t_log - start) + offset")
      .with(Trait::clock)
      .idle_when({without_gaze_log()});
  schema
      .value("--gaze-scale", &JobSettings::gaze_scale, "FACTOR", Touch::gaze,
             "Clock rate of video over that of the log")
      .with(Trait::clock)
      .above(0)
      .idle_when({without_gaze_log()});
  schema
      .value("--gaze-start", &JobSettings::gaze_start, "DURATION", Touch::gaze,
             "Time on the log's clock that is video time --gaze-offset; default: its first sample")
      .with(Trait::clock)
      .idle_when({without_gaze_log()});
  schema
      .value("--gaze-latency", &JobSettings::gaze_latency, "DURATION", Touch::gaze,
             "Sampling follows the gaze as it was this long ago; measurements use the true gaze")
      .idle_when({without_gaze_log()});
  schema
      .flag("--keep-ids", &JobSettings::keep_ids, Touch::gaze,
            "Keeps the log's times of day in plan, headers and records; otherwise time is counted from the log's first "
            "sample")
      .decides_nothing()
      .with(Trait::one_run);
  schema
      .repeated("--gaze-anchor", &JobSettings::gaze_anchors, "LOG=VIDEO", Touch::gaze,
                "An event on both clocks, in place of --gaze-start, --gaze-offset and --gaze-scale: a time of the log "
                "or the text of its message, and the video time of it; with two or more, offset and scale are fitted")
      .with(Trait::clock)
      .idle_when({without_gaze_log()});
}

void add_time_options(JobSchema& schema) {
  schema.group("Gaze in time");
  schema
      .value("--gaze-at", &JobSettings::gaze_at, "U,V", Touch::gaze,
             "A fixed gaze in fractions of the screen from its top left, in place of a log")
      .with(Trait::gaze_source)
      .with(Trait::everyday);
  schema
      .value("--gaze-mode", &JobSettings::gaze_mode, choices<GazeInterpolation>(), Touch::gaze,
             "How the gaze of a frame is taken from the log's samples")
      .idle_when({without_gaze_log()});
  schema
      .value("--gaze-missing", &JobSettings::gaze_missing, choices<NoGazePolicy>(), Touch::gaze,
             "In frames without usable gaze: hold the last one (the centre before the first), look at the "
             "centre, render uniformly, or stop with an error")
      .idle_when({without_gaze_log()});
  schema
      .value("--gaze-max-missing-frames", &JobSettings::gaze_max_missing_frames, "N", Touch::gaze,
             "More frames than this in a row without usable gaze are refused; 0: any number")
      .decides_nothing()
      .idle_when({without_gaze_log()});
  schema
      .value("--gaze-max-age", &JobSettings::gaze_max_age, "DURATION", Touch::gaze, "An older sample counts as no gaze")
      .at_least(0)
      .idle_when({without_gaze_log()});
  schema
      .value("--gaze-max-gap", &JobSettings::gaze_max_gap, "DURATION", Touch::gaze,
             "A longer step between two samples is a gap: nothing is interpolated across it, and samples that are held "
             "in it are marked")
      .at_least(0)
      .idle_when({without_gaze_log()});
  add_clock_options(schema);
}

constexpr auto rule(auto member) {
  return at(&GazeFileSettings::trial_rules, member);
}

void add_column_options(OptionSchema<GazeFileSettings>& schema) {
  schema.group("Columns of a table");
  schema.value("--time-column", column(&GazeColumns::time), "NAME", Touch::gaze, "Column of the stamps");
  schema.value("--x-column", column(&GazeColumns::x), "NAME", Touch::gaze,
               "Column of the horizontal position, or direction x");
  schema.value("--y-column", column(&GazeColumns::y), "NAME", Touch::gaze,
               "Column of the vertical position, or direction y");
  schema.value("--z-column", column(&GazeColumns::z), "NAME", Touch::gaze, "Column of direction z");
  schema.value("--validity-column", column(&GazeColumns::validity), "NAME", Touch::gaze,
               "Column that says which samples are valid");
  schema.value("--valid-values", column(&GazeColumns::valid_values), "TEXT,TEXT", Touch::gaze,
               "Values of that column that mean a valid sample; default: 1, true, ok, valid");
  schema.value("--confidence-column", column(&GazeColumns::confidence), "NAME", Touch::gaze,
               "Column of the confidence");
  schema.value("--pupil-column", column(&GazeColumns::pupil), "NAME", Touch::gaze, "Column of the pupil's size");
  schema.value("--eye-column", column(&GazeColumns::eye), "NAME", Touch::gaze, "Column of the eye");
  schema.value("--recording-column", column(&GazeColumns::recording), "NAME", Touch::gaze,
               "Column that tells the recordings of a file apart");
  schema
      .value("--columns", &GazeFileSettings::columns_file, "FILE", Touch::gaze,
             "Column map as JSON, for tables of one's own; 'gazetrace gaze inspect --save-columns' writes one")
      .decides_by_file();
}

void add_convention_options(OptionSchema<GazeFileSettings>& schema) {
  schema.group("Meaning of the numbers");
  schema.value("--format", gaze_read(&GazeReadOptions::format), "NAME", Touch::gaze,
               "Format of the log ('gazetrace list gaze-formats'); default: found by its content");
  schema.value("--time-unit", column(&GazeColumns::time_unit), choices<TimeUnit>(), Touch::gaze, "Unit of the stamps");
  schema.value("--unit", column(&GazeColumns::position_unit), choices<PositionUnit>(), Touch::gaze,
               "Unit of the positions");
  schema.value("--origin", column(&GazeColumns::origin), choices<PositionOrigin>(), Touch::gaze, "Where (0, 0) is");
  schema.value("--corner", gaze_read(&GazeReadOptions::corner), "X,Y", Touch::gaze,
               "The log's x and y of the display's top left corner, such as 1920,0 on the right one of two monitors");
  schema.value("--axes", column(&GazeColumns::axes), choices<GazeAxes>(), Touch::gaze,
               "Axes of directions: gl looks along -z, unity left-handed along +z, sranipal along +z with x to the "
               "left, cv along +z with y down, unreal along +x with z up; default: the format's own");
  schema.value("--frame", gaze_read(&GazeReadOptions::frame), choices<GazeFrame>(), Touch::gaze,
               "Which gaze is taken of a log that states several: head, directions from the head; scene-camera, places "
               "on the scene camera's picture; world, directions in the space of the head's poses");
  schema.value("--min-confidence", &GazeFileSettings::min_confidence, "SHARE", Touch::gaze,
               "Samples of less confidence are not used; default: the format's own, such as 0.6 for Pupil Core");
  schema.value("--missing-value", gaze_read(&GazeReadOptions::missing_value), "VALUE", Touch::gaze,
               "The number, such as -1, that the log has where it has no position, in both axes or in one; 0 counts in "
               "both only; -32768, and magnitudes from 1e7 on, always mean that");
  schema.value("--order", gaze_read(&GazeReadOptions::unordered), choices<UnorderedPolicy>(), Touch::gaze,
               "Stamps that do not grow: an error; sorted, where the last of equal ones is kept; equal ones in pairs "
               "stand half a step apart; a counter that overflowed (at 2^16 or 2^32) goes on");
  schema.flag("--swap-xy", gaze_read(&GazeReadOptions::swap_xy), Touch::gaze, "Exchanges the two axes");
  schema.flag("--flip-x", gaze_read(&GazeReadOptions::flip_x), Touch::gaze, "Exchanges left and right");
  schema.flag("--flip-y", gaze_read(&GazeReadOptions::flip_y), Touch::gaze, "Exchanges top and bottom");
  schema
      .value("--events", gaze_read(&GazeReadOptions::events_file), "FILE", Touch::gaze,
             "A table of fixations, saccades or blinks that another program found in this log: they become its events")
      .decides_by_file();
}

void add_trial_options(OptionSchema<GazeFileSettings>& schema) {
  schema.group("Trials, which are blocks of the log unless they are named here");
  schema.value("--trial-start", rule(&TrialRules::begin), "PATTERN", Touch::gaze,
               "A message that begins a trial: a part of its text, or all of it with * and ?");
  schema.value("--trial-end", rule(&TrialRules::end), "PATTERN", Touch::gaze,
               "A message that ends it; default: where the next one begins, or its block ends");
  schema
      .value("--trial-nth", rule(&TrialRules::nth), "N", Touch::gaze,
             "Only the Nth message that fits begins a trial; 0: every one")
      .at_least(0);
  schema.flag("--trial-per-block", rule(&TrialRules::per_block), Touch::gaze, "Counts --trial-nth anew in each block");
  schema
      .value("--trial-table", rule(&TrialRules::table), "FILE", Touch::gaze,
             "Trials as a table: onset and duration in seconds on the log's clock, as in BIDS events, or onset_ns and "
             "offset_ns; a name or trial_type each")
      .decides_by_file();
}

}  // namespace

OptionSchema<GazeFileSettings> gaze_choice_schema() {
  OptionSchema<GazeFileSettings> schema;
  schema.group("Gaze log");
  schema.value("--gaze-recording", gaze_read(&GazeReadOptions::recording), "NUMBER|NAME", Touch::gaze,
               "Which recording, or which block, of a file that holds several: 'gazetrace gaze inspect' lists them");
  schema.value(
      "--gaze-eye", gaze_read(&GazeReadOptions::eye), choices<EyeChoice>(), Touch::gaze,
      "Which gaze is taken of a log of both eyes; auto: its combined gaze, else the mean of both eyes by angle, or the "
      "better eye where the two differ vertically by more than half a degree in the median");
  schema.value("--trial", &GazeFileSettings::trial, "NUMBER|NAME", Touch::gaze,
               "Only this trial of the log, whose beginning becomes video time 0 ('gazetrace gaze trials' lists them)");
  return schema;
}

OptionSchema<GazeFileSettings> gaze_import_schema() {
  OptionSchema<GazeFileSettings> schema = gaze_choice_schema();
  add_column_options(schema);
  add_convention_options(schema);
  add_trial_options(schema);
  return schema;
}

OptionSchema<std::vector<std::string>> gaze_process_schema() {
  OptionSchema<std::vector<std::string>> schema;
  schema.group("Gaze in time");
  schema.repeated(
      "--gaze-process", whole<std::vector<std::string>, std::vector<std::string>>(), "STEP[:NAME=VALUE,...]",
      Touch::gaze,
      "A step of processing ('gazetrace list gaze-steps'), such as fill-gaps:max=75ms, median:samples=5 or "
      "noise:sd=0.5deg,seed=1; given once for each step, in the order of the steps. Measurements use the gaze as it "
      "was read");
  return schema;
}

void add_gaze_options(JobSchema& schema) {
  schema.group("Gaze log");
  schema
      .value("--gaze", at(&JobSettings::gaze, &GazeFileSettings::path), "FILE", Touch::gaze,
             "Where the viewer looked, over time")
      .decides_by_file()
      .with(Trait::gaze_source)
      .with(Trait::everyday);
  schema.include(gaze_choice_schema(), &JobSettings::gaze);
  add_time_options(schema);
  schema.include(gaze_process_schema(), &JobSettings::gaze_process).idle_when({without_gaze_log()});
}

}  // namespace gazetrace
