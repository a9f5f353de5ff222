// SPDX-License-Identifier: Apache-2.0
// A glTF 2.0 document as plain values, with the defaults of the specification filled in. It is made by document.cpp,
// the only file that uses the parser; all other files in this folder work on these values.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "gazetrace/math.hpp"
#include "scene/gltf/check.hpp"

namespace gazetrace {

struct GltfBufferView {
  int buffer = 0;
  std::uint64_t offset = 0, length = 0, stride = 0;  // stride 0: packed
};

struct GltfAccessor {
  int buffer_view = -1;  // -1: zeros
  std::uint64_t offset = 0, count = 0;
  int component_type = 0;  // 5120 ... 5126
  int components = 1;      // 1, 2, 3, 4, 9, 16
  bool normalized = false;
  struct Sparse {
    std::uint64_t count = 0;
    int indices_view = 0, indices_component_type = 0, values_view = 0;
    std::uint64_t indices_offset = 0, values_offset = 0;
  };
  std::optional<Sparse> sparse;
};

struct GltfPrimitive {
  std::map<std::string, int> attributes;
  int indices = -1, material = -1, mode = 4;
  std::vector<std::map<std::string, int>> targets;  // morph targets: from attribute to accessor
};

struct GltfMesh {
  std::string name;
  std::vector<double> weights;  // of morph targets; empty: 0
  std::vector<GltfPrimitive> primitives;
  std::vector<std::string> target_names;  // extras.targetNames, as most exporters write them; may be empty
};

struct GltfTextureInfo {
  int texture = -1, tex_coord = 0;
  bool has_transform = false;
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double rotation_rad = 0;
  double scale_factor = 1;  // of a normal map's x and y
};

// Any extension of a material by its JSON keys; material_extension.hpp interprets them.
struct GltfExtension {
  std::map<std::string, std::vector<double>> numbers;  // a number, or an array of numbers
  std::map<std::string, GltfTextureInfo> textures;
  std::set<std::string> others;  // keys of everything else
};

struct GltfMaterial {
  std::string name, alpha_mode;
  std::array<double, 4> base_color{1, 1, 1, 1};
  std::array<double, 3> emissive{0, 0, 0};
  double metallic = 1, roughness = 1, normal_scale = 1, alpha_cutoff = 0.5;
  bool double_sided = false, unlit = false;
  GltfTextureInfo base_color_texture, metallic_roughness_texture, normal_texture, emissive_texture;
  std::map<std::string, GltfExtension> extensions;
};

struct GltfNode {
  std::string name;
  int mesh = -1, camera = -1, skin = -1, light = -1;
  std::vector<int> children;
  bool hidden = false;  // KHR_node_visibility: with everything below it
  bool has_matrix = false;
  Affine matrix;  // used where has_matrix, otherwise the three below
  Vec3d translation{0, 0, 0}, scale{1, 1, 1};
  Quatd rotation;
  std::vector<double> weights;            // of its mesh's morph targets; empty: those of the mesh
  std::map<std::string, int> instancing;  // EXT_mesh_gpu_instancing: from attribute to accessor
};

struct GltfSampler {
  int mag_filter = -1, wrap_s = 10497, wrap_t = 10497;
};

struct GltfTexture {
  int sampler = -1, source = -1;
};

struct GltfCamera {
  std::string name;
  bool perspective = true;
  double yfov_rad = 0, aspect = 0, xmag = 0, ymag = 0, znear = 0, zfar = 0;
  Vec2d middle_m;  // extras.gazetrace.middle_m
};

struct GltfLight {
  std::string name, type;
  std::array<double, 3> color{1, 1, 1};
  double intensity = 1, range = 0, inner_cone_rad = 0, outer_cone_rad = kPi / 4;
};

struct GltfAnimation {
  std::string name;
  struct Sampler {
    int input = -1, output = -1;
    std::string interpolation;
  };
  struct Channel {
    int sampler = -1, node = -1;
    std::string path;
  };
  std::vector<Sampler> samplers;
  std::vector<Channel> channels;
};

struct GltfSkin {
  std::string name;
  std::vector<int> joints;         // nodes
  int inverse_bind_matrices = -1;  // accessor; -1: identity
};

struct GltfDocument {
  std::string path;
  std::vector<std::filesystem::path> data_roots;       // as GltfFile::roots
  std::vector<std::span<const std::uint8_t>> buffers;  // an entry is empty where the file has no data for it
  std::vector<GltfImageSource> images;
  std::vector<std::string> extensions_used;

  std::vector<GltfBufferView> buffer_views;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<GltfMaterial> materials;
  std::vector<GltfNode> nodes;
  std::vector<GltfSampler> samplers;
  std::vector<GltfTexture> textures;
  std::vector<GltfCamera> cameras;
  std::vector<GltfLight> lights;
  std::vector<GltfAnimation> animations;
  std::vector<GltfSkin> skins;
  std::vector<int> roots;  // of the default scene, or all root nodes where there is no scene
  std::size_t scene_count = 0;
  std::string environment_uri;  // extras.gazetrace.environment of the default scene; empty: it names none
};

// Runs the parser on checked JSON. The buffers are left empty for the caller to fill.
GltfDocument parse_gltf(const std::string& path, const CheckedGltf& checked);

}  // namespace gazetrace
