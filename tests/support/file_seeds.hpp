// SPDX-License-Identifier: Apache-2.0
// Small valid files for every target of file_fuzz.hpp, written by the same code that writes them for users, so that
// they stay valid when formats change.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "farm/engine.hpp"
#include "support/file_fuzz.hpp"
#include "support/scene_seeds.hpp"
#include "support/text_file.hpp"

namespace gazetrace {

struct FileSeed {
  std::string target, name, bytes;
};

namespace seeds {

inline FrameHeader header() {
  FrameHeader header;
  header.frame = 1;
  header.settings_digest = fuzz::kDigest;
  header.software = "gazetrace";
  header.gaze_processing = {"offset 1 2"};
  return header;
}

inline RunRecord record() {
  RunRecord record;
  record.version = "0.1.0";
  record.build = "gcc";
  record.command_line = {"gazetrace", "render"};
  record.config_toml = job_as_toml(Job{});
  record.settings_digest = fuzz::kDigest;
  record.input_digests = {{"scene.gltf", fuzz::kDigest}};
  record.frames = "1-2";
  record.is_part = true;
  record.facts = {{"load_s", "0.5"}};
  record.warnings = {"a warning"};
  record.bad_samples = {{1, 2, 3, 4, "rejected ray"}};
  record.files = {{"f.0001.exr", {1, 10, fuzz::kDigest}}, {"timing.1-2.csv", {2, 20, fuzz::kDigest}}};
  return record;
}

inline std::string timing() {
  TimingRow row;
  row.frame = 1;
  TimingRow next;
  next.frame = 2;
  next.gaze_state = "ok";
  return timing_csv_text({row, next});
}

inline FarmPlan farm(const std::string& engine) {
  FarmPlan plan;
  plan.name = "night";
  plan.engine = engine;
  plan.program = "/usr/bin/gazetrace";
  plan.job_file = "/data/job.toml";
  plan.folder = "/data/out/farm";
  plan.run_folder = "/data/out";
  plan.work_folder = "/data";
  plan.chunks = {"1-10", "11-20"};
  plan.samples = {100, 200};
  plan.time_s = 60;
  plan.memory_mib = 512;
  plan.then = {"report out"};
  return plan;
}

inline void add_pictures(std::vector<FileSeed>& files, const std::string& folder) {
  const std::vector<std::uint8_t> rgb(8 * 6 * 3, 100);
  EncodeOptions options;
  options.note = "frame 1";
  options.software = "gazetrace";
  for (const char* suffix : {"png", "jpg"}) {
    const auto bytes = encode_image(std::string("f.") + suffix, 8, 6, 8, rgb, options);
    files.push_back({std::string("picture-") + suffix, "coded", std::string(bytes.begin(), bytes.end())});
  }
  using test::PngColor;
  for (const auto& [name, color, bits, samples] :
       std::vector<std::tuple<const char*, PngColor, int, std::vector<std::uint16_t>>>{
           {"gray", PngColor::gray, 8, {1, 2, 3, 4}},
           {"gray-alpha", PngColor::gray_alpha, 16, {1, 65535, 3, 4, 5, 6, 7, 8}},
           {"rgba", PngColor::rgba, 8, std::vector<std::uint16_t>(16, 77)}}) {
    const auto bytes = test::png_bytes(2, 2, color, bits, samples);
    files.push_back({"picture-png", name, std::string(bytes.begin(), bytes.end())});
  }
  Frame frame;
  frame.radiance = ImageRgb(8, 6, {0.5F, 1, 2});
  frame.sample_count = frame.variance = frame.depth_m = ImageGray(8, 6, 3);
  frame.albedo = frame.normal = ImageRgb(8, 6, {0, 1, 0});
  for (const char* compression : {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
    ExrSettings exr;
    exr.compression = compression;
    exr.pixels = compression[0] == 'z' ? ExrPixels::float32 : ExrPixels::half;
    if (compression[0] == 'p') {
      exr.aovs = {"albedo", "normal", "depth", "samples", "variance"};
    }
    const std::string path = folder + "/seed.exr";
    write_frame_exr(path, frame, nullptr, header(), exr, 1);
    files.push_back({"picture-exr", compression, gazetrace::read_file(path)});
  }
  // Two scanlines of run lengths and one of plain pixels, as Ward's format has them.
  std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1.5\n\n-Y 2 +X 8\n";
  for (int row = 0; row < 2; ++row) {
    hdr += std::string("\2\2\0\10", 4);
    for (int channel = 0; channel < 4; ++channel) {
      hdr += std::string("\x84\x60\4\1\2\3\4", 7);
    }
  }
  files.push_back({"picture-hdr", "runs", hdr});
  files.push_back(
      {"picture-hdr", "plain", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + std::string(8, '\x80')});
}

}  // namespace seeds

// `folder` is for files that are written and read back at once.
inline std::vector<FileSeed> file_seeds(const std::string& folder) {
  std::vector<FileSeed> files;
  for (const auto& [name, bytes] : test::scene_seeds()) {
    files.push_back({"scene", name, bytes});
    files.push_back({"scene-render", name, bytes});
  }
  seeds::add_pictures(files, folder);
  files.push_back({"job", "defaults", job_as_toml(Job{})});
  files.push_back({"job", "some",
                   "scene = \"a.gltf\"\nsize = \"64x36\"\nframes = \"1-3,7\"\nspp = 4\noutput = \"o.####.exr\"\n"
                   "density = \"mar\"\ngaze-process = [\"median\"]\nfps = 23.976\n"});
  files.push_back({"sweep-plan", "small", R"(title = "t"
[common]
screen = "paper"
size = "64x36"
spp = 16
[[scene]]
name = "s"
path = "a.gltf"
environment = "sky.hdr"
camera = "still"
[[gaze]]
name = "center"
at = [0.5, 0.5]
[[gaze]]
name = "log"
gaze = "g.csv"
[[setting]]
label = "x"
density = "mar"
[grid]
spp = [1, 2]
filter = ["linear", "guided"]
[reference]
spp = 64
scramblings = 4
[measure]
metrics = ["flip"]
)"});
  const std::string record = run_record_json(seeds::record());
  files.push_back({"run-record", "part", record});
  files.push_back({"timing", "two", seeds::timing()});
  files.push_back({"parts", "one", seeds::timing() + "\n%%FILE run.1-2.json\n" + record});
  for (const char* engine : {"slurm", "openjd", "local"}) {
    files.push_back({"farm", engine, farm_plan_json(seeds::farm(engine))});
  }
  files.push_back({"chunks", "two", chunk_file_text({fuzz::kDigest, "1-20", {"1-10", "11-20"}, {100, 200}})});
  files.push_back({"results", "empty", results_json(Results{})});
  files.push_back({"display", "desk",
                   R"({"width_px": 1920, "height_px": 1080, "width_cm": 51, "height_cm": 29, "distance_cm": 65})"});
  files.push_back(
      {"aois", "all",
       "[[aoi]]\nname = \"a\"\nrectangle = [0.1, 0.1, 0.4, 0.5]\n[[aoi]]\nname = \"b\"\nellipse = [0.5, 0.5, 0.1, "
       "0.1]\n"
       "[[aoi]]\nname = \"c\"\npolygon = [[0, 0], [0.1, 0], [0, 0.2]]\n[[aoi]]\nname = \"d\"\nnode = \"vase*\"\n"});
  files.push_back({"density-curve", "three", "ecc_deg,density\n0,1\n10,0.5\n40,0.01\n"});
  return files;
}

}  // namespace gazetrace
