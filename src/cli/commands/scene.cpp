// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "gazetrace/build_info.hpp"
#include "gazetrace/input_digest.hpp"
#include "gazetrace/resolve.hpp"
#include "gazetrace/scene.hpp"
#include "gazetrace/scene_contents.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {
namespace {

// The options of a job that say how its scene is read.
constexpr std::array<const char*, 5> kReading{"animation", "allow-outside", "allow-missing", "strict", "max-memory"};

struct SceneArguments {
  std::string path;
  Job job;
  bool bvh = false;
  bool estimate = false;
  JsonOutput json;
  int threads = 0;
};

struct SceneReport {
  SceneEstimate estimate;
  Scene scene;
  SceneContents contents;
  SceneSummary summary;
  double load_s = 0;
  std::optional<TracerMemory> tracer;
  std::string ray_library;
  double peak_memory_mib = 0;
};

double mib(std::uint64_t bytes) {
  return static_cast<double>(bytes) / 1048576.0;
}

std::vector<std::string> feature_names(const SceneFeatures& features) {
  std::vector<std::string> names;
  const auto add = [&](bool present, const char* name) {
    if (present) {
      names.emplace_back(name);
    }
  };
  add(features.textures, "textures");
  add(features.normal_maps, "normal maps");
  add(features.vertex_colors, "vertex colours");
  add(features.alpha_mask, "alpha mask");
  add(features.alpha_blend, "alpha blend");
  add(features.emissive_triangles, "emissive triangles");
  add(features.punctual_lights, "punctual lights");
  add(features.instances, "instances");
  add(features.unlit, "unlit");
  add(features.layers.clearcoat, "clearcoat");
  add(features.layers.sheen, "sheen");
  add(features.layers.specular, "specular");
  add(features.layers.ior, "ior");
  add(features.layers.transmission, "transmission");
  add(features.layers.volume, "volume");
  add(features.layers.anisotropy, "anisotropy");
  add(features.layers.iridescence, "iridescence");
  add(features.layers.diffuse_transmission, "diffuse transmission");
  add(features.layers.dispersion, "dispersion");
  return names;
}

std::string or_none(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

std::string camera_text(const SceneCamera& camera) {
  const Projection& projection = camera.path.projection;
  std::string text = projection.kind == ProjectionKind::perspective
                         ? fmt::format("perspective, {:.2f} degrees high", projection.yfov_rad * kDegPerRad)
                         : fmt::format("orthographic, {} m high", 2 * projection.ymag_m);
  text += projection.aspect > 0 ? fmt::format(", {:.4g} times as wide", projection.aspect) : "";
  if (camera.path.is_static) {
    return text + ", still";
  }
  return text + fmt::format(", animated from {:.3f} s to {:.3f} s", static_cast<double>(camera.path.begin_ns) * 1e-9,
                            static_cast<double>(camera.path.end_ns) * 1e-9);
}

std::string light_text(const PunctualLight& light) {
  const char* kind = light.kind == LightKind::directional ? "directional" : "point";
  return fmt::format("{} '{}'", light.kind == LightKind::spot ? "spot" : kind, light.name);
}

std::string estimate_text(const SceneEstimate& estimate) {
  return fmt::format(
      "will take    about {:.0f} MiB: geometry {:.1f}, tree {:.1f}, textures {:.1f}, pictures while they are decoded "
      "{:.1f}, nodes {:.1f}, files {:.1f}\n",
      mib(estimate.total_bytes()), mib(estimate.geometry_bytes), mib(estimate.tree_bytes), mib(estimate.texture_bytes),
      mib(estimate.picture_bytes), mib(estimate.node_bytes), mib(estimate.file_bytes));
}

nlohmann::ordered_json estimate_json(const SceneEstimate& estimate) {
  return {{"total_bytes", estimate.total_bytes()},   {"geometry_bytes", estimate.geometry_bytes},
          {"tree_bytes", estimate.tree_bytes},       {"texture_bytes", estimate.texture_bytes},
          {"picture_bytes", estimate.picture_bytes}, {"node_bytes", estimate.node_bytes},
          {"file_bytes", estimate.file_bytes},       {"triangles", estimate.triangles},
          {"pictures", estimate.pictures},           {"nodes", estimate.nodes}};
}

std::string contents_text(const SceneContents& contents) {
  std::string text;
  for (std::size_t i = 0; i < contents.animations.size(); ++i) {
    const SceneContents::Animation& animation = contents.animations[i];
    text += fmt::format("animation {:<2} '{}': from {:.3f} s to {:.3f} s, moves {} nodes and {} shapes\n", i,
                        animation.name, animation.begin_s, animation.end_s, animation.nodes, animation.shapes);
  }
  for (std::size_t i = 0; i < contents.skins.size(); ++i) {
    text += fmt::format("skin {:<7} '{}': {} joints\n", i, contents.skins[i].name, contents.skins[i].joints);
  }
  for (const SceneContents::MorphedMesh& mesh : contents.morphed) {
    text += fmt::format("morphs       '{}': {}\n", mesh.name, fmt::join(mesh.targets, ", "));
  }
  return text;
}

void add_contents(const SceneContents& contents, nlohmann::ordered_json& json) {
  using Json = nlohmann::ordered_json;
  json["animations"] = Json::array();
  for (const SceneContents::Animation& animation : contents.animations) {
    json["animations"].push_back({{"name", animation.name},
                                  {"begin_s", animation.begin_s},
                                  {"end_s", animation.end_s},
                                  {"nodes", animation.nodes},
                                  {"shapes", animation.shapes}});
  }
  json["skins"] = Json::array();
  for (const SceneContents::Skin& skin : contents.skins) {
    json["skins"].push_back({{"name", skin.name}, {"joints", skin.joints}});
  }
  json["morph_targets"] = Json::array();
  for (const SceneContents::MorphedMesh& mesh : contents.morphed) {
    json["morph_targets"].push_back({{"mesh", mesh.name}, {"targets", mesh.targets}});
  }
}

std::string report_text(const SceneReport& report) {
  const Scene& scene = report.scene;
  const SceneSummary& s = report.summary;
  std::string text = fmt::format("{}\n", scene.source) + estimate_text(report.estimate);
  text += fmt::format("triangles    {} unique, {} instanced, {} emissive\n", s.triangles_unique, s.triangles_instanced,
                      s.emissive_triangles);
  text += fmt::format("meshes       {} with {} parts, {} instances, {} vertices\n", s.meshes, s.geometries, s.instances,
                      s.vertices);
  text += fmt::format("materials    {}, textures {}\n", s.materials, s.textures);
  if (s.bounds_min.x <= s.bounds_max.x) {
    text += fmt::format("bounds       {:g} {:g} {:g} to {:g} {:g} {:g} m\n", s.bounds_min.x, s.bounds_min.y,
                        s.bounds_min.z, s.bounds_max.x, s.bounds_max.y, s.bounds_max.z);
  }
  text += fmt::format("memory       geometry {:.1f} MiB, textures {:.1f} MiB\n", mib(s.geometry_bytes),
                      mib(s.texture_bytes));
  text += fmt::format("features     {}\n", or_none(feature_names(features_of(scene))));
  text += fmt::format("extensions   {}\n", or_none(scene.extensions_used));
  text += contents_text(report.contents);
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    text += fmt::format("camera {:<5} '{}': {}\n", i, scene.cameras[i].name, camera_text(scene.cameras[i]));
  }
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    text += fmt::format("light {:<6} {}\n", i, light_text(scene.lights[i]));
  }
  for (const std::string& line : scene.ignored) {
    text += fmt::format("ignored      {}\n", line);
  }
  for (const std::string& line : scene.warnings) {
    text += fmt::format("warning      {}\n", line);
  }
  text += fmt::format("loaded in    {:.3f} s\n", report.load_s);
  if (report.tracer) {
    text += fmt::format("tree         {:.1f} MiB, built in {:.3f} s by {}\n", mib(report.tracer->bvh_bytes),
                        report.tracer->build_s, report.ray_library);
    text += fmt::format("peak memory  {:.1f} MiB\n", report.peak_memory_mib);
  }
  return text;
}

