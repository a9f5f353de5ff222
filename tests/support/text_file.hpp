// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

namespace gazetrace {

// A folder for the running test, which is removed with everything in it.
class TextFiles {
 public:
  TextFiles() {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(info->test_suite_name()) + "." + info->name();
    for (char& c : name) {
      c = c == '/' ? '_' : c;
    }
    folder_ = std::filesystem::path(::testing::TempDir()) / ("gazetrace-" + name + "." + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  TextFiles(const TextFiles&) = delete;
  TextFiles& operator=(const TextFiles&) = delete;
  ~TextFiles() {
    std::error_code code;
    std::filesystem::remove_all(folder_, code);
  }

  [[nodiscard]] std::string path(std::string_view name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string write(std::string_view name, std::string_view text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  // A message without the test's folder: "log.csv:3: ...".
  [[nodiscard]] std::string without_folder(std::string message) const {
    const std::string folder = folder_.string() + "/";
    for (std::size_t at = 0; (at = message.find(folder, at)) != std::string::npos;) {
      message.erase(at, folder.size());
    }
    return message;
  }

 private:
  std::filesystem::path folder_;
};

inline std::string read_file(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace gazetrace
