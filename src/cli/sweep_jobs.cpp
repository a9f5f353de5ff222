// SPDX-License-Identifier: Apache-2.0
#include "cli/sweep_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <set>

#include "cli/inputs.hpp"
#include "cli/sweep_job.hpp"
#include "cli/sweep_job_checks.hpp"
#include "cli/sweep_measure.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

// Told in the paragraph on methods though they may be the defaults.
constexpr std::array kAlwaysStated{
    "size",   "fps",        "falloff", "region-samples", "region-blocks",  "region-angles", "angle-reading",
    "filter", "accumulate", "bounces", "diffuse",        "light-sampling", "pixel-filter",  "sample-unit",
    "seed",   "exposure",   "view",    "region-shape",   "clamp-indirect", "pixel-cone",    "bounce-cone"};

class JobMaker {
 public:
  explicit JobMaker(const SweepRequest& request) : request_(request), file_(request.file) {}

  SweepJobs make() {
    SweepPlan& plan = jobs_.plan;
    plan.title = file_.title;
    plan.plan_file = file_.path;
    plan.varied = file_.varied;
    plan.measure = sweep_measure(file_, request_.threads);
    for (std::size_t s = 0; s < file_.scenes.size(); ++s) {
      add_scene(s);
    }
    check_seeds(file_, tests_);
    check_frames(file_.path, plan.measure.comparison.metrics, plan.tests);
    state_settings();
    for (const SweepFileGaze& gaze : file_.gazes) {
      plan.gazes.emplace_back(gaze.name, "(" + options_text(gaze.options) + ")");
    }
    std::sort(jobs_.warnings.begin(), jobs_.warnings.end());
    jobs_.warnings.erase(std::unique(jobs_.warnings.begin(), jobs_.warnings.end()), jobs_.warnings.end());
    return std::move(jobs_);
  }

 private:
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
    assign_shared(request_, scene, *job);
    TracerOptions tracer;
    tracer.threads = job->settings.threads;
    tracer.bvh_quality = job->settings.bvh;
    // One scene stays as it is; several take turns in memory.
    const std::shared_ptr<const Scene> kept = file_.scenes.size() == 1 ? loaded : nullptr;
    jobs_.plan.scenes.push_back(
        {scene.name, options_text(scene.options),
         [job, kept, place = scene.place] { return kept ? kept : with_place(*job, place, [&] { return load(*job); }); },
         tracer});
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
    const std::unique_ptr<Job> job = test_job(request_, scene, gaze, setting);
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
    check_new(jobs_.plan.tests, test, place);
    check_gaze(jobs_.plan.tests, test, place);
    check_metrics(test);
    jobs_.plan.tests.push_back(std::move(test));
    tests_.push_back({place, job->settings.trace.seed});
  }

  std::string uniform_digest(const Job& test, const std::string& gaze, const std::vector<std::int32_t>& frames) {
    const std::string digest = digest_of(*uniform_job(test), frames);
    return uses_gaze_otherwise(test) ? digest_settings({{"settings", digest}, {"gaze", gaze}}) : digest;
  }

  std::string add_reference(std::size_t index, const Job& test, const SweepFileSetting& setting,
                            const std::vector<std::int32_t>& frames, const std::shared_ptr<const Scene>& loaded) {
    const SweepFileScene& scene = file_.scenes[index];
    const std::unique_ptr<Job> job = reference_job(request_, scene, test, setting);
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
      throw Error(ErrorKind::input, place_of(file_, text.starts_with("leave-out") ? "leave-out" : "metrics"),
                  fmt::format("{}: {}", test.id, text));
    }
  }

  // Every setting that reaches into pixels and has one value in all rows.
  void state_settings() {
    std::vector<std::unique_ptr<Job>> jobs;
    for (const SweepFileScene& scene : file_.scenes) {
      for (std::size_t g = 0; g < std::max<std::size_t>(file_.gazes.size(), 1); ++g) {
        jobs.push_back(
            test_job(request_, scene, file_.gazes.empty() ? nullptr : &file_.gazes[g], file_.settings.front()));
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

  const SweepRequest request_;
  const SweepFile& file_;
  const Scene empty_;  // where the camera stands elsewhere
  SweepJobs jobs_;
  std::vector<SweepTestPlace> tests_;
  std::set<std::string> checked_;  // by check_metrics()
  std::map<std::string, std::map<std::string, std::string>> digests_;
};

}  // namespace

SweepJobs make_sweep_jobs(const SweepFile& file, const std::optional<FrameList>& frames,
                          const std::optional<int>& threads) {
  return JobMaker({file, frames, threads}).make();
}

}  // namespace gazetrace
