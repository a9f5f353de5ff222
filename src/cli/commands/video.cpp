// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/video.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/compare_inputs.hpp"

namespace gazetrace {

template <>
struct EnumNames<VideoCodec> {
  static constexpr const char* kWhat = "codec";
  static NameList<VideoCodec> values() {
    return {{VideoCodec::h264, "h264"}, {VideoCodec::hevc, "hevc"}, {VideoCodec::ffv1, "ffv1"}};
  }
};

namespace {

constexpr const char* kContingent =
    "Gaze-contingent: sampled for the gaze of one viewer. Other viewers look elsewhere and see other errors.";

struct VideoArguments {
  CompareJob job;  // its reference and test are the two sequences; the same one twice where there is one
  std::string output, color;
  VideoSettings video;
  std::vector<std::string> labels;  // of the sequences, from the left
  bool show_gaze = false, show_rings = false, fixation_mark = false, insets = false, overwrite = false;
  JsonOutput json;
};

DisplayImage display_image_of(const ImageRgb& code) {
  DisplayImage image{code.width_px, code.height_px, 8, {}};
  image.bytes.reserve(3 * code.pixels.size());
  for (const Vec3f& pixel : code.pixels) {
    for (const float channel : {pixel.x, pixel.y, pixel.z}) {
      image.bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(channel, 0.0F, 1.0F))));
    }
  }
  return image;
}

// Frames a second in exact numbers: of the run record, or the nearest of n and n/1.001.
FrameRate frame_rate(const CompareJob& job, const CompareInputs& inputs) {
  if (job.fps) {
    return *job.fps;
  }
  if (inputs.reference_run) {
    return inputs.reference_run->settings().fps;
  }
  const double rate = inputs.frames_per_second;
  if (!(rate > 0)) {
    throw Error(ErrorKind::usage, job.reference, "the pictures do not say their frame rate", "give --fps");
  }
  const double whole = std::round(rate);
  constexpr double kSame = 1e-6;
  if (std::fabs(rate - whole) < kSame) {
    return {static_cast<std::int64_t>(whole), 1};
  }
  return {std::llround(rate * 1001), 1001};
}

// A sequence of every third frame lasts as long as the whole one.
FrameRate thinned(const FrameRate& rate, const std::vector<std::int32_t>& frames) {
  std::set<std::int32_t> steps;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    steps.insert(frames[i] - frames[i - 1]);
  }
  if (steps.size() > 1) {
    print_warnings({"frames are missing in between: the video does not keep time"});
    return rate;
  }
  return steps.empty() ? rate : FrameRate{rate.numerator, rate.denominator * *steps.begin()};
}

const JobSettings* foveated_run(const CompareInputs& inputs) {
  for (const auto* const run : {&inputs.test_run, &inputs.reference_run}) {
    if (*run && !is_uniform((*run)->settings().foveation.sampling)) {
      return &(*run)->settings();
    }
  }
  return nullptr;
}

// Where regions end; about densities, which end nowhere, a scale.
std::vector<double> ring_angles_deg(const JobSettings* run) {
  if (run == nullptr) {
    return {};
  }
  const RegionSampling* const regions = regions_of(run->foveation.sampling);
  return regions == nullptr ? std::vector{5.0, 10.0, 20.0}
                            : std::vector(regions->eccentricities_deg.begin(), regions->eccentricities_deg.end());
}

class FrameMaker {
 public:
  FrameMaker(const VideoArguments& arguments, const CompareInputs& inputs)
      : arguments_(arguments),
        inputs_(inputs),
        rings_deg_(ring_angles_deg(foveated_run(inputs))),
        color_(compare_color(arguments.job, inputs)) {
    print_warnings(color_.warnings());
    if (const std::size_t shown = arguments.job.test == arguments.job.reference ? 1 : 2;
        arguments.labels.size() > shown) {
      throw Error(ErrorKind::usage, "--labels",
                  fmt::format("there are {} for {} sequence{}", arguments.labels.size(), shown, shown == 1 ? "" : "s"),
                  "give one for each, without commas in it");
    }
    if (arguments.show_rings && (rings_deg_.empty() || !inputs.screen)) {
      throw Error(
          ErrorKind::usage, "--show-rings",
          rings_deg_.empty() ? "no run record beside the pictures tells of a run with gaze" : "the screen is not known",
          rings_deg_.empty() ? "leave it out" : "give --screen");
    }
  }

  DisplayImage make(std::int32_t frame) {
    const CompareJob& job = arguments_.job;
    const std::string left_path = picture_path(job.reference, frame);
    const ComparedPicture left = read_compared_picture(left_path);
    is_linear_ = left.is_linear;
    const double ev = left.facts.exposure_ev.value_or(0);
    DisplayImage image = shown(left, ev);
    const std::string right_path = picture_path(job.test, frame);
    const FrameFacts right_facts = job.test == job.reference ? left.facts : read_frame_facts(right_path);
    const ComparedGaze gaze =
        compared_gaze(job, inputs_, left.facts, right_facts, frame, image.width_px, image.height_px);
    mark(image, gaze.px, 0);
    if (job.test != job.reference) {
      const ComparedPicture right = read_compared_picture(right_path);
      check_comparable(job, inputs_, left, right, left_path, right_path);
      DisplayImage other = shown(right, ev);
      mark(other, gaze.px, 1);
      image = side_by_side(image, other);
    }
    return image;
  }
  [[nodiscard]] std::string view() const {
    return is_linear_ ? color_.description() : inputs_.reference_run ? inputs_.reference_run->view : "";
  }
  [[nodiscard]] bool any_gaze() const { return any_gaze_; }

