// SPDX-License-Identifier: Apache-2.0
// From a job to the tasks of a farm, and what each will take.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "core/text.hpp"
#include "farm/engine.hpp"
#include "farm/plan.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/reconstruct.hpp"
#include "gazetrace/resolve.hpp"
#include "gazetrace/sweep_plan.hpp"
#include "job/chunks.hpp"

namespace gazetrace {
namespace {

namespace fs = std::filesystem;

constexpr double kReserveOfMemory = 1.25;  // over what is predicted
constexpr std::uint64_t kProgramMib = 256;
// What a run holds of a frame while it renders: sums, guides, the picture, and its view, with copies of some.
constexpr std::uint64_t kBytesOfAPixel = 600;
// By the filter oidn: 1050 bytes, and 2520 where halves go through the network, too (1280x720 with Open Image Denoise
// 2.5.1).
constexpr std::uint64_t kBytesOfADenoisedPixel = 2600;

// Engines read the name within lines of their own.
std::string plain_name(std::string name) {
  for (char& letter : name) {
    const bool is_plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                          (letter >= '0' && letter <= '9') || letter == '-' || letter == '.';
    letter = is_plain ? letter : '_';
  }
  return name.empty() ? "gazetrace" : name;
}

std::uint64_t memory_mib(const JobSettings& job, const FramePlan& frames) {
  std::uint64_t bytes = estimate_scene(job.scene, scene_read_options(job)).total_bytes();
  std::uint64_t largest = 0;
  for (const FrameRequest& request : frames.frames) {
    largest =
        std::max(largest, static_cast<std::uint64_t>(request.width_px) * static_cast<std::uint64_t>(request.height_px));
  }
  bytes += largest * (job.filter == "oidn" ? kBytesOfADenoisedPixel : kBytesOfAPixel);
  return static_cast<std::uint64_t>(kReserveOfMemory * static_cast<double>(bytes) / 1048576.0) + kProgramMib;
}

void check_render_job(const FarmSettings& settings, const JobSettings& job) {
  if (job.outputs.empty()) {
    throw Error(ErrorKind::input, settings.job_file, "the job has no output, which says where the farm is",
                "add output = [\"out/frame.####.exr\"]");
  }
  if (job.chunk || job.frames == std::nullopt) {
    throw Error(ErrorKind::input, settings.job_file,
                job.frames ? "the job is a part of a sequence already" : "the job does not say which frames it has",
                job.frames ? "leave `chunk` out" : "add frames = \"1-100\"");
  }
}

// Every handing over has its own retries, and does again what follows the chunks: how that ended before tells nothing
// of frames that are made anew, nor of commands that are others now.
void forget_earlier(const FarmPlan& plan) {
  const fs::path tasks = fs::path(plan.folder) / "tasks";
  std::error_code failed;
  for (const std::string& task : farm_tasks(plan)) {
    fs::remove(tasks / (task + ".tries"), failed);
  }
  for (const std::string& task : tasks_after_chunks(plan)) {
    fs::remove(tasks / (task + ".exit"), failed);
  }
}

std::string record_of_chunk(const FarmPlan& plan, std::size_t chunk) {
  return run_record_file_name(run_name_of(plan), plan.chunks[chunk], true);
}

// Parts of an earlier division that have begun would be rendered once more, and then stand in the way of the merge.
void check_same_division(const FarmPlan& plan) {
  const std::string farm = (fs::path(plan.folder) / "farm.json").string();
  if (plan.kind == FarmKind::sweep || !fs::exists(farm)) {
    return;
  }
  FarmPlan earlier;
  try {
    earlier = read_farm(plan.folder);
  } catch (const Error&) {
    return;  // damaged, or of another version: it is replaced
  }
  if (earlier.kind == FarmKind::sweep || earlier.is_moved) {
    return;
  }
  std::set<std::string> records;
  for (std::size_t i = 0; i < plan.chunks.size(); ++i) {
    records.insert(record_of_chunk(plan, i));
  }
  for (std::size_t i = 0; i < earlier.chunks.size(); ++i) {
    const std::string record = record_of_chunk(earlier, i);
    if (!records.contains(record) && fs::exists(record)) {
      throw Error(ErrorKind::input, plan.run_folder,
                  fmt::format("holds parts of another division, in {} chunks, such as {}", earlier.chunks.size(),
                              fs::path(record).filename().string()),
                  "divide it as before, or remove *run.*.json, *timing.*.csv and the pictures there");
    }
  }
}

}  // namespace

FarmPlan farm_plan_of(const FarmSettings& settings, const std::string& run_folder) {
  for (const std::string& path : {absolute_path(run_folder), absolute_path(settings.job_file)}) {
    if (!is_utf8(path)) {
      throw Error(ErrorKind::input, path, "a farm keeps its names in JSON, and this one is not UTF-8", "rename it");
    }
  }
  FarmPlan plan;
  plan.engine = settings.engine;
  plan.program = settings.program.find('/') == std::string::npos ? settings.program : absolute_path(settings.program);
  plan.container = settings.container;
  plan.job_file = absolute_path(settings.job_file);
  plan.work_folder = absolute_path("");
  plan.run_folder = absolute_path(run_folder);
  plan.folder = (fs::path(plan.run_folder) / "farm").string();
  plan.name = plain_name(fs::path(settings.job_file).stem().string());
  plan.threads = settings.threads;
  plan.retries = settings.retries;
  plan.memory_mib = (settings.memory.bytes + 1048575) / 1048576;
  plan.time_s = settings.time ? settings.time->ns / 1'000'000'000 : 0;
  plan.then = settings.then;
  plan.confine = settings.confine;
  return plan;
}

std::string absolute_path(const std::string& path) {
  return fs::absolute(path.empty() ? "." : path).lexically_normal().string();
}

std::string run_name_of(const FarmPlan& plan) {
  return plan.run_folder + "/" + plan.run_name;
}

FarmPlan plan_farm(const FarmSettings& settings) {
  farm_engine(settings.engine);
  if (settings.chunks == 0) {
    throw Error(ErrorKind::usage, "`chunks`", "into how many tasks is the job divided?", "give `chunks`");
  }
  if (is_sweep_plan(settings.job_file)) {
    return plan_sweep_farm(settings);
  }
  if (!settings.output.empty()) {
    throw Error(ErrorKind::usage, "`output`", "is where a sweep is measured; a job names its outputs itself",
                "leave it out");
  }
  const Job job = load_job(settings.job_file, settings.confine);
  check_render_job(settings, job.settings);
  ResolveOptions options;
  options.scope = ResolveScope::plan;
  options.tell_idle = false;
  const ResolvedJob resolved = resolve(job, options);

  const std::string& run_name = resolved.pipeline.output.run_name;
  FarmPlan plan = farm_plan_of(settings, folder_of_run(run_name));
  plan.run_name = fs::path(run_name).filename().string();
  JobSettings divided = resolved.job.settings;
  // No chunk is empty: their number is all that the tasks are told.
  divided.chunk = Chunk{1, std::min(settings.chunks, static_cast<std::uint32_t>(resolved.plan.frames.size()))};
  for (const FrameChunk& chunk : divide_frames(divided, resolved.plan).chunks) {
    plan.chunks.push_back(format_frame_list(chunk.frames));
    plan.samples.push_back(chunk.samples);
  }
  const OutputSettings& output = resolved.pipeline.output;
  plan.files_per_frame = static_cast<std::int32_t>(!output.exr.pattern.empty()) +
                         static_cast<std::int32_t>(!output.display.pattern.empty()) +
                         static_cast<std::int32_t>(!output.map_pattern.empty());
  if (plan.container.empty()) {
    plan.filter = resolved.job.settings.filter;
    plan.denoiser = plan.filter == "oidn" ? denoiser_description() : std::string();
  }
  if (plan.memory_mib == 0) {
    plan.memory_mib = memory_mib(resolved.job.settings, resolved.plan);
  }
  return plan;
}

void write_farm(const FarmPlan& plan, const std::vector<std::size_t>& chunks) {
  check_same_division(plan);
  std::error_code failed;
  for (const char* folder : {"tasks", "logs"}) {
    fs::create_directories(fs::path(plan.folder) / folder, failed);
  }
  if (failed) {
    throw Error(ErrorKind::input, plan.folder, "the folder cannot be made: " + failed.message(),
                "choose another output folder");
  }
  const FileLock alone = lock_farm(plan);
  forget_earlier(plan);
  for (const auto& [name, text] : farm_files(plan, chunks)) {
    write_text_atomically((fs::path(plan.folder) / name).string(), text);
  }
  write_text_atomically((fs::path(plan.folder) / "farm.json").string(), farm_plan_json(plan));
}

}  // namespace gazetrace
