// SPDX-License-Identifier: Apache-2.0
// Reads what the runs over parts left in a directory.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "core/list_folder.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

// A file of a part, "NAME.timing.1-3.csv" or, in a folder of an earlier version, "timing.1-3.csv".
struct PartName {
  std::string run;   // "NAME", or nothing
  std::string part;  // "1-3"
};

std::optional<PartName> part_name(const std::string& file, const std::string& stem, const std::string& suffix) {
  const std::size_t at = file.rfind(stem);
  const std::size_t part = at + stem.size();
  if (at == std::string::npos || (at > 0 && file[at - 1] != '.') || !file.ends_with(suffix) ||
      file.size() <= part + suffix.size()) {
    return std::nullopt;
  }
  return PartName{file.substr(0, at > 0 ? at - 1 : 0), file.substr(part, file.size() - part - suffix.size())};
}

std::optional<PartName> part_of_record(const std::string& file) {
  return part_name(file, "run.", ".json");
}

std::optional<PartName> part_of_timing(const std::string& file) {
  return part_name(file, "timing.", ".csv");
}

RunPart read_part(const std::filesystem::path& timing, const PartName& name) {
  RunPart part;
  part.run_name = (timing.parent_path() / name.run).string();
  part.timing_path = timing.string();
  const std::string record_path = run_record_file_name(part.run_name, name.part, true);
  std::error_code ignored;
  if (!std::filesystem::exists(record_path, ignored)) {
    throw Error(ErrorKind::input, part.timing_path, "its run record " + record_path + " is missing",
                "finish or remove this part");
  }
  part.record_path = record_path;
  part.record = read_run_record(record_path);
  for (const auto& [listed, file] : read_file_journal(file_journal_name(record_path))) {
    part.record.files.insert_or_assign(listed, file);
  }
  for (TimingRow& row : read_timing_csv(part.timing_path)) {
    part.rows.insert_or_assign(row.frame, std::move(row));  // a resumed run may have written a frame twice
  }
  return part;
}

void check_same_settings(const std::vector<RunPart>& parts) {
  const RunPart& first = parts.front();
  for (const RunPart& part : parts) {
    if (part.record.settings_digest != first.record.settings_digest &&
        part.record.denoiser.empty() != first.record.denoiser.empty()) {
      const bool first_has = part.record.denoiser.empty();
      throw Error(ErrorKind::input, part.timing_path,
                  fmt::format("was rendered {} Open Image Denoise, and {} {} it", first_has ? "without" : "by",
                              first.timing_path, first_has ? "by" : "without"),
                  "render them all where it is found, or with another `filter`");
    }
    if (part.record.settings_digest != first.record.settings_digest) {
      throw Error(ErrorKind::input, part.timing_path, "was rendered with other settings than " + first.timing_path,
                  "keep parts of one job in a folder");
    }
    for (const auto& [path, digest] : part.record.input_digests) {
      const auto other = first.record.input_digests.find(path);
      if (other != first.record.input_digests.end() && other->second != digest) {
        throw Error(ErrorKind::input, part.timing_path,
                    "was rendered from another version of " + path + " than " + first.timing_path,
                    "render the older part again");
      }
    }
  }
}

void check_one_sequence(const std::vector<RunPart>& parts) {
  for (const RunPart& part : parts) {
    if (part.run_name != parts.front().run_name) {
      throw Error(ErrorKind::input, part.timing_path, "is of another sequence than " + parts.front().timing_path,
                  "name the pictures of one of them, as out/frame.####.exr");
    }
  }
}

}  // namespace

std::vector<RunPart> read_run_parts(const std::string& where) {
  const bool is_folder = std::filesystem::is_directory(where);
  const std::string wanted = is_folder ? std::string() : run_name_of(where);
  const std::string directory = is_folder ? where : folder_of_run(wanted);
  const auto is_wanted = [&](const PartName& name) {
    return is_folder || (std::filesystem::path(directory) / name.run).string() == wanted;
  };
  std::vector<RunPart> parts, without_rows;
  for (const std::filesystem::path& path : list_folder(directory)) {
    const std::string file = path.filename().string();
    if (const auto timing = part_of_timing(file); timing && is_wanted(*timing)) {
      parts.push_back(read_part(path, *timing));
    } else if (const auto record = part_of_record(file); record && is_wanted(*record)) {
      // The record of a part that was ended before its table began is all that tells of its frames.
      RunPart part;
      part.run_name = (path.parent_path() / record->run).string();
      part.timing_path = timing_file_name(part.run_name, record->part, true);
      std::error_code ignored;
      if (!std::filesystem::exists(part.timing_path, ignored)) {
        part.record_path = path.string();
        part.record = read_run_record(part.record_path);
        without_rows.push_back(std::move(part));
      }
    }
  }
  if (parts.empty()) {
    throw Error(ErrorKind::input, where, "contains no parts of a run (NAME.timing.<part>.csv)",
                "give the folder that chunks (`chunk` K/N) were rendered into, or the name of their pictures");
  }
  std::move(without_rows.begin(), without_rows.end(), std::back_inserter(parts));
  check_one_sequence(parts);
  check_same_settings(parts);
  return parts;
}

}  // namespace gazetrace
