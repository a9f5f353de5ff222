// SPDX-License-Identifier: Apache-2.0
// A short, seeded cousin of the fuzzers (tests/fuzz): scenes, pictures, jobs, plans and what runs leave for each other,
// damaged. Each file is read, and then can be used, or refused with one line; anything else ends the test, and the
// sanitizers watch.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <random>
#include <string>

#include "support/file_seeds.hpp"
#include "support/json_mutator.hpp"

namespace gazetrace::file_mutations_test {
namespace {

namespace fs = std::filesystem;

std::mt19937_64& engine() {
  static std::mt19937_64 random;
  return random;
}

// Flipped bits, extreme words, and pieces that are gone, in place of LLVMFuzzerMutate.
std::size_t mutate_bytes(std::uint8_t* data, std::size_t size, std::size_t most) {
  const auto below = [](std::size_t n) { return static_cast<std::size_t>(engine()() % std::max<std::size_t>(n, 1)); };
  if (size == 0) {
    return 0;
  }
  switch (below(4)) {
    case 0:
      return below(size + 1);
    case 1: {
      constexpr std::array<std::uint8_t, 4> kBytes{0, 0xFF, 0x7F, 0x80};
      const std::uint8_t byte = kBytes[below(4)];
      for (std::size_t i = below(size), n = 1 + below(4); i < size && n > 0; ++i, --n) {
        data[i] = byte;
      }
      return size;
    }
    case 2: {
      const std::size_t from = below(size);
      const std::size_t count = std::min({below(16), size - from, most - size});
      std::memmove(data + from + count, data + from, size - from);
      return size + count;
    }
    default:
      for (std::size_t n = 1 + below(6); n > 0; --n) {
        data[below(size)] ^= static_cast<std::uint8_t>(1U << below(8));
      }
      return size;
  }
}

bool is_json(std::string_view text) {
  return text.starts_with("{");
}

std::string damaged(const FileSeed& seed, std::uint64_t number) {
  engine().seed(number);
  JsonMutator mutate(number, mutate_bytes);
  std::string changed;
  if (seed.bytes.starts_with("glTF")) {
    changed = mutate_glb(seed.bytes, mutate, number, mutate_bytes);
  } else if (is_json(seed.bytes) && number % 8 != 0) {
    changed = mutate(seed.bytes);
  } else {
    changed = seed.bytes;
    changed.resize(seed.bytes.size() + 64);
    changed.resize(mutate_bytes(reinterpret_cast<std::uint8_t*>(changed.data()), seed.bytes.size(), changed.size()));
  }
  return changed;
}

class FileMutations : public ::testing::Test {
 protected:
  const std::string parent =
      (fs::path(::testing::TempDir()) / ("gazetrace-files." + std::to_string(getpid()))).string();
  FuzzFolder folder{parent};
};

TEST_F(FileMutations, EverySeedIsRead) {
  for (const FileSeed& seed : file_seeds(parent)) {
    EXPECT_TRUE(fuzz_file(seed.target, seed.bytes, folder)) << seed.target << " " << seed.name;
  }
}

TEST_F(FileMutations, DamagedFilesAreReadOrRefused) {
  std::size_t read = 0;
  std::size_t refused = 0;
  std::uint64_t number = 0;
  for (const FileSeed& seed : file_seeds(parent)) {
    // Rendering takes longest, and shares its seeds with loading.
    const int times = seed.target == "scene-render" ? 3 : 12;
    for (int i = 0; i < times; ++i) {
      ++(fuzz_file(seed.target, damaged(seed, ++number), folder) ? read : refused);
    }
  }
  // Both happen often, or the mutations would be too wild or too tame to test anything.
  EXPECT_GT(read, (read + refused) / 10);
  EXPECT_GT(refused, (read + refused) / 10);
}

TEST_F(FileMutations, EveryReaderMeetsTheFilesOfAllOthers) {
  const auto seeds = file_seeds(parent);
  for (const std::string& target : fuzz_files()) {
    for (const FileSeed& seed : seeds) {
      fuzz_file(target, seed.bytes, folder);
    }
  }
}

}  // namespace
}  // namespace gazetrace::file_mutations_test
