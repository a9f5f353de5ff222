// SPDX-License-Identifier: Apache-2.0
// The scene of a run and the light around it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "gazetrace/error.hpp"
#include "gazetrace/resolve.hpp"
#include "gazetrace/sky.hpp"
#include "job/scene.hpp"

namespace gazetrace {

std::string set_environment(const JobSettings& job, Scene& scene) {
  const std::string& wanted = job.environment;
  const auto gain = static_cast<float>(std::exp2(job.environment_ev));
  if (wanted == "none") {
    return "none";
  }
  if (wanted == "auto" && !scene.own_environment.empty() && !scene.environment.present()) {
    scene.environment =
        load_environment(scene.own_environment, job.environment_rotation_deg, job.environment_ev, job.max_memory.bytes);
    return scene.own_environment + ", which the scene names (`env` chooses)";
  }
  if (wanted == "auto") {
    const SceneFeatures features = features_of(scene);
    if (features.emissive_triangles || features.punctual_lights || scene.environment.present()) {
      return "none (the scene brings its own light; `env` chooses)";
    }
    scene.environment = clear_sky({}, job.environment_rotation_deg, job.environment_ev);
    return "the built-in sky with its sun (the scene has no light of its own; `env` chooses)";
  }
  if (wanted == "sky") {
    scene.environment = clear_sky({}, job.environment_rotation_deg, job.environment_ev);
    return "the built-in sky with its sun";
  }
  if (wanted == "soft-sky") {
    scene.environment = builtin_sky(job.environment_rotation_deg, job.environment_ev);
    return "the built-in sky without a sun";
  }
  if (wanted.starts_with("constant:")) {
    Vec3d radiance;
    parse_value(wanted.substr(9), "`env` constant:R,G,B", radiance);
    if (radiance.x < 0 || radiance.y < 0 || radiance.z < 0) {
      throw Error(ErrorKind::usage, "`env`", "a radiance cannot be negative");
    }
    scene.environment = constant_environment(to_float(radiance) * gain);
    return wanted;
  }
  scene.environment = load_environment(wanted, job.environment_rotation_deg, job.environment_ev, job.max_memory.bytes);
  return wanted;
}

void check_environment_file(const JobSettings& job) {
  const std::string& wanted = job.environment;
  const bool is_word = wanted == "none" || wanted == "auto" || wanted == "sky" || wanted == "soft-sky" ||
                       wanted.starts_with("constant:");
  std::error_code unknown;
  if (!is_word && !std::filesystem::exists(wanted, unknown)) {
    throw Error(ErrorKind::input, wanted, "there is no such environment",
                "give `env` a .hdr or .exr file, sky, soft-sky, none or constant:R,G,B");
  }
}

SceneReadOptions scene_read_options(const JobSettings& job) {
  SceneReadOptions options;
  options.animation = job.animation;
  options.threads = job.threads;
  options.memory_bytes = job.max_memory.bytes;
  options.allow_outside = job.allow_outside;
  options.allow_missing = job.allow_missing;
  options.strict = job.strict;
  options.cull_back_faces = job.cull_back_faces;
  return options;
}

void check_scene_shows(const Scene& scene) {
  const auto shows = [&](const Instance& instance) {
    const auto& geometries = scene.meshes[static_cast<std::size_t>(instance.mesh)].geometries;
    return std::any_of(geometries.begin(), geometries.end(),
                       [](const Geometry& part) { return !part.triangles.empty(); });
  };
  if (std::any_of(scene.instances.begin(), scene.instances.end(), shows)) {
    return;
  }
  std::vector<std::string> left_out = scene.ignored;
  left_out.insert(left_out.end(), scene.warnings.begin(), scene.warnings.end());
  std::string text;
  constexpr std::size_t kMost = 4;
  for (std::size_t i = 0; i < std::min(left_out.size(), kMost); ++i) {
    text += (i == 0 ? "; left out: " : "; ") + left_out[i];
  }
  if (left_out.size() > kMost) {
    text += "; and " + std::to_string(left_out.size() - kMost) + " more";
  }
  throw Error(ErrorKind::input, scene.source, "there is no geometry to render" + text,
              "'gazetrace scene' prints the contents of the file");
}

Scene load_job_scene(const JobSettings& job, const std::function<void(std::size_t, std::size_t)>& progress) {
  SceneReadOptions options = scene_read_options(job);
  options.progress = progress;
  Scene scene = load_scene(job.scene, options);
  check_scene_shows(scene);
  set_environment(job, scene);
  return scene;
}

bool moves(const Scene& scene) {
  return !(scene.motions.empty() && scene.deformations.empty());
}

}  // namespace gazetrace
