// SPDX-License-Identifier: Apache-2.0
// How far a farm is, from the files in its folders alone.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>

#include "core/file_lock.hpp"
#include "farm/engine.hpp"
#include "gazetrace/error.hpp"
#include "pipeline/file_journal.hpp"
#include "pipeline/lock_state.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

struct Observed {
  TaskStatus task;
  double made_ms = 0;  // of the frames whose times are known
  std::size_t timed = 0;
};

std::optional<int> exit_code_of(const FarmPlan& plan, const std::string& task) {
  std::ifstream file(fs::path(plan.folder) / "tasks" / (task + ".exit"));
  int code = 0;
  return file >> code ? std::optional(code) : std::nullopt;
}

// Frames of which all files are there, by the record and the journal of a run.
std::set<std::int32_t> finished_frames(const std::string& folder, const std::string& record_path,
                                       std::int32_t files_per_frame) {
  std::map<std::int32_t, std::int32_t> count;
  std::error_code missing;
  for (const auto& [name, file] : read_earlier_files(record_path)) {
    if (fs::exists(fs::path(folder) / name, missing)) {
      ++count[file.frame];
    }
  }
  std::set<std::int32_t> frames;
  for (const auto& [frame, files] : count) {
    if (files >= files_per_frame) {
      frames.insert(frame);
    }
  }
  return frames;
}

std::string state_in(const std::string& record_path) {
  try {
    const RunRecord record = read_run_record(record_path);
    const auto state = record.facts.find("state");
    return state == record.facts.end() ? std::string() : state->second;
  } catch (const Error&) {
    return {};
  }
}

void add_times(const std::string& timing_path, Observed& run) {
  try {
    for (const TimingRow& row : read_timing_csv(timing_path)) {
      if (std::isfinite(row.total_ms)) {
        run.made_ms += row.total_ms;
        ++run.timed;
      }
    }
  } catch (const Error&) {
    // There is no table yet.
  }
}

// `name`: of the run in the names of its files, which begins with its frames.
Observed observe_run(const FarmPlan& plan, const std::string& task, const std::string& frames, const std::string& name,
                     bool is_part, std::int32_t files_per_frame) {
  Observed run;
  run.task.name = task;
  run.task.frames = frames;
  const std::vector<std::int32_t> wanted = parse_frame_list(frames);
  run.task.all = wanted.size();
  run.task.exit_code = exit_code_of(plan, task);
  const std::string record_path = run_record_file_name(plan.run_folder, name, is_part);
  const std::set<std::int32_t> finished = finished_frames(plan.run_folder, record_path, files_per_frame);
  run.task.done = static_cast<std::size_t>(
      std::count_if(wanted.begin(), wanted.end(), [&](std::int32_t frame) { return finished.contains(frame); }));
  add_times(timing_file_name(plan.run_folder, name, is_part), run);
  std::error_code missing;
  const bool has_record = fs::exists(record_path, missing);
  if (is_locked(record_path)) {
    run.task.state = TaskState::running;
  } else if (has_record && run.task.done == run.task.all && state_in(record_path) == "done") {
    run.task.state = TaskState::done;
  } else if (run.task.exit_code && *run.task.exit_code != 0 && *run.task.exit_code != 4) {
    run.task.state = TaskState::failed;
  } else if (has_record) {
    // Ended in order, or without a word.
    run.task.state = state_in(record_path) == "interrupted" ? TaskState::interrupted : TaskState::failed;
  }
  return run;
}

bool is_held(const std::string& lock, FileLock::Kind tried) {
  std::error_code missing;
  return fs::exists(lock, missing) && !FileLock(lock, tried, false).is_held();
}

// What follows the frames leaves no record of a run: all that is known is whether its script runs, which then holds a
// shared lock, and how it ended.
TaskStatus observe_exit(const FarmPlan& plan, const std::string& name) {
  TaskStatus task;
  task.name = name;
  task.exit_code = exit_code_of(plan, name);
  if (task.exit_code) {
    task.state = *task.exit_code == 0 ? TaskState::done : TaskState::failed;
  } else if (is_held(fmt::format("{}/tasks/{}.running", plan.folder, name), FileLock::Kind::alone)) {
    task.state = TaskState::running;
  }
  return task;
}

// A task that measures rows of a sweep holds a lock in the sweep's folder while it runs, see SweepDirectory.
Observed observe_rows(const FarmPlan& plan, std::size_t chunk) {
  Observed run;
  run.task = observe_exit(plan, std::to_string(chunk + 1));
  run.task.frames = plan.chunks[chunk];
  if (is_held(fmt::format("{}/lock.{}-of-{}", plan.run_folder, chunk + 1, plan.chunks.size()),
              FileLock::Kind::shared)) {
    run.task.state = TaskState::running;
  }
  return run;
}

Observed observe_chunk(const FarmPlan& plan, std::size_t chunk) {
  const std::string task = std::to_string(chunk + 1);
  const std::string& frames = plan.chunks[chunk];
  switch (plan.kind) {
    case FarmKind::sweep:
      return observe_rows(plan, chunk);
    case FarmKind::samples: {
      SampleRange range;
      parse_value(plan.ranges[chunk], plan.folder, range);
      return observe_run(plan, task, frames, part_of_samples_name(frames, range), true, 1);
    }
    case FarmKind::frames:
      break;
  }
  return observe_run(plan, task, frames, frames, true, plan.traces_first ? 1 : plan.files_per_frame);
}

