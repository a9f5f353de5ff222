// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/sweep_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "gazetrace/error.hpp"
#include "gazetrace/resolve.hpp"
#include "job/confine.hpp"
#include "sweep/certainty.hpp"
#include "sweep/plan_measure.hpp"
#include "sweep/row_checks.hpp"
#include "sweep/row_jobs.hpp"

namespace gazetrace {
namespace {

class PlanMaker {
 public:
  explicit PlanMaker(const SweepRequest& request) : request_(request), file_(request.file), schema_(request.schema) {}

  LoadedSweepPlan make() {
    SweepPlan& plan = jobs_.plan;
    plan.title = file_.title;
    plan.plan_file = file_.path;
    plan.varied = file_.varied;
    plan.measure = sweep_measure(file_, request_.threads);
    plan.go_on = file_.reference.go_on;
    if (file_.reference.is_auto && !highest_jod(plan.measure)) {
      throw Error(ErrorKind::input, file_.path, "a reference of \"auto\" follows a level in JOD, and there is none",
                  "measure fovvideovdp, and give it a level: quality = [\"fovvideovdp=9\"]");
    }
    for (std::size_t s = 0; s < file_.scenes.size(); ++s) {
      add_scene(s);
    }
    check_seeds(file_, tests_);
    check_frames(file_.path, plan.measure.comparison.metrics, plan.tests);
    state_settings();
    for (const SweepFileGaze& gaze : file_.gazes) {
      plan.gazes.emplace_back(gaze.name, "(" + options_text(gaze.options) + ")");
    }
    for (const auto& [names, digests] : digests_) {
      for (const auto& [path, digest] : digests) {
        plan.files.push_back(path);
      }
    }
    std::sort(jobs_.warnings.begin(), jobs_.warnings.end());
    jobs_.warnings.erase(std::unique(jobs_.warnings.begin(), jobs_.warnings.end()), jobs_.warnings.end());
    return std::move(jobs_);
  }

 private:
  // Digests of contents, computed once for each set of files.
  const std::map<std::string, std::string>& files_of(const Job& job) {
    std::string names;
    for (const OptionOf<JobSettings>& option : schema_.options()) {
      if (option.decides == Decides::file) {
        names += fmt::format("{}\n", fmt::join(option.values(job.settings), "\n"));
      }
    }
    const auto found = digests_.find(names);
    return found != digests_.end() ? found->second
                                   : digests_.emplace(names, digest_job_files(job.settings)).first->second;
  }

  std::string digest_of(const Job& job, const std::vector<std::int32_t>& frames) {
    const std::string settings = digest_job(job.settings, files_of(job), schema_);
    return digest_settings({{"settings", settings}, {"frames", format_frame_list(frames)}});
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
    const Job job = shared_job(request_, scene);
    // A single scene stays in memory; several take turns.
    const std::shared_ptr<const Scene> kept = file_.scenes.size() == 1 ? loaded : nullptr;
    jobs_.plan.scenes.push_back({scene.name, options_text(scene.options),
                                 [job, kept, place = scene.place, schema = schema_] {
                                   return kept ? kept : with_place(job, schema, place, [&] { return load(job); });
                                 },
                                 tracer_options(job.settings)});
  }

  static ResolveOptions planned_with(const Scene* scene) {
    ResolveOptions options;
    options.scope = ResolveScope::plan;
    options.loaded = scene;
    options.tell_idle = false;  // in a grid it is normal that a setting has no effect in some rows
    return options;
  }

  static std::shared_ptr<const Scene> load(const Job& job) {
    return std::make_shared<Scene>(load_job_scene(job.settings));
  }

  void add_test(std::size_t index, const SweepFileGaze* gaze, std::size_t k, std::shared_ptr<const Scene>& loaded) {
    const SweepFileScene& scene = file_.scenes[index];
    const SweepFileSetting& setting = file_.settings[k];
    Job job = test_job(request_, scene, gaze, setting);
    const std::string place = setting.place;
    const std::string name = gaze == nullptr ? "none" : gaze->name;
    with_place(job, schema_, place, [&] { check(job); });
    with_place(job, schema_, place, [&] { files_of(job); });
    const bool needs_scene = camera_needs_scene(job.settings) || !job.settings.frames;
    if (needs_scene && !loaded) {
      loaded = with_place(job, schema_, scene.place, [&] { return load(job); });
      jobs_.warnings.insert(jobs_.warnings.end(), loaded->warnings.begin(), loaded->warnings.end());
    }
    ResolvedJob inputs = with_place(job, schema_, gaze == nullptr ? place : gaze->place,
                                    [&] { return resolve(job, planned_with(needs_scene ? loaded.get() : &empty_)); });
    jobs_.warnings.insert(jobs_.warnings.end(), inputs.warnings.begin(), inputs.warnings.end());
    job.settings = inputs.job.settings;  // with the size, rate and window that follow from screen and length
    job.settings.frames = FrameList{inputs.frames};

    SweepTest test;
    test.id = fmt::format("{}-{}-{}", scene.name, name, k + 1);
    test.scene = index;
    test.gaze = name;
    test.label = setting.label;
    for (const std::string& option : file_.varied) {
      test.settings.emplace_back(option, option_text(job, option, schema_));
    }
    test.pipeline = pipeline_settings(job.settings);
    test.plan = std::move(inputs.plan);
    test.resolution_scale = setting.resolution_scale;
    for (const SweepFilePublished& other : file_.published) {
      if (other.scene == scene.name && other.setting == setting.label) {
        test.published.push_back({other.speed_up, other.source});
      }
    }
    test.digest = digest_of(job, inputs.frames);
    test.uniform_digest = uniform_digest(job, name, inputs.frames);
    test.reference = add_reference(index, job, setting, inputs.frames, loaded);
    for (const auto& [option, value] : test.settings) {
      if (uniform_sees(*schema_.find(option), job)) {
        test.uniform_settings.emplace_back(option, value);
      }
    }
    check_new(jobs_.plan.tests, test, place);
    check_gaze(jobs_.plan.tests, test, place);
    check_metrics(test);
    jobs_.plan.tests.push_back(std::move(test));
    tests_.push_back({place, job.settings.trace.seed});
  }

