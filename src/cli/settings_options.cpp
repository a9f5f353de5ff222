// SPDX-License-Identifier: Apache-2.0
#include "cli/settings_options.hpp"

#include <fmt/format.h>

#include "cli/foveation_options.hpp"
#include "cli/presets.hpp"

namespace gazetrace {
namespace {

constexpr Influence kPixels = Influence::pixels;
constexpr Influence kFile = Influence::file;

void add_scene_options(OptionTable& table, JobSettings& job) {
  table.group("Scene and light");
  table.value("scene", job.scene, "FILE", "glTF 2.0 scene, .gltf or .glb", kFile);
  table.value("--animation", job.animation, "NAME|N",
              "The animation that plays, by name or number from 0; default: for each body and camera the first that "
              "moves it ('gazetrace scene' lists them)",
              kPixels);
  table.value("--env", job.environment, "FILE|sky|constant:R,G,B|none|auto",
              "Light from all around: a lat-long .hdr or .exr, the built-in sky, a constant radiance, or none; auto is "
              "the sky for a scene without light of its own, otherwise none",
              kFile);
  table.value("--env-rotation", job.environment_rotation_deg, "DEG", "Turns the environment about +y, degrees",
              kPixels);
  table.value("--env-ev", job.environment_ev, "STOPS", "Multiplies the environment by 2^STOPS", kPixels);
}

void add_camera_options(OptionTable& table, JobSettings& job) {
  table.group("Scene camera (what is pictured)");
  table.value("--camera", job.camera, "NAME|INDEX",
              "Camera of the glTF file by name or number from 0; default: the "
              "first one, or a view of the whole scene when it has none",
              kPixels);
  table.value("--camera-path", job.camera_path, "FILE",
              "Poses over time: gazetrace CSV (t[s],x[m],y[m],z[m],qx,qy,qz,qw), TUM, EuRoC, Nuke .chan, NeRF "
              "transforms.json or COLMAP images.txt",
              kFile);
  table.flag("--camera-from-gaze", job.camera_from_gaze,
             "The head's pose in a head-mounted display's log is the camera's path", kPixels);
  table.value("--camera-format", job.camera_read.format, "NAME", "Format of --camera-path; default: by its content",
              kPixels);
  table.value("--camera-axes", job.camera_read.axes, choices<CameraAxes>(),
              "Axes of the poses: gl looks along -z with y up, cv along +z with y down, unity left-handed along +z; "
              "default: the format's own, gl for CSV, TUM and EuRoC",
              kPixels);
  table.value("--camera-rotation-order", job.camera_read.rotation_order, choices<RotationOrder>(),
              "Order in which the angles of a .chan file turn, the first letter first", kPixels);
  table.value("--camera-fps", job.camera_fps, "RATE",
              "Frames a second of paths that count frames: .chan, NeRF, COLMAP; default: --fps", kPixels);
  table.value("--camera-up", job.camera_up, choices<WorldUp>(), "The axis of the path's world that points up", kPixels);
  table.value("--camera-turn", job.camera_placement.turn_deg, "DEG",
              "Turns a path or a head's poses about the scene's +y, to the left, degrees", kPixels);
  table.value("--camera-scale", job.camera_placement.scale, "FACTOR", "Metres per unit of the path", kPixels);
  table.value("--camera-start", job.camera_placement.start_m, "X,Y,Z",
              "Moves a path or a head's poses so that the first one is here, metres", kPixels);
  table.value("--camera-interpolation", job.camera_read.interpolation, choices<PathInterpolation>(),
              "Between two poses of the path", kPixels);
  table.value("--camera-extrapolation", job.camera_extrapolation, choices<CameraExtrapolation>(),
              "For frames before or after the path", kPixels);
  table.flag("--camera-keep-time", job.camera_read.keep_time,
             "Stamps of the path are video times; otherwise its first stamp is video time 0", kPixels);
  table.value("--eye", job.eye, "X,Y,Z", "A still camera at this point, metres", kPixels);
  table.value("--target", job.target, "X,Y,Z", "The point that --eye looks at, metres", kPixels);
  table.value("--up", job.up, "X,Y,Z", "Up for --eye", kPixels);
  table.value(
      "--yfov", job.yfov_deg, "DEG",
      "Vertical field of view in degrees for --eye and --camera-path (50 when not set); replaces that of a glTF "
      "camera when set",
      kPixels);
}

void add_lens_options(OptionTable& table, JobSettings& job) {
  table.group("Lens and shutter");
  table.value("--aperture", job.aperture, "f/N|METRES",
              "Depth of field: the lens's f-number, or the radius of its opening in metres; 0: a pinhole, all is sharp",
              kPixels);
  table.value("--focus-distance", job.focus_distance_m, "METRES",
              "What is sharp, along the view from the camera; needed with --aperture", kPixels);
  table.value("--sensor-height", job.sensor_height_mm, "MM",
              "Height of the picture on the sensor, millimetres: with the field of view it gives the focal length "
              "that f/N refers to",
              kPixels);
  table.value("--shutter", job.shutter, "PART|DEGdeg|OPEN,CLOSE",
              "Motion blur: how much of a frame's time the shutter is open, about its middle (0.5, 180deg), or from "
              "when to when (0.25,0.75); 0: off",
              kPixels);
}

void add_gaze_mapping_options(OptionTable& table, JobSettings& job) {
  table.group("Gaze in time");
  table.value("--gaze-at", job.gaze_at, "U,V",
              "A fixed gaze in fractions of the screen from its top left, in place of "
              "a log",
              kPixels);
  table.value("--gaze-mode", job.gaze_mode, choices<GazeInterpolation>(), "Which samples of the log a frame gets",
              kPixels);
  table.value(
      "--gaze-missing", job.gaze_missing, choices<NoGazePolicy>(),
      "For frames without usable gaze: hold the last (the centre before there is one), look at the centre, render "
      "uniformly, or stop",
      kPixels);
  table.value("--gaze-max-age", job.gaze_max_age, "DURATION", "An older sample counts as no gaze", kPixels);
  table.value("--gaze-max-gap", job.gaze_max_gap, "DURATION",
              "A longer step between two samples is a gap: not interpolated, and held samples in it are marked so",
              kPixels);
  table.value("--gaze-offset", job.gaze_offset, "DURATION", "t_video = scale (t_log - start) + offset", kPixels);
  table.value("--gaze-scale", job.gaze_scale, "FACTOR", "Clock rate of video over that of the log", kPixels);
  table.value("--gaze-start", job.gaze_start, "DURATION",
              "Time on the log's clock that is video time --gaze-offset; default: its first sample", kPixels);
  table.value("--gaze-latency", job.gaze_latency, "DURATION",
              "Sampling follows the gaze of this long ago; measurements keep the true gaze", kPixels);
  table.flag("--keep-ids", job.keep_ids,
             "Times of day of the log stay in plan, headers and records; otherwise time counts from its first sample");
  table.repeated(
      "--gaze-anchor", job.gaze_anchors, "LOG=VIDEO",
      "An event on both clocks, in place of --gaze-start, --gaze-offset and --gaze-scale: a time of the log or "
      "the text of its message, and the video time of it; with two or more, offset and scale are fitted",
      kPixels);
  add_gaze_process_options(table, job.gaze_process);
  table.flag("--gaze-uncertainty", job.gaze_uncertainty,
             "The fovea grows by what the gaze may be off: accuracy + precision + age x speed", kPixels);
  table.value("--gaze-accuracy", job.gaze_accuracy_deg, "DEG",
              "The tracker's systematic error; default: the mean error of the log's validations", kPixels);
  table.value("--gaze-precision", job.gaze_precision_deg, "DEG",
              "The tracker's scatter; default: the root mean square in the log's fixations", kPixels);
}

void add_frame_options(OptionTable& table, JobSettings& job) {
  table.group("Frames");
  table.value("--size", job.size, "WxH", "Size of the pictures in pixels", kPixels);
  table.value("--fps", job.fps, "RATE", "Frames a second: 24, 23.976 or 24000/1001", kPixels);
  table.value("--frames,--only-frame", job.frames, "LIST",
              "Which frames, counted from 1: 1-100, 1-100x2, 3,7,9-12; default: as long as the animated camera, else "
              "the gaze log, else frame 1");
  table.value("--start", job.start, "DURATION", "Video time at which frame 1 begins", kPixels);
  table.flag("--part", job.part,
             "The frames are a part of a sequence that other runs share: timing and run record carry the range in "
             "their names, 'gazetrace merge' joins them; frames that depend on those before need --resume-from, or "
             "--preroll");
  table.value("--sample-range", job.trace.samples, "A:B",
              "Only samples A to B - 1 of every pixel or block: keeps their sums in place of pictures, and 'gazetrace "
              "merge' makes the pictures once all parts are there, to the bit those of one run");
  table.value("--frame-rect", job.frame_rect, "X,Y,W,H",
              "Where the frame lies on the screen, in screen pixels; default: it fills the screen", kPixels);
}

void add_reconstruction_options(OptionTable& table, JobSettings& job) {
  table.group("Between the samples");
  table.value(
      "--filter", job.filter, "NAME",
      "Fills pixels between samples ('gazetrace list filters'). auto: guided for foveated frames; linear, which passes "
      "single pixels through, for uniform ones (without gaze all are), with --aperture or --shutter, --sample-range, "
      "--enhance-contrast and --accumulate-order before. One filter for all frames: where --gaze-missing uniform makes "
      "some of a log's uniform, they are guided, too. What guided takes from first hits shows no blur of lens and "
      "shutter",
      kPixels);
  table.value(
      "--pass-through", job.pass_through_samples, "SPP",
      "Pixels with at least so many samples keep their own mean in every filter; 0: guided and oidn smooth all; "
      "default: in a fovea of 8 and more its full rate, at most 16; none in uniform frames",
      kPixels);
  table.value(
      "--enhance-contrast", job.enhance_contrast, "0..1",
      "An enhancement, no estimate: raises what contrast blocks have left, as the eye's periphery misses contrast "
      "more than detail; 1: a wave of half the blocks' limit is as strong as at full rate",
      kPixels);
}

void add_accumulate_options(OptionTable& table, JobSettings& job) {
  AccumulateSettings& accumulate = job.accumulate;
  table.group("Over time");
  table.value("--accumulate", accumulate.mode, choices<AccumulateMode>(),
              "running: mean over frames while the camera stands still; reproject: what was seen before is looked up "
              "where camera, bodies and shapes have it now, and checked",
              kPixels);
  table.value("--accumulate-order", accumulate.order, choices<AccumulateOrder>(),
              "reproject: before or after the filter fills pixels between samples; guided: after", kPixels);
  table.value("--accumulate-frames", accumulate.frames, "N",
              "reproject: memory in frames; a pixel gathers N times a frame's samples; 0 forgets nothing", kPixels);
  table.value("--accumulate-blend", accumulate.blend, "SHARE",
              "reproject: a fixed share of the current frame where there is history, 1e-6..1; 0: by samples", kPixels);
  table.value("--accumulate-clip", accumulate.clip_sigmas, "SIGMAS",
              "reproject: history stays within so many standard deviations of the current neighborhood; 0: anywhere",
              kPixels);
  table.flag("--accumulate-reset-saccades", accumulate.reset_at_saccades,
             "reproject: nothing of the past in frames since whose predecessor the eye has jumped", kPixels);
  table.flag("--accumulate-reset-blinks", accumulate.reset_at_blinks,
             "reproject: nothing of the past in frames since whose predecessor the eye was closed", kPixels);
  table.value(
      "--checkpoint", job.checkpoint, "FILE",
      "What is accumulated and the smoothed exposure, to the bit, after the last frame; --resume makes it where it "
      "is missing");
  table.value("--checkpoint-every", job.checkpoint_every, "N", "Also after every N frames; 0: only at the end");
  table.value("--resume-from", job.resume_from, "FILE",
              "Begins with a checkpoint, which must be of the same settings: as if in one run with the frames before");
  table.value("--preroll", job.preroll, "N",
              "Renders up to N frames before the first for what they leave behind, and writes them not");
}

void add_trace_options(OptionTable& table, JobSettings& job) {
  table.group("Light transport");
  table.value("--bounces", job.trace.max_bounces, "N", "Scattering events on a path; 0 shows emission only", kPixels);
  table.flag("--russian-roulette", job.trace.russian_roulette,
             "Ends dim paths early from the third bounce on, without bias", kPixels);
  table.value("--diffuse", job.trace.diffuse, choices<DiffuseModel>(), "Diffuse lobe", kPixels);
  table.value("--light-sampling", job.trace.light_sampling, choices<LightSampling>(),
              "Lights and surfaces together (mis), or one of them alone", kPixels);
  table.flag("--compensate-environment", job.trace.compensate_environment,
             "Light samples of the environment go where it stands out: less noise in the open, more indoors", kPixels);
  table.value("--clamp-indirect", job.trace.clamp_indirect, "RADIANCE",
              "Most that a sample may add after more than one scattering event: fewer fireflies, with bias; 0: off",
              kPixels);
  table.value("--pixel-filter", job.trace.filter, choices<PixelFilter>(),
              "Spread of the samples of a pixel; --filter guided has edges and texture of a box in any case", kPixels);
  table.value(
      "--pixel-cone", job.trace.pixel_cone, "PIXELS",
      "Texture detail at first hits: width of a camera ray's footprint; 0: full resolution, averaged by the samples; "
      "with --filter guided never less than 1",
      kPixels);
  table.value("--bounce-cone", job.trace.bounce_cone_rad, "RADIANS",
              "Texture detail after bounces: how much a diffuse bounce widens the footprint; 0: not at all", kPixels);
  table.value("--seed", job.trace.seed, "N", "Same seed, same pictures, for any number of threads", kPixels);
  table.value("--bvh", job.bvh, choices<BvhQuality>(), "Build quality of the ray tracing tree");
  table.value("--threads", job.threads, "N", "0: as many as the machine has; pictures do not depend on it");
  table.value("--only-pixel", job.only_pixel, "X,Y",
              "Traces only the samples of this pixel, for replaying a bad one; without --output it is printed",
              kPixels);
}

void add_color_options(OptionTable& table, JobSettings& job) {
  table.group("Exposure and colour");
  table.value("--exposure", job.exposure, "STOPS|auto", "Stops, or auto for the log-average, with a shift: auto+0.5",
              kPixels);
  table.value("--exposure-key", job.exposure.key, "LUMINANCE", "Luminance that auto brings the log-average to",
              kPixels);
  table.value("--exposure-smoothing", job.exposure_smoothing, "DURATION", "Time constant over video time; 0s: off",
              kPixels);
  add_ocio_config_options(table, job.color);
  table.value("--display", job.color.display, "NAME",
              "OpenColorIO display; default: the config's ('gazetrace list "
              "views')",
              kPixels);
  table.value("--view", job.color.view, "NAME", "OpenColorIO view; default: the display's", kPixels);
  table.value("--look", job.color.look, "NAME", "OpenColorIO look; default: the view's", kPixels);
  table.value("--view-precision", job.color.precision, choices<ViewPrecision>(),
              "exact: OpenColorIO for every pixel; baked: a table where it is within half an 8-bit code value of that, "
              "several times faster; auto: baked for the built-in ACES view at 8 bits",
              kPixels);
}

void add_output_options(OptionTable& table, JobSettings& job) {
  table.group("Files");
  table.repeated(
      "-o,--output", job.outputs, "PATTERN",
      "Linear pictures (.exr) and display pictures (.png .jpg .tif .dpx), one option each; the frame's number "
      "stands where ####, %04d or <frame> is");
  table.value("--exr-pixels", job.exr.pixels, choices<ExrPixels>(), "Type of the colour channels", kPixels);
  table.value("--exr-compression", job.exr.compression, "NAME",
              "none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa or dwab", kPixels);
  table.value("--exr-zip-level", job.exr.zip_level, "1..9",
              "Of zip and zips: 1 fast, 9 small; lossless at every level");
  table.value("--aov", job.exr.aovs, "NAME,NAME", "More channels of the .exr ('gazetrace list aovs')", kPixels);
  table.value("--map", job.map_pattern, "PATTERN", "Sampling maps (.exr): region, samples a pixel, eccentricity");
  table.value("--bits", job.picture.bits, "8|16", "Bits a channel of .png and .tif", kPixels);
  table.value("--jpeg-quality", job.picture.quality, "1..100", "Quality of .jpg", kPixels);
  table.flag("--overwrite", job.overwrite, "Replaces files that are there");
  table.flag("--resume", job.resume, "Keeps finished frames of the same settings and renders the rest");
  table.group("Talk");
  table.value("--progress", job.progress, "auto|always|never",
              "A bar on a terminal, plain lines elsewhere (auto); "
              "always: the bar");
  table.flag("--quiet", job.quiet, "No progress and no summary; warnings and errors stay");
}

}  // namespace

void add_gaze_file_options(OptionTable& table, GazeFileSettings& gaze) {
  GazeColumns& columns = gaze.read.columns;
  table.group("Gaze log");
  table.value("--gaze-format", gaze.read.format, "NAME", "Default: by its content ('gazetrace list gaze-formats')",
              kPixels);
  table.value("--gaze-time-column", columns.time, "NAME", "Column of the stamps", kPixels);
  table.value("--gaze-x-column", columns.x, "NAME", "Column of the horizontal position, or direction x", kPixels);
  table.value("--gaze-y-column", columns.y, "NAME", "Column of the vertical position, or direction y", kPixels);
  table.value("--gaze-z-column", columns.z, "NAME", "Column of direction z", kPixels);
  table.value("--gaze-validity-column", columns.validity, "NAME", "Column that says which samples are good", kPixels);
  table.value("--gaze-valid-values", columns.valid_values, "TEXT,TEXT",
              "What good samples have in it; default: 1, true, ok, valid", kPixels);
  table.value("--gaze-confidence-column", columns.confidence, "NAME", "Column of the confidence", kPixels);
  table.value("--gaze-pupil-column", columns.pupil, "NAME", "Column of the pupil's size", kPixels);
  table.value("--gaze-eye-column", columns.eye, "NAME", "Column of the eye", kPixels);
  table.value("--gaze-time-unit", columns.time_unit, choices<TimeUnit>(), "Unit of the stamps", kPixels);
  table.value("--gaze-unit", columns.position_unit, choices<PositionUnit>(), "Unit of the positions", kPixels);
  table.value("--gaze-origin", columns.origin, choices<PositionOrigin>(), "Where (0, 0) is", kPixels);
  table.flag("--gaze-sort", gaze.sort, "Sorts unordered stamps and keeps the last of equal ones", kPixels);
  table.value("--gaze-columns", gaze.columns_file, "FILE",
              "Column map as JSON, for tables of one's own; 'gazetrace gaze inspect --save-columns' writes one", kFile);
  table.value("--gaze-axes", columns.axes, choices<GazeAxes>(),
              "Axes of directions: gl looks along -z, unity left-handed along +z, sranipal along +z with x to the "
              "left, cv along +z with y down; default: the format's own",
              kPixels);
  table.value("--gaze-frame", gaze.read.frame, choices<GazeFrame>(),
              "Of logs that know several: head takes directions from the head, scene-camera places on its picture",
              kPixels);
  table.value("--gaze-eye", gaze.read.eye, choices<EyeChoice>(),
              "Of binocular logs: auto takes the log's combined gaze, else the mean of both eyes in angle", kPixels);
  table.value("--gaze-dominant", gaze.read.dominant_eye, choices<Eye>(), "The eye of --gaze-eye dominant", kPixels);
  table.value("--gaze-min-confidence", gaze.min_confidence, "SHARE",
              "Samples below it are not used; default: the format's own, such as 0.6 for Pupil Core", kPixels);
  table.flag("--gaze-zero-missing", gaze.read.zero_is_missing, "Takes positions of exactly (0, 0) for missing ones",
             kPixels);
  table.value("--gaze-missing-value", gaze.read.missing_value, "VALUE",
              "What the log has in both axes, such as -1, where it has no position; -32768, and 1e7 and beyond, are "
              "always taken for that",
              kPixels);
  table.flag("--gaze-swap-xy", gaze.read.swap_xy, "Exchanges the two axes", kPixels);
  table.flag("--gaze-flip-x", gaze.read.flip_x, "Exchanges left and right", kPixels);
  table.flag("--gaze-flip-y", gaze.read.flip_y, "Exchanges top and bottom", kPixels);
  table.flag("--gaze-decimal-comma", gaze.read.decimal_comma,
             "Numbers have decimal commas though commas separate the columns; not needed with tabs or semicolons",
             kPixels);
}

void add_gaze_process_options(OptionTable& table, std::vector<std::string>& steps) {
  table.repeated(
      "--gaze-process", steps, "STEP[:NAME=VALUE,...]",
      "A step of processing, one option each, in this order ('gazetrace list gaze-steps'): "
      "fill-gaps:max=75ms, median:samples=5, noise:sd=0.5deg,seed=1. Measurements keep the gaze as it was read",
      kPixels);
}

void add_screen_options(OptionTable& table, ScreenSettings& screen) {
  table.group("Screen (where the eye is)");
  table.value("--screen", screen.name, "NAME|FILE",
              "A known screen and its distance ('gazetrace list screens'), or a .json file; default: what the gaze log "
              "states",
              kPixels);
  table.value("--screen-px", screen.size_px, "W,H", "Resolution of the screen", kPixels);
  table.value("--screen-cm", screen.size_cm, "W,H", "Size of its active area, centimetres", kPixels);
  table.value("--screen-distance-cm", screen.distance_cm, "CM", "Eye to screen, centimetres", kPixels);
  table.value("--screen-eye-cm", screen.eye_cm, "X,Y",
              "Where the eye's perpendicular meets the screen, from its centre, right and up, centimetres", kPixels);
  table.value("--screen-ppd", screen.pixels_per_degree, "PIXELS",
              "Pixels a degree in the middle of the screen, in place of its size and distance", kPixels);
}

// Only what is rendered is watched on another screen than it was recorded on.
void add_transfer_options(OptionTable& table, JobSettings& job) {
  table.value("--recording-screen", job.recording_screen, "NAME|FILE",
              "The screen of the recording where it is not --screen; default: what the gaze log states", kPixels);
  table.value(
      "--gaze-transfer", job.gaze_transfer, choices<GazeTransfer>(),
      "From the recording's screen to another: places stay (fraction) or angles do; needed where they differ by "
      "more than 2 %",
      kPixels);
}

void add_ocio_config_options(OptionTable& table, ColorSettings& color) {
  table.value("--ocio", color.config, "FILE", "OpenColorIO config; default: $OCIO, else the built-in one", kFile);
  table.value("--ocio-input", color.input, "NAME",
              "The config's name of linear Rec.709, where it has no aces_interchange role", kPixels);
}

void add_job_options(OptionTable& table, JobSettings& job) {
  add_preset_option(table, job.preset);  // first: other options go over it
  add_scene_options(table, job);
  add_camera_options(table, job);
  add_lens_options(table, job);
  table.group("Gaze log");
  table.value("--gaze", job.gaze.path, "FILE", "Where the viewer looked, over time", kFile);
  add_gaze_file_options(table, job.gaze);
  add_gaze_mapping_options(table, job);
  add_screen_options(table, job.screen);
  add_transfer_options(table, job);
  add_frame_options(table, job);
  add_foveation_options(table, job.foveation);
  add_reconstruction_options(table, job);
  add_accumulate_options(table, job);
  add_trace_options(table, job);
  add_color_options(table, job);
  add_output_options(table, job);
}

}  // namespace gazetrace
