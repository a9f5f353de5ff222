// SPDX-License-Identifier: Apache-2.0
// Makes small glTF files, which can be changed (or broken) as JSON before they are written.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace::test {

// A folder for the running test, which is removed at the end.
class TempFolder {
 public:
  TempFolder() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(info->test_suite_name()) + "." + info->name() + "." + std::to_string(::getpid());
    for (char& c : name) {
      c = c == '/' ? '_' : c;
    }
    path_ = std::filesystem::path(::testing::TempDir()) / name;
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path path = path_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path.string();
  }
  std::string write(const std::string& name, const std::vector<std::uint8_t>& bytes) const {
    return write(name, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }

 private:
  std::filesystem::path path_;
};

inline std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (i + k < bytes.size() ? bytes[i + k] : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kAlphabet[bits >> (18U - 6U * k) & 63U];
    }
  }
  return text;
}

template <class T>
constexpr int component_type_of() {
  return std::is_same_v<T, std::int8_t>     ? 5120
         : std::is_same_v<T, std::uint8_t>  ? 5121
         : std::is_same_v<T, std::int16_t>  ? 5122
         : std::is_same_v<T, std::uint16_t> ? 5123
         : std::is_same_v<T, std::uint32_t> ? 5125
                                            : 5126;
}

// A file with one buffer, and a bufferView for every accessor.
class GltfBuilder {
 public:
  nlohmann::json json = {{"asset", {{"version", "2.0"}}}};

  // Adds elements of `components` values, padded to multiples of 4 bytes as vertex attributes must be.
  template <class T>
  int add(const std::vector<T>& values, int components, bool normalized = false) {
    const std::size_t width = static_cast<std::size_t>(components);
    const std::size_t element = width * sizeof(T);
    const std::size_t stride = components == 1 ? sizeof(T) : (element + 3) / 4 * 4;
    const int view = begin_view();
    for (std::size_t i = 0; i < values.size(); i += width) {
      const std::size_t at = bin_.size();
      bin_.resize(at + stride);
      std::memcpy(&bin_[at], &values[i], element);
    }
    end_view(view);
    if (stride != element) {
      json["bufferViews"].back()["byteStride"] = stride;
    }
    const char* const types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    json["accessors"].push_back({{"bufferView", view},
                                 {"componentType", component_type_of<T>()},
                                 {"count", values.size() / width},
                                 {"type", components == 16 ? "MAT4" : types[components]}});
    if (normalized) {
      json["accessors"].back()["normalized"] = true;
    }
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  // Adds raw bytes in a bufferView of their own.
  int add_view(const std::vector<std::uint8_t>& bytes) {
    const int view = begin_view();
    bin_.insert(bin_.end(), bytes.begin(), bytes.end());
    end_view(view);
    return view;
  }

  // Adds a mesh of one primitive.
  int add_mesh(const nlohmann::json& primitive) {
    json["meshes"].push_back({{"primitives", {primitive}}});
    return static_cast<int>(json["meshes"].size()) - 1;
  }
  int add_node(const nlohmann::json& node, bool is_root = true) {
    json["nodes"].push_back(node);
    const int index = static_cast<int>(json["nodes"].size()) - 1;
    if (is_root) {
      json["scene"] = 0;
      json["scenes"][0]["nodes"].push_back(index);
    }
    return index;
  }
  // Adds a triangle (0,0,0) (1,0,0) (0,1,0) in a node of its own; returns the mesh.
  int add_triangle(nlohmann::json primitive = nlohmann::json::object()) {
    primitive["attributes"]["POSITION"] = add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    const int mesh = add_mesh(primitive);
    add_node({{"mesh", mesh}});
    return mesh;
  }

  // The JSON with the buffer as a data: uri; call it once, at the end.
  [[nodiscard]] std::string text() {
    if (!bin_.empty()) {
      json["buffers"][0] = {{"byteLength", bin_.size()},
                            {"uri", "data:application/octet-stream;base64," + base64(bin_)}};
    }
    return json.dump();
  }
  [[nodiscard]] std::vector<std::uint8_t> glb() {
    json["buffers"][0] = {{"byteLength", bin_.size()}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    bin_.resize((bin_.size() + 3) / 4 * 4);
    std::vector<std::uint8_t> file{'g', 'l', 'T', 'F', 2, 0, 0, 0};
    const auto put32 = [&](std::size_t value) {
      for (const unsigned shift : {0U, 8U, 16U, 24U}) {
        file.push_back(static_cast<std::uint8_t>(value >> shift & 0xFFU));
      }
    };
    put32(12 + 8 + text.size() + 8 + bin_.size());
    put32(text.size());
    put32(0x4E4F534A);
    file.insert(file.end(), text.begin(), text.end());
    put32(bin_.size());
    put32(0x004E4942);
    file.insert(file.end(), bin_.begin(), bin_.end());
    return file;
  }

 private:
  int begin_view() {
    bin_.resize((bin_.size() + 3) / 4 * 4);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin_.size()}});
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  void end_view(int view) {
    auto& entry = json["bufferViews"][static_cast<std::size_t>(view)];
    entry["byteLength"] = bin_.size() - entry["byteOffset"].get<std::size_t>();
  }
  std::vector<std::uint8_t> bin_;
};

// The message with which loading refuses a file, which must be an ErrorKind::input.
inline std::string error_of(const std::string& path) {
  try {
    static_cast<void>(load_scene(path));
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "no error";
}

}  // namespace gazetrace::test
