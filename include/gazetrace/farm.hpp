// SPDX-License-Identifier: Apache-2.0
// Divides a job into tasks for many machines. The tasks of an array render chunks of the frames, or measure
// chunks of the rows of a sweep; a last task joins their outputs. Every engine runs the same tasks, by one
// script that lies in the farm's folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/job.hpp"

namespace gazetrace {

struct FarmEngineInfo {
  std::string name, description;
};
std::vector<FarmEngineInfo> farm_engines();

struct FarmSettings {
  std::string job_file;            // TOML, as `render` takes it, whose outputs say where the farm is; or a sweep's plan
  std::string output;              // of a sweep: its folder; empty: the plan's name with .sweep
  std::string engine;              // a name of farm_engines()
  std::string program;             // gazetrace itself, as the tasks call it
  std::uint32_t chunks = 0;        // so many, of about equal cost; at least 1
  int threads = 0;                 // of a task; 0: all of its machine's
  int retries = 3;                 // of a task that failed by chance or was interrupted
  ByteCount memory;                // of a task; 0: by estimate_scene() and the size of the pictures
  std::optional<DurationNs> time;  // limit of a task; empty: none
  std::string container;           // words before the program: "apptainer exec gazetrace.sif"
  std::vector<std::string> then;   // commands of the shell after the sequence is whole: a video, a report
  bool confine = false;            // the job is by others: it and its tasks keep to its folder or data set
};

// The kind of work that is divided into chunks.
enum class FarmKind : std::uint8_t { frames, sweep };

// The whole job, for status, retry and every engine; farm.json in the farm's folder.
struct FarmPlan {
  FarmKind kind = FarmKind::frames;
  std::string name, engine, program, container, job_file;
  // The denoiser on the machine where the farm is planned, denoiser_description(): theirs must be the
  // same. Empty: by nothing, or not known, as in a container.
  std::string filter, denoiser;
  std::string folder;                // of the farm: `farm` in that of the run, absolute like the other paths
  std::string run_folder;            // where the outputs lie
  std::string run_name;              // the prefix of the run's own files there, run_name_of() without the folder
  std::string work_folder;           // where the tasks are started, since paths in the job count from there
  std::vector<std::string> chunks;   // the frames of each; of a sweep, its rows
  std::vector<double> samples;       // that the plan expects of each; 0: not known
  std::int32_t files_per_frame = 1;  // in the whole sequence
  int threads = 0, retries = 0;
  std::uint64_t memory_mib = 0;
  std::int64_t time_s = 0;  // limit of a task; 0: none
  std::vector<std::string> then;
  bool confine = false;
  bool is_moved = false;  // by read_farm(): it does not lie where it was made for, and cannot be run
};

// Reads job and plan, and predicts memory. Error(usage, input) as resolve() does, and for a job
// without outputs. It writes nothing.
FarmPlan plan_farm(const FarmSettings& settings);
std::string farm_plan_text(const FarmPlan& plan);  // for people
// Error(input) for a folder without a farm; `folder` is that of the run or of the farm. Where that has been moved, or
// is another name of it on this machine, the plan's folders are those that were found.
FarmPlan read_farm(const std::string& folder);

// The names of a plan's tasks: "1" to the number of chunks, "finish", "after-1", ...
std::vector<std::string> farm_tasks(const FarmPlan& plan);
// The engine's input for these chunks; by names within the farm's folder.
std::map<std::string, std::string> farm_files(const FarmPlan& plan, const std::vector<std::size_t>& chunks);
// Writes farm.json, the borders of the chunks, the script of the tasks and the engine's files. Error(input) where parts
// of another division of the frames lie in the folder, which no merge could join with these.
void write_farm(const FarmPlan& plan, const std::vector<std::size_t>& chunks);
// The command of the shell that hands the farm's files over to the engine; empty: run_local() runs it.
std::string submit_command(const FarmPlan& plan);

// unknown: it has begun and not ended, and whether it still runs cannot be told, since its folder cannot be locked.
enum class TaskState : std::uint8_t { missing, running, interrupted, failed, done, unknown };
const char* to_string(TaskState state);

struct TaskStatus {
  std::string name;    // "3", "finish"
  std::string frames;  // a frame list; empty for the tasks after the sequence
  TaskState state = TaskState::missing;
  std::size_t all = 0, done = 0;  // frames
  std::optional<int> exit_code;   // of the last attempt, where the script of the tasks saw it end
};
struct FarmStatus {
  std::vector<TaskStatus> tasks;            // as farm_tasks()
  std::size_t frames = 0, frames_done = 0;  // pictures of the sequence
  [[nodiscard]] bool is_done() const;
  // 3 where a task has failed, else 4 where one was interrupted, else 0.
  [[nodiscard]] int exit_code() const;
};
// How finished files are looked at: their sizes alone, or their content, which reads all of them.
enum class FileCheck : std::uint8_t { size, content };
// From records, journals, tables and locks that lie in the folder, on any machine that sees it. A task whose files or
// rows are not as it left them is not done.
FarmStatus farm_status(const FarmPlan& plan, FileCheck check = FileCheck::size);
std::string farm_status_text(const FarmPlan& plan, const FarmStatus& status);
std::string farm_status_json(const FarmPlan& plan, const FarmStatus& status);
// The chunks that are neither done nor running, counted from 0.
std::vector<std::size_t> chunks_to_retry(const FarmStatus& status);
// Error(input) where the folder of a run holds the plan of its farm, and that names another filter or denoiser than
// this machine takes for the run. `run_name` as FarmPlan has it.
void check_farm_denoiser(const std::string& run_folder, const std::string& run_name, const std::string& filter,
                         const std::string& denoiser);
// Whether chunks can be handed over once more while others run, and the tasks after them wait for these, too.
bool can_retry_beside_running(const FarmPlan& plan);
// Whether the command of submit_command() ends when the last task has, and not when the engine has taken them.
bool submit_waits(const FarmPlan& plan);

struct LocalSettings {
  int processes = 1;           // at the same time
  std::function<bool()> stop;  // asked often; true: running tasks are asked to end, and no other begins
  std::function<void(const std::string& task, const std::string& what)> tell;  // "1", "begins"; "1", "exit code 0"
};
// Runs these chunks on this machine, and the tasks after them once all chunks of the plan are done. Returns the worst
// exit code: of a task that failed before that of one that was interrupted (4), else 0. A task that ends with exit code
// 3, 4 or by a signal is tried again as often as the plan says. Error(runtime) where another process is at the tasks of
// this folder.
int run_local(const FarmPlan& plan, const std::vector<std::size_t>& chunks, const LocalSettings& settings);

}  // namespace gazetrace
