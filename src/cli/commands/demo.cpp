// SPDX-License-Identifier: Apache-2.0
// The shipped example, or a job of one's own, from end to end by the program's own commands, which are printed so that
// they can be repeated.
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/demo_measurement.hpp"
#include "cli/exit_codes.hpp"
#include "cli/external_program.hpp"
#include "cli/json_output.hpp"
#include "cli/own_program.hpp"
#include "cli/progress.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/job.hpp"

extern char** environ;

namespace gazetrace {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

struct DemoArguments {
  std::string folder = "gazetrace-demo", data, config;
  std::string frames, size;
  bool overwrite = false, without_sweep = false;
  JsonOutput json;
};

// The folder that holds examples/, scenes/ and gazelogs/: share/gazetrace of an installation, the repository of a
// build.
fs::path find_data(const std::string& given) {
  const auto holds_it = [](const fs::path& folder) {
    std::error_code ignored;
    return fs::is_regular_file(folder / "examples" / "example.toml", ignored);
  };
  if (!given.empty()) {
    if (!holds_it(given)) {
      throw Error(ErrorKind::input, given, "holds no examples/example.toml", "name the folder of examples and scenes");
    }
    return given;
  }
  for (fs::path folder = own_program().parent_path(); folder != folder.parent_path(); folder = folder.parent_path()) {
    for (const fs::path& place : {folder / "share" / "gazetrace", folder}) {
      if (holds_it(place)) {
        return place;
      }
    }
  }
  if (holds_it(".")) {
    return ".";
  }
  throw Error(ErrorKind::input, "demo", "the example's scene and gaze are not beside the program",
              "give `data` with the folder that holds examples/ and scenes/");
}

// Runs the program itself with these words. A code other than 0 ends the demo with the same code.
int run_step(const char* what, const Words& words) {
  std::fprintf(stderr, "\n== %s\n   gazetrace %s\n", what, fmt::format("{}", fmt::join(words, " ")).c_str());
  std::fflush(nullptr);
  const std::string program = own_program().string();
  std::vector<char*> pointers{const_cast<char*>(program.c_str())};  // NOLINT: as posix_spawn takes them
  for (const std::string& word : words) {
    pointers.push_back(const_cast<char*>(word.c_str()));  // NOLINT
  }
  pointers.push_back(nullptr);
  pid_t child = 0;
  if (const int problem = posix_spawn(&child, program.c_str(), nullptr, nullptr, pointers.data(), environ);
      problem != 0) {
    throw Error(ErrorKind::runtime, program, std::string("cannot be started: ") + std::strerror(problem));
  }
  int state = 0;
  while (waitpid(child, &state, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(state) ? WEXITSTATUS(state) : static_cast<int>(exit_interrupted);
}

struct Step {
  const char* what;
  Words words;
  bool may_fail = false;  // the demo is worth its time without
};

// A rendering of some frames of the job into a folder of the demo.
Words render_words(const DemoArguments& arguments, const std::string& config, const std::string& frames,
                   const char* name, const Words& more) {
  const std::string pattern = (fs::path(arguments.folder) / name / "frame.####").string();
  Words words{"render", "--config", config, "--overwrite", "-o", pattern + ".exr", "-o", pattern + ".png"};
  if (!frames.empty()) {
    words.insert(words.end(), {"--frames", frames});
  }
  if (!arguments.size.empty()) {
    words.insert(words.end(), {"--size", arguments.size});
  }
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// `wall_s`, `samples` and `pixels` of a run that wrote its summary there.
FirstFrame first_frame_of(const std::string& summary) {
  std::ifstream file(summary);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object() || json.value("pixels", 0.0) <= 0) {
    throw Error(ErrorKind::runtime, summary, "the first frame left no summary",
                "start the demo again with --overwrite");
  }
  return {json.value("samples", 0.0) / json.value("pixels", 0.0), json.value("wall_s", 0.0)};
}

std::vector<Step> steps_of(const DemoArguments& arguments, const std::string& config, const std::string& frames,
                           const std::string& plan, const FirstFrame& first, bool has_ffmpeg) {
  const fs::path folder(arguments.folder);
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::vector<Step> steps{
      {"Frames that are sampled where the eye looked", render_words(arguments, config, frames, "foveated", {})},
      {"The same frames with the same number of samples, spread evenly",
       render_words(arguments, config, frames, "uniform",
                    {"--sampling", "uniform", "--spp", fmt::format("{:.3g}", first.spp)})},
  };
  if (has_ffmpeg) {
    steps.push_back({"A video of them",
                     {"video", in("foveated/frame.####.png"), "-o", in("foveated.mp4"), "--labels",
                      "sampled where the eye looked", "--overwrite"}});
    steps.push_back(
        {"Both beside each other: spread evenly on the left, where the eye looked (ring) on the right",
         {"video", in("uniform/frame.####.exr"), in("foveated/frame.####.exr"), "-o", in("side-by-side.mp4"),
          "--show-gaze", "--insets", "--labels", "spread evenly,where the eye looked", "--overwrite"}});
  }
  if (arguments.without_sweep) {
    return steps;
  }
  Words sweep{"sweep", plan, "-o", in("sweep")};
  if (arguments.overwrite) {
    sweep.emplace_back("--restart");
  }
  steps.push_back({"A small measurement: foveated beside uniform sampling of the same cost", sweep});
  steps.push_back({"A page on it", {"report", in("sweep"), "-o", in("report.html"), "--overwrite"}, true});
  return steps;
}

int run_demo(const DemoArguments& arguments) {
  const fs::path folder(arguments.folder);
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::error_code ignored;
  if (fs::is_regular_file(folder, ignored)) {
    throw Error(ErrorKind::input, arguments.folder, "this is a file, and results go into a folder",
                "settings of your own are given by --config");
  }
  if (!arguments.overwrite && fs::exists(folder, ignored) && !fs::is_empty(folder, ignored)) {
    throw Error(ErrorKind::input, arguments.folder, "this folder is there already",
                "give --overwrite or another folder");
  }
  arguments.json.check();
  const bool is_own = !arguments.config.empty();
  const fs::path data = is_own ? fs::path() : find_data(arguments.data);
  const std::string config = is_own ? arguments.config : (data / "examples" / "example.toml").string();
  const std::string frames = arguments.frames.empty() && !is_own ? "1-24" : arguments.frames;
  const std::string plan = is_own ? in("measurement.toml") : (data / "examples" / "demo.toml").string();
  const bool has_ffmpeg = find_on_path("ffmpeg").has_value();
  const auto begin = std::chrono::steady_clock::now();
  const Job job = load_job(config);
  const std::string middle = std::to_string(middle_frame(job, frames));
  if (const int code = run_step("One frame, to see how long all will take",
                                render_words(arguments, config, middle, "first",
                                             {"--accumulate-past", "0s", "--accumulate-future", "0s", "--json",
                                              in("first.json"), "--quiet"}));
      code != exit_done) {
    return code;
  }
  const FirstFrame first = first_frame_of(in("first.json"));
  const double sweep_s = arguments.without_sweep ? 0 : is_own ? own_sweep_s(job, first) : shipped_sweep_s(first);
  std::fputs(estimate_text(job, frames, first, sweep_s).c_str(), stderr);
  if (is_own && !arguments.without_sweep) {
    std::ofstream(plan) << measurement_of(job, middle);
  }
  double first_picture_s = 0;
  bool has_page = !arguments.without_sweep;
  for (const Step& step : steps_of(arguments, config, frames, plan, first, has_ffmpeg)) {
    if (const int code = run_step(step.what, step.words); code != exit_done) {
      if (!step.may_fail || code == exit_interrupted) {
        return code;
      }
      has_page = false;
    }
    const double now_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    first_picture_s = first_picture_s > 0 ? first_picture_s : now_s;
  }
  const double all_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::vector<std::pair<std::string, std::string>> made{{"frames", in("foveated/frame.####.png")}};
  if (has_ffmpeg) {
    made.emplace_back("video", in("foveated.mp4"));
    made.emplace_back("side by side", in("side-by-side.mp4"));
  }
  if (!arguments.without_sweep) {
    made.emplace_back("measurement", in("sweep/results.csv"));
  }
  if (has_page) {
    made.emplace_back("report", in("report.html"));
  }
  std::string text =
      fmt::format("Done in {} (frames after {}). Look at:\n", duration_text(all_s), duration_text(first_picture_s));
  nlohmann::ordered_json json{{"seconds", all_s}, {"first_frames_s", first_picture_s}};
  for (const auto& [name, path] : made) {
    text += fmt::format("  {:<14}{}\n", name, path);
    json[name] = path;
  }
  if (!has_ffmpeg) {
    text += "No video was made: there is no ffmpeg on the PATH.\n";
  }
  arguments.json.print(text, [&] { return json.dump(2) + "\n"; });
  return exit_done;
}

}  // namespace

Command add_demo_command(CLI::App& app, const Invocation& /*invocation*/) {
  const auto arguments = std::make_shared<DemoArguments>();
  app.add_option("folder", arguments->folder, "Where everything goes")->type_name("DIR")->capture_default_str();
  app.add_option("--data", arguments->data,
                 "The folder that holds examples/, scenes/ and gazelogs/; default: that of the installation or the "
                 "repository")
      ->type_name("DIR");
  app.add_option("--frames", arguments->frames, "Which frames; default: 1-24 of the example, those of --config")
      ->type_name("LIST");
  app.add_option("--size", arguments->size, "Their size; default: that of the example or of --config")
      ->type_name("WxH");
  app.add_flag("--no-sweep", arguments->without_sweep, "Leaves out the measurement and its report");
  app.add_flag("--overwrite", arguments->overwrite, "Replaces an earlier demo in the folder");
  add_json_option(app, arguments->json, arguments->overwrite);
  app.footer(
      std::string("--config FILE takes a job of your own in place of the example: settings of 'gazetrace render' "
                  "with scene and gaze.\n") +
      kExitCodesHelp);
  return {[arguments] { return run_demo(*arguments); },
          [arguments](const std::string& path) { arguments->config = path; }};
}

}  // namespace gazetrace
