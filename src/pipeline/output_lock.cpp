// SPDX-License-Identifier: Apache-2.0
// Which folders' locks stand for the files of a run.
#include "gazetrace/output_lock.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "pipeline/folder_lock.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

struct File {
  fs::path path;            // without links
  fs::path folder;          // where it is claimed, without links
  std::string name, place;  // as both are spelled
};

std::vector<File> without_links(const FilesByFolder& files) {
  std::vector<File> all;
  std::map<std::string, fs::path> known;
  for (const auto& [place, names] : files) {
    const fs::path base = fs::canonical(place);
    for (const std::string& name : names) {
      const fs::path parent = fs::path(name).parent_path();
      const auto folder = known.try_emplace(parent.string());
      if (folder.second) {
        folder.first->second = fs::weakly_canonical(parent.empty() ? "." : parent);
      }
      const fs::path& own = folder.first->second;
      const bool is_below = std::mismatch(base.begin(), base.end(), own.begin(), own.end()).first == base.end();
      all.push_back({own / fs::path(name).filename(), is_below ? base : own, name, is_below ? place : own.string()});
    }
  }
  return all;
}

// Of one folder.
struct Claim {
  std::string place;  // the folder as it is spelled
  FolderLock::Files files;
};
using Claims = std::map<fs::path, Claim>;  // by the folders, without links

void add_file(Claims& claims, const fs::path& folder, const std::string& place, const File& file) {
  Claim& claim = claims.try_emplace(folder, Claim{place, {}}).first->second;
  claim.files.emplace(lock_position(file.path.lexically_relative(folder).string()), file.name);
}

std::vector<fs::path> locked_folders_above(const fs::path& file) {
  std::vector<fs::path> folders;
  std::error_code ignored;
  for (fs::path at = file; at != at.parent_path();) {
    at = at.parent_path();
    if (fs::exists(lock_path(at.string()), ignored)) {
      folders.push_back(at);
    }
  }
  return folders;
}

// The same file may be claimed in a folder above it, where a pattern has the frame's number in a folder's name, or in
// its own. So who has claimed files looks into all other folders on the way to them: of two that come at once, one at
// least sees the other.
Claims claims_of_others(const std::vector<File>& files) {
  Claims claims;
  std::map<fs::path, std::vector<fs::path>> known;
  for (const File& file : files) {
    const auto above = known.try_emplace(file.path.parent_path());
    if (above.second) {
      above.first->second = locked_folders_above(file.path);
    }
    for (const fs::path& folder : above.first->second) {
      if (folder != file.folder) {
        add_file(claims, folder, folder.string(), file);
      }
    }
  }
  return claims;
}

}  // namespace

OutputLock::OutputLock() = default;
OutputLock::~OutputLock() = default;
OutputLock::OutputLock(OutputLock&& other) noexcept = default;
OutputLock& OutputLock::operator=(OutputLock&& other) noexcept = default;

OutputLock lock_files(const FilesByFolder& files) {
  OutputLock lock;
  const std::vector<File> all = without_links(files);
  Claims claims;
  for (const File& file : all) {
    add_file(claims, file.folder, file.place, file);
  }
  for (const auto& [folder, claim] : claims) {
    lock.folders_.push_back(std::make_unique<FolderLock>(claim.place, FolderLock::Use::claim));
    if (!lock.folders_.back()->claim(claim.files)) {
      lock.warnings_.push_back(claim.place +
                               ": no files can be locked in this file system, so that two runs that write the "
                               "same ones here would not notice each other");
    }
  }
  for (const auto& [folder, claim] : claims_of_others(all)) {
    FolderLock(claim.place, FolderLock::Use::look).check(claim.files);
  }
  return lock;
}

OutputLock lock_outputs(const PipelineSettings& settings, const std::vector<std::int32_t>& frames) {
  FilesByFolder claims;
  const OutputSettings& output = settings.output;
  const std::vector<std::string> files = output_files(settings, frames);
  for (std::size_t i = 0; i < std::min<std::size_t>(files.size(), 2); ++i) {
    claims[folder_of_run(output.run_name)].push_back(files[i]);
  }
  for (const std::string& pattern : {output.exr.pattern, output.display.pattern, output.map_pattern}) {
    for (std::size_t i = 0; !pattern.empty() && i < frames.size(); ++i) {
      claims[folder_of_frames(pattern)].push_back(frame_file_name(pattern, frames[i]));
    }
  }
  return lock_files(claims);
}

std::optional<bool> is_locked(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return FolderLock(folder.empty() ? "." : folder.string(), FolderLock::Use::look)
      .holds(fs::path(path).filename().string());
}

}  // namespace gazetrace