  std::string uniform_digest(const Job& test, const std::string& gaze, const std::vector<std::int32_t>& frames) {
    const std::string digest = digest_of(uniform_job(test, schema_), frames);
    return uses_gaze_otherwise(test) ? digest_settings({{"settings", digest}, {"gaze", gaze}}) : digest;
  }

  std::string add_reference(std::size_t index, const Job& test, const SweepFileSetting& setting,
                            const std::vector<std::int32_t>& frames, const std::shared_ptr<const Scene>& loaded) {
    const SweepFileScene& scene = file_.scenes[index];
    const Job job = reference_job(request_, scene, test, setting);
    with_place(job, schema_, scene.place, [&] { check(job); });
    SweepReference reference;
    for (int i = 0; i < file_.reference.scramblings; ++i) {
      reference.seeds.push_back(file_.reference.seed + static_cast<std::uint64_t>(i));
    }
    reference.digest = digest_of(job, frames);
    if (file_.reference.is_auto) {
      reference.most_spp = file_.reference.most_spp;
      reference.digest =
          digest_settings({{"reference", reference.digest}, {"auto", fmt::format("{}", *reference.most_spp)}});
    }
    reference.key = scene.name + "-" +
                    digest_settings({{"reference", reference.digest},
                                     {"seeds", fmt::format("{}", fmt::join(reference.seeds, " "))}})
                        .substr(0, 12);
    const auto& known = jobs_.plan.references;
    if (std::none_of(known.begin(), known.end(), [&](const auto& other) { return other.key == reference.key; })) {
      ResolvedJob inputs = with_place(job, schema_, scene.place,
                                      [&] { return resolve(job, planned_with(loaded ? loaded.get() : &empty_)); });
      reference.scene = index;
      reference.pipeline = pipeline_settings(job.settings);
      reference.plan = std::move(inputs.plan);
      reference.color = job.settings.color;
      jobs_.plan.references.push_back(std::move(reference));
      return jobs_.plan.references.back().key;
    }
    return reference.key;
  }

  // Every check that needs nothing large to be loaded.
  void check(const Job& job) {
    check_job(job, schema_);
    const ColorPipeline color(job.settings.color);
    jobs_.warnings.insert(jobs_.warnings.end(), color.warnings().begin(), color.warnings().end());
    Scene scene;
    if (job.settings.environment != "auto") {
      set_environment(job.settings, scene);
    }
  }

  // Checked once for all tests that look the same to the metrics.
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

  // Every setting that affects pixels and has one value in all rows.
  void state_settings() {
    std::vector<Job> jobs;
    for (const SweepFileScene& scene : file_.scenes) {
      for (std::size_t g = 0; g < std::max<std::size_t>(file_.gazes.size(), 1); ++g) {
        jobs.push_back(
            test_job(request_, scene, file_.gazes.empty() ? nullptr : &file_.gazes[g], file_.settings.front()));
      }
    }
    for (const OptionOf<JobSettings>& option : schema_.options()) {
      const std::string value = option_text(jobs.front(), option.name, schema_);
      const bool is_shared = std::all_of(
          jobs.begin(), jobs.end(), [&](const Job& job) { return option_text(job, option.name, schema_) == value; });
      if (option.decides != Decides::nothing && !is_among(file_.varied, option.name) && is_shared && !value.empty()) {
        jobs_.plan.common_settings.emplace_back(option.name, value);
        if (option.values(jobs.front().settings) != option.defaults || option.is(Trait::always_stated)) {
          jobs_.plan.stated_settings.emplace_back(option.name, value);
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
  const JobSchema& schema_;
  const Scene empty_;  // used where the camera does not come from the scene
  LoadedSweepPlan jobs_;
  std::vector<SweepTestPlace> tests_;
  std::set<std::string> checked_;  // by check_metrics()
  std::map<std::string, std::map<std::string, std::string>> digests_;
};

void check_confined_plan(const SweepFile& file, const JobSchema& schema) {
  const auto check = [&](const std::vector<Assignment>& options) {
    for (const Assignment& given : options) {
      check_confined(*schema.find(given.option), given.values, file.path, given.place);
    }
  };
  check(file.common);
  for (const SweepFileScene& scene : file.scenes) {
    check(scene.options);
  }
  for (const SweepFileGaze& gaze : file.gazes) {
    check(gaze.options);
  }
  for (const SweepFileSetting& setting : file.settings) {
    check(setting.options);
  }
  check(file.reference.options);
}

}  // namespace

LoadedSweepPlan load_sweep_plan(const std::string& path, const std::optional<FrameList>& frames,
                                const std::optional<int>& threads, const JobSchema& schema, bool confine) {
  const SweepFile file = read_sweep_file(path, schema);
  if (confine) {
    check_confined_plan(file, schema);
  }
  return PlanMaker({file, frames, threads, schema}).make();
}

}  // namespace gazetrace
