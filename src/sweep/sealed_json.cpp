// SPDX-License-Identifier: Apache-2.0
#include "sweep/sealed_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "core/file_digest.hpp"
#include "core/file_lock.hpp"
#include "core/json_whole.hpp"
#include "core/parallel.hpp"
#include "core/text.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSeal = "seal";
constexpr const char* kFiles = "files";

// Numbers are written with as many digits as tell them apart, so that what is read back has the same text.
std::string seal_of(const Json& content) {
  const std::string text = content.dump();
  return digest_bytes(std::as_bytes(std::span(text)));
}

// Pictures that are not as they were written are removed, so that no record may name a file outside of the folder.
bool is_of_the_sweep(const std::string& name) {
  return (name.starts_with("frames/") || name.starts_with("references/")) &&
         fs::path(name).lexically_normal().string() == name;
}

bool is_as_written(const std::string& path, const WrittenFile& file) {
  std::error_code failed;
  if (!fs::is_regular_file(path, failed) || fs::file_size(path, failed) != file.bytes || failed) {
    return false;
  }
  try {
    return digest_file(path) == file.digest;
  } catch (const Error&) {
    return false;
  }
}

// Why a record does not count, and the pictures that it names and that are not as they were written.
struct Damage {
  std::string problem;  // empty: none
  std::vector<std::string> pictures;
};

Damage damage_of(const std::string& directory, const std::string& record, bool trust_files) {
  const std::optional<WrittenFiles> files = files_of_record(record);
  if (!files) {
    return {"is damaged", {}};
  }
  Damage damage;
  for (const auto& [name, file] : trust_files ? WrittenFiles() : *files) {
    if (!is_as_written((fs::path(directory) / name).string(), file)) {
      damage.pictures.push_back(name);
    }
  }
  if (!damage.pictures.empty()) {
    damage.problem =
        fmt::format("names '{}', which is missing or not as it was written", bounded(damage.pictures.front(), 120));
  }
  return damage;
}

}  // namespace

std::optional<WrittenFiles> files_of_record(const std::string& path) {
  try {
    Json json = Json::parse(read_text_file(path));
    const std::string seal = json.at(kSeal);
    json.erase(kSeal);
    if (seal != seal_of(json)) {
      return std::nullopt;
    }
    WrittenFiles files;
    for (const auto& [name, file] : json.at(kFiles).items()) {
      if (!is_of_the_sweep(name)) {
        return std::nullopt;
      }
      files[name] = {0, json_whole<std::uint64_t>(file.at("bytes"), path), file.at("digest")};
    }
    return files;
  } catch (const Json::exception&) {
    return std::nullopt;
  } catch (const Error&) {  // it went away, or cannot be read
    return std::nullopt;
  }
}

// Other tasks make and remove folders meanwhile: none of that is an error here.
std::vector<std::string> sealed_records(const std::string& directory) {
  std::set<std::string> paths;
  for (const char* name : {"runs", "references"}) {
    std::error_code failed;
    fs::recursive_directory_iterator at(fs::path(directory) / name, failed);
    while (!failed && at != fs::recursive_directory_iterator()) {
      const std::string entry = at->path().filename().string();
      std::error_code gone;
      if (entry.starts_with("scrambling-") || entry == "locks") {
        at.disable_recursion_pending();
      } else if (at->path().extension() == ".json" && at->is_regular_file(gone)) {
        paths.insert(at->path().string());
      }
      at.increment(failed);
    }
  }
  return {paths.begin(), paths.end()};
}

void save_sealed(const std::string& path, const std::string& object, const WrittenFiles& files) {
  Json content = Json::parse(object);
  Json& list = content[kFiles] = Json::object();
  for (const auto& [name, file] : files) {
    list[name] = {{"bytes", file.bytes}, {"digest", file.digest}};
  }
  content[kSeal] = seal_of(content);
  fs::create_directories(fs::path(path).parent_path());
  write_text_atomically(path, content.dump(1) + "\n");
}

void drop_damaged(const std::string& directory, bool trust_files, int threads, const SweepObserver& observer) {
  const std::vector<std::string> records = sealed_records(directory);
  std::vector<char> is_bad(records.size());
  parallel_for(records.size(), threads, [&](std::size_t i) {
    is_bad[i] = damage_of(directory, records[i], trust_files).problem.empty() ? 0 : 1;
  });
  if (std::find(is_bad.begin(), is_bad.end(), 1) == is_bad.end()) {
    return;
  }
  // Another task may have removed a record meanwhile, and measured again what it held. So each is looked at once more,
  // now that no other task removes anything.
  const FileLock alone(directory + "/lock.check", FileLock::Kind::alone, true);
  for (std::size_t i = 0; i < records.size(); ++i) {
    std::error_code ignored;
    if (is_bad[i] == 0 || !fs::exists(records[i], ignored)) {
      continue;
    }
    const Damage damage = damage_of(directory, records[i], trust_files);
    for (const std::string& name : damage.pictures) {
      fs::remove(fs::path(directory) / name, ignored);
    }
    if (!damage.problem.empty()) {
      fs::remove(records[i], ignored);
      if (observer.warn) {
        observer.warn(fmt::format("{}: {}; it does not count as finished", records[i], damage.problem));
      }
    }
  }
}

}  // namespace gazetrace
