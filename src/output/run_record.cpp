// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/hash.hpp"
#include "core/json_problem.hpp"
#include "core/json_whole.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {

using Json = nlohmann::ordered_json;

namespace {

std::string file_of_run(const std::string& run_name, const std::string& file) {
  return run_name.empty() || run_name.ends_with('/') ? run_name + file : run_name + "." + file;
}

// Common file systems limit names to 255 bytes, so a long list of frames is cut and gets a digest that makes it unique.
std::string part_file_name(const std::string& run_name, const std::string& stem, const std::string& suffix,
                           const std::string& frames, bool is_part) {
  constexpr std::size_t kMaxFrames = 120;
  std::string name = file_of_run(run_name, stem);
  if (is_part) {
    name += '.';
    if (frames.size() > kMaxFrames) {
      Digest digest;
      digest.add(frames);
      name += frames.substr(0, frames.rfind(',', kMaxFrames)) + "-and-more-" + digest.hex().substr(0, 12);
    } else {
      name += frames;
    }
  }
  return name + suffix;
}

}  // namespace

std::string folder_of_run(const std::string& run_name) {
  const std::string folder = std::filesystem::path(run_name).parent_path().string();
  return folder.empty() ? "." : folder;
}

std::string timing_file_name(const std::string& run_name, const std::string& frames, bool is_part) {
  return part_file_name(run_name, "timing", ".csv", frames, is_part);
}

std::string run_record_file_name(const std::string& run_name, const std::string& frames, bool is_part) {
  return part_file_name(run_name, "run", ".json", frames, is_part);
}

std::string run_record_json(const RunRecord& record) {
  Json bad_samples = Json::array();
  for (const BadSample& bad : record.bad_samples) {
    bad_samples.push_back(
        {{"frame", bad.frame}, {"x_px", bad.x_px}, {"y_px", bad.y_px}, {"sample", bad.sample}, {"what", bad.what}});
  }
  Json files = Json::object();
  for (const auto& [name, file] : record.files) {
    files[name] = {{"frame", file.frame}, {"bytes", file.bytes}, {"digest", file.digest}};
  }
  const Json json{{"version", record.version},
                  {"build", record.build},
                  {"instruction_set", record.instruction_set},
                  {"ray_library", record.ray_library},
                  {"denoiser", record.denoiser},
                  {"command_line", record.command_line},
                  {"settings_digest", record.settings_digest},
                  {"part_digests", record.part_digests},
                  {"frames", record.frames},
                  {"is_part", record.is_part},
                  {"chunk_file", record.chunk_file},
                  {"input_digests", record.input_digests},
                  {"facts", record.facts},
                  {"warnings", record.warnings},
                  {"bad_samples", bad_samples},
                  {"files", files},
                  {"config_toml", record.config_toml}};
  // Paths need not be UTF-8; invalid bytes become replacement characters instead of an exception.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

void check_same_denoiser(const RunRecord& first, const std::string& first_path, const RunRecord& other,
                         const std::string& other_path) {
  if (first.denoiser != other.denoiser) {
    throw Error(
        ErrorKind::input, other_path,
        fmt::format("frames were denoised by '{}', those of {} by '{}'", other.denoiser, first_path, first.denoiser),
        "render them all with one library on one kind of processor");
  }
}

RunRecord read_run_record(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw Error(ErrorKind::input, path, "cannot be opened");
  }
  try {
    const Json json = Json::parse(file);
    RunRecord record;
    json.at("version").get_to(record.version);
    json.at("build").get_to(record.build);
    json.at("instruction_set").get_to(record.instruction_set);
    json.at("ray_library").get_to(record.ray_library);
    json.at("command_line").get_to(record.command_line);
    json.at("settings_digest").get_to(record.settings_digest);
    json.at("frames").get_to(record.frames);
    json.at("is_part").get_to(record.is_part);
    // Records of earlier versions have no denoiser, parts and files.
    record.denoiser = json.value("denoiser", "");
    record.chunk_file = json.value("chunk_file", "");
    record.part_digests = json.value("part_digests", record.part_digests);
    json.at("input_digests").get_to(record.input_digests);
    json.at("facts").get_to(record.facts);
    json.at("warnings").get_to(record.warnings);
    json.at("config_toml").get_to(record.config_toml);
    for (const Json& bad : json.at("bad_samples")) {
      record.bad_samples.push_back({json_whole<std::int32_t>(bad.at("frame"), path),
                                    json_whole<int>(bad.at("x_px"), path), json_whole<int>(bad.at("y_px"), path),
                                    json_whole<std::uint32_t>(bad.at("sample"), path), bad.at("what")});
    }
    if (const auto files = json.find("files"); files != json.end()) {
      for (const auto& [name, written] : files->items()) {
        record.files[name] = {json_whole<std::int32_t>(written.at("frame"), path),
                              json_whole<std::uint64_t>(written.at("bytes"), path), written.at("digest")};
      }
    }
    return record;
  } catch (const Json::exception& e) {
    throw Error(ErrorKind::input, path, "is not a run record, or is cut: " + bounded(json_problem(e.what()), 200),
                "remove it, or render with `resume`, which makes it anew");
  }
}

}  // namespace gazetrace
