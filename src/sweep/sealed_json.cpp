// SPDX-License-Identifier: Apache-2.0
#include "sweep/sealed_json.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
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

// Of pictures that are not as they were written some are removed, so that no record may lead out of the folder.
bool is_of_the_sweep(const std::string& name) {
  return (name.starts_with("frames/") || name.starts_with("references/")) &&
         fs::path(name).lexically_normal().string() == name;
}

// Empty where it is damaged.
std::optional<WrittenFiles> read_sealed(const std::string& path) {
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

std::vector<std::string> records_below(const std::string& directory) {
  std::set<std::string> paths;
  for (const char* name : {"runs", "references"}) {
    std::error_code ignored;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(directory) / name, ignored)) {
      const bool is_scrambling = entry.path().parent_path().filename().string().starts_with("scrambling-");
      if (entry.path().extension() == ".json" && !is_scrambling && entry.is_regular_file(ignored)) {
        paths.insert(entry.path().string());
      }
    }
  }
  return {paths.begin(), paths.end()};
}

}  // namespace

void save_sealed(const std::string& path, Json content, const WrittenFiles& files) {
  Json& list = content[kFiles] = Json::object();
  for (const auto& [name, file] : files) {
    list[name] = {{"bytes", file.bytes}, {"digest", file.digest}};
  }
  content[kSeal] = seal_of(content);
  fs::create_directories(fs::path(path).parent_path());
  write_text_atomically(path, content.dump(1) + "\n");
}

void drop_damaged(const std::string& directory, bool trust_files, const SweepObserver& observer) {
  const FileLock alone(directory + "/lock.check", FileLock::Kind::alone, true);
  const std::vector<std::string> records = records_below(directory);
  std::vector<std::optional<WrittenFiles>> contents(records.size());
  parallel_for(records.size(), 0, [&](std::size_t i) { contents[i] = read_sealed(records[i]); });

  // Several records may name the same picture.
  std::map<std::pair<std::string, std::string>, bool> pictures;  // name and digest -> whether it is as it was written
  std::vector<std::pair<std::string, WrittenFile>> to_check;
  for (const auto& files : contents) {
    for (const auto& [name, file] : files && !trust_files ? *files : WrittenFiles()) {
      if (pictures.emplace(std::pair(name, file.digest), true).second) {
        to_check.emplace_back(name, file);
      }
    }
  }
  std::vector<char> good(to_check.size());
  parallel_for(to_check.size(), 0, [&](std::size_t i) {
    good[i] = is_as_written(directory + "/" + to_check[i].first, to_check[i].second) ? 1 : 0;
  });
  for (std::size_t i = 0; i < to_check.size(); ++i) {
    pictures[{to_check[i].first, to_check[i].second.digest}] = good[i] != 0;
  }

  const auto drop = [&](const std::string& path, const std::string& what) {
    std::error_code ignored;
    fs::remove(path, ignored);
    if (observer.warn) {
      observer.warn(fmt::format("{}: {}; what it held is made again", path, what));
    }
  };
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!contents[i]) {
      drop(records[i], "is damaged");
      continue;
    }
    std::string first_bad;
    for (const auto& [name, file] : trust_files ? WrittenFiles() : *contents[i]) {
      if (!pictures.at({name, file.digest})) {
        first_bad = first_bad.empty() ? name : first_bad;
        std::error_code ignored;
        fs::remove(fs::path(directory) / name, ignored);
      }
    }
    if (!first_bad.empty()) {
      drop(records[i], fmt::format("names '{}', which is missing or not as it was written", bounded(first_bad, 120)));
    }
  }
}

}  // namespace gazetrace
