// SPDX-License-Identifier: Apache-2.0
// Logs that are cut off and logs with flipped bits: a reader either reads them or answers with one line of text, for
// every format, by name and by sniffing. What it must not do is crash, hang, or fill the memory; the sanitizers watch.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "gazetrace/gaze.hpp"
#include "support/text_file.hpp"

namespace gazetrace::gaze_damage_test {
namespace {

void expect_answer(const std::string& path, const std::string& format, GazeFrame frame) {
  GazeReadOptions options;
  options.format = format;
  options.frame = frame;
  options.unordered = UnorderedPolicy::sort;
  options.guess_display = true;
  try {
    const GazeLog log = load_gaze_log(path, options);
    for (std::size_t i = 0; i < log.samples.size(); ++i) {
      const GazeSample& s = log.samples[i];
      ASSERT_TRUE(i == 0 || log.samples[i - 1].t_ns < s.t_ns) << path;
      // What is called usable can be used.
      const bool known =
          log.kind == GazeKind::direction ? is_finite(s.direction) : std::isfinite(s.u) && std::isfinite(s.v);
      ASSERT_TRUE(known || !is_usable(s.validity)) << path << " row " << s.row << " of " << log.format;
    }
    ASSERT_TRUE(log.eyes.empty() || log.eyes.size() == log.samples.size());
    ASSERT_TRUE(log.origins.empty() || log.origins.size() == log.samples.size());
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
  }
}

struct Seed {
  std::string name, file, format;
};

// Beginnings of the real recordings, and small files of the formats that have none.
std::vector<Seed> seeds() {
  return {
      {"bino1000_blinks.asc", "eyelink-asc/bino1000_blinks.asc", "eyelink-asc"},
      {"data.tsv", "tobii-studio-tsv/data.tsv", "tobii-studio"},
      {"excerpt.tsv", "tobii-pro-lab-tsv/mobile_mapped_excerpt.tsv", "tobii-pro-lab"},
      {"livedata.json.gz", "tobii-glasses2/livedata.json.gz", "tobii-glasses-2"},
      {"gazedata.gz", "tobii-glasses3/gazedata.gz", "tobii-glasses-3"},
      {"gaze_positions.csv", "pupil-core/gaze_positions_with_monocular.csv", "pupil-core"},
      {"gaze.csv", "pupil-invisible-cloud/gaze.csv", "pupil-cloud"},
      {"samples.txt", "smi-iview-txt/recording1_Samples.txt", "smi"},
      {"gaze.arff", "arff/gaze.arff", "arff"},
      {"vive.csv", "vive-pro-eye/TESTNA01_360VR_Fist3.csv", "vive-sranipal"},
      {"boxing.csv", "pico-neo3-pro/boxing_VR.csv", "pico"},
      {"vr.csv", "gazebase-vr/gazebase_vr_example.csv", "gazebase"},
      {"toy.csv", "plain-csv/gaze-toy-example.csv", "generic"},
  };
}

TEST(GazeDamage, TruncatedAndFlippedRecordings) {
  const TextFiles files;
  std::mt19937_64 random(4);
  std::size_t tried = 0;
  for (const Seed& seed : seeds()) {
    const std::string path = std::string(GAZETRACE_SHARED_DIR) + "/gaze-samples/" + seed.file;
    if (!std::filesystem::exists(path)) {
      continue;
    }
    const bool packed = path.ends_with("gz");
    const std::string whole = read_file(path);
    const std::string start = packed ? whole : whole.substr(0, 12000);
    for (int round = 0; round < (packed ? 12 : 30); ++round) {
      std::string text = start;
      if (round % 2 == 0) {
        text.resize(random() % start.size());
      }
      const int flips = round % 3 == 0 ? 0 : 1 + static_cast<int>(random() % 8);
      for (int i = 0; i < flips && !text.empty(); ++i) {
        text[random() % text.size()] ^= static_cast<char>(1U << (random() % 8));
      }
      const std::string damaged = files.write(seed.name, text);
      for (const GazeFrame frame : {GazeFrame::automatic, GazeFrame::head, GazeFrame::scene_camera}) {
        expect_answer(damaged, seed.format, frame);
        expect_answer(damaged, "", frame);
      }
      ++tried;
    }
  }
  if (tried == 0) {
    GTEST_SKIP() << "the folder of real recordings is not here";
  }
}

TEST(GazeDamage, EveryFormatOnTextOfEveryOther) {
  const TextFiles files;
  const std::vector<std::string> texts = {
      "",
      "\n",
      "{}",
      "{\"ts\":",
      "[1]",
      "XDF:",
      "** CONVERTED FROM\n1 2\nSAMPLES\nSTART\n1\n",
      "@RELATION\n@DATA\n,,,\n",
      "## \nTime\tType\n1\tSMP\n",
      "n,x,y,val\n1,2\n",
      "Recording timestamp\tSensor\tParticipant name\n\t\t\n",
      std::string(1000, '{'),
      std::string(1000, ','),
      std::string(300, '"'),
      std::string("\0\1\2\3", 4),
      "t[ns],u[1],v[1]\n9223372036854775807,1e308,-1e308\n-9223372036854775808,nan,inf\n",
      "XDF:\x08\xFF\xFF\xFF\xFF\xFF\xFF\xFF\x7F\x02\x00",
      "\x1F\x8B\x08\x00\x00\x00\x00\x00\x00\x03",
      "{\"type\":\"gaze\",\"timestamp\":1e400,\"data\":{}}\n",
      "{\"ts\":99999999999999999999,\"gidx\":1,\"gp\":[1]}\n"};
  for (const GazeFormatInfo& format : gaze_formats()) {
    for (const std::string& text : texts) {
      for (const std::string name : {"log.csv", "sub-1_physio.tsv", "gaze ps1.raw"}) {
        const std::string path = files.write(name, text);
        for (const GazeFrame frame : {GazeFrame::automatic, GazeFrame::head, GazeFrame::scene_camera}) {
          expect_answer(path, format.name, frame);
        }
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::gaze_damage_test
