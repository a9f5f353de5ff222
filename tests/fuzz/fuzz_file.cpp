// SPDX-License-Identifier: Apache-2.0
// libFuzzer's entries for the targets of file_fuzz.hpp. The environment's GAZETRACE_FUZZ_READER names the target. With
// GAZETRACE_FUZZ_SEEDS=FOLDER the first inputs of all targets are written there, and nothing else is done.
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "support/file_seeds.hpp"
#include "support/json_mutator.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

using namespace gazetrace;
namespace fs = std::filesystem;

// Files in memory where the system has such a place.
FuzzFolder& folder() {
  static const fs::path parent = fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path();
  static FuzzFolder folder(parent / ("gazetrace-fuzz." + std::to_string(getpid())));
  return folder;
}

const std::string& target() {
  static const std::string chosen = [] {
    const char* const named = std::getenv("GAZETRACE_FUZZ_READER");
    const std::string name = named == nullptr ? "" : named;
    const auto known = fuzz_files();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      std::fprintf(stderr, "GAZETRACE_FUZZ_READER must be one of:");
      for (const std::string& one : known) {
        std::fprintf(stderr, " %s", one.c_str());
      }
      std::fprintf(stderr, "\n");
      std::_Exit(2);
    }
    return name;
  }();
  return chosen;
}

bool is_json(const std::string& name) {
  return name.starts_with("scene") || name == "run-record" || name == "farm" || name == "chunks" || name == "results" ||
         name == "display";
}

// New bytes, empty where there is no way of their own for this target and input.
std::string mutated(std::string_view input, std::uint64_t seed) {
  static const std::vector<std::pair<std::string, std::string>> donors = test::scene_seeds();
  JsonMutator mutate(seed, LLVMFuzzerMutate);
  if (target().starts_with("scene") && input.starts_with("glTF")) {
    return mutate_glb(input, mutate, seed, LLVMFuzzerMutate);
  }
  if (is_json(target()) && seed % 16 != 0) {
    const std::string& donor = donors[seed / 16 % donors.size()].second;
    return mutate(input, target().starts_with("scene") ? std::string_view(donor) : std::string_view());
  }
  return {};
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*count*/, char*** /*arguments*/) {
  if (const char* const seeds = std::getenv("GAZETRACE_FUZZ_SEEDS")) {
    for (const FileSeed& seed : file_seeds(fs::temp_directory_path().string())) {
      fs::create_directories(fs::path(seeds) / seed.target);
      std::ofstream(fs::path(seeds) / seed.target / seed.name, std::ios::binary) << seed.bytes;
    }
    std::_Exit(0);
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  std::string changed = mutated({reinterpret_cast<const char*>(data), size}, hash64(seed));
  if (changed.empty() || changed.size() > most) {
    size = LLVMFuzzerMutate(data, size, most);
    changed.assign(reinterpret_cast<const char*>(data), size);
  }
  size = std::min(changed.size(), most);
  std::memcpy(data, changed.data(), size);
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz_file(target(), {reinterpret_cast<const char*>(data), size}, folder());
  return 0;
}
