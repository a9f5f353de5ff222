// SPDX-License-Identifier: Apache-2.0
// The options of `compare`. What it shares with `render` has the same names there.
#include "cli/compare_inputs.hpp"

namespace gazetrace {

template <>
struct EnumNames<DisplayResponse> {
  static constexpr const char* kWhat = "display response";
  static NameList<DisplayResponse> values() {
    return {{DisplayResponse::srgb, "srgb"},
            {DisplayResponse::gamma22, "gamma2.2"},
            {DisplayResponse::gamma24, "gamma2.4"},
            {DisplayResponse::linear, "linear"},
            {DisplayResponse::pq, "pq"},
            {DisplayResponse::linear_hdr, "linear-hdr"}};
  }
};
template <>
struct EnumNames<FlipToneMapper> {
  static constexpr const char* kWhat = "tone mapper";
  static NameList<FlipToneMapper> values() {
    return {{FlipToneMapper::aces, "aces"}, {FlipToneMapper::hable, "hable"}, {FlipToneMapper::reinhard, "reinhard"}};
  }
};

namespace {

void add_metric_options(OptionTable& table, CompareJob& job) {
  MetricSettings& metric = job.settings.metric;
  table.group("Metrics");
  table.value(
      "--metrics", job.metrics, "NAME,NAME",
      "Which ('gazetrace list metrics'); default: mse, relmse, psnr, ssim, flip and, where screen and gaze are known, "
      "fovvideovdp and, from a second on, flicker");
  table.repeated("--fail-above", job.fail_above, "METRIC=VALUE",
                 "Exit code 1 where the sequence's value is larger; for metrics of which less is better");
  table.repeated("--fail-below", job.fail_below, "METRIC=VALUE",
                 "Exit code 1 where it is smaller; for metrics of which more is better");
  table.value(
      "--response", metric.response, choices<DisplayResponse>(),
      "How the display turns code values into light; pq: SMPTE ST 2084; linear-hdr: the pictures (.exr, .hdr) hold "
      "cd/m2 and no view is applied, metrics of code values see PQ");
  table.value("--relmse-epsilon", metric.relmse_epsilon, "VALUE", "Added to the squared reference in relmse");
  table.value("--flip-tone-mapper", metric.hdr_flip.tone_mapper, "aces|hable|reinhard", "Curve of hdr_flip");
  table.value("--flip-start", metric.hdr_flip.start_ev, "STOPS",
              "First exposure of hdr_flip; default: from the first reference frame");
  table.value("--flip-stop", metric.hdr_flip.stop_ev, "STOPS", "Last exposure of hdr_flip");
  table.value("--flip-count", metric.hdr_flip.count, "N", "Number of exposures of hdr_flip");
  DisplayPhotometry& photometry = job.settings.photometry;
  table.value(
      "--peak-cd-m2", photometry.peak_cd_m2, "CD_M2",
      "Luminance of the display's white, for fovvideovdp and flicker, and for all metrics with pq and linear-hdr");
  table.value("--contrast", photometry.contrast, "RATIO", "White over the display's own black, for fovvideovdp");
  table.value("--ambient-lux", photometry.ambient_lux, "LUX", "Light that falls on the display, for fovvideovdp");
  table.value("--reflectivity", photometry.reflectivity, "SHARE", "How much of it comes back, for fovvideovdp");
  table.flag("--correct-border", job.correct_border,
             "fovvideovdp treats the right border rightly where its authors' program does not; such scores do not "
             "compare with theirs");
}

void add_sequence_options(OptionTable& table, CompareJob& job) {
  table.group("Frames and gaze");
  table.value("--frames", job.frames, "LIST", "Which frames; default: those that are there");
  table.value("--fps", job.fps, "RATE", "Frames a second; default: what the pictures or their run record say");
  table.flag("--anyway", job.anyway, "Scores sequences whose frames, views, exposures or gaze differ");
  table.value("--gaze", job.shared.gaze.path, "FILE",
              "Where the viewer looked; default: gaze_true of the reference's pictures, else of the test's",
              Influence::file);
  table.value("--gaze-at", job.shared.gaze_at, "U,V", "A fixed gaze in fractions of the screen from its top left");
  table.value("--gaze-mode", job.shared.gaze_mode, "hold|nearest|linear", "Which samples of the log a frame gets");
  table.value("--gaze-offset", job.shared.gaze_offset, "DURATION", "t_video = scale (t_log - start) + offset");
  table.value("--gaze-start", job.shared.gaze_start, "DURATION",
              "Time on the log's clock that is video time --gaze-offset; default: its first sample");
  table.value("--region-angles", job.region_angles_deg, "DEG,DEG",
              "Where fovea and intermediate region end; default: those of the run, else 5.2,17");
  table.value("--angle-reading", job.reading, choices<AngleReading>(),
              "The angles are diameters (full-angle) or eccentricities");
  table.value("--frame-rect", job.shared.frame_rect, "X,Y,W,H",
              "Where the frame lies on the screen, in screen pixels; default: as rendered, else it fills the screen");
}

void add_result_options(OptionTable& table, CompareJob& job) {
  table.group("Exposure and colour of .exr pictures");
  table.value("--exposure", job.exposure_ev, "STOPS", "For both; default: the reference's own, frame by frame");
  add_ocio_config_options(table, job.shared.color);
  table.value("--display", job.shared.color.display, "NAME", "OpenColorIO display; default: the reference's");
  table.value("--view", job.shared.color.view, "NAME", "OpenColorIO view; default: the reference's");
  table.group("Results");
  table.value("--csv", job.csv, "FILE", "One row a frame and metric, written as it goes");
  table.value("--json", job.json, "FILE", "Everything as JSON");
  table.value("--maps", job.maps, "FOLDER", "Error maps as pictures, METRIC.####.png");
  table.flag("--map-overlay", job.map_overlay, "Draws gaze and borders of the retinal regions into them");
  table.flag("--overwrite", job.overwrite, "Replaces outputs that are there");
  table.value("--threads", job.shared.threads, "N", "0: as many as the machine has; numbers do not depend on it");
}

}  // namespace

void add_compare_options(OptionTable& table, CompareJob& job) {
  add_metric_options(table, job);
  add_sequence_options(table, job);
  add_gaze_file_options(table, job.shared.gaze);
  add_screen_options(table, job.shared.screen);
  add_result_options(table, job);
}

}  // namespace gazetrace
