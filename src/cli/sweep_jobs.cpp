// SPDX-License-Identifier: Apache-2.0
#include "cli/sweep_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <set>

#include "cli/inputs.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Options = std::vector<Assignment>;

// Headings of settings_options.cpp: what a uniform frame does not see.
constexpr const char* kPresets = "Presets";
const std::vector<std::string> kSampling{"Where the samples go", "Density models ('gazetrace list falloffs')",
                                         kPresets};
const std::vector<std::string> kGaze{"Gaze in time", "Gaze log"};
// Of these, what decides where a camera that follows the head is.
const std::vector<std::string> kClock{"gaze-offset", "gaze-scale", "gaze-start", "gaze-anchor"};
const std::vector<std::string> kAfterSampling{"Between the samples", "Over time"};
// What makes rendering cheaper and less true: a reference takes these from [common] and [reference], not from rows.
const std::vector<std::string> kTradeOffs{
    "bounces",        "russian-roulette", "light-sampling", "compensate-environment",
    "clamp-indirect", "pixel-cone",       "bounce-cone",    "seed"};
// Of these none is right by itself.
const std::vector<std::string> kNeedTruth{"bounces", "pixel-cone", "bounce-cone"};

// Told in the paragraph on methods though they may be the defaults.
const std::vector<std::string> kAlwaysStated{
    "size",   "fps",        "falloff", "region-samples", "region-blocks",  "region-angles", "angle-reading",
    "filter", "accumulate", "bounces", "diffuse",        "light-sampling", "pixel-filter",  "sample-unit",
    "seed",   "exposure",   "view",    "region-shape",   "clamp-indirect", "pixel-cone",    "bounce-cone"};

