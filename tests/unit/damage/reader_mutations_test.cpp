// SPDX-License-Identifier: Apache-2.0
// A short, seeded cousin of the fuzzers (tests/fuzz): every reader gets damaged copies of small files of its own, and
// of others'. It reads them or refuses them with one line; anything else ends the test, and the sanitizers watch.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "support/reader_fuzz.hpp"
#include "support/text_file.hpp"

namespace gazetrace::reader_mutations_test {
namespace {

namespace fs = std::filesystem;

struct Seed {
  std::string reader, text;
};

// The seeds of the fuzzers, and beginnings of the recordings beside the project where they are there.
std::vector<Seed> seeds() {
  std::vector<Seed> all;
  for (const auto& entry : fs::recursive_directory_iterator(std::string(GAZETRACE_SOURCE_DIR) + "/tests/fuzz/seeds")) {
    if (entry.is_regular_file()) {
      all.push_back({entry.path().parent_path().filename().string(), read_file(entry.path().string())});
    }
  }
  const std::vector<std::pair<std::string, std::string>> recordings{
      {"gaze-eyelink-asc", "eyelink-asc/bino1000.asc"},
      {"gaze-tobii-studio", "tobii-studio-tsv/data.tsv"},
      {"gaze-tobii-glasses-2", "tobii-glasses2/livedata.json.gz"},
      {"gaze-tobii-glasses-3", "tobii-glasses3/gazedata.gz"},
      {"gaze-pupil-core", "pupil-core/gaze_positions_with_monocular.csv"},
      {"gaze-pupil-cloud", "pupil-invisible-cloud/gaze.csv"},
      {"gaze-neon-native", "pupil-neon-native/gaze ps1.raw"},
      {"gaze-arff", "arff/gaze.arff"},
      {"gaze-vive-sranipal", "vive-pro-eye/TESTNA01_360VR_Fist3.csv"},
      {"gaze-pico", "pico-neo3-pro/boxing_VR.csv"},
      {"gaze-gazebase", "gazebase-vr/gazebase_vr_example.csv"},
  };
  for (const auto& [reader, file] : recordings) {
    const std::string path = std::string(GAZETRACE_SHARED_DIR) + "/gaze-samples/" + file;
    if (fs::exists(path)) {
      all.push_back({reader, read_file(path).substr(0, 6000)});
    }
  }
  std::sort(all.begin(), all.end(),
            [](const Seed& a, const Seed& b) { return a.reader == b.reader ? a.text < b.text : a.reader < b.reader; });
  return all;
}

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string operator()(std::string text) {
    const int changes = 1 + static_cast<int>(below(3));
    for (int i = 0; i < changes && !text.empty(); ++i) {
      change(text);
    }
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % std::max<std::size_t>(n, 1)); }

  void change(std::string& text) {
    switch (below(8)) {
      case 0:  // cut off
        text.resize(below(text.size()));
        break;
      case 1:  // flipped bits
        for (std::size_t i = 1 + below(8); i > 0; --i) {
          text[below(text.size())] ^= static_cast<char>(1U << below(8));
        }
        break;
      case 2:
        shuffle_lines(text);
        break;
      case 3:
        replace_number(text);
        break;
      case 4: {  // its beginning, header and all, once more somewhere
        const std::string head = text.substr(0, below(std::min<std::size_t>(text.size(), 600)));
        text.insert(below(text.size()), head);
        break;
      }
      case 5: {  // a piece is gone
        const std::size_t at = below(text.size());
        text.erase(at, below(200));
        break;
      }
      case 6:  // a cell is empty, or there is one too many
        text.insert(below(text.size()), std::array<const char*, 4>{",", "\t", ";", "\n"}[below(4)]);
        break;
      default:  // one long line
        std::replace(text.begin(), text.end(), '\n', ' ');
        break;
    }
  }

  void shuffle_lines(std::string& text) {
    std::vector<std::string> lines;
    std::size_t begin = 0;
    while (begin < text.size()) {
      const std::size_t end = std::min(text.find('\n', begin), text.size() - 1);
      lines.push_back(text.substr(begin, end + 1 - begin));
      begin = end + 1;
    }
    // Not std::shuffle: its order is the library's own affair.
    for (std::size_t i = lines.size(); i > 1; --i) {
      std::swap(lines[i - 1], lines[below(i)]);
    }
    text.clear();
    for (const std::string& line : lines) {
      text += line;
    }
  }

  void replace_number(std::string& text) {
    static constexpr std::array<const char*, 12> kNumbers{"9223372036854775807",
                                                          "-9223372036854775808",
                                                          "18446744073709551616",
                                                          "1e308",
                                                          "-1e308",
                                                          "1e-320",
                                                          "nan",
                                                          "-inf",
                                                          "0",
                                                          "-32768",
                                                          "99999999999999999999999999",
                                                          "1e999"};
    const std::size_t at = text.find_first_of("0123456789", below(text.size()));
    if (at != std::string::npos) {
      const std::size_t end = std::min(text.find_first_not_of("0123456789.", at), text.size());
      text.replace(at, end - at, kNumbers[below(kNumbers.size())]);
    }
  }

  std::mt19937_64 random_;
};

TEST(ReaderMutations, EveryReaderReadsItsOwnSeeds) {
  FuzzFolder folder(fs::path(::testing::TempDir()) / ("gazetrace-seeds." + std::to_string(getpid())));
  const std::vector<Seed> all = seeds();
  for (const std::string& reader : fuzz_readers()) {
    bool read = reader.ends_with("-any");
    for (const Seed& seed : all) {
      // The length chooses the options, 2 x 3 x 5 x 7 of them: line ends at the end change nothing.
      for (std::size_t more = 0; more < 210 && seed.reader == reader && !read; ++more) {
        read = fuzz_reader(reader, seed.text + std::string(more, '\n'), folder);
      }
    }
    EXPECT_TRUE(read) << reader << " has no seed that it reads";
  }
}

TEST(ReaderMutations, DamagedFilesAreReadOrRefused) {
  FuzzFolder folder(fs::path(::testing::TempDir()) / ("gazetrace-mutations." + std::to_string(getpid())));
  Mutator mutate(20);
  std::size_t read = 0;
  std::size_t refused = 0;
  for (const Seed& seed : seeds()) {
    const std::string any = seed.reader.substr(0, seed.reader.find('-')) + "-any";
    for (int i = 0; i < 24; ++i) {
      const std::string text = mutate(seed.text);
      ++(fuzz_reader(i % 4 == 3 ? any : seed.reader, text, folder) ? read : refused);
    }
  }
  // Both happen often, or the mutations would be too wild or too tame to test anything.
  EXPECT_GT(read, (read + refused) / 20);
  EXPECT_GT(refused, (read + refused) / 20);
}

TEST(ReaderMutations, EveryReaderMeetsTheFilesOfAllOthers) {
  FuzzFolder folder(fs::path(::testing::TempDir()) / ("gazetrace-strangers." + std::to_string(getpid())));
  const std::vector<Seed> all = seeds();
  for (const std::string& reader : fuzz_readers()) {
    for (const Seed& seed : all) {
      fuzz_reader(reader, std::string_view(seed.text).substr(0, 2000), folder);
    }
  }
}

}  // namespace
}  // namespace gazetrace::reader_mutations_test
