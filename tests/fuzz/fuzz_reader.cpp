// SPDX-License-Identifier: Apache-2.0
// libFuzzer's entry. The environment's GAZETRACE_FUZZ_READER names the reader, such as gaze-eyelink-asc or camera-tum.
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "support/reader_fuzz.hpp"

namespace {

std::string chosen_reader() {
  const char* const named = std::getenv("GAZETRACE_FUZZ_READER");
  const std::string reader = named == nullptr ? "" : named;
  const auto known = gazetrace::fuzz_readers();
  if (std::find(known.begin(), known.end(), reader) == known.end()) {
    std::fprintf(stderr, "GAZETRACE_FUZZ_READER must be one of:");
    for (const std::string& name : known) {
      std::fprintf(stderr, " %s", name.c_str());
    }
    std::fprintf(stderr, "\n");
    std::_Exit(2);
  }
  return reader;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string reader = chosen_reader();
  // Files in memory where the system has such a place.
  static const std::filesystem::path parent =
      std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
  static gazetrace::FuzzFolder folder(parent / ("gazetrace-fuzz." + std::to_string(getpid())));
  gazetrace::fuzz_reader(reader, {reinterpret_cast<const char*>(data), size}, folder);
  return 0;
}
