// SPDX-License-Identifier: Apache-2.0
// Loads a Scene from a file: reads, checks, parses and converts it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <utility>

#include "core/data_root.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"
#include "scene/gltf/accessor.hpp"
#include "scene/gltf/animation.hpp"
#include "scene/gltf/compression.hpp"
#include "scene/gltf/estimate.hpp"
#include "scene/gltf/file.hpp"
#include "scene/gltf/material.hpp"
#include "scene/gltf/mesh.hpp"
#include "scene/gltf/node.hpp"
#include "scene/open_scene.hpp"
#include "scene/parallel_errors.hpp"
#include "scene/smooth_glass.hpp"

namespace gazetrace {
namespace {

// How far vertices reach, by the largest coordinate: of the box around them its nearest and farthest corner, and its
// size.
struct VertexReach {
  double nearest = 0, farthest = 0, size = 0;
};
VertexReach reach_of(const std::vector<Vec3f>& positions) {
  VertexReach reach;
  for (const auto axis : {&Vec3f::x, &Vec3f::y, &Vec3f::z}) {
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (const Vec3f& position : positions) {
      low = std::min(low, position.*axis);
      high = std::max(high, position.*axis);
    }
    if (low <= high) {
      const double away = low > 0 ? low : std::max(-high, 0.0F);
      reach.nearest = std::max(reach.nearest, away);
      reach.farthest =
          std::max({reach.farthest, std::fabs(static_cast<double>(low)), std::fabs(static_cast<double>(high))});
      reach.size = std::max(reach.size, static_cast<double>(high) - static_cast<double>(low));
    }
  }
  return reach;
}

void list_extensions(const GltfDocument& document, Scene& scene) {
  const auto& known = known_gltf_extensions();
  for (const std::string& name : document.extensions_used) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      scene.ignored.push_back("extension " + name);
      if (const char* shown = shown_without(name)) {
        scene.warnings.push_back("the scene uses " + name + ": " + shown);
        continue;
      }
      scene.warnings.push_back("the scene uses " + name +
                               (name == "KHR_texture_basisu"
                                    ? ", which cannot be read; the textures' fallback pictures are used"
                                    : ", which is not supported and is left out"));
    }
  }
}

// Where transforms place a body far from the world's origin, it loses nothing. Vertices that are far from the origin of
// their own mesh are coarse in the file.
void warn_of_coarse_vertices(const Scene& scene, Warnings& warnings) {
  constexpr double kNoticeable_m = 1e-3;
  constexpr double kNoticeableShare = 1e-3;  // of the size of the part: a pixel, where it fills a thousand
  double coarsest_m = 0;
  std::string where;
  std::size_t parts = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    const double scale = std::cbrt(std::fabs(determinant(instance.to_world)));
    for (const Geometry& geometry : mesh.geometries) {
      const VertexReach reach = reach_of(geometry.positions);
      const double apart_m = std::ldexp(reach.farthest, -23) * scale;  // float's steps at that distance
      const bool is_far = reach.nearest > reach.size;
      if (is_far && (apart_m > kNoticeable_m || apart_m > kNoticeableShare * reach.size * scale)) {
        ++parts;
        where = apart_m > coarsest_m ? mesh.name : where;
        coarsest_m = std::max(coarsest_m, apart_m);
      }
    }
  }
  if (parts > 0) {
    warnings.push_back(fmt::format(
        "the vertices of {} parts are so far from their own origin that the file holds them in steps of up to {:.2g} m "
        "(mesh '{:.60}'); put the distance into their nodes",
        parts, coarsest_m, where));
  }
}

void list_unshown(const GltfDocument& document, Scene& scene) {
  if (document.scene_count > 1) {
    scene.ignored.push_back(std::to_string(document.scene_count - 1) + " scenes besides the default one");
    scene.warnings.emplace_back("the file holds several scenes; the default one is shown");
  }
}

// The index of the material for primitives that name none. It is appended where a primitive needs it, or where there is
// no other material.
std::int32_t default_material(const GltfDocument& document, std::vector<Material>& materials) {
  bool needed = materials.empty();
  for (const GltfMesh& mesh : document.meshes) {
    for (const GltfPrimitive& primitive : mesh.primitives) {
      needed = needed || primitive.material < 0;
    }
  }
  if (needed) {
    materials.emplace_back().name = "glTF default";
  }
  return static_cast<std::int32_t>(materials.size()) - 1;
}

// Counts what is loaded, from several threads.
class LoadCount {
 public:
  LoadCount(const std::function<void(std::size_t, std::size_t)>& report, std::size_t total)
      : report_(report), total_(total) {}

  void one_done() {
    if (report_) {
      const std::lock_guard lock(mutex_);
      report_(++done_, total_);
    }
  }

 private:
  const std::function<void(std::size_t, std::size_t)>& report_;
  std::size_t total_;
  std::size_t done_ = 0;
  std::mutex mutex_;
};

