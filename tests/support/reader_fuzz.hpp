// SPDX-License-Identifier: Apache-2.0
// One entry point for all readers of gaze logs and camera paths. Any bytes are either read, and then the result is as
// the headers promise, or refused with one line of text. Anything else ends the program. The fuzzers and the mutation
// test use it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/gaze.hpp"
#include "gazetrace/gaze_trials.hpp"

namespace gazetrace {

// "gaze-eyelink-asc", "camera-tum", ...; "gaze-any" and "camera-any" choose the format by sniffing, "gaze-recordings"
// takes the second recording of such a file, "gaze-event-table" reads the events of a log from the file, and
// "gaze-trial-table" its trials.
inline std::vector<std::string> fuzz_readers() {
  std::vector<std::string> names{"gaze-any", "gaze-recordings", "gaze-event-table", "gaze-trial-table", "camera-any"};
  for (const GazeFormatInfo& format : gaze_formats()) {
    names.push_back("gaze-" + format.name);
  }
  for (const CameraFormatInfo& format : camera_formats()) {
    names.push_back("camera-" + format.name);
  }
  return names;
}

// A folder with the files of one input. For formats of several files the input contains all of them; `\n%%FILE name\n`
// begins the next one.
class FuzzFolder {
 public:
  explicit FuzzFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::filesystem::create_directories(folder_);
    write("dataset_description.json", "{}");  // BIDS looks no higher than this
  }
  FuzzFolder(const FuzzFolder&) = delete;
  FuzzFolder& operator=(const FuzzFolder&) = delete;
  ~FuzzFolder() {
    std::error_code code;
    std::filesystem::remove_all(folder_, code);
  }

  // The first file's path.
  std::string put(const std::string& first_name, std::string_view input) {
    constexpr std::string_view kNext = "\n%%FILE ";
    std::set<std::string> written;
    std::string name = first_name;
    for (;;) {
      const std::size_t next = input.find(kNext);
      write(name, input.substr(0, next));
      written.insert(name);
      if (next == std::string_view::npos || written.size() == 6) {
        break;
      }
      input.remove_prefix(next + kNext.size());
      const std::size_t end = input.find('\n');
      name = safe_name(input.substr(0, end));
      input.remove_prefix(end == std::string_view::npos ? input.size() : end + 1);
    }
    for (const std::string& old : names_) {
      if (written.count(old) == 0) {
        std::filesystem::remove(folder_ / old);
      }
    }
    names_ = written;
    return (folder_ / first_name).string();
  }

 private:
  void write(const std::string& name, std::string_view bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  static std::string safe_name(std::string_view text) {
    std::string name;
    for (const char c : text.substr(0, 80)) {
      const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
      name += plain || c == '.' || c == '_' || c == '-' || c == ' ' ? c : '_';
    }
    return name.empty() || name.front() == '.' ? "_" + name : name;
  }

  std::filesystem::path folder_;
  std::set<std::string> names_;
};

namespace fuzz {

inline void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "promise broken: %s\n", what);
    std::abort();
  }
}

inline bool is_unit(const Vec3d& v) {
  return std::abs(length(v) - 1) < 1e-6;
}

inline void check_log(const GazeLog& log) {
  require(!log.samples.empty(), "a log has samples");
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const GazeSample& s = log.samples[i];
    require(i == 0 || log.samples[i - 1].t_ns < s.t_ns, "times increase");
    const bool known =
        log.kind == GazeKind::direction ? is_unit(s.direction) : std::isfinite(s.u) && std::isfinite(s.v);
    require(known || !is_usable(s.validity), "usable gaze is finite, directions have length 1");
  }
  require(log.eyes.empty() || log.eyes.size() == log.samples.size(), "both eyes, or none, for every sample");
  require(log.origins.empty() || log.origins.size() == log.samples.size(), "origins, or none, for every sample");
  for (std::size_t i = 0; i < log.head.size(); ++i) {
    const HeadPose& pose = log.head[i];
    require(i == 0 || log.head[i - 1].t_ns < pose.t_ns, "times of head poses increase");
    require(is_finite(pose.position_m), "a head is somewhere");
    const Quatd& q = pose.orientation;
    require(std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1) < 1e-6, "a head's turn is a rotation");
  }
  for (const std::string& warning : log.warnings) {
    require(warning.find('\n') == std::string::npos, "a warning has one line");
  }
  const GazeMapping mapping;
  for (const std::int64_t t_ns : {std::int64_t{0}, std::int64_t{1'000'000'000}}) {
    gaze_at(log, mapping, t_ns);
  }
}

inline void check_path(const CameraPath& path) {
  require(path.begin_ns <= path.end_ns, "a path begins before it ends");
  const std::int64_t middle = path.begin_ns / 2 + path.end_ns / 2;
  for (const std::int64_t t_ns : {path.begin_ns, middle, path.end_ns}) {
    const CameraPose pose = path.pose_at(t_ns);
    const Quatd& q = pose.orientation;
    require(is_finite(pose.position_m), "a camera is somewhere");
    require(std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1) < 1e-6, "a camera's turn is a rotation");
  }
  require(path.projection.yfov_rad > 0 && path.projection.yfov_rad < kPi, "a field of view is one");
}