bool is_among(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// The table refers to the settings: the two stay where they are.
struct Job {
  JobSettings settings;
  OptionTable table;
  std::map<std::string, std::string> places;  // of the options that were given

  Job() { add_job_options(table, settings); }
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  void assign(const Options& options, const std::function<bool(const OptionEntry&)>& wanted = {}) {
    for (const Assignment& option : options) {
      const OptionEntry& entry = *table.find(option.option);
      if (!wanted || wanted(entry)) {
        entry.assign(option.values, option.place + ": " + option.option);
        places[option.option] = option.place;
      }
    }
  }
  // The effective values of another job, those of its presets among them.
  void take(const Job& other, const std::function<bool(const OptionEntry&)>& wanted) {
    for (const OptionEntry& entry : other.table.entries()) {
      const std::vector<std::string> values = entry.values();
      if (!values.empty() && values != entry.defaults && wanted(entry)) {
        table.find(entry.name)->assign(values, entry.name);
        const auto place = other.places.find(entry.name);
        places[entry.name] = place == other.places.end() ? std::string() : place->second;
      }
    }
  }
  void assign(const std::string& option, const std::string& value) { table.find(option)->assign({value}, option); }
  [[nodiscard]] std::string text_of(const std::string& option) const {
    return fmt::format("{}", fmt::join(table.find(option)->values(), ";"));
  }
};

// Runs a check, and puts the plan's line before what it complains of.
template <class Check>
auto with_place(const Job& job, const std::string& otherwise, const Check& check) {
  try {
    return check();
  } catch (const Error& error) {
    const std::string text = error.what();
    std::string place = otherwise;
    if (text.starts_with("--")) {
      const auto found = job.places.find(text.substr(2, text.find(':') - 2));
      place = found == job.places.end() ? otherwise : found->second;
    } else {
      for (const char* option : {"scene", "env", "gaze", "camera-path"}) {
        if (job.places.contains(option) && !job.text_of(option).empty() && text.starts_with(job.text_of(option))) {
          place = job.places.at(option);
        }
      }
    }
    throw Error(error.kind() == ErrorKind::usage ? ErrorKind::input : error.kind(), place, text);
  }
}

class JobMaker {
 public:
  JobMaker(const SweepFile& file, const std::optional<FrameList>& frames, const std::optional<int>& threads)
      : file_(file), frames_(frames), threads_(threads) {}

  SweepJobs make() {
    SweepPlan& plan = jobs_.plan;
    plan.title = file_.title;
    plan.plan_file = file_.path;
    plan.varied = file_.varied;
    plan.measure = measure();
    for (std::size_t s = 0; s < file_.scenes.size(); ++s) {
      add_scene(s);
    }
    check_seeds();
    check_frames();
    state_settings();
    for (const SweepFileGaze& gaze : file_.gazes) {
      plan.gazes.emplace_back(gaze.name, "(" + options_text(gaze.options) + ")");
    }
    std::sort(jobs_.warnings.begin(), jobs_.warnings.end());
    jobs_.warnings.erase(std::unique(jobs_.warnings.begin(), jobs_.warnings.end()), jobs_.warnings.end());
    return std::move(jobs_);
  }

 private:
  void assign_shared(Job& job, const SweepFileScene& scene) const {
    job.assign(file_.common);
    if (frames_) {
      job.settings.frames = frames_;
    }
    if (threads_) {
      job.settings.threads = *threads_;
    }
    job.assign(scene.options);
    job.settings.quiet = true;
  }

  std::unique_ptr<Job> test_job(const SweepFileScene& scene, const SweepFileGaze* gaze,
                                const SweepFileSetting& setting) const {
    auto job = std::make_unique<Job>();
    assign_shared(*job, scene);
    if (gaze != nullptr) {
      job->assign(gaze->options);
    }
    job->assign(setting.options);
    // Its baselines go through the same one.
    job->settings.filter = filter_of(job->settings);
    return job;
  }

  // What of the row decides what is pictured, what is true by [common] and the scene, then [reference].
  std::unique_ptr<Job> reference_job(const SweepFileScene& scene, const Job& test,
                                     const SweepFileSetting& setting) const {
    auto job = std::make_unique<Job>();
    job->take(test, [](const OptionEntry& entry) {
      return !is_among(kSampling, entry.group) && !is_among(kAfterSampling, entry.group) &&
             !is_among(kTradeOffs, entry.name) && !is_among(kGaze, entry.group);
    });
    const auto is_trade_off = [](const OptionEntry& entry) {
      return is_among(kTradeOffs, entry.name) && entry.name != "seed";
    };
    job->assign(file_.common, is_trade_off);
    job->assign(scene.options, is_trade_off);
    for (const auto& [option, value] :
         {std::pair("falloff", "uniform"), std::pair("spp", "256"), std::pair("filter", "none"),
          std::pair("accumulate", "off"), std::pair("russian-roulette", "false"), std::pair("clamp-indirect", "0")}) {
      job->assign(option, value);
    }
    job->assign(file_.reference.options);
    job->settings.frames = test.settings.frames;
    job->settings.threads = test.settings.threads;
    if (test.settings.camera_from_gaze) {
      job->settings.camera_from_gaze = true;
      job->settings.gaze = test.settings.gaze;
      job->take(test, [](const OptionEntry& entry) { return is_among(kClock, entry.name); });
    }
    for (const std::string& option : kNeedTruth) {
      const auto row = std::find_if(setting.options.begin(), setting.options.end(),
                                    [&](const Assignment& given) { return given.option == option; });
      const auto found = job->places.find(option);
      if (row != setting.options.end() && found == job->places.end()) {
        throw Error(ErrorKind::input, row->place,
                    fmt::format("'{}' varies, and the reference does not know which value is right", option),
                    fmt::format("give '{}' in [reference]", option));
      }
    }
    return job;
  }

  // Content digests, read once for each set of files.
  const std::map<std::string, std::string>& files_of(const Job& job) {
    std::string names;
    for (const OptionEntry& entry : job.table.entries()) {
      if (entry.influence == Influence::file) {
        names += fmt::format("{}\n", fmt::join(entry.values(), "\n"));
      }
    }
    const auto found = digests_.find(names);
    return found != digests_.end() ? found->second
                                   : digests_.emplace(names, digest_job_files(job.settings)).first->second;
  }

  std::string digest_of(const Job& job, const std::vector<std::int32_t>& frames) {
    PipelineSettings settings;
    digest_job(job.table, job.settings, frames, files_of(job), settings);
    return digest_settings({{"settings", settings.settings_digest}, {"frames", format_frame_list(frames)}});
  }

  void add_scene(std::size_t index) {
    const SweepFileScene& scene = file_.scenes[index];
    std::vector<const SweepFileGaze*> gazes;
    for (const SweepFileGaze& gaze : file_.gazes) {
      gazes.push_back(&gaze);
    }
    if (gazes.empty()) {
      gazes.push_back(nullptr);
    }
    std::shared_ptr<const Scene> loaded;
    for (const SweepFileGaze* gaze : gazes) {
      for (std::size_t k = 0; k < file_.settings.size(); ++k) {
        add_test(index, gaze, k, loaded);
      }
    }
    auto job = std::make_shared<Job>();
    assign_shared(*job, scene);
    TracerOptions tracer;
    tracer.threads = job->settings.threads;
    tracer.bvh_quality = job->settings.bvh;
    // One scene stays as it is; several take turns in memory.
    const std::shared_ptr<const Scene> kept = file_.scenes.size() == 1 ? loaded : nullptr;
    jobs_.plan.scenes.push_back(
        {scene.name, options_text(scene.options), [job, kept] { return kept ? kept : load(*job); }, tracer});
  }

  static std::shared_ptr<const Scene> load(const Job& job) {
    SceneReadOptions options;
    options.animation = job.settings.animation;
    options.threads = job.settings.threads;
    auto scene = std::make_shared<Scene>(load_scene(job.settings.scene, options));
    set_environment(job.settings, *scene);
    return scene;
  }

  void add_test(std::size_t index, const SweepFileGaze* gaze, std::size_t k, std::shared_ptr<const Scene>& loaded) {
    const SweepFileScene& scene = file_.scenes[index];
    const SweepFileSetting& setting = file_.settings[k];
    const std::unique_ptr<Job> job = test_job(scene, gaze, setting);
    const std::string place = setting.place;
    const std::string name = gaze == nullptr ? "none" : gaze->name;
    with_place(*job, place, [&] { check(*job); });
    with_place(*job, place, [&] { files_of(*job); });
    const bool needs_scene = camera_needs_scene(job->settings) || !job->settings.frames;
    if (needs_scene && !loaded) {
      loaded = with_place(*job, scene.place, [&] { return load(*job); });
      jobs_.warnings.insert(jobs_.warnings.end(), loaded->warnings.begin(), loaded->warnings.end());
    }
    Inputs inputs = with_place(*job, gaze == nullptr ? place : gaze->place, [&] {
      return load_inputs(job->settings, InputScope::plan_only, {}, needs_scene ? loaded.get() : &empty_);
    });
    jobs_.warnings.insert(jobs_.warnings.end(), inputs.warnings.begin(), inputs.warnings.end());
    job->settings.frames = FrameList{inputs.frames};

    SweepTest test;
    test.id = fmt::format("{}-{}-{}", scene.name, name, k + 1);
    test.scene = index;
    test.gaze = name;
    test.label = setting.label;
    for (const std::string& option : file_.varied) {
      test.settings.emplace_back(option, job->text_of(option));
    }
    test.pipeline = pipeline_settings(job->settings, inputs.frames);
    test.plan = std::move(inputs.plan);
    test.resolution_scale = setting.resolution_scale;
    for (const SweepFilePublished& other : file_.published) {
      if (other.scene == scene.name && other.setting == setting.label) {
        test.published.push_back({other.speed_up, other.source});
      }
    }
    test.digest = digest_of(*job, inputs.frames);
    test.uniform_digest = uniform_digest(*job, name, inputs.frames);
    test.reference = add_reference(index, *job, setting, inputs.frames, loaded);
    for (const auto& [option, value] : test.settings) {
      if (uniform_sees(job->table.find(option)->group, *job)) {
        test.uniform_settings.emplace_back(option, value);
      }
    }
    check_new(test, place);
    check_gaze(test, place);
    check_metrics(test);
    jobs_.plan.tests.push_back(std::move(test));
    tests_.push_back({place, job->settings.trace.seed});
  }

  static bool uses_gaze_otherwise(const Job& job) {
    const AccumulateSettings& accumulate = job.settings.accumulate;
    return job.settings.camera_from_gaze || accumulate.reset_at_saccades || accumulate.reset_at_blinks;
  }
  // Whether options of a group mean anything to uniform frames beside a test. A preset is not only of sampling.
  static bool uniform_sees(const std::string& group, const Job& test) {
    return (group == kPresets || !is_among(kSampling, group)) && (!is_among(kGaze, group) || uses_gaze_otherwise(test));
  }

  std::string uniform_digest(const Job& test, const std::string& gaze, const std::vector<std::int32_t>& frames) {
    const bool sees_gaze = uses_gaze_otherwise(test);
    Job job;
    job.take(test, [](const OptionEntry& entry) {
      return !is_among(kSampling, entry.group) && !is_among(kGaze, entry.group);
    });
    const std::string digest = digest_of(job, frames);
    return sees_gaze ? digest_settings({{"settings", digest}, {"gaze", gaze}}) : digest;
  }

  std::string add_reference(std::size_t index, const Job& test, const SweepFileSetting& setting,
                            const std::vector<std::int32_t>& frames, const std::shared_ptr<const Scene>& loaded) {
    const SweepFileScene& scene = file_.scenes[index];
    const std::unique_ptr<Job> job = reference_job(scene, test, setting);
    with_place(*job, scene.place, [&] { check(*job); });
    SweepReference reference;
    for (int i = 0; i < file_.reference.scramblings; ++i) {
      reference.seeds.push_back(file_.reference.seed + static_cast<std::uint64_t>(i));
    }
    reference.digest = digest_of(*job, frames);
    reference.key = scene.name + "-" +
                    digest_settings({{"reference", reference.digest},
                                     {"seeds", fmt::format("{}", fmt::join(reference.seeds, " "))}})
                        .substr(0, 12);
    const auto& known = jobs_.plan.references;
    if (std::none_of(known.begin(), known.end(), [&](const auto& other) { return other.key == reference.key; })) {
      Inputs inputs = with_place(*job, scene.place, [&] {
        return load_inputs(job->settings, InputScope::plan_only, {}, loaded ? loaded.get() : &empty_);
      });
      reference.scene = index;
      reference.pipeline = pipeline_settings(job->settings, frames);
      reference.plan = std::move(inputs.plan);
      reference.color = job->settings.color;
      jobs_.plan.references.push_back(std::move(reference));
      return jobs_.plan.references.back().key;
    }
    return reference.key;
  }

  // Everything that fails without loading anything large.
  static void check(const Job& job) {
    check_settings(job.settings);
    const ColorPipeline color(job.settings.color);
    Scene scene;
    if (job.settings.environment != "auto") {
      set_environment(job.settings, scene);
    }
  }

  void check_new(const SweepTest& test, const std::string& place) const {
    for (const SweepTest& other : jobs_.plan.tests) {
      if (other.digest == test.digest && other.gaze == test.gaze && other.scene == test.scene &&
          other.resolution_scale == test.resolution_scale) {
        throw Error(ErrorKind::input, place, fmt::format("'{}' and '{}' are the same setting", other.label, test.label),
                    "leave one out");
      }
    }
  }

  // Rows of one gaze share their reference's floor, and what they show: it must be one gaze.
  void check_gaze(const SweepTest& test, const std::string& place) const {
    const auto differs = [](const FrameRequest& a, const FrameRequest& b) {
      return a.gaze_direction_true != b.gaze_direction_true || a.gaze_true.no_gaze != b.gaze_true.no_gaze ||
             gaze_class_of(a.gaze_true) != gaze_class_of(b.gaze_true);
    };
    for (const SweepTest& other : jobs_.plan.tests) {
      const auto& a = other.plan.frames;
      const auto& b = test.plan.frames;
      if (other.gaze == test.gaze && other.reference == test.reference &&
          !std::equal(a.begin(), a.end(), b.begin(), b.end(), std::not_fn(differs))) {
        throw Error(ErrorKind::input, place,
                    fmt::format("with '{}' the eye looks elsewhere than with '{}', and both are gaze '{}'", test.label,
                                other.label, test.gaze),
                    "give what moves the gaze in a [[gaze]] of another name");
      }
    }
  }

  // Once for all tests that look the same to the metrics.
  void check_metrics(const SweepTest& test) {
    const FrameRequest& first = test.plan.frames.front();
    const std::string what = fmt::format("{}x{} {} {}/{} {} {} {}", first.width_px, first.height_px, first.view.step_x,
                                         test.pipeline.fps.numerator, test.pipeline.fps.denominator,
                                         test.plan.frames.size(), test.gaze, test.scene);
    if (!checked_.insert(what).second) {
      return;
    }
    try {
      check_scoring(jobs_.plan.measure, test);
    } catch (const Error& error) {
      const std::string text = error.what();
      throw Error(ErrorKind::input, place_of(text.starts_with("leave-out") ? "leave-out" : "metrics"),
                  fmt::format("{}: {}", test.id, text));
    }
  }

  void check_seeds() const {
    const auto repeats = static_cast<std::uint64_t>(file_.measure.repeats);
    const auto scramblings = static_cast<std::uint64_t>(file_.reference.scramblings);
    for (const auto& [place, seed] : tests_) {
      if (seed < file_.reference.seed + scramblings && file_.reference.seed < seed + repeats) {
        throw Error(ErrorKind::input, place,
                    fmt::format("seeds {} to {} are of the reference, too", seed, seed + repeats - 1),
                    "give [reference] another seed");
      }
    }
  }

  // Some metrics look back in time: their frames must follow each other.
  void check_frames() const {
    const std::vector<std::string>& metrics = jobs_.plan.measure.comparison.metrics;
    const auto over_time = std::find_if(metrics.begin(), metrics.end(), [](const std::string& name) {
      return is_among({"fovvideovdp", "flicker", "temporal_bias"}, name);
    });
    if (over_time == metrics.end()) {
      return;
    }
    for (const SweepTest& test : jobs_.plan.tests) {
      const auto& frames = test.plan.frames;
      if (frames.back().frame - frames.front().frame + 1 != static_cast<std::int32_t>(frames.size())) {
        throw Error(ErrorKind::input, file_.path,
                    *over_time + " sees time, but frames are missing between the first and the last",
                    "name consecutive frames, or leave the metric out of [measure]");
      }
    }
  }

  [[nodiscard]] std::string place_of(const std::string& key) const {
    const auto found = file_.places.find(key);
    return found == file_.places.end() ? file_.path : found->second;
  }

  [[nodiscard]] SweepMeasure measure() const {
    const SweepFileMeasure& from = file_.measure;
    SweepMeasure measure;
    measure.repeats = from.repeats;
    measure.warm_up = from.warm_up;
    measure.leave_out_s = static_cast<double>(from.leave_out.ns) * 1e-9;
    measure.efficiency_spp = from.efficiency_spp;
    measure.comparison = from.compare.settings;
    measure.comparison.metrics = from.compare.metrics;
    measure.comparison.photometry.response = measure.comparison.metric.response;
    measure.comparison.metric.peak_cd_m2 = measure.comparison.photometry.peak_cd_m2;
    measure.comparison.original_border = !from.compare.correct_border;
    measure.comparison.metric.threads = threads_.value_or(0);
    measure.write_png = from.pictures == "png" || from.pictures == "both";
    measure.write_exr = from.pictures == "exr" || from.pictures == "both";
    SweepBaselines& baselines = measure.baselines;
    baselines.reference_rate = is_among(from.baselines, "uniform-reference-rate");
    baselines.equal_samples = is_among(from.baselines, "equal-samples");
    baselines.equal_time = is_among(from.baselines, "equal-time");
    baselines.low_resolution = is_among(from.baselines, "low-resolution");
    baselines.wrong_gaze = from.controls;
    baselines.reference_spp = from.reference_rate;
    for (const std::string& text : from.uniform_rates) {
      double spp = 0;
      parse_value(text, place_of("uniform-rates") + ": uniform-rates", spp);
      if (!(spp > 0 && spp <= 1e6)) {
        throw Error(ErrorKind::input, place_of("uniform-rates"), fmt::format("{} samples a pixel are no rate", text));
      }
      baselines.uniform_rates.push_back(spp);
    }
    measure.fixed_quality = fixed_quality();
    return measure;
  }

  [[nodiscard]] std::vector<std::pair<std::string, double>> fixed_quality() const {
    std::vector<std::string> wanted = file_.measure.quality;
    if (wanted.empty()) {
      wanted = {"fovvideovdp=9", "fovvideovdp=9.5", "flip=0.05"};
    }
    std::vector<std::pair<std::string, double>> levels;
    for (const std::string& text : wanted) {
      const std::string place = place_of("quality");
      const std::size_t equals = text.find('=');
      if (equals == std::string::npos) {
        throw Error(ErrorKind::input, place, "'" + text + "' is not METRIC=VALUE", "write \"flip=0.05\"");
      }
      std::pair<std::string, double> level{text.substr(0, equals), 0};
      parse_value(text.substr(equals + 1), place + ": quality", level.second);
      if (is_among(file_.measure.compare.metrics, level.first)) {
        levels.push_back(level);
      } else if (!file_.measure.quality.empty()) {
        throw Error(ErrorKind::input, place, "metric '" + level.first + "' is not among those measured",
                    "add it to metrics");
      }
    }
    return levels;
  }

  // Every setting that reaches into pixels and has one value in all rows.
  void state_settings() {
    std::vector<std::unique_ptr<Job>> jobs;
    for (const SweepFileScene& scene : file_.scenes) {
      for (std::size_t g = 0; g < std::max<std::size_t>(file_.gazes.size(), 1); ++g) {
        jobs.push_back(test_job(scene, file_.gazes.empty() ? nullptr : &file_.gazes[g], file_.settings.front()));
      }
    }
    for (const OptionEntry& entry : jobs.front()->table.entries()) {
      const std::string value = jobs.front()->text_of(entry.name);
      const bool is_shared = std::all_of(
          jobs.begin(), jobs.end(), [&](const std::unique_ptr<Job>& job) { return job->text_of(entry.name) == value; });
      if (entry.influence != Influence::none && !is_among(file_.varied, entry.name) && is_shared && !value.empty()) {
        jobs_.plan.common_settings.emplace_back(entry.name, value);
        if (entry.values() != entry.defaults || is_among(kAlwaysStated, entry.name)) {
          jobs_.plan.stated_settings.emplace_back(entry.name, value);
        }
      }
    }
  }

  // As written, option by option.
  static std::string options_text(const std::vector<Assignment>& options) {
    std::string text;
    for (const Assignment& option : options) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", option.option, fmt::join(option.values, ";"));
    }
    return text;
  }

  const SweepFile& file_;
  const std::optional<FrameList>& frames_;
  const std::optional<int>& threads_;
  const Scene empty_;  // where the camera stands elsewhere
  SweepJobs jobs_;
  struct TestPlace {
    std::string place;
    std::uint64_t seed = 0;
  };
  std::vector<TestPlace> tests_;
  std::set<std::string> checked_;  // by check_metrics()
  std::map<std::string, std::map<std::string, std::string>> digests_;
};

}  // namespace

SweepJobs make_sweep_jobs(const SweepFile& file, const std::optional<FrameList>& frames,
                          const std::optional<int>& threads) {
  return JobMaker(file, frames, threads).make();
}

}  // namespace gazetrace
