// SPDX-License-Identifier: Apache-2.0
// One entry point for the readers of everything but gaze logs and camera paths (reader_fuzz.hpp has those): scenes,
// pictures, jobs, plans, and what runs leave for each other. Any bytes are either read, and then what was read can be
// used, or refused with one short line. Anything else ends the program. The fuzzers and the mutation test use it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/image_io.hpp"
#include "gazetrace/compare.hpp"
#include "gazetrace/farm.hpp"
#include "gazetrace/gaze_aois.hpp"
#include "gazetrace/job.hpp"
#include "gazetrace/job_schema.hpp"
#include "gazetrace/resolve.hpp"
#include "gazetrace/results.hpp"
#include "output/exr.hpp"
#include "render/tracer_scenes.hpp"
#include "support/reader_fuzz.hpp"
#include "sweep/plan_file.hpp"

namespace gazetrace {

// "scene" loads; "scene-render" also traces a tiny frame of what was loaded. "picture-exr" and the like have the suffix
// that the file gets.
inline std::vector<std::string> fuzz_files() {
  return {
      "scene",  "scene-render", "picture-png", "picture-jpg", "picture-exr",   "picture-hdr",
      "job",    "sweep-plan",   "run-record",  "timing",      "parts",         "farm",
      "chunks", "results",      "display",     "aois",        "density-curve",
  };
}

namespace fuzz {

// The most that a scene may take here; the fuzzer's own limit is above it.
inline constexpr std::uint64_t kSceneBytes = std::uint64_t{192} << 20U;
inline constexpr const char* kDigest = "0123456789abcdef0123456789abcdef";

// A frame and settings that scenes are rendered with.
struct SmallRun {
  Scene scene;
  FrameRequest request;
  FrameSettings settings;

  SmallRun() {
    scene.materials = {test::diffuse_material({0.8F, 0.7F, 0.6F})};
    scene.environment = constant_environment({1, 1, 1});
    test::add_mesh(scene, test::box(0.6F, false, 0));
    request.width_px = 8;
    request.height_px = 6;
    request.t_video_ns = request.shutter_open_ns = request.shutter_close_ns = 20'000'000;
    request.camera = test::camera_at({0.5, 0.5, 3}, {0, 0, 0});
    request.view = view_of_perspective(50 * kRadPerDeg, request.width_px, request.height_px);
    request.gaze_direction_render = request.gaze_direction_true = request.view.direction(4, 3);
    std::get<RegionSampling>(settings.foveation.sampling).samples = {4, 2, 2};
    settings.reconstruction.filter = "guided";
    settings.exposure.mode = ExposureMode::log_average;
    settings.threads = 1;
  }
};

inline SceneReadOptions scene_options() {
  SceneReadOptions options;
  options.threads = 1;
  options.memory_bytes = kSceneBytes;
  return options;
}

inline std::vector<std::int64_t> times_of(std::int64_t end_ns) {
  return {std::numeric_limits<std::int64_t>::min(), -1, 0, end_ns / 3, end_ns,
          std::numeric_limits<std::int64_t>::max()};
}

// What other code relies on.
inline void check_scene(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    for (const Geometry& geometry : mesh.geometries) {
      const std::size_t count = geometry.positions.size();
      require(geometry.normals.size() == count, "a normal for every vertex");
      for (const auto& triangle : geometry.triangles) {
        require(triangle[0] < count && triangle[1] < count && triangle[2] < count, "corners are vertices");
      }
      require(geometry.material >= 0 && static_cast<std::size_t>(geometry.material) < scene.materials.size(),
              "a material that there is");
      for (const auto* uv : {&geometry.uv0, &geometry.uv1}) {
        require(uv->empty() || uv->size() == count, "texture coordinates for all vertices");
      }
      require(geometry.tangents.empty() || geometry.tangents.size() == count, "tangents for all vertices");
      require(geometry.colors.empty() || geometry.colors.size() == count, "colours for all vertices");
    }
  }
  for (const Instance& instance : scene.instances) {
    require(instance.mesh >= 0 && static_cast<std::size_t>(instance.mesh) < scene.meshes.size(),
            "a mesh that there is");
  }
  for (const std::string& warning : scene.warnings) {
    require(warning.find('\n') == std::string::npos || bounded(warning).find('\n') == std::string::npos, "one line");
  }
  static_cast<void>(features_of(scene));
  static_cast<void>(summarize(scene));
  for (const Motion& motion : scene.motions) {
    for (const std::int64_t t_ns : times_of(motion.end_ns)) {
      static_cast<void>(motion.to_world_at(t_ns));
    }
  }
  for (const SceneCamera& camera : scene.cameras) {
    for (const std::int64_t t_ns : times_of(camera.path.end_ns)) {
      static_cast<void>(camera.path.pose_at(t_ns));
    }
  }
  for (const Instance& instance : scene.instances) {
    if (instance.deformation >= 0) {
      const Deformation& deformation = scene.deformations[static_cast<std::size_t>(instance.deformation)];
      for (const Geometry& geometry : scene.meshes[static_cast<std::size_t>(instance.mesh)].geometries) {
        const Material& material = scene.materials[static_cast<std::size_t>(geometry.material)];
        static_cast<void>(deform(geometry, deformation.pose_at(deformation.end_ns / 3), material.normal_texture, 1));
      }
    }
  }
}

// A frame of a few pixels with an open shutter, through guides, filter and all.
inline void render_scene(Scene scene) {
  SmallRun run;
  scene.environment = constant_environment({0.5F, 0.6F, 0.7F});
  std::int64_t end_ns = 0;
  for (const Motion& motion : scene.motions) {
    end_ns = std::max(end_ns, motion.end_ns);
  }
  run.request.shutter_open_ns = end_ns / 4;
  run.request.t_video_ns = end_ns / 4;
  run.request.shutter_close_ns = end_ns / 2;
  if (!scene.cameras.empty()) {
    run.request.camera.pose = scene.cameras.front().path.pose_at(run.request.t_video_ns);
    run.request.camera.projection = scene.cameras.front().path.projection;
  }
  PathTracer tracer(scene, test::threads(1));
  const RenderedFrame rendered = FrameRenderer(tracer, run.settings).render(run.request);
  for (const Vec3f& pixel : rendered.frame.radiance.pixels) {
    require(is_finite(pixel), "every pixel is finite");
  }
}

inline void read_scene(const std::string& path, bool with_picture) {
  Scene scene = load_scene(path, scene_options());
  check_scene(scene);
  static_cast<void>(estimate_scene(path, scene_options()));
  if (with_picture) {
    render_scene(std::move(scene));
  }
}

// Calls each of several readers of one file; whether any of them read it.
template <class... Readers>
bool any_reads(const Readers&... readers) {
  std::size_t read = 0;
  const auto one = [&](const auto& reader) {
    try {
      reader();
      ++read;
    } catch (const Error& error) {
      const std::string_view message = error.what();
      static const bool tell = std::getenv("GAZETRACE_FUZZ_TELL") != nullptr;  // what a finding became
      if (tell) {
        std::fprintf(stderr, "refused: %s\n", error.what());
      }
      require(!message.empty() && message.size() < 3000 && message.find('\n') == std::string_view::npos,
              "a refusal has one short line");
    }
  };
  (one(readers), ...);
  return read > 0;
}

inline bool read_picture(const std::string& path, std::string_view input) {
  PictureLimits limits;
  limits.expansion = 200;
  limits.free_bytes = std::uint64_t{16} << 20U;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(input.data());
  return any_reads([&] { static_cast<void>(read_image_rgba(path, "images[0]", limits)); },
                   [&] { static_cast<void>(read_image_rgba(std::span(bytes, input.size()), "images[0]", limits)); },
                   [&] { static_cast<void>(read_picture_size(path, "images[0]", limits)); },
                   [&] { static_cast<void>(load_environment(path, 30, 1)); },
                   [&] { static_cast<void>(read_compared_picture(path)); },
                   [&] { static_cast<void>(read_pooling_weights(path)); },
                   [&] {
                     static_cast<void>(read_picture_channel(path, {"Y", "R"}));
                   },
                   [&] { static_cast<void>(read_exr_rgb(path)); }, [&] { static_cast<void>(read_frame_stamp(path)); },
                   [&] { static_cast<void>(read_image_note(path)); });
}

inline void read_job(const std::string& path) {
  const Job job = load_job(path);
  const std::string text = job_as_toml(job);
  require(job_as_toml(job_from_toml(text, "again")) == text, "a job that was written is the same job");
  static_cast<void>(idle_option_warnings(job));
  check_job(job);
}

inline void read_farm_folder(const std::string& folder) {
  const FarmPlan plan = read_farm(folder);
  static_cast<void>(farm_plan_text(plan));
  static_cast<void>(farm_tasks(plan));
  std::vector<std::size_t> chunks(plan.chunks.size());
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    chunks[i] = i;
  }
  static_cast<void>(farm_files(plan, chunks));
}

