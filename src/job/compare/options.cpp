// SPDX-License-Identifier: Apache-2.0
// The options of `compare`. What it shares with `render` has the same names there.
#include "gazetrace/compare_inputs.hpp"

namespace gazetrace {
namespace {

constexpr const char* kColor = "Exposure and colour of .exr pictures";

template <class Member>
auto shared(Member member) {
  return at(&CompareJob::shared, member);
}

void add_limits(OptionSchema<CompareJob>& schema) {
  schema.repeated("--fail-above", &CompareJob::fail_above, "METRIC=VALUE",
                  "Exit code 1 where the sequence's value is larger; for metrics of which less is better");
  schema.repeated("--fail-below", &CompareJob::fail_below, "METRIC=VALUE",
                  "Exit code 1 where it is smaller; for metrics of which more is better");
}

void add_sequence_options(OptionSchema<CompareJob>& schema) {
  schema.group("Frames and gaze");
  schema.value("--frames", &CompareJob::frames, "LIST", "Which frames; default: those that are there");
  schema.value("--fps", &CompareJob::fps, "RATE", "Frames a second; default: from the pictures or their run record");
  schema.flag("--anyway", &CompareJob::anyway, "Scores sequences whose frames, views, exposures or gaze differ");
  schema.value("--gaze", at(&CompareJob::shared, &JobSettings::gaze, &GazeFileSettings::path), "FILE",
               "Where the viewer looked; default: gaze_true of the reference's pictures, else of the test's");
  schema.value("--gaze-at", shared(&JobSettings::gaze_at), "U,V",
               "A fixed gaze in fractions of the screen from its top left");
  schema.value("--gaze-mode", shared(&JobSettings::gaze_mode), "hold|nearest|linear",
               "Which samples of the log a frame gets");
  schema.value("--gaze-offset", shared(&JobSettings::gaze_offset), "DURATION",
               "t_video = scale (t_log - start) + offset");
  schema.value("--gaze-start", shared(&JobSettings::gaze_start), "DURATION",
               "Time on the log's clock that is video time --gaze-offset; default: its first sample");
  schema.value("--region-eccentricities", &CompareJob::region_eccentricities_deg, "DEG,DEG",
               "Where fovea and intermediate region end; default: those of the run, else 2.6,8.5");
  schema.value("--frame-rect", shared(&JobSettings::frame_rect), "X,Y,W,H",
               "Where the frame lies on the screen, in screen pixels; default: as rendered, else it fills the screen");
}

void add_result_options(OptionSchema<CompareJob>& schema) {
  schema.group(kColor);
  schema.value("--exposure", &CompareJob::exposure_ev, "STOPS",
               "For both; default: the reference's own, frame by frame");
  schema.include(color_config_schema().with_headings([](const Option&) { return kColor; }),
                 shared(&JobSettings::color));
  schema.value("--display", at(&CompareJob::shared, &JobSettings::color, &ColorSettings::display), "NAME",
               "OpenColorIO display; default: the reference's");
  schema.value("--view", at(&CompareJob::shared, &JobSettings::color, &ColorSettings::view), "NAME",
               "OpenColorIO view; default: the reference's");
  schema.group("Results");
  schema.value("--csv", &CompareJob::csv, "FILE", "One row a frame and metric, written as it goes");
  schema.value("--json", &CompareJob::json, "[FILE]",
               "Results as JSON, into a .json file, or on stdout in place of text (no FILE, or -)");
  schema.value("--maps", &CompareJob::maps, "FOLDER", "Error maps as pictures, METRIC.####.png");
  schema.flag("--map-overlay", &CompareJob::map_overlay, "Draws gaze and borders of the retinal regions into them");
  schema.flag("--overwrite", &CompareJob::overwrite, "Replaces outputs that are there");
  schema.value("--threads", shared(&JobSettings::threads), "N",
               "0: as many as the machine has; numbers do not depend on it");
}

}  // namespace

OptionSchema<CompareJob> compare_schema() {
  OptionSchema<CompareJob> schema;
  schema.include(metric_schema(), whole<CompareJob, MetricChoice>());
  schema.value("--pooling-weights", &CompareJob::pooling_weights, "FILE",
               "A picture in the frames' size whose red channel says how much each pixel counts in fovvideovdp's means "
               "over a frame, as where windows stand for the whole; other metrics are refused beside it");
  add_limits(schema);
  add_sequence_options(schema);
  schema.include(gaze_choice_schema(), shared(&JobSettings::gaze));
  schema.include(screen_schema(), shared(&JobSettings::screen));
  add_result_options(schema);
  return schema;
}

}  // namespace gazetrace
