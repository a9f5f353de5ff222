// SPDX-License-Identifier: Apache-2.0
// How far a farm is, from the files in its folders alone.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "core/file_lock.hpp"
#include "farm/engine.hpp"
#include "farm/plan.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output_lock.hpp"
#include "output/written_file.hpp"
#include "pipeline/file_journal.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

fs::path exit_file(const FarmPlan& plan, const std::string& task) {
  return fs::path(plan.folder) / "tasks" / (task + ".exit");
}

std::optional<int> exit_code_of(const FarmPlan& plan, const std::string& task) {
  std::ifstream file(exit_file(plan, task));
  int code = 0;
  return file >> code ? std::optional(code) : std::nullopt;
}

// Frames of which all files are as they were written, by the record and the journal of a run.
std::set<std::int32_t> finished_frames(const std::string& folder, const std::string& record_path,
                                       std::int32_t files_per_frame, FileCheck check) {
  const WrittenFiles files = read_earlier_files(record_path);
  std::set<std::string> bad;
  if (check == FileCheck::content) {
    for (const BadFile& file : find_bad_files(folder, files, {})) {
      bad.insert(file.path);
    }
  }
  std::map<std::int32_t, std::int32_t> count;
  for (const auto& [name, file] : files) {
    std::error_code missing;
    const std::string path = path_in_record(folder, name);
    if (fs::file_size(path, missing) == file.bytes && !missing && !bad.contains(path)) {
      ++count[file.frame];
    }
  }
  std::set<std::int32_t> frames;
  for (const auto& [frame, files_of_frame] : count) {
    if (files_of_frame >= files_per_frame) {
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

// The frames that have a row; none where there is no table yet, or it is damaged.
std::set<std::int32_t> frames_of_table(const std::string& timing_path) {
  std::set<std::int32_t> rows;
  try {
    for (const TimingRow& row : read_timing_csv(timing_path)) {
      rows.insert(row.frame);
    }
  } catch (const Error&) {
    rows.clear();
  }
  return rows;
}

// What a run, or a merge, has left in the folder.
struct Outputs {
  std::string name;  // of the run in the names of its files, which begins with its frames
  bool is_part = false;
  std::int32_t files_per_frame = 1;
};

// Counts the finished frames; true where these are all, each with its row in the table.
bool observe_outputs(const FarmPlan& plan, const Outputs& outputs, FileCheck check, TaskStatus& task) {
  const std::vector<std::int32_t> wanted = parse_frame_list(task.frames);
  const std::string record_path = run_record_file_name(run_name_of(plan), outputs.name, outputs.is_part);
  const std::set<std::int32_t> finished = finished_frames(plan.run_folder, record_path, outputs.files_per_frame, check);
  const std::set<std::int32_t> rows =
      frames_of_table(timing_file_name(run_name_of(plan), outputs.name, outputs.is_part));
  task.all = wanted.size();
  task.done = static_cast<std::size_t>(
      std::count_if(wanted.begin(), wanted.end(), [&](std::int32_t frame) { return finished.contains(frame); }));
  return task.done == task.all &&
         std::all_of(wanted.begin(), wanted.end(), [&](std::int32_t frame) { return rows.contains(frame); });
}

TaskStatus observe_run(const FarmPlan& plan, const std::string& name, const std::string& frames, const Outputs& outputs,
                       FileCheck check) {
  TaskStatus task;
  task.name = name;
  task.frames = frames;
  task.exit_code = exit_code_of(plan, name);
  const std::string record_path = run_record_file_name(run_name_of(plan), outputs.name, outputs.is_part);
  const bool is_whole = observe_outputs(plan, outputs, check, task);
  std::error_code missing;
  const bool has_record = fs::exists(record_path, missing);
  // A task that was refused for other inputs has left the files of those before it as they were.
  const bool has_failed = task.exit_code.value_or(0) != 0 && task.exit_code != 4;
  const std::optional<bool> locked = is_locked(record_path);
  if (locked.value_or(false)) {
    task.state = TaskState::running;
  } else if (has_failed) {
    task.state = TaskState::failed;
  } else if (has_record && is_whole && state_in(record_path) == "done") {
    task.state = TaskState::done;
  } else if (has_record) {
    // Ended in order, or without a word, or some of its files are damaged since. Where nothing can be locked it may
    // also run.
    task.state = state_in(record_path) == "interrupted" ? TaskState::interrupted
                 : locked                               ? TaskState::failed
                                                        : TaskState::unknown;
  } else if (task.exit_code == 4) {  // before its first frame
    task.state = TaskState::interrupted;
  }
  return task;
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

TaskStatus observe_chunk(const FarmPlan& plan, std::size_t chunk, FileCheck check) {
  const std::string name = std::to_string(chunk + 1);
  const std::string& frames = plan.chunks[chunk];
  if (plan.kind == FarmKind::frames) {
    return observe_run(plan, name, frames, {frames, true, plan.files_per_frame}, check);
  }
  TaskStatus task = observe_exit(plan, name);
  task.frames = frames;
  // A task that measures rows of a sweep holds a lock in the sweep's folder while it runs, see SweepDirectory.
  if (is_held(fmt::format("{}/lock.{}-of-{}", plan.run_folder, name, plan.chunks.size()), FileLock::Kind::shared)) {
    task.state = TaskState::running;
  }
  return task;
}

std::string all_frames(const FarmPlan& plan) {
  std::vector<std::int32_t> frames;
  for (const std::string& chunk : plan.chunks) {
    const std::vector<std::int32_t> list = parse_frame_list(chunk);
    frames.insert(frames.end(), list.begin(), list.end());
  }
  return format_frame_list(frames);
}

// Of a merge there are its exit code and what it has written.
TaskStatus observe_finish(const FarmPlan& plan, FileCheck check) {
  if (plan.kind == FarmKind::sweep) {
    return observe_exit(plan, "finish");
  }
  const std::string frames = all_frames(plan);
  const Outputs whole{frames, false, plan.files_per_frame};
  TaskStatus merged;
  merged.frames = frames;
  TaskStatus task = observe_exit(plan, "finish");
  if (task.state == TaskState::done && !observe_outputs(plan, whole, check, merged)) {
    task.state = TaskState::missing;
    task.exit_code.reset();
  }
  return task;
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
    case TaskState::unknown:
      return "unknown";
    case TaskState::done:
      return "done";
  }
  return "";
}

bool FarmStatus::is_done() const {
  return std::all_of(tasks.begin(), tasks.end(), [](const TaskStatus& task) { return task.state == TaskState::done; });
}

int FarmStatus::exit_code() const {
  const auto any = [&](TaskState state) {
    return std::any_of(tasks.begin(), tasks.end(), [&](const TaskStatus& task) { return task.state == state; });
  };
  return any(TaskState::failed) ? 3 : any(TaskState::interrupted) ? 4 : 0;
}

FarmStatus farm_status(const FarmPlan& plan, FileCheck check) {
  FarmStatus status;
  const TaskStatus finish = observe_finish(plan, check);
  for (std::size_t i = 0; i < plan.chunks.size(); ++i) {
    const TaskStatus task = observe_chunk(plan, i, check);
    status.frames += task.all;
    status.frames_done += task.done;
    status.tasks.push_back(task);
  }
  status.tasks.push_back(finish);
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
  return text + fmt::format("{} of {} frames are rendered\n", status.frames_done, status.frames);
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
  Json json{{"folder", plan.folder},
            {"engine", plan.engine},
            {"is_done", status.is_done()},
            {"frames", status.frames},
            {"frames_done", status.frames_done},
            {"tasks", tasks}};
  return json.dump(2) + "\n";
}

}  // namespace gazetrace
