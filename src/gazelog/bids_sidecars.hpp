// SPDX-License-Identifier: Apache-2.0
// The inheritance of BIDS: the metadata of a file may stand in JSON files with fewer entities in their names, beside it
// or in folders above it. For each key the most specific file wins.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazelog/json.hpp"

namespace gazetrace {

// "sub-01_task-view_recording-eye1_physio.tsv.gz"
struct BidsName {
  std::string folder;
  std::vector<std::string> entities;  // "sub-01", "task-view", "recording-eye1"
  std::string suffix;                 // "physio"
  std::string extension;              // ".tsv.gz"
  [[nodiscard]] bool is_table() const { return extension == ".tsv" || extension == ".tsv.gz"; }
};
BidsName parse_bids_name(const std::string& path);

class Sidecars {
 public:
  // Reads the sidecars of `suffix` that apply to `name`, from its folder upwards to the data set's root. Throws
  // Error(input) for broken JSON, and for links out of the data set unless these are allowed.
  Sidecars(const BidsName& name, std::string_view suffix, bool allow_outside = false);

  [[nodiscard]] std::string text(std::string_view path) const { return value(path, &JsonLeaves::text); }
  [[nodiscard]] std::optional<double> number(std::string_view path) const { return value(path, &JsonLeaves::number); }
  [[nodiscard]] std::vector<double> numbers(std::string_view path) const { return value(path, &JsonLeaves::numbers); }
  [[nodiscard]] std::vector<std::string> texts(std::string_view path) const { return value(path, &JsonLeaves::texts); }
  [[nodiscard]] bool allow_outside() const { return allow_outside_; }
  [[nodiscard]] std::string source(std::string_view path) const;  // the file that states it

 private:
  struct File {
    std::string path;
    JsonLeaves json;
  };
  [[nodiscard]] const File* file_with(std::string_view path) const;
  // Of the most specific file that has the key; empty where none has it.
  template <class Value>
  [[nodiscard]] Value value(std::string_view path, Value (JsonLeaves::*get)(std::string_view) const) const {
    const File* const file = file_with(path);
    return file == nullptr ? Value() : (file->json.*get)(path);
  }
  std::vector<File> files_;  // the most specific first
  bool allow_outside_;
};

// Error(input) where the file `path`, which belongs to a recording, is a link out of the recording's data set.
void check_in_data_set(const std::string& recording, const std::string& path);

// Files in the folder of `name` with the same entities except for `recording`.
std::vector<std::string> files_of_bids_name(const BidsName& name);
// Those of them that are tables with this suffix, without `name` itself.
std::vector<std::string> sibling_recordings(const BidsName& name, std::string_view suffix);

// Other physiological signals are recorded in files with the same kind of name. mislabeled: the file has positions, but
// its PhysioType is not eyetrack.
enum class BidsSignal { gaze, mislabeled, other };
// `x_column` is the column of positions, where it has another name than that of the standard.
BidsSignal recorded_signal(const Sidecars& sidecars, const std::string& x_column = {});

// A key of gazetrace's own, in every JSON file that gazetrace writes.
inline constexpr const char* kBidsWriterKey = "WrittenBy";
inline constexpr const char* kBidsWriter = "gazetrace";

}  // namespace gazetrace
