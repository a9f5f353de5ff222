// SPDX-License-Identifier: Apache-2.0
// From what was typed to loaded inputs: everything that can be checked is checked here, before the first ray.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/settings_options.hpp"
#include "gazetrace/color.hpp"
#include "gazetrace/pipeline.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

// A run's inputs. `scene` is empty where the plan alone was asked for and the camera does not come from it.
struct Inputs {
  std::unique_ptr<Scene> scene;
  std::optional<GazeLog> gaze;
  std::optional<ProcessedGaze> steering;  // what --gaze-process made of it
  PlanSettings plan_settings;
  FramePlan plan;
  std::vector<std::int32_t> frames;
  // What was decided where the settings left a choice: "environment" -> "built-in sky, ...".
  std::vector<std::pair<std::string, std::string>> decisions;
  Warnings warnings;
  double load_s = 0;  // scene and environment
};

enum class InputScope {
  plan_only,  // the scene is read only when the camera comes from it, and may be missing when nothing needs it
  render,
};

// Error(usage or input). Every warning of a part (scene, camera, log, plan) is in Inputs::warnings.
// `progress` is told of the scene's textures and meshes, see SceneReadOptions. `loaded`: this scene, with its
// environment, is taken in place of the job's file, and Inputs::scene stays empty.
Inputs load_inputs(const JobSettings& job, InputScope scope,
                   const std::function<void(std::size_t done, std::size_t total)>& progress = {},
                   const Scene* loaded = nullptr);
// The camera stands in the scene's file.
bool camera_needs_scene(const JobSettings& job);

// Pipeline settings from options; checks names, patterns, folders. Without the settings digest.
PipelineSettings pipeline_settings(const JobSettings& job, const std::vector<std::int32_t>& frames);
// --filter, or what its "auto" stands for: "guided" for foveated frames; "linear", which passes single pixels through,
// for uniform ones, where lens or shutter blur what guided takes from first hits, and for what guided does not go with.
std::string filter_of(const JobSettings& job);
ReconstructionNeeds needs_of_filter(const JobSettings& job);
// The pattern and range checks alone, for before anything is loaded.
void check_settings(const JobSettings& job);
// Error(input) naming the first output that exists, unless --overwrite or --resume; then makes the folders and tries
// whether files can be made in them.
void prepare_outputs(const PipelineSettings& settings, const std::vector<std::int32_t>& frames,
                     const std::map<std::string, std::string>& input_digests);

// Content hashes of all files that the job reads.
std::map<std::string, std::string> digest_job_files(const JobSettings& job);
// Sets the digests of `settings`: of what reaches into pixels (options, file contents, version), and of this with the
// frame list and where the history comes from, where frames depend on those before them. The same files under other
// names give the same digests.
void digest_job(const OptionTable& table, const JobSettings& job, const std::vector<std::int32_t>& frames,
                const std::map<std::string, std::string>& files, PipelineSettings& settings);

// Parts of load_inputs that `gaze` and `scene` use as well.
std::optional<DisplayGeometry> screen_geometry(const ScreenSettings& screen);
GazeColumns merged_columns(const GazeFileSettings& gaze);  // options over the column map
GazeReadOptions read_options(const GazeFileSettings& gaze, const ScreenSettings& screen);
GazeLog read_gaze_file(const GazeFileSettings& gaze, const ScreenSettings& screen);
// "auto" is resolved by the scene; returns what was taken, in words.
std::string set_environment(const JobSettings& job, Scene& scene);
CameraPath choose_camera(const JobSettings& job, const Scene* scene, const GazeLog* log, std::string& decision);
// Error(usage, input) of anchors; `decision` says what they gave.
GazeMapping gaze_mapping(const JobSettings& job, const GazeLog* log, std::string* decision = nullptr);
// Where the log of a screen knows no angles, what it does not state of its geometry is that of the given screen.
void complete_recording_geometry(GazeLog& log, const ScreenSettings& screen);
std::vector<GazeStep> gaze_steps_of(const std::vector<std::string>& texts);
std::optional<GazeUncertainty> gaze_uncertainty(const JobSettings& job, const GazeLog& log);

}  // namespace gazetrace
