// SPDX-License-Identifier: Apache-2.0
// A scene as plain data, in metres with +y up, and how it is read from glTF 2.0.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/deformation.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/material.hpp"
#include "gazetrace/math.hpp"

namespace gazetrace {

// One glTF primitive: triangles with one material, in the mesh's own space. Per-vertex arrays are empty where the file
// has none, except that after loading there are always normals and, where a normal map needs them, tangents.
struct Geometry {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<Vec4f> tangents;  // w: sign of the bitangent
  std::vector<Vec2f> uv0, uv1;
  std::vector<Vec4f> colors;  // linear; they multiply the base colour
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::int32_t material = 0;
  // Only for meshes that an instance deforms.
  std::vector<MorphTarget> morph_targets;
  JointInfluences influences;
  bool flat_normals = false;   // the file has no normals, so every triangle has vertices of its own
  bool made_tangents = false;  // the file has no tangents, so they were computed
};

struct Mesh {
  std::string name;
  std::vector<Geometry> geometries;
};

// A mesh placed in the world. Loading leaves out instances whose 3x3 part has no finite inverse, with a warning.
struct Instance {
  std::int32_t mesh = 0;
  Affine to_world;                // at rest, for an instance that moves
  std::int32_t motion = -1;       // index into Scene::motions; -1: stands still
  std::int32_t deformation = -1;  // index into Scene::deformations; -1: keeps its shape
  std::string node{};             // name of the glTF node that places it; "#3" for node 3 without a name
  // Name of the outermost node above it, or its own. Where the scene has a single outermost node without a mesh, as
  // many exporters write it, that node's children count as outermost ones.
  std::string asset{};
};

// Where an instance is over time: a node's animation together with those of its parents. May be called with any time;
// before the first and after the last keyframe it stands still.
struct Motion {
  std::function<Affine(std::int64_t t_video_ns)> to_world_at;
  std::int64_t end_ns = 0;  // time of the last keyframe
};

enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };

// How a channel of a texel is stored. Images of up to 8 bits stay as they are. Of deeper ones, colours are kept as
// linear light in half floats (11 bits of precision at any brightness) and other data as 16-bit integers.
enum class TexelFormat : std::uint8_t { unorm8, unorm16, half };

// Interleaved RGBA with unassociated alpha and a full mip chain, level 0 first.
struct Texture {
  std::string name;
  TexelFormat format = TexelFormat::unorm8;
  bool srgb = false;  // RGB is sRGB-encoded; unorm8 only
  bool has_alpha = false;
  bool nearest = false;  // magFilter NEAREST
  TextureWrap wrap_u = TextureWrap::repeat;
  TextureWrap wrap_v = TextureWrap::repeat;
  struct Level {
    int width_px = 0, height_px = 0;
    std::vector<std::uint8_t> rgba;  // 4 or 8 bytes per texel, in the machine's byte order
  };
  std::vector<Level> levels;
};

enum class LightKind : std::uint8_t { directional, point, spot };

// KHR_lights_punctual, in world space. Candela and lux are taken as W/sr and W/m^2 (no luminous efficacy).
struct PunctualLight {
  std::string name;
  LightKind kind = LightKind::point;
  Vec3f intensity{1, 1, 1};  // colour * intensity: W/sr (point, spot) or W/m^2 (directional)
  Vec3d position_m;
  Vec3f direction{0, 0, -1};                     // the way the light travels (directional, spot)
  float range_m = 0;                             // 0: infinite
  float cos_inner = 1, cos_outer = 0.70710678F;  // of a spot's cone angles: full intensity inside, none outside
};

// Radiance from all directions as a latitude-longitude picture: u = 0.5 + azimuth / 2 pi, with the azimuth measured
// from -z towards +x (the picture's centre is -z), and v = 0 straight up (+y). A constant environment is one pixel.
struct Environment {
  ImageRgb radiance;        // empty: no environment at all
  double rotation_rad = 0;  // about +y; a positive angle turns the picture's content from -z towards +x
  std::string source;
  Warnings warnings;
  [[nodiscard]] bool present() const { return !radiance.empty(); }
};

struct SceneCamera {
  std::string name;
  CameraPath path;  // static or animated, by its node or that node's parents
};

// The features of a scene. The tracer chooses the variant of its inner loop by it.
struct SceneFeatures {
  bool textures = false;
  bool normal_maps = false;
  bool vertex_colors = false;
  bool alpha_mask = false;
  bool alpha_blend = false;
  bool emissive_triangles = false;
  bool punctual_lights = false;
  bool environment = false;
  bool instances = false;  // a mesh is used more than once
  bool motion = false;     // an instance that moves or deforms
  bool unlit = false;
  MaterialLayers layers;
  bool specular = true;  // some material is not purely diffuse (true of every glTF material)
};

