// SPDX-License-Identifier: Apache-2.0
#include "gazelog/bids_sidecars.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/data_root.hpp"
#include "core/list_folder.hpp"
#include "core/text.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLevels = 6;

bool contains_all(const std::vector<std::string>& all, const std::vector<std::string>& some) {
  return std::all_of(some.begin(), some.end(),
                     [&](const std::string& entity) { return std::find(all.begin(), all.end(), entity) != all.end(); });
}

std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> files;
  std::error_code code;
  for (const fs::path& path : list_folder(folder, code)) {
    files.push_back(path.string());
  }
  return files;
}

}  // namespace

BidsName parse_bids_name(const std::string& path) {
  BidsName name;
  const fs::path at(path);
  name.folder = at.parent_path().string();
  std::string stem = at.filename().string();
  const std::size_t dot = stem.find('.');
  if (dot != std::string::npos) {
    name.extension = stem.substr(dot);
    stem.resize(dot);
  }
  std::vector<std::string_view> parts;
  split_cells(stem, '_', parts);
  for (const std::string_view part : parts) {
    if (part.find('-') != std::string_view::npos) {
      name.entities.emplace_back(part);
    } else {
      name.suffix = part;
    }
  }
  return name;
}

void check_in_data_set(const std::string& recording, const std::string& path) {
  std::error_code code;
  std::vector<fs::path> roots = data_roots(recording);
  roots.push_back(fs::weakly_canonical(fs::absolute(recording).parent_path(), code));
  check_within(roots, path, fs::path(path).filename().string(), path,
               "put the file itself there, or give `allow-outside` where you trust the data");
}

Sidecars::Sidecars(const BidsName& name, std::string_view suffix, bool allow_outside) : allow_outside_(allow_outside) {
  std::error_code code;
  fs::path folder = fs::absolute(name.folder.empty() ? "." : name.folder, code);
  for (int level = 0; level < kMostLevels; ++level) {
    std::vector<std::pair<std::size_t, std::string>> found;
    for (const std::string& path : files_in(folder)) {
      const BidsName other = parse_bids_name(path);
      if (other.suffix == suffix && other.extension == ".json" && contains_all(name.entities, other.entities)) {
        found.emplace_back(other.entities.size(), path);
      }
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (const auto& [entities, path] : found) {
      if (!allow_outside) {
        check_in_data_set((folder / "any").string(), path);
      }
      files_.push_back({path, JsonLeaves(read_text_file(path), path)});
    }
    if (fs::exists(folder / "dataset_description.json", code) || folder == folder.root_path()) {
      return;
    }
    folder = folder.parent_path();
  }
}

const Sidecars::File* Sidecars::file_with(std::string_view path) const {
  for (const File& file : files_) {
    if (file.json.has(path)) {
      return &file;
    }
  }
  return nullptr;
}

std::string Sidecars::source(std::string_view path) const {
  const File* const file = file_with(path);
  return file == nullptr ? "" : fs::path(file->path).filename().string();
}

std::vector<std::string> files_of_bids_name(const BidsName& name) {
  const auto without_recording = [](std::vector<std::string> entities) {
    std::erase_if(entities, [](const std::string& entity) { return entity.starts_with("recording-"); });
    return entities;
  };
  std::vector<std::string> files = files_in(name.folder.empty() ? "." : name.folder);
  std::erase_if(files, [&](const std::string& path) {
    return without_recording(parse_bids_name(path).entities) != without_recording(name.entities);
  });
  return files;
}

std::vector<std::string> sibling_recordings(const BidsName& name, std::string_view suffix) {
  std::vector<std::string> siblings = files_of_bids_name(name);
  std::erase_if(siblings, [&](const std::string& path) {
    const BidsName other = parse_bids_name(path);
    return other.suffix != suffix || !other.is_table() || other.entities == name.entities;
  });
  return siblings;
}

BidsSignal recorded_signal(const Sidecars& sidecars, const std::string& x_column) {
  const std::vector<std::string> columns = sidecars.texts("Columns");
  const bool has_positions = std::any_of(columns.begin(), columns.end(), [&](const std::string& column) {
    return column == "x_coordinate" || column == "eye1_x_coordinate" || column == "eye2_x_coordinate" ||
           (!x_column.empty() && column == x_column);
  });
  const std::string type = to_lower(trim(sidecars.text("PhysioType")));
  if (!type.empty() && type != "eyetrack") {
    return has_positions ? BidsSignal::mislabeled : BidsSignal::other;
  }
  return columns.empty() || has_positions ? BidsSignal::gaze : BidsSignal::other;  // unnamed columns may be anything
}

}  // namespace gazetrace
