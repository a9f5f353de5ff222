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

#include <cerrno>
#include <filesystem>
#include <span>

#include "core/atomic_file.hpp"
#include "gazelog/bids_parts.hpp"
#include "gazelog/bids_sidecars.hpp"
#include "gazelog/gzip.hpp"
#include "gazetrace/gaze_read.hpp"
#include "gazetrace/gaze_write.hpp"

namespace gazetrace {
namespace {

using Json = BidsJson;

std::string task_of(const BidsName& name) {
  for (const std::string& entity : name.entities) {
    if (entity.starts_with("task-")) {
      return entity.substr(5);
    }
  }
  return "";
}

// What the standard recommends for every sidecar of a task.
Json with_task(Json json, const BidsName& name) {
  if (const std::string task = task_of(name); !task.empty()) {
    json["TaskName"] = task;
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

}  // namespace gazetrace
