// SPDX-License-Identifier: Apache-2.0
// Identifies the build that runs and the machine, so that measurements of different ones are never mixed.
#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

#include "core/parallel.hpp"
#include "gazetrace/build_info.hpp"
#include "gazetrace/input_digest.hpp"
#include "sweep/state.hpp"

namespace gazetrace {
namespace {

// The mapped file that holds an address (Linux, proc(5)); empty where that cannot be told.
std::string file_of_code(std::uintptr_t address) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t from = 0;
    std::uintptr_t to = 0;
    char dash = 0;
    std::istringstream text(line);
    std::string flags;
    std::string offset;
    std::string device;
    std::string inode;
    std::string path;
    text >> std::hex >> from >> dash >> to >> flags >> offset >> device >> inode >> std::ws;
    std::getline(text, path);
    if (address >= from && address < to) {
      return path;
    }
  }
  return {};
}

}  // namespace

std::string build_digest() {
  const std::string file = file_of_code(reinterpret_cast<std::uintptr_t>(&build_digest));
  return file.empty() ? build_description() : digest_files({file}).begin()->second;
}

std::string machine_description() {
  std::string processor = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
      processor = line.substr(line.find(": ") + 2);
      break;
    }
  }
  return fmt::format("{}, {} threads", processor, resolve_threads(0));
}

}  // namespace gazetrace