 private:
  [[nodiscard]] DisplayImage shown(const ComparedPicture& picture, double ev) const {
    return picture.is_linear ? color_.apply(picture.picture.light, ev, 8, arguments_.job.shared.threads)
                             : display_image_of(picture.picture.code);
  }
  // What the ring is stands under it all, where there are labels.
  void draw_labels(DisplayImage& image, std::size_t place) const {
    if (place >= arguments_.labels.size()) {
      return;
    }
    const int dot_px = std::max(1, image.width_px / 320);
    draw_label(image, {4.0 * dot_px, 4.0 * dot_px}, arguments_.labels[place], dot_px);
    if (arguments_.show_gaze) {
      const double top_px = image.height_px - 15.0 * dot_px;
      draw_label(image, {4.0 * dot_px, top_px}, "   gaze", dot_px);
      draw_gaze_ring(image, {13.0 * dot_px, top_px + 5.5 * dot_px}, 3.5 * dot_px, dot_px);
    }
  }
  void mark(DisplayImage& image, const std::optional<Vec2d>& gaze_px, std::size_t place) {
    const DisplayImage clean = arguments_.insets ? image : DisplayImage{};
    draw(image, gaze_px, place);
    if (arguments_.insets) {
      image = with_insets(image, clean, gaze_px);
    }
  }
  void draw(DisplayImage& image, const std::optional<Vec2d>& gaze_px, std::size_t place) {
    draw_labels(image, place);
    if (!gaze_px) {
      return;
    }
    any_gaze_ = true;
    const double unit_px = std::max(1.0, image.width_px / 640.0);
    const std::optional<PlanarView> view = compare_view(inputs_, image.width_px, image.height_px);
    if (arguments_.show_rings && view) {
      for (const double angle_deg : rings_deg_) {
        draw_eccentricity_ring(image, *view, *gaze_px, angle_deg, unit_px);
      }
    }
    if (arguments_.fixation_mark) {
      constexpr double kDefaultPixelsPerDegree = 30;  // of a frame 1280 pixels wide
      draw_fixation_mark(image, *gaze_px,
                         view ? 1 / (view->step_x * kDegPerRad) : kDefaultPixelsPerDegree * image.width_px / 1280.0);
    }
    if (arguments_.show_gaze) {
      draw_gaze_ring(image, *gaze_px, 10 * unit_px, 1.5 * unit_px);
    }
  }

  const VideoArguments& arguments_;
  const CompareInputs& inputs_;
  std::vector<double> rings_deg_;
  ColorPipeline color_;
  bool is_linear_ = false;
  bool any_gaze_ = false;
};

int run_video(VideoArguments& arguments) {
  CompareJob& job = arguments.job;
  if (arguments.output.empty()) {
    throw Error(ErrorKind::usage, "--output", "is not given", "name a .mp4, .mov or .mkv file");
  }
  if (job.test.empty()) {
    job.test = job.reference;
  }
  if (!has_frame_number(job.reference) || !has_frame_number(job.test)) {
    throw Error(ErrorKind::usage, has_frame_number(job.reference) ? job.test : job.reference, "is no sequence",
                "name it as name.####.png");
  }
  const CompareInputs inputs = load_compare_inputs(job);
  VideoSettings& video = arguments.video;
  video.fps = thinned(frame_rate(job, inputs), inputs.frames);
  video.threads = job.shared.threads;
  check_video_settings(arguments.output, video);
  arguments.json.check({arguments.output}, compared_files(job, inputs));
  FrameMaker maker(arguments, inputs);
  DisplayImage image = maker.make(inputs.frames.front());
  video.color = arguments.color.empty() ? video_color_of_view(maker.view()) : video_color_by_name(arguments.color);
  const bool is_contingent = foveated_run(inputs) != nullptr;
  video.comment = is_contingent ? kContingent : "";
  VideoWriter writer(arguments.output, image.width_px, image.height_px, video);
  writer.add(image);
  for (std::size_t i = 1; i < inputs.frames.size(); ++i) {
    writer.add(maker.make(inputs.frames[i]));
  }
  const bool wants_gaze = arguments.show_gaze || arguments.show_rings || arguments.fixation_mark || arguments.insets;
  if (wants_gaze && !maker.any_gaze()) {
    throw Error(ErrorKind::input, job.reference, "the frames do not say where the gaze was",
                "give --gaze or --gaze-at, or name the .exr files of the run");
  }
  writer.finish();
  arguments.json.print(fmt::format("{}: {} frames of {}x{}, {} a second, colors {}\n{}", arguments.output,
                                   inputs.frames.size(), image.width_px, image.height_px, format_value(video.fps),
                                   video.color.name, is_contingent ? std::string(kContingent) + "\n" : ""),
                       [&] {
                         const nlohmann::ordered_json json{
                             {"video", arguments.output},       {"frames", inputs.frames.size()},
                             {"width_px", image.width_px},      {"height_px", image.height_px},
                             {"fps", format_value(video.fps)},  {"color", video.color.name},
                             {"gaze_contingent", is_contingent}};
                         return json.dump(2) + "\n";
                       });
  return exit_done;
}

