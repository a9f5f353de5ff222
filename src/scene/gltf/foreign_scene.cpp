// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/foreign_scene.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/list_folder.hpp"
#include "core/text.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

// A kind of file by how it begins, by a word near its beginning, or by the end of its name; empty parts say nothing.
struct ForeignKind {
  const char* name;
  std::string_view begins, holds;
  std::vector<std::string_view> suffixes;
  const char* way = "import it in Blender and export .glb";
};

constexpr const char* kImport = "make it one: gazetrace import FILE -o SCENE.glb";

const std::vector<ForeignKind>& foreign_kinds() {
  static const std::vector<ForeignKind> kKinds{
      {"USD", "PXR-USDC", "#usda", {".usd", ".usda", ".usdc", ".usdz"}, kImport},
      {"FBX", "Kaydara FBX Binary", "FBXHeaderExtension", {".fbx"}, kImport},
      {"a Blender file",
       "BLENDER",
       "",
       {".blend"},
       "make it one: gazetrace import FILE -o SCENE.glb; or render it with the add-on (docs/blender.md)"},
      {"a Mitsuba scene", "", "<scene", {}, "export .glb from where it was made, or import it in Blender first"},
      {"a pbrt scene",
       "",
       "WorldBegin",
       {".pbrt"},
       "export .glb from where it was made, or import it in Blender first"},
      {"COLLADA", "", "<COLLADA", {".dae"}},
      {"X3D", "", "<X3D", {".x3d", ".wrl"}},
      {"PLY", "ply\n", "", {".ply"}, kImport},
      {"PLY", "ply\r", "", {}, kImport},
      {"Alembic", "Ogawa", "", {".abc"}, kImport},
      {"Wavefront OBJ", "", "mtllib ", {".obj"}, kImport},
      {"STL", "", "", {".stl"}, kImport},
      {"3DS", "", "", {".3ds"}},
      {"a Maya scene", "", "//Maya ASCII", {".ma", ".mb"}, "export .glb from where it was made"},
      {"a 3ds Max scene", "", "", {".max"}, "export .glb from where it was made"},
      {"a Cinema 4D scene", "", "", {".c4d"}, "export .glb from where it was made"},
      {"a Houdini scene", "", "", {".hip", ".hipnc"}, "export .glb from where it was made"},
      {"a web page", "<!DOCTYPE html", "<html", {".html", ".htm"}, "download the file itself"},
      {"a pointer of Git LFS", "version https://git-lfs", "", {}, "fetch the file itself: git lfs pull"},
      {"a settings file", "", "", {".toml"}, "give it by --config"},
      {"a table",
       "",
       "",
       {".csv", ".tsv", ".txt", ".asc"},
       "a gaze log goes after `gaze`, a camera path after `camera-path`"},
      {"a picture", "", "", {".hdr", ".exr", ".png", ".jpg"}, "an environment goes after `env`"},
      {"a zip archive", "PK\x03\x04", "", {".zip"}, "unpack it and give the .gltf or .glb that is in it"},
  };
  return kKinds;
}

bool has_suffix(const ForeignKind& kind, const std::string& suffix) {
  return std::find(kind.suffixes.begin(), kind.suffixes.end(), suffix) != kind.suffixes.end();
}

bool has_content(const ForeignKind& kind, std::string_view head) {
  return (!kind.begins.empty() && head.starts_with(kind.begins)) ||
         (!kind.holds.empty() && head.find(kind.holds) != std::string_view::npos);
}

bool is_scene_name(const fs::path& path) {
  const std::string suffix = to_lower(path.extension().string());
  return suffix == ".gltf" || suffix == ".glb";
}

}  // namespace

void refuse_foreign_scene(const std::string& path, std::string_view bytes) {
  constexpr std::size_t kHead = 4096;
  const std::string_view head = bytes.substr(0, kHead);
  if (const std::size_t first = head.find_first_not_of(" \t\r\n");
      first != std::string_view::npos && head[first] == '{') {
    return;  // JSON, and its reader says what is wrong
  }
  const std::string suffix = to_lower(fs::path(path).extension().string());
  const ForeignKind* found = nullptr;
  for (const ForeignKind& kind : foreign_kinds()) {  // a name says more than bytes: a .usdz is a zip archive
    found = has_suffix(kind, suffix) ? &kind : found;
  }
  for (const ForeignKind& kind : foreign_kinds()) {
    found = found == nullptr && has_content(kind, head) ? &kind : found;
  }
  if (found != nullptr) {
    throw Error(ErrorKind::input, path, std::string("this is ") + found->name + ", and only glTF (.gltf, .glb) is read",
                found->way);
  }
}

void refuse_folder_as_scene(const std::string& path) {
  std::error_code failed;
  std::vector<std::string> scenes;
  for (const fs::path& entry : list_folder(path, failed)) {
    if (is_scene_name(entry)) {
      scenes.push_back(entry.string());
    } else if (std::error_code ignored; fs::is_directory(entry, ignored)) {
      for (const fs::path& within : list_folder(entry, failed)) {  // as in the sample assets: Fox/glTF/Fox.gltf
        if (is_scene_name(within)) {
          scenes.push_back(within.string());
        }
      }
    }
  }
  throw Error(
      ErrorKind::input, path, "this is a folder, not a scene",
      scenes.empty()
          ? "give the path of a .gltf or .glb; there is none in it"
          : "give " + scenes.front() +
                (scenes.size() == 1 ? "" : ", or one of the " + std::to_string(scenes.size() - 1) + " more in it"));
}

}  // namespace gazetrace
