// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include "core/text.hpp"
#include "gazelog/bids_sidecars.hpp"
#include "gazetrace/gaze_write.hpp"

namespace gazetrace {
namespace {

bool is_table(const BidsName& name) {
  return name.extension == ".tsv" || name.extension == ".tsv.gz";
}

// Decided by the recording's own sidecar, not by one that it inherits.
bool is_own(const std::string& path) {
  const BidsName name = parse_bids_name(path);
  const std::string sidecar = path.substr(0, path.size() - name.extension.size()) + ".json";
  std::error_code code;
  return std::filesystem::exists(sidecar, code) &&
         JsonLeaves(read_text_file(sidecar), sidecar).text(kBidsWriterKey) == kBidsWriter;
}

}  // namespace

std::vector<BidsLeftover> bids_leftovers(const std::vector<std::string>& written) {
  std::vector<BidsLeftover> leftovers;
  if (written.empty()) {
    return leftovers;
  }
  const std::vector<std::string> present = files_of_bids_name(parse_bids_name(written.front()));
  std::vector<std::vector<std::string>> gaze;  // entities of the recordings that are read or will be
  for (const std::vector<std::string>* const paths : {&written, &present}) {
    for (const std::string& path : *paths) {
      const BidsName name = parse_bids_name(path);
      if (name.suffix == "physio" && is_table(name) &&
          (paths == &written || recorded_signal(Sidecars(name, name.suffix)) != BidsSignal::other)) {
        gaze.push_back(name.entities);
      }
    }
  }
  const auto is_written = [&](const std::string& path) {
    const auto name = std::filesystem::path(path).filename();
    return std::any_of(written.begin(), written.end(),
                       [&](const std::string& w) { return std::filesystem::path(w).filename() == name; });
  };
  for (const std::string& path : present) {
    const BidsName name = parse_bids_name(path);
    const bool is_of_gaze = (name.suffix == "physio" || name.suffix == "physioevents") &&
                            std::find(gaze.begin(), gaze.end(), name.entities) != gaze.end();
    const bool is_screen = name.suffix == "events" && name.extension == ".json";
    const bool is_data = is_table(name) || name.extension == ".json";
    if (is_data && (is_of_gaze || is_screen) && !is_written(path)) {
      const bool own = is_own(path);
      if (own || is_of_gaze) {
        leftovers.push_back({path, own});
      }
    }
  }
  return leftovers;
}

}  // namespace gazetrace