void warn_of_backslashes(const OpenScene& open, Warnings& warnings) {
  const auto add = [&](const std::string& uri) {
    if (!is_data_uri(uri) && percent_decoded(uri).find('\\') != std::string::npos) {
      warnings.push_back("the uri '" + bounded(uri, 200) +
                         "' holds a backslash, which glTF does not allow; it was read as /");
    }
  };
  for (const GltfBufferSource& buffer : open.checked.buffers) {
    add(buffer.uri);
  }
  for (const GltfImageSource& image : open.document.images) {
    add(image.uri);
  }
}

void refuse_warnings(const Scene& scene) {
  if (!scene.warnings.empty()) {
    throw Error(
        ErrorKind::input, scene.source,
        scene.warnings.front() + (scene.warnings.size() == 1
                                      ? std::string()
                                      : "; and " + std::to_string(scene.warnings.size() - 1) + " more warnings"),
        "mend it, or leave `strict` out");
  }
}

void append(std::vector<std::string>& to, const std::vector<std::string>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

SceneEstimate estimate_scene(const std::string& path, const SceneReadOptions& options) {
  OpenScene open = open_scene(path, options);
  SceneEstimate estimate = estimate_geometry(open.file, open.checked, open.document);
  std::vector<std::vector<std::uint8_t>> storage;
  const auto& images = open.document.images;
  if (std::any_of(images.begin(), images.end(), [](const GltfImageSource& image) { return image.buffer_view >= 0; })) {
    open.document.buffers = load_buffers(open.file, open.checked.buffers, storage);
  }
  Warnings unused;
  TextureTable textures(open.document, memory_limit(options), options.allow_missing);
  make_materials(open.document, textures, unused);
  add_pictures(textures, options.threads, estimate);
  return estimate;
}

Scene load_scene(const std::string& path, const SceneReadOptions& options) {
  OpenScene open = open_scene(path, options);
  const GltfFile& file = open.file;
  const CheckedGltf& checked = open.checked;
  GltfDocument& document = open.document;
  SceneEstimate estimate = estimate_geometry(file, checked, document);
  check_memory(estimate, memory_limit(options), path);
  std::vector<std::vector<std::uint8_t>> storage;
  document.buffers = load_buffers(file, checked.buffers, storage);
  unpack_meshopt(document, checked.meshopt_views, storage, options.threads);
  unpack_draco(document, checked.draco_primitives, storage, options.threads);
  check_gltf_size(document);

  Scene scene;
  scene.source = path;
  scene.cull_back_faces = options.cull_back_faces;
  scene.extensions_used = document.extensions_used;
  if (!document.environment_uri.empty()) {
    scene.own_environment =
        resolve_uri(path, file.roots, document.environment_uri, path + ": extras.gazetrace.environment");
  }
  list_extensions(document, scene);
  warn_of_backslashes(open, scene.warnings);
  list_unshown(document, scene);

  TextureTable textures(document, memory_limit(options), options.allow_missing);
  scene.materials = make_materials(document, textures, scene.warnings);
  add_pictures(textures, options.threads, estimate);
  check_memory(estimate, memory_limit(options), path);
  const std::int32_t fallback = default_material(document, scene.materials);

  LoadCount count(options.progress, textures.picture_count() + document.meshes.size());
  const auto one_done = [&] { count.one_done(); };
  MeshResult meshes;
  parallel_for_first_error(2, options.threads, [&](std::size_t part) {
    if (part == 0) {
      scene.textures = textures.load(options.threads, one_done);
    } else {
      meshes = make_meshes(document, scene.materials, fallback, options.threads, one_done);
    }
  });
  scene.meshes = std::move(meshes.meshes);
  drop_needless_alpha(scene.textures, scene.meshes, scene.materials);
  append(scene.ignored, meshes.ignored);
  if (!meshes.ignored.empty()) {
    scene.warnings.push_back(
        meshes.ignored.front() +
        (meshes.ignored.size() == 1 ? "" : ", and " + std::to_string(meshes.ignored.size() - 1) + " more primitives"));
  }
  append(scene.warnings, meshes.warnings);

  std::vector<int> parents;
  const std::vector<WorldNode> nodes = world_nodes(document, parents);
  PlacedMeshes placed = make_instances(document, nodes, parents, scene.materials, scene.meshes, scene.warnings);
  scene.instances = std::move(placed.instances);
  scene.motions = std::move(placed.motions);
  scene.deformations = std::move(placed.deformations);
  warn_of_coarse_vertices(scene, scene.warnings);
  scene.lights = make_lights(document, nodes, scene.warnings);
  warn_of_lights_behind_glass(scene, scene.warnings);
  scene.cameras = make_cameras(document, nodes, parents, scene.warnings);
  list_unshown_motion(document, nodes, parents, scene.ignored, scene.warnings);
  for (std::size_t i = 0; i < document.animations.size(); ++i) {
    scene.animations.push_back(animation_name(document, i));
  }
  if (options.strict) {
    refuse_warnings(scene);
  }
  return scene;
}

}  // namespace gazetrace
