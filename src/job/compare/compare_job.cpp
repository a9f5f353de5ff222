// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/compare_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "gazetrace/compare_inputs.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/flicker.hpp"

namespace gazetrace {
namespace {

struct Limit {
  std::string metric;
  double value = 0;
  bool above = true;
};

Limit parse_limit(const std::string& text, bool above) {
  const std::string place = above ? "`fail-above`" : "`fail-below`";
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    throw Error(ErrorKind::usage, place, "'" + text + "' is not METRIC=VALUE", "write flip=0.05");
  }
  Limit limit{text.substr(0, equals), 0, above};
  parse_value(text.substr(equals + 1), place, limit.value);
  for (const MetricInfo& info : comparison_metrics()) {
    if (info.name == limit.metric && (info.better == MetricDirection::lower) != above) {
      throw Error(ErrorKind::usage, place, fmt::format("{} {} is better", above ? "more" : "less", limit.metric),
                  above ? "use `fail-below`" : "use `fail-above`");
    }
  }
  return limit;
}

std::vector<Limit> limits_of(const CompareJob& job, const std::vector<std::string>& metrics) {
  std::vector<Limit> limits;
  for (const std::string& text : job.fail_above) {
    limits.push_back(parse_limit(text, true));
  }
  for (const std::string& text : job.fail_below) {
    limits.push_back(parse_limit(text, false));
  }
  for (const Limit& limit : limits) {
    if (std::find(metrics.begin(), metrics.end(), limit.metric) == metrics.end()) {
      throw Error(ErrorKind::usage, limit.above ? "`fail-above`" : "`fail-below`",
                  "metric '" + limit.metric + "' is not among those compared", "add it to `metrics`");
    }
  }
  return limits;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool holds_a_second(const CompareInputs& inputs) {
  constexpr double kLeastRate = 4;
  return inputs.frames_per_second >= kLeastRate &&
         inputs.frames.size() >= static_cast<std::size_t>(frames_of_a_second(inputs.frames_per_second));
}

// What needs neither gaze nor much time, and what is there for the asking: FovVideoVDP wants a screen and gaze,
// flicker a second of frames as well, HDR-FLIP linear light.
std::vector<std::string> chosen_metrics(const CompareJob& job, const CompareInputs& inputs, bool is_linear) {
  const bool has_gaze = !inputs.gaze.words.empty();
  std::vector<std::string> metrics = job.metrics;
  if (metrics.empty()) {
    metrics = {"mse", "relmse", "psnr", "ssim", "flip"};
    constexpr double kLeastRate = 4;  // above it, two frames are within the 250 ms that FovVideoVDP sees
    const bool shows_time = inputs.frames_per_second > kLeastRate;
    if (inputs.screen && has_gaze && (inputs.frames.size() == 1 || shows_time)) {
      metrics.emplace_back("fovvideovdp");
    }
    if (inputs.screen && has_gaze && shows_time && holds_a_second(inputs)) {
      metrics.emplace_back("flicker");
    }
  }
  // What never changes does not flicker, however wrong it is.
  if (contains(metrics, "flicker") && !contains(metrics, "temporal_bias")) {
    metrics.insert(std::find(metrics.begin(), metrics.end(), "flicker") + 1, "temporal_bias");
  }
  if (!is_linear && contains(metrics, "hdr_flip")) {
    throw Error(ErrorKind::usage, "`metrics`", "hdr_flip needs scene-linear pictures (.exr)", "leave it out");
  }
  for (const MetricInfo& info : comparison_metrics()) {
    if (info.needs_gaze && !has_gaze && inputs.screen && contains(metrics, info.name)) {
      throw Error(ErrorKind::usage, info.name, "needs gaze, and no frame has one",
                  "give `gaze` or `gaze-at`, or leave the metric out");
    }
  }
  return metrics;
}

// Metrics that look back in time: their frames must follow each other.
void check_consecutive(const CompareInputs& inputs, const std::vector<std::string>& metrics) {
  const bool is_single = inputs.frames.size() < 2;
  for (const char* name : {"flicker", "temporal_bias", "fovvideovdp"}) {
    const bool is_of_a_second = std::string_view(name) != "fovvideovdp";
    if (!contains(metrics, name) || (is_single && !is_of_a_second)) {
      continue;
    }
    if (!is_single &&
        inputs.frames.back() - inputs.frames.front() + 1 != static_cast<std::int32_t>(inputs.frames.size())) {
      throw Error(ErrorKind::usage, name, "sees time, but frames are missing between the first and the last",
                  "name consecutive frames with `frames`, or leave the metric out");
    }
    if (!is_single && inputs.frames_per_second == 0) {
      throw Error(ErrorKind::usage, name, "the pictures do not say their frame rate", "give `fps`");
    }
    if (is_of_a_second && !holds_a_second(inputs)) {
      throw Error(ErrorKind::usage, name,
                  fmt::format("looks at whole seconds; {} frames at {:g} a second are less", inputs.frames.size(),
                              inputs.frames_per_second),
                  "compare a longer sequence, or leave the metric out");
    }
  }
}

class PairReader {
 public:
  PairReader(const CompareJob& job, const CompareInputs& inputs)
      : job_(job), inputs_(inputs), color_(compare_color(job, inputs)) {}

  // Light and code values of both, the test through the reference's view and exposure.
  FramePair read(std::int32_t frame) {
    const std::string reference_path = picture_path(job_.reference, frame);
    const std::string test_path = picture_path(job_.test, frame);
    ComparedPicture reference = read_compared_picture(reference_path);
    ComparedPicture test = read_compared_picture(test_path);
    check_comparable(job_, inputs_, reference, test, reference_path, test_path);
    check_same_gaze(job_, inputs_, reference.facts, test.facts, test_path);
    is_linear_ = reference.is_linear;
    const double ev = job_.exposure_ev.value_or(reference.facts.exposure_ev.value_or(0));
    FramePair pair;
    pair.frame = frame;
    for (ComparedPicture* one : {&reference, &test}) {
      MetricPicture& picture = one->picture;
      if (shows_light()) {
        picture.code = pq_codes(one->is_linear ? picture.light : picture.code, peak_cd_m2(), threads());
        picture.light = emitted(picture.code, DisplayResponse::pq, peak_cd_m2(), threads());
      } else if (one->is_linear) {
        picture.code = viewed(picture.light, color_, ev, threads());
      } else {
        picture.light = emitted(picture.code, job_.settings.metric.response, peak_cd_m2(), threads());
      }
    }
    const ComparedGaze gaze = compared_gaze(job_, inputs_, reference.facts, test.facts, frame,
                                            reference.picture.code.width_px, reference.picture.code.height_px);
    pair.gaze_px = gaze.px;
    pair.gaze_class = gaze.gaze_class;
    pair.reference = std::move(reference.picture);
    pair.test = std::move(test.picture);
    return pair;
  }
  [[nodiscard]] bool is_linear() const { return is_linear_ && !shows_light(); }
  [[nodiscard]] std::string view() const {
    return shows_light() ? fmt::format("light in cd/m2 as it is, up to {:g}", peak_cd_m2())
           : is_linear_  ? color_.description()
                         : "display images as they are";
  }

 private:
  [[nodiscard]] bool shows_light() const { return job_.settings.metric.response == DisplayResponse::linear_hdr; }
  [[nodiscard]] double peak_cd_m2() const { return job_.settings.photometry.peak_cd_m2; }
  [[nodiscard]] int threads() const { return job_.shared.threads; }
  const CompareJob& job_;
  const CompareInputs& inputs_;
  ColorPipeline color_;
  bool is_linear_ = false;
};

CompareConditions conditions_of(const CompareJob& job, const CompareInputs& inputs, const PairReader& reader,
                                const ComparisonSettings& settings, int width, int height) {
  CompareConditions conditions{{"reference", job.reference},
                               {"test", job.test},
                               {"size", fmt::format("{}x{}", width, height)},
                               {"view", reader.view()},
                               {"ppd", fmt::format("{:.4f}{}", settings.metric.pixels_per_degree,
                                                   inputs.screen ? "" : " (FLIP's default: no screen is known)")}};
  if (inputs.screen) {
    const DisplayGeometry& g = *inputs.screen;
    conditions.emplace_back("screen", fmt::format("{}x{} px, {:g}x{:g} cm at {:g} cm", g.width_px, g.height_px,
                                                  g.width_cm, g.height_cm, g.distance_cm));
  }
  if (inputs.screen) {
    conditions.emplace_back("regions", fmt::format("fovea to {:g} deg, intermediate to {:g} deg of eccentricity",
                                                   settings.regions.end_deg[0], settings.regions.end_deg[1]));
  }
  if (inputs.frames_per_second > 0) {
    conditions.emplace_back("frame rate", fmt::format("{:g}", inputs.frames_per_second));
  }
  if (!inputs.gaze.words.empty()) {
    conditions.emplace_back("gaze", inputs.gaze.words);
  }
  if (contains(settings.metrics, "flicker")) {
    const FlickerRange range = flicker_range(inputs.frames_per_second, settings.photometry.peak_cd_m2 / 2);
    conditions.emplace_back("flicker", flicker_range_text(range) + "; blind to bias (see temporal_bias)");
  }
  if (!job.pooling_weights.empty()) {
    conditions.emplace_back("pooling", "by the weights of " + job.pooling_weights + "; bands and regions are not");
  }
  if (contains(settings.metrics, "fovvideovdp")) {
    const DisplayPhotometry& p = settings.photometry;
    conditions.emplace_back("fovvideovdp",
                            fmt::format("{}; peak {:g} cd/m2, contrast {:g}, {:g} lux; blind to uniform "
                                        "differences, not comparable between gaze positions",
                                        kFovVideoVdpParameters, p.peak_cd_m2, p.contrast, p.ambient_lux));
  }
  return conditions;
}

void write_maps(const CompareJob& job, const ComparisonSettings& settings, const FramePair& pair,
                const FrameScores& frame) {
  for (std::size_t m = 0; m < frame.maps.size(); ++m) {
    if (frame.maps[m].empty()) {
      continue;
    }
    const std::string pattern = map_pattern(job, frame.scores[m].metric);
    FrameHeader header;
    header.frame = frame.frame;
    DisplayImage picture = error_map_picture(frame.scores[m].metric, frame.maps[m], pair.reference.code);
    if (job.map_overlay && settings.view && pair.gaze_px) {
      draw_gaze(picture, *settings.view, *pair.gaze_px, settings.regions);
    }
    write_display_image(frame_file_name(pattern, frame.frame), picture, header, {});
  }
}

// A limit on what could not be scored is not kept.
Warnings over_limits(const std::vector<Limit>& limits, const SequenceScores& claim) {
  Warnings over;
  for (const Limit& limit : limits) {
    for (const Scores& scores : claim.scores) {
      if (scores.metric != limit.metric) {
        continue;
      }
      if (!scores.value) {
        over.push_back(fmt::format("{} was not scored, so its limit is not kept", limit.metric));
      } else if (limit.above ? !(*scores.value <= limit.value) : !(*scores.value >= limit.value)) {
        over.push_back(fmt::format("{} is {:g} ({} frames), {} {:g}", limit.metric, *scores.value, claim.gaze_class,
                                   limit.above ? "above" : "below", limit.value));
      }
    }
  }
  return over;
}

void make_folder(const std::string& folder) {
  std::error_code problem;
  if (!folder.empty() && !std::filesystem::is_directory(folder) &&
      !std::filesystem::create_directories(folder, problem)) {
    throw Error(ErrorKind::usage, "`maps`", "cannot make the folder '" + folder + "': " + problem.message());
  }
}

ComparisonSettings settings_of(const CompareJob& job, const CompareInputs& inputs, const PairReader& reader,
                               const FramePair& first) {
  ComparisonSettings settings = job.settings;
  settings.metrics = chosen_metrics(job, inputs, reader.is_linear());
  settings.regions = inputs.regions;
  settings.view = compare_view(inputs, first.reference.code.width_px, first.reference.code.height_px);
  settings.frames_per_second = inputs.frames_per_second;
  settings.original_border = !job.correct_border;
  settings.want_maps = job.want_maps || !job.maps.empty();
  complete_settings(settings, job.shared.threads);
  fix_flip_exposures(settings, first.reference.light);
  if (!job.pooling_weights.empty()) {
    settings.pooling_weights = read_pooling_weights(job.pooling_weights);
  }
  return settings;
}

}  // namespace

ComparedSequences compare(const CompareJob& job, const std::function<void(FrameScores& scores)>& on_frame) {
  check_comparison(job.settings);
  const CompareInputs inputs = load_compare_inputs(job);
  PairReader reader(job, inputs);
  FramePair pair = reader.read(inputs.frames.front());
  const int width = pair.reference.code.width_px;
  const int height = pair.reference.code.height_px;
  const ComparisonSettings settings = settings_of(job, inputs, reader, pair);
  const std::vector<Limit> limits = limits_of(job, settings.metrics);
  check_consecutive(inputs, settings.metrics);
  Comparison comparison(settings, width, height);
  check_compare_outputs(job, inputs, settings.metrics);
  make_folder(job.maps);
  std::string csv = compare_csv_header();
  ComparedSequences compared;
  for (std::size_t i = 0; i < inputs.frames.size(); ++i) {
    if (i > 0) {
      pair = reader.read(inputs.frames[i]);
    }
    FrameScores scores = comparison.add(pair);
    if (!job.maps.empty()) {
      write_maps(job, settings, pair, scores);
    }
    csv += compare_csv_rows(scores);
    if (on_frame) {
      on_frame(scores);
    }
    scores.maps.clear();
    compared.frames.push_back(std::move(scores));
  }
  compared.summary = comparison.summary();
  compared.conditions = conditions_of(job, inputs, reader, settings, width, height);
  compared.over_limits = over_limits(limits, headline(compared.summary));
  if (!job.csv.empty()) {
    write_text_atomically(job.csv, csv);  // a table of some of the frames would look like one of all
  }
  if (!job.json.empty() && job.json != "-") {
    write_text_atomically(job.json, compare_json(compared));
  }
  return compared;
}

}  // namespace gazetrace
