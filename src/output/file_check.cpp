// SPDX-License-Identifier: Apache-2.0
// Compares what lies in a folder with what the records of the runs say they wrote.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/file_digest.hpp"
#include "core/parallel.hpp"
#include "gazetrace/output.hpp"
#include "output/written_file.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

bool has_stamp(const std::string& path) {
  return !path.ends_with(".sums") && !path.ends_with(".sparse");
}

// Why the content of a file may be another one than was written, as far as its header tells.
std::string what_it_is(const std::string& path, const WrittenFile& file, const std::string& settings_digest) {
  if (!has_stamp(path)) {
    return {};
  }
  const FrameStamp stamp = read_frame_stamp(path);
  if (stamp.frame && *stamp.frame != file.frame) {
    return fmt::format("holds frame {}", *stamp.frame);
  }
  if (!stamp.settings_digest.empty() && stamp.settings_digest != settings_digest) {
    return "was made under other settings or from other files";
  }
  return {};
}

// Empty: it is as it was written.
std::string problem_of(const std::string& path, const WrittenFile& file, const std::string& settings_digest) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status)) {
    return "is missing";
  }
  if (!fs::is_regular_file(status)) {
    return "is not a file";
  }
  const auto size = fs::file_size(path, failed);
  if (failed) {
    return "cannot be read: " + failed.message();
  }
  std::string digest;
  if (size == file.bytes) {
    try {
      digest = digest_file(path);
    } catch (const Error& error) {
      return error.what();
    }
    if (digest == file.digest) {
      return {};
    }
  }
  if (std::string other = what_it_is(path, file, settings_digest); !other.empty()) {
    return other;
  }
  return size == file.bytes ? std::string("has another content than was written")
                            : fmt::format("has {} bytes in place of {}", size, file.bytes);
}

// The names that the same file of another frame may have: with the other number, of as many digits at least, in some or
// all of the places where its own stands, since a name may hold other numbers that are equal.
std::vector<std::string> names_of_frame(const std::string& name, std::int32_t frame, std::int32_t other) {
  constexpr const char* kNumerals = "0123456789";
  constexpr std::size_t kMostNumerals = 9;
  constexpr std::size_t kMostPlaces = 6;
  struct Place {
    std::size_t begin, count;
  };
  std::vector<Place> places;
  for (std::size_t at = name.find_first_of(kNumerals); at != std::string::npos && places.size() < kMostPlaces;) {
    const std::size_t end = std::min(name.find_first_not_of(kNumerals, at), name.size());
    if (end - at <= kMostNumerals && std::stoi(name.substr(at, end - at)) == frame) {
      places.push_back({at, end - at});
    }
    at = name.find_first_of(kNumerals, end);
  }
  std::vector<std::string> names;
  for (unsigned some = 1; some < 1U << places.size(); ++some) {
    std::string changed = name;
    for (std::size_t i = places.size(); i-- > 0;) {  // from behind, since a longer number moves what follows
      if ((some >> i & 1U) != 0) {
        changed.replace(places[i].begin, places[i].count, fmt::format("{:0{}}", other, places[i].count));
      }
    }
    names.push_back(std::move(changed));
  }
  return names;
}

// Parts that were asked for different outputs do not make one sequence. Adds each file that a frame lacks and that the
// frame with the most files has.
void add_frames_without_a_file(const std::vector<RunPart>& parts, std::vector<BadFile>& bad) {
  std::map<std::int32_t, std::set<std::string>> names;
  for (const RunPart& part : parts) {
    for (const auto& [name, file] : part.record.files) {
      names[file.frame].insert(name);
    }
  }
  const auto most = std::max_element(names.begin(), names.end(),
                                     [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  for (const RunPart& part : parts) {
    for (const auto& [frame, row] : part.rows) {
      const auto found = names.find(frame);
      if (found == names.end()) {
        bad.push_back({part.record_path, frame, fmt::format("lists no file of frame {}", frame)});
        continue;
      }
      for (const std::string& name : most->second) {
        const std::vector<std::string> names_here = names_of_frame(name, most->first, frame);
        if (names_here.empty()) {
          continue;  // of one frame alone, without a number
        }
        if (std::none_of(names_here.begin(), names_here.end(),
                         [&](const std::string& one) { return found->second.contains(one); })) {
          bad.push_back(
              {part.record_path, frame,
               fmt::format("lists no '{}', and frame {} has a file like that", names_here.back(), most->first)});
        }
      }
    }
  }
}

}  // namespace

std::vector<BadFile> find_bad_files(const std::string& directory, const WrittenFiles& files,
                                    const std::string& settings_digest, int threads) {
  std::vector<BadFile> checked;
  for (const auto& [name, file] : files) {
    checked.push_back({path_in_record(directory, name), file.frame, {}});
  }
  std::vector<const WrittenFile*> wanted;
  for (const auto& [name, file] : files) {
    wanted.push_back(&file);
  }
  parallel_for(checked.size(), threads,
               [&](std::size_t i) { checked[i].problem = problem_of(checked[i].path, *wanted[i], settings_digest); });
  std::erase_if(checked, [](const BadFile& file) { return file.problem.empty(); });
  std::stable_sort(checked.begin(), checked.end(),
                   [](const BadFile& a, const BadFile& b) { return a.frame < b.frame; });
  return checked;
}

std::vector<BadFile> find_bad_files(const std::vector<RunPart>& parts, int threads) {
  std::vector<BadFile> bad;
  for (const RunPart& part : parts) {
    const std::string folder = fs::path(part.timing_path).parent_path().string();
    const std::vector<BadFile> found = find_bad_files(folder, part.record.files, part.record.settings_digest, threads);
    bad.insert(bad.end(), found.begin(), found.end());
  }
  add_frames_without_a_file(parts, bad);
  std::stable_sort(bad.begin(), bad.end(), [](const BadFile& a, const BadFile& b) { return a.frame < b.frame; });
  return bad;
}

void refuse_bad_files(const std::string& directory, const std::vector<BadFile>& bad) {
  if (bad.empty()) {
    return;
  }
  std::set<std::int32_t> frames;
  for (const BadFile& file : bad) {
    frames.insert(file.frame);
  }
  std::string named;
  constexpr std::size_t kNamed = 4;
  for (std::size_t i = 0; i < std::min(kNamed, bad.size()); ++i) {
    named += fmt::format("{}{}: {}", i == 0 ? "" : ", ", bad[i].path, bad[i].problem);
  }
  if (bad.size() > kNamed) {
    named += fmt::format(", and {} more", bad.size() - kNamed);
  }
  throw Error(ErrorKind::input, directory,
              fmt::format("{} not as recorded, of frames {}: {}",
                          bad.size() == 1 ? "1 file is" : fmt::format("{} files are", bad.size()),
                          format_frame_list({frames.begin(), frames.end()}), named),
              "render their parts again with `resume`, which makes these frames alone, or give `trust-files`");
}

}  // namespace gazetrace
