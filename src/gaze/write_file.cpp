// SPDX-License-Identifier: Apache-2.0
#include "gaze/write_file.hpp"

#include <cstdio>
#include <filesystem>

#include "gazetrace/error.hpp"

namespace gazetrace {

void write_whole_file(const std::string& path, std::string_view bytes) {
  const std::string part = path + ".part";
  std::FILE* const file = std::fopen(part.c_str(), "wb");
  bool good = file != nullptr && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  good = (file == nullptr || std::fclose(file) == 0) && good;
  std::error_code code;
  if (good) {
    std::filesystem::rename(part, path, code);
  }
  if (!good || code) {
    std::filesystem::remove(part, code);
    throw Error(ErrorKind::runtime, path, "cannot be written", "check that its folder exists and has room");
  }
}

}  // namespace gazetrace
