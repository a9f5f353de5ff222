// SPDX-License-Identifier: Apache-2.0
// Which files a run reads, and digests of their content.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/data_root.hpp"
#include "core/file_digest.hpp"
#include "core/parallel.hpp"
#include "gazetrace/input_digest.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

std::string read_bytes(std::ifstream& file, std::size_t count) {
  std::string bytes(count, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

// The JSON of a .gltf, or of a .glb's first chunk (glTF 2.0, section 4.4). What is broken here is left to the reader
// of scenes, whose messages are better: the result is then empty.
std::string json_text(const std::string& path) {
  std::ifstream file = open_for_reading(path);
  std::string head = read_bytes(file, 20);
  if (head.size() == 20 && head.starts_with("glTF")) {
    std::uint32_t length = 0;
    std::memcpy(&length, head.data() + 12, sizeof(length));
    std::error_code ignored;
    const auto size = fs::file_size(path, ignored);
    return ignored || length > size ? std::string() : read_bytes(file, length);
  }
  std::string rest((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return head + rest;
}

}  // namespace

std::vector<std::string> scene_files(const std::string& path, bool allow_outside) {
  std::vector<std::string> files{path};
  const std::vector<fs::path> roots = data_roots(path);
  const auto json = nlohmann::json::parse(json_text(path), nullptr, false);
  if (!json.is_object()) {
    return files;
  }
  const auto add = [&](const std::string& text, const std::string& kind) {
    if (text.empty() || text.starts_with("data:")) {
      return;
    }
    const std::string file = file_of_uri(path, text);
    if (!allow_outside) {
      check_within(roots, file, text, path + ": " + kind);
    }
    // A missing image is the scene reader's business: it may go on with a warning.
    std::error_code unknown;
    if (fs::is_regular_file(file, unknown) && std::find(files.begin(), files.end(), file) == files.end()) {
      files.push_back(file);
    }
  };
  for (const char* kind : {"buffers", "images"}) {
    const auto list = json.find(kind);
    if (list == json.end() || !list->is_array()) {
      continue;
    }
    for (const auto& item : *list) {
      const auto uri = item.is_object() ? item.find("uri") : item.end();
      if (item.is_object() && uri != item.end() && uri->is_string()) {
        add(uri->get<std::string>(), kind);
      }
    }
  }
  // The environment that a scene names: of whichever of its scenes is shown.
  const auto scenes = json.find("scenes");
  for (const auto& scene : scenes != json.end() && scenes->is_array() ? *scenes : nlohmann::json::array()) {
    const nlohmann::json::json_pointer place("/extras/gazetrace/environment");
    if (scene.is_object() && scene.contains(place) && scene.at(place).is_string()) {
      add(scene.at(place).get<std::string>(), "extras.gazetrace.environment");
    }
  }
  return files;
}

std::map<std::string, std::string> digest_files(const std::vector<std::string>& paths, int threads) {
  std::vector<std::string> digests(paths.size());
  parallel_for(paths.size(), threads, [&](std::size_t i) { digests[i] = digest_file(paths[i]); });
  std::map<std::string, std::string> result;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    result[paths[i]] = digests[i];
  }
  return result;
}

}  // namespace gazetrace