struct Scene {
  std::string source;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Motion> motions;
  std::vector<Deformation> deformations;
  std::vector<Material> materials;  // never empty: index 0 may be glTF's default material
  std::vector<Texture> textures;
  std::vector<PunctualLight> lights;
  std::vector<SceneCamera> cameras;
  Environment environment;
  // Camera rays pass the backs of triangles whose material is not double-sided (glTF 2.0 section 3.9.5); rays after a
  // bounce, and to lights, never do.
  bool cull_back_faces = false;
  std::string own_environment;  // the picture that the file names in its extras; empty: none. It is not read

  std::vector<std::string> animations;  // names; "#0" where the file gives none
  std::vector<std::string> extensions_used;
  std::vector<std::string> ignored;  // parts of the file that gazetrace does not show, one line each
  Warnings warnings;
};

struct MaterialExtensionInfo {
  std::string name;  // "KHR_materials_clearcoat"
  std::string description;
};
std::vector<MaterialExtensionInfo> material_extensions();

// Three quarters of the memory that the machine, or the control group that the process is in, lets it have.
std::uint64_t most_memory_bytes();

struct SceneReadOptions {
  int threads = 0;  // for decoding textures and reading meshes, which overlap; 0: all cores
  // The animation that plays, by name or number ("2", counted from 0). Empty: for each node, camera and skin the first
  // one that moves it.
  std::string animation;
  // Called with the number of textures and meshes that are ready; from several threads, but never at the same time.
  std::function<void(std::size_t done, std::size_t total)> progress;
  // The most memory of the loaded scene with its tracing structures, by estimate_scene() and not by the size of its
  // file; 0: most_memory_bytes(). One picture may unpack to a sixteenth of it beyond 200 times its file, and the
  // nodes may take a sixteenth. Every refusal names `max-memory`.
  std::uint64_t memory_bytes = 0;
  // The scene may name files outside of its data set. Otherwise buffers and pictures must lie, symbolic links followed,
  // in the scene's folder or in the data set that it belongs to, see src/core/data_root.hpp.
  bool allow_outside = false;
  bool allow_missing = false;    // a material whose picture is not there is shown without it, with a warning
  bool cull_back_faces = false;  // becomes Scene::cull_back_faces
  bool strict = false;           // every warning of the scene is an Error(input)
};

// The memory that a scene will take, from its JSON and the headers of its pictures: no picture is decoded.
struct SceneEstimate {
  std::uint64_t file_bytes = 0;      // the scene's file with its buffers, held while it is loaded
  std::uint64_t geometry_bytes = 0;  // vertices and triangles
  std::uint64_t texture_bytes = 0;   // with their mip levels
  std::uint64_t picture_bytes = 0;   // the largest picture as it is decoded, held while it becomes a texture
  std::uint64_t node_bytes = 0;      // nodes and instances
  std::uint64_t tree_bytes = 0;      // for tracing: trees over the triangles, and triangles prepared for shading
  std::uint64_t triangles = 0, pictures = 0, nodes = 0;
  [[nodiscard]] std::uint64_t total_bytes() const {
    return file_bytes + geometry_bytes + texture_bytes + picture_bytes + node_bytes + tree_bytes;
  }
};
// Error(input) as load_scene() would throw for faults of the JSON and of pictures' headers; not for its memory.
SceneEstimate estimate_scene(const std::string& path, const SceneReadOptions& options = {});

// Reads a .gltf or .glb file. Error(input) names the file, the place in its JSON
// ("meshes[3].primitives[0].attributes.NORMAL") and the fault; an unknown extension in extensionsRequired is such
// an error.
Scene load_scene(const std::string& path, const SceneReadOptions& options = {});

// Reads a latitude-longitude .hdr, .exr or other picture; pixels are multiplied by 2^exposure_ev. Error(input) for cube
// maps, for non-finite pixels, and for pictures that take more than `memory_bytes` (0: most_memory_bytes()). With a
// warning, infinite halves become 65504, display values the light of sRGB, and negative values, which lossy compression
// leaves in dark areas, 0.
Environment load_environment(const std::string& path, double rotation_deg = 0, double exposure_ev = 0,
                             std::uint64_t memory_bytes = 0);
Environment constant_environment(const Vec3f& radiance);
// A clear sky without a sun disc: an analytic gradient (zenith, horizon, ground) with a soft glow around the sun's
// direction, smooth enough to need few samples.
Environment builtin_sky(double rotation_deg = 0, double exposure_ev = 0);

SceneFeatures features_of(const Scene& scene);

struct SceneSummary {
  std::uint64_t triangles_unique = 0, triangles_instanced = 0;
  std::uint64_t vertices = 0, meshes = 0, geometries = 0, instances = 0;
  std::uint64_t materials = 0, textures = 0, lights = 0, emissive_triangles = 0;
  std::uint64_t geometry_bytes = 0, texture_bytes = 0;
  Vec3d bounds_min, bounds_max;  // of all vertices at rest, in the world; min > max when empty
};
SceneSummary summarize(const Scene& scene);

}  // namespace gazetrace