inline std::string first_name(const std::string& reader) {
  return reader == "gaze-bids"          ? "sub-01_task-view_recording-eye1_physio.tsv"
         : reader == "gaze-neon-native" ? "gaze ps1.raw"
         : reader == "gaze-pupil-cloud" ? "gaze.csv"
         : reader == "camera-colmap"    ? "images.txt"
                                        : "log";
}

// Options are derived from the length of the input, so that an input alone reproduces what it found.
inline void read_gaze(const std::string& format, const std::string& path, std::size_t length) {
  GazeReadOptions options;
  options.format = format;
  options.guess_display = length % 2 == 0;
  options.unordered = length % 3 == 0 ? UnorderedPolicy::error : UnorderedPolicy::sort;
  options.frame = length % 5 < 2 ? GazeFrame::automatic : length % 5 < 4 ? GazeFrame::head : GazeFrame::scene_camera;
  if (length % 7 < 3) {
    options.display = DisplayGeometry{
        .width_px = 1920, .height_px = 1080, .width_cm = 51, .height_cm = 29, .distance_cm = 65, .eye_y_cm = 2};
  }
  check_log(load_gaze_log(path, options));
}

// The second recording of a file, of whatever format.
inline void read_second_recording(const std::string& path, std::size_t length) {
  GazeReadOptions options;
  options.recording = "2";
  options.guess_display = true;
  options.unordered = UnorderedPolicy::sort;
  options.frame = length % 2 == 0 ? GazeFrame::head : GazeFrame::scene_camera;
  check_log(load_gaze_log(path, options));
}

// A log of ten seconds beside the input as `name`; its path.
inline std::string log_beside(FuzzFolder& folder, const std::string& name, std::string_view input) {
  std::string log = "t[ns],u[1],v[1]\n";
  for (int i = 0; i <= 10; ++i) {
    log += std::to_string(i * 1'000'000'000LL) + ",0.5,0.5\n";
  }
  return folder.put("log", log + "\n%%FILE " + name + "\n" + std::string(input));
}

// The input as the events of a log.
inline void read_events(FuzzFolder& folder, std::string_view input) {
  GazeReadOptions options;
  const std::string path = log_beside(folder, "events.csv", input);
  options.events_file = path.substr(0, path.size() - 3) + "events.csv";
  check_log(load_gaze_log(path, options));
}

// The input as the trials of a log, and the log cut to each of the first.
inline void read_trials(FuzzFolder& folder, std::string_view input) {
  const std::string path = log_beside(folder, "trials.csv", input);
  GazeLog log = load_gaze_log(path, {});
  TrialRules rules;
  rules.table = path.substr(0, path.size() - 3) + "trials.csv";
  name_trials(log, rules);
  std::vector<GazeTrial> trials = find_trials(log);
  require(!trials.empty(), "there are trials, or a refusal");
  trials.resize(std::min<std::size_t>(trials.size(), 20));
  for (const GazeTrial& trial : trials) {
    require(trial.begin_ns <= trial.end_ns, "a trial begins before it ends");
    require(trial.end_ns / 2 - trial.begin_ns / 2 < std::numeric_limits<std::int64_t>::max() / 2,
            "the duration of a trial is a number");
    check_log(cut_to_trial(log, trial));
  }
}

inline void read_camera(const std::string& format, const std::string& path, std::size_t length) {
  CameraReadOptions options;
  options.format = format;
  options.axes = length % 3 == 0 ? CameraAxes::gl : length % 3 == 1 ? CameraAxes::cv : CameraAxes::unity;
  options.interpolation = length % 2 == 0 ? PathInterpolation::linear : PathInterpolation::step;
  options.keep_time = length % 5 == 0;
  check_path(load_camera_path(path, options));
}

}  // namespace fuzz

// True where the bytes were read, false where they were properly refused.
inline bool fuzz_reader(const std::string& reader, std::string_view input, FuzzFolder& folder) {
  const bool gaze = reader.starts_with("gaze-");
  const std::string name = reader.substr(reader.find('-') + 1);
  const std::string format = name == "any" ? "" : name;
  try {
    if (reader == "gaze-event-table") {
      fuzz::read_events(folder, input);
      return true;
    }
    if (reader == "gaze-trial-table") {
      fuzz::read_trials(folder, input);
      return true;
    }
    const std::string path = folder.put(fuzz::first_name(reader), input);
    if (reader == "gaze-recordings") {
      fuzz::read_second_recording(path, input.size());
      return true;
    }
    gaze ? fuzz::read_gaze(format, path, input.size()) : fuzz::read_camera(format, path, input.size());
    return true;
  } catch (const Error& error) {
    const std::string_view message = error.what();
    fuzz::require(!message.empty() && message.find('\n') == std::string_view::npos, "a refusal has one line");
    return false;
  }
}

}  // namespace gazetrace