std::string all_frames(const FarmPlan& plan) {
  std::vector<std::int32_t> frames;
  for (const std::string& chunk : plan.chunks) {
    const std::vector<std::int32_t> list = parse_frame_list(chunk);
    frames.insert(frames.end(), list.begin(), list.end());
  }
  return format_frame_list(frames);
}

std::string duration_words(double seconds) {
  return seconds < 90
             ? fmt::format("{:.0f} s", seconds)
             : (seconds < 5400 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600));
}

// Traced frames may be removed once their pictures are there.
void count_as_traced(FarmStatus& status) {
  for (TaskStatus& task : status.tasks) {
    task.done = task.all;
    task.state = TaskState::done;
  }
  status.frames_done = status.frames;
}

// What follows the chunks has to be done again where something before it is not done any more.
void forget_what_was_before(std::size_t chunks, FarmStatus& status) {
  bool all_done = true;
  for (std::size_t i = 0; i < status.tasks.size(); ++i) {
    TaskStatus& task = status.tasks[i];
    if (i >= chunks && !all_done && task.state == TaskState::done) {
      task.state = TaskState::missing;
      task.exit_code.reset();
    }
    all_done = all_done && task.state == TaskState::done;
  }
}

}  // namespace

const char* to_string(TaskState state) {
  switch (state) {
    case TaskState::missing:
      return "missing";
    case TaskState::running:
      return "running";
    case TaskState::interrupted:
      return "interrupted";
    case TaskState::failed:
      return "failed";
    case TaskState::done:
      return "done";
  }
  return "";
}

bool FarmStatus::is_done() const {
  return std::all_of(tasks.begin(), tasks.end(), [](const TaskStatus& task) { return task.state == TaskState::done; });
}

FarmStatus farm_status(const FarmPlan& plan) {
  FarmStatus status;
  double made_ms = 0;
  std::size_t timed = 0;
  std::size_t running = 0;
  for (std::size_t i = 0; i < plan.chunks.size(); ++i) {
    const Observed run = observe_chunk(plan, i);
    status.frames += run.task.all;
    status.frames_done += run.task.done;
    running += run.task.state == TaskState::running ? 1 : 0;
    made_ms += run.made_ms;
    timed += run.timed;
    status.tasks.push_back(run.task);
  }
  const double left = static_cast<double>(status.frames - status.frames_done);
  if (timed > 0) {
    status.seconds_left =
        left * made_ms / 1000 / static_cast<double>(timed) / static_cast<double>(std::max<std::size_t>(running, 1));
  }
  if (plan.traces_first) {
    const std::string all = all_frames(plan);
    status.tasks.push_back(observe_run(plan, "finish", all, all, false, plan.files_per_frame).task);
    if (status.tasks.back().state == TaskState::done) {
      count_as_traced(status);
    }
  } else {
    status.tasks.push_back(observe_exit(plan, "finish"));
  }
  for (std::size_t i = 1; i <= plan.then.size(); ++i) {
    status.tasks.push_back(observe_exit(plan, fmt::format("after-{}", i)));
  }
  forget_what_was_before(plan.chunks.size(), status);
  return status;
}

std::vector<std::size_t> chunks_to_retry(const FarmStatus& status) {
  std::vector<std::size_t> chunks;
  for (std::size_t i = 0; i < status.tasks.size() && status.tasks[i].name == std::to_string(i + 1); ++i) {
    const TaskState state = status.tasks[i].state;
    if (state != TaskState::done && state != TaskState::running) {
      chunks.push_back(i);
    }
  }
  return chunks;
}

std::string farm_status_text(const FarmPlan& plan, const FarmStatus& status) {
  std::string text =
      fmt::format("{:>9}  {:<12}{:>7}{:>7}{:>6}  {}\n", "task", "state", "frames", "done", "exit", "which");
  for (const TaskStatus& task : status.tasks) {
    text += fmt::format("{:>9}  {:<12}{:>7}{:>7}{:>6}  {}\n", task.name, to_string(task.state),
                        task.all > 0 ? std::to_string(task.all) : "-", task.all > 0 ? std::to_string(task.done) : "-",
                        task.exit_code ? std::to_string(*task.exit_code) : "-", bounded(task.frames, 60));
  }
  if (plan.kind == FarmKind::sweep) {
    return text;
  }
  text += fmt::format("{} of {} {} are {}", status.frames_done, status.frames,
                      plan.kind == FarmKind::samples ? "parts of frames" : "frames",
                      plan.traces_first ? "traced" : "rendered");
  if (status.seconds_left && status.frames_done < status.frames) {
    text += fmt::format(", about {} left", duration_words(*status.seconds_left));
  }
  return text + "\n";
}

std::string farm_status_json(const FarmPlan& plan, const FarmStatus& status) {
  using Json = nlohmann::ordered_json;
  Json tasks = Json::array();
  for (const TaskStatus& task : status.tasks) {
    Json json{{"task", task.name}, {"state", to_string(task.state)}, {"exit_code", nullptr}};
    if (task.exit_code) {
      json["exit_code"] = *task.exit_code;
    }
    if (task.all > 0) {
      json["frames"] = task.frames;
      json["all"] = task.all;
      json["done"] = task.done;
    }
    tasks.push_back(json);
  }
  Json json{{"folder", plan.folder},       {"engine", plan.engine},   {"traces_first", plan.traces_first},
            {"is_done", status.is_done()}, {"frames", status.frames}, {"frames_done", status.frames_done},
            {"seconds_left", nullptr},     {"tasks", tasks}};
  if (status.seconds_left) {
    json["seconds_left"] = *status.seconds_left;
  }
  return json.dump(2) + "\n";
}

}  // namespace gazetrace