constexpr const char* kColor = "Color of .exr pictures";

OptionSchema<VideoArguments> video_schema() {
  const auto job = [](auto... members) { return at(&VideoArguments::job, members...); };
  const auto shared = [](auto... members) { return at(&VideoArguments::job, &CompareJob::shared, members...); };
  OptionSchema<VideoArguments> schema;
  schema.group("Video");
  schema.value("-o,--output", &VideoArguments::output, "FILE", "A .mp4, .mov or .mkv; appears when it is complete");
  schema.value("--codec", at(&VideoArguments::video, &VideoSettings::codec), "h264|hevc|ffv1",
               "h264 and hevc: 8 bits, 4:2:0; ffv1: RGB without loss, .mkv only");
  schema.value("--crf", at(&VideoArguments::video, &VideoSettings::crf), "0..51",
               "Quality of h264 and hevc, less is better");
  schema.value("--color", &VideoArguments::color, "srgb|rec709|display-p3|linear",
               "Colour space that the file states; default: that of the run's view");
  schema.value("--ffmpeg", at(&VideoArguments::video, &VideoSettings::program), "PROGRAM", "The ffmpeg program");
  schema.flag("--overwrite", &VideoArguments::overwrite, "Replaces the file when it is there");
  schema.group("Marks");
  schema.flag("--show-gaze", &VideoArguments::show_gaze, "Draws a ring about the true gaze");
  schema.flag("--show-rings", &VideoArguments::show_rings,
              "Draws where the regions end, or else 5, 10 and 20 degrees from the gaze");
  schema.flag("--fixation-mark", &VideoArguments::fixation_mark,
              "Draws a mark to look at where the viewer looked (0.6 degrees; Thaler et al. 2013)");
  schema.flag("--insets", &VideoArguments::insets,
              "Shows two parts below each picture, about the gaze and far from it, three times as large");
  schema.value("--labels", &VideoArguments::labels, "TEXT,TEXT",
               "Writes these names of the sequences into their corners, in capitals, and with --show-gaze the meaning "
               "of the ring");
  schema.group("Frames and gaze");
  schema.value("--frames", job(&CompareJob::frames), "LIST", "Which frames; default: those that are there");
  schema.value("--fps", job(&CompareJob::fps), "RATE", "Frames a second; default: from the run record or the pictures");
  schema.flag("--anyway", job(&CompareJob::anyway),
              "Shows sequences beside each other whose frames, views or exposures differ");
  schema.value("--gaze", shared(&JobSettings::gaze, &GazeFileSettings::path), "FILE",
               "Where the viewer looked; default: from the pictures");
  schema.value("--gaze-at", shared(&JobSettings::gaze_at), "U,V",
               "A fixed gaze in fractions of the screen from its top left");
  schema.value("--gaze-offset", shared(&JobSettings::gaze_offset), "DURATION",
               "t_video = scale (t_log - start) + offset");
  schema.value("--frame-rect", shared(&JobSettings::frame_rect), "X,Y,W,H",
               "Where the frame lies on the screen, in screen pixels; default: as rendered, else it fills the screen");
  schema.include(gaze_choice_schema(), shared(&JobSettings::gaze));
  schema.include(screen_schema(), shared(&JobSettings::screen));
  schema.group(kColor);
  schema.include(color_config_schema().with_headings([](const Option&) { return kColor; }),
                 shared(&JobSettings::color));
  schema.value("--display", shared(&JobSettings::color, &ColorSettings::display), "NAME",
               "OpenColorIO display; default: the run's");
  schema.value("--view", shared(&JobSettings::color, &ColorSettings::view), "NAME",
               "OpenColorIO view; default: the run's");
  schema.value("--threads", shared(&JobSettings::threads), "N", "0: as many as the machine has");
  return schema;
}

}  // namespace

Command add_video_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<VideoArguments>();
  const auto options = std::make_shared<CommandOptions<VideoArguments>>(video_schema());
  options->bind(app, *arguments);
  app.add_option("sequence", arguments->job.reference, "Pictures as name.####.png or name.####.exr")
      ->required()
      ->type_name("PATTERN");
  app.add_option("beside", arguments->job.test, "A second sequence, shown to the right of it")->type_name("PATTERN");
  add_json_option(app, arguments->json, arguments->overwrite);
  app.footer(std::string(kConfigHelp) + kExitCodesHelp);
  return {[arguments] { return run_video(*arguments); },
          [arguments, options](const std::string& path) { options->read_config(*arguments, "video", path); }};
}

}  // namespace gazetrace