std::string report_json(const SceneReport& report) {
  using Json = nlohmann::ordered_json;
  const Scene& scene = report.scene;
  const SceneSummary& s = report.summary;
  Json json{{"source", scene.source},
            {"estimate", estimate_json(report.estimate)},
            {"triangles_unique", s.triangles_unique},
            {"triangles_instanced", s.triangles_instanced},
            {"emissive_triangles", s.emissive_triangles},
            {"meshes", s.meshes},
            {"geometries", s.geometries},
            {"instances", s.instances},
            {"vertices", s.vertices},
            {"materials", s.materials},
            {"textures", s.textures},
            {"geometry_bytes", s.geometry_bytes},
            {"texture_bytes", s.texture_bytes},
            {"features", feature_names(features_of(scene))},
            {"extensions_used", scene.extensions_used},
            {"ignored", scene.ignored},
            {"warnings", scene.warnings},
            {"load_s", report.load_s}};
  if (s.bounds_min.x <= s.bounds_max.x) {
    json["bounds_m"] = {{"min", {s.bounds_min.x, s.bounds_min.y, s.bounds_min.z}},
                        {"max", {s.bounds_max.x, s.bounds_max.y, s.bounds_max.z}}};
  }
  json["cameras"] = Json::array();
  for (const SceneCamera& camera : scene.cameras) {
    json["cameras"].push_back({{"name", camera.name},
                               {"description", camera_text(camera)},
                               {"animated", !camera.path.is_static},
                               {"begin_ns", camera.path.begin_ns},
                               {"end_ns", camera.path.end_ns}});
  }
  add_contents(report.contents, json);
  json["lights"] = Json::array();
  for (const PunctualLight& light : scene.lights) {
    json["lights"].push_back(light_text(light));
  }
  if (report.tracer) {
    json["bvh_bytes"] = report.tracer->bvh_bytes;
    json["bvh_build_s"] = report.tracer->build_s;
    json["ray_library"] = report.ray_library;
    json["peak_memory_mib"] = report.peak_memory_mib;
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

int run_scene(const SceneArguments& arguments) {
  if (arguments.json.wanted()) {
    arguments.json.check({}, scene_files(arguments.path, arguments.job.settings.allow_outside));
  }
  SceneReport report;
  SceneReadOptions options = scene_read_options(arguments.job.settings);
  options.threads = arguments.threads;
  report.estimate = estimate_scene(arguments.path, options);
  if (arguments.estimate) {
    arguments.json.print(arguments.path + "\n" + estimate_text(report.estimate),
                         [&] { return estimate_json(report.estimate).dump(2) + "\n"; });
    return exit_done;
  }
  const auto begin = std::chrono::steady_clock::now();
  report.scene = load_scene(arguments.path, options);
  report.load_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  report.summary = summarize(report.scene);
  report.contents = read_scene_contents(arguments.path, options);
  if (arguments.bvh) {
    TracerOptions tracer_options;
    tracer_options.threads = arguments.threads;
    const PathTracer tracer(report.scene, tracer_options);
    report.tracer = tracer.memory();
    report.ray_library = tracer.ray_library();
    report.peak_memory_mib = peak_memory_mib();
  }
  arguments.json.print(report_text(report), [&] { return report_json(report); });
  return exit_done;
}

}  // namespace

Command add_scene_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<SceneArguments>();
  app.add_option("scene", arguments->path, "glTF 2.0 scene, .gltf or .glb")->required()->type_name("FILE");
  app.add_flag("--estimate", arguments->estimate, "Tells the memory that the scene will need, and does not load it");
  OptionList reading;
  for (const char* name : kReading) {
    reading.push_back(job_schema().find(name));
  }
  bind_options(app, reading, [arguments](const Option& option, const std::vector<std::string>& values) {
    set_option(arguments->job, option.name, values, {Origin::given, "the command line", {}, {}});
  });
  app.add_flag("--bvh", arguments->bvh, "Builds the ray tracing tree, too: its memory and time, and peak memory");
  app.add_option("--threads", arguments->threads, "0: as many as the machine has")
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  add_json_option(app, arguments->json);
  return {[arguments] { return run_scene(*arguments); }, {}};
}

}  // namespace gazetrace
