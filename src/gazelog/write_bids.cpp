// SPDX-License-Identifier: Apache-2.0
// BIDS 1.11 eye tracking: ..._recording-<eye>_physio.tsv.gz without a header line, its sidecar, ..._physioevents.tsv.gz
// for the events of that eye, ..._events.tsv for what happened in the run, and ..._events.json with the screen.
//
// x and y are pixels, or degrees of azimuth and elevation for gaze in the head, as other programs expect them. Where
// these do not give back every bit of what was read, columns of gazetrace's own follow that do. Other such columns hold
// validity, confidence and the eye's position in the head, for which the standard has no names.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <span>

#include "core/atomic_file.hpp"
#include "core/text.hpp"
#include "gazelog/bids_parts.hpp"
#include "gazelog/bids_sidecars.hpp"
#include "gazelog/log_file.hpp"
#include "gazetrace/gaze_read.hpp"
#include "gazetrace/gaze_write.hpp"

namespace gazetrace {
namespace {

using Json = BidsJson;

// What the standard recommends for every sidecar of a task.
Json with_task(Json json, const BidsName& name) {
  for (const std::string& entity : name.entities) {
    if (entity.starts_with("task-") && entity.size() > 5) {
      json["TaskName"] = entity.substr(5);
      break;
    }
  }
  return json;
}

std::string label_of(Eye eye) {
  return eye == Eye::left ? "eye1" : eye == Eye::right ? "eye2" : "cyclopean";
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

struct File {
  std::string path, bytes;
};

std::string path_of(const BidsName& name, const std::string& recording, const std::string& ending) {
  std::string file;
  for (const std::string& entity : name.entities) {
    file += entity.starts_with("recording-") ? "" : entity + "_";
  }
  file += recording.empty() ? "" : "recording-" + recording + "_";
  return (std::filesystem::path(name.folder) / (file + ending)).string();
}

std::vector<File> files_of(const GazeLog& log, const std::string& path) {
  const BidsName name = parse_bids_name(path);
  if (!is_bids_file_name(path)) {
    throw Error(ErrorKind::usage, path, "is no name of a BIDS recording",
                "give one such as sub-01_task-view_physio.tsv.gz");
  }
  if (log.kind == GazeKind::scene_camera) {
    throw Error(ErrorKind::input, log.source, "gaze on a scene camera's picture has no coordinate system in BIDS",
                "convert to gazetrace CSV, or use `frame` head");
  }
  std::vector<File> files;
  const std::vector<BidsRecording> recordings = bids_recordings(log);
  const BidsPixelScale scale = bids_pixel_scale(log);
  const bool is_exact = are_pixels_exact(recordings, log.kind, scale);
  for (const BidsRecording& recording : recordings) {
    const std::string label = label_of(recording.eye);
    const BidsSamples samples = bids_samples(log, recording, scale, is_exact);
    files.push_back({path_of(name, label, "physio.tsv.gz"), pack_gzip(samples.table)});
    files.push_back({path_of(name, label, "physio.json"), json_text(with_task(samples.sidecar, name))});
    if (const BidsEvents events = bids_events_of_eye(log, recording.eye, recordings); !events.table.empty()) {
      files.push_back({path_of(name, label, "physioevents.tsv.gz"), pack_gzip(events.table)});
      files.push_back({path_of(name, label, "physioevents.json"), json_text(with_task(events.sidecar, name))});
    }
  }
  const BidsEvents run = bids_run_events(log);
  files.push_back({path_of(name, "", "events.tsv"), run.table});
  files.push_back({path_of(name, "", "events.json"), json_text(with_task(run.sidecar, name))});
  return files;
}

std::vector<std::string> names_of(const std::vector<File>& files) {
  std::vector<std::string> names;
  for (const File& file : files) {
    names.push_back(file.path);
  }
  return names;
}

// Held by one at a time, in any process, until it is destroyed. Where a file system has no locks, nothing is held.
class FolderLock {
 public:
  explicit FolderLock(const std::string& folder)
      : descriptor_(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (descriptor_ >= 0) {
      while (::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) {
      }
    }
  }
  ~FolderLock() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);  // which gives the lock back
    }
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

// Decided by the recording's own sidecar, not by one that it inherits.
bool is_own(const std::string& path) {
  const BidsName name = parse_bids_name(path);
  const std::string sidecar = path.substr(0, path.size() - name.extension.size()) + ".json";
  std::error_code code;
  return std::filesystem::exists(sidecar, code) &&
         JsonLeaves(read_text_file(sidecar), sidecar).text(kBidsWriterKey) == kBidsWriter;
}

}  // namespace

bool is_bids_file_name(const std::string& path) {
  const BidsName name = parse_bids_name(path);
  return name.suffix == "physio" && name.extension == ".tsv.gz" && !name.entities.empty();
}

std::vector<std::string> bids_file_names(const GazeLog& log, const std::string& path) {
  return names_of(files_of(log, path));
}

void write_gaze_bids(const GazeLog& log, const std::string& path, const BidsLook& look) {
  const std::vector<File> files = files_of(log, path);
  const FolderLock lock(parse_bids_name(path).folder);
  const std::vector<std::string> removed = look ? look(names_of(files)) : std::vector<std::string>{};
  for (const File& file : files) {
    write_bytes_atomically(file.path, std::as_bytes(std::span(file.bytes)));
  }
  for (const std::string& leftover : removed) {
    std::error_code code;
    if (!std::filesystem::remove(leftover, code) && code) {
      throw Error(ErrorKind::runtime, leftover, "cannot be removed", "remove it: it would be read with the rest");
    }
  }
}

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
      if (name.suffix == "physio" && name.is_table() &&
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
    const bool is_data = name.is_table() || name.extension == ".json";
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