// A folder that several runs rendered into.
inline void read_parts(const std::string& folder) {
  const std::vector<RunPart> parts = read_run_parts(folder);
  static_cast<void>(find_bad_files(parts, 1));
  for (const RunPart& part : parts) {
    static_cast<void>(parse_frame_list(part.record.frames));
  }
}

inline std::string name_of_file(const std::string& target) {
  return target.starts_with("scene")      ? "scene.gltf"
         : target.starts_with("picture-") ? "picture." + target.substr(8)
         : target == "job"                ? "job.toml"
         : target == "sweep-plan"         ? "plan.toml"
         : target == "parts"              ? "timing.1-2.csv"
         : target == "farm"               ? "farm.json"
                                          : "file." + target;
}

inline bool read_file(const std::string& target, const std::string& path, std::string_view input) {
  const std::string folder = path.substr(0, path.rfind('/'));
  if (target.starts_with("picture-")) {
    return read_picture(path, input);
  }
  return any_reads([&] {
    if (target.starts_with("scene")) {
      read_scene(path, target == "scene-render");
    } else if (target == "job") {
      read_job(path);
    } else if (target == "sweep-plan") {
      static_cast<void>(read_sweep_file(path, job_schema()));
    } else if (target == "run-record") {
      static_cast<void>(job_of_record(read_run_record(path), path));
    } else if (target == "timing") {
      static_cast<void>(timing_csv_text(read_timing_csv(path)));
    } else if (target == "parts") {
      read_parts(folder);
    } else if (target == "farm") {
      read_farm_folder(folder);
    } else if (target == "chunks") {
      static_cast<void>(chunk_file_text(read_chunk_file(path)));
    } else if (target == "results") {
      static_cast<void>(read_results(path));
    } else if (target == "display") {
      static_cast<void>(load_display(path));
    } else if (target == "aois") {
      static_cast<void>(load_aois(path, std::nullopt));
    } else if (target == "density-curve") {
      static_cast<void>(load_density_curve(path));
    } else {
      require(false, "there is no such target");
    }
  });
}

}  // namespace fuzz

// True where the bytes were read, false where they were properly refused.
inline bool fuzz_file(const std::string& target, std::string_view input, FuzzFolder& folder) {
  const std::string path = folder.put(fuzz::name_of_file(target), input);
  return fuzz::read_file(target, path, input);
}

}  // namespace gazetrace
