// SPDX-License-Identifier: Apache-2.0
// What foveation itself gains, apart from what a filter gains: every density against uniform rendering through
// the same filter.
//   gazetrace_foveation_gain SCENE.gltf=SKY.hdr [--eye X,Y,Z --target X,Y,Z --fov DEG] --reference A.exr,B.exr,...
//       --csv FILE [--size 960x540] [--budget 1] [--models all] [--filters none,linear,guided]
//       [--gaze U,V ...] [--fixations LOG.csv:COUNT:SEED] [--seeds 1] [--ev E] [--metrics relmse,flip,fovvideovdp]
//       [--clip FRAMES]
//   gazetrace_foveation_gain ... --times ROUNDS
//   gazetrace_foveation_gain --tables FILE.csv [FILE.csv ...] [--full FILE.md]
// The first form appends to the CSV file what it lacks of the scene's errors, an arm a row; the second the times, which
// need a quiet machine; the third reads the rows of all scenes and prints tables. Without --gaze it looks at the
// centre, 10 degrees right of it, at the edge and into the corner, and at the fixations drawn.
//
// The frame fills the paper's display (70.848 x 39.852 cm at 60 cm). Every model is scaled to --budget samples a pixel;
// cut-off frequencies count relative to the fovea. Its rivals go through the same filter:
//   equal samples   uniform with as many samples in all (fractional counts)
//   equal time      what uniform would reach in the time of the model's plan, guides, trace, reconstruction and
//                   accumulation: the logarithm of its errors (JOD as they are), between rates of 0.25 to 2.8 budgets,
//                   linear in the logarithm of their times
//   low resolution  uniform with as many samples in all in a frame of half the width and height, enlarged bilinearly
//   in blocks       uniform with as many samples in all in blocks of 8 samples and more, as models have them in the
//                   periphery: what a filter does to a single pixel with a sample is not what it does to a block
// With --clip every picture is the last of so many frames at rest, each of --budget samples a pixel ("paper"
// and "foveal rate" of their own), for models and rivals alike: the mean of their pictures. Times are
// those of a frame, by the mean. Models and rivals share no samples, nor do gazes. The reference is the mean of the
// files, each of a seed of its own;
// --ev, by default what brings its log-average luminance to 0.18, is the exposure. relMSE (the library's) is that of
// linear light at the exposure; FLIP and FovVideoVDP see the plain sRGB view in 8 bits. The floor is the score of one
// half of the files against the other: nothing beneath it is claimed (*). Tables take off relMSE what the reference's
// own noise adds: the error of one half against the mean of both. "paper" is 32 / 16 / 8 with its own count, "foveal
// rate" uniform with 32: the fovea of both must score the same, unless the filter smooths uniform frames of any rate.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "benchmark_main.hpp"
#include "foveation_gain/study.hpp"
#include "foveation_gain/tables.hpp"
#include "gazetrace/error.hpp"
#include "pixel_statistics.hpp"
#include "support/sampling_models.hpp"

namespace {

using namespace gazetrace;

constexpr const char* kAdvice = "read the head of foveation_gain.cpp";

bool is_option(const char* text) {
  return std::string_view(text).substr(0, 2) == "--";
}

template <class Info>
std::vector<std::string> names_of(const std::vector<Info>& family) {
  std::vector<std::string> names(family.size());
  std::transform(family.begin(), family.end(), names.begin(), [](const Info& info) { return info.name; });
  return names;
}

void check_names(const char* option, const std::vector<std::string>& given, const std::vector<std::string>& known) {
  for (const std::string& name : given) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw Error(ErrorKind::usage, option, unknown_name_message("name", name, known));
    }
  }
}

struct Arguments {
  gain::StudySettings study;
  std::vector<std::string> table_files;
  std::string full;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  gain::StudySettings& study = arguments.study;
  std::optional<Vec3d> eye;
  std::optional<Vec3d> target;
  double fov_deg = 50;
  std::vector<gain::Gaze> fixations;
  for (int i = 1; i < argc;) {
    const std::string_view name = argv[i++];
    if (name.substr(0, 2) != "--") {
      study.scene = name;
      continue;
    }
    std::vector<const char*> values;
    do {
      values.push_back(i < argc ? argv[i++] : "");
    } while ((name == "--gaze" || name == "--tables") && i < argc && !is_option(argv[i]));
    const char* value = values[0];
    if (name == "--eye") {
      eye = benchmark::parse_point(value);
    } else if (name == "--target") {
      target = benchmark::parse_point(value);
    } else if (name == "--fov") {
      fov_deg = std::strtod(value, nullptr);
    } else if (name == "--reference") {
      study.reference = benchmark::parse_names(value);
    } else if (name == "--size") {
      study.size = benchmark::parse_size(value);
    } else if (name == "--budget") {
      study.spp = std::strtod(value, nullptr);
    } else if (name == "--models") {
      study.models = std::string_view(value) == "all" ? std::vector<std::string>{} : benchmark::parse_names(value);
    } else if (name == "--filters") {
      study.filters = benchmark::parse_names(value);
    } else if (name == "--metrics") {
      study.metrics = benchmark::parse_names(value);
    } else if (name == "--gaze") {
      for (const char* text : values) {
        const std::vector<double> at = benchmark::parse_numbers(text);
        if (at.size() != 2) {
          throw Error(ErrorKind::usage, name, fmt::format("'{}' is no place", text), "write it as 0.5,0.5");
        }
        study.gazes.push_back({fmt::format("at {:.4g} {:.4g}", at[0], at[1]), {at[0], at[1]}});
      }
    } else if (name == "--fixations") {
      fixations = gain::drawn_fixations(value);
    } else if (name == "--seeds") {
      study.seeds = std::atoi(value);
    } else if (name == "--ev") {
      study.ev = std::strtod(value, nullptr);
    } else if (name == "--csv") {
      study.csv = value;
    } else if (name == "--clip") {
      study.clip_frames = std::max(std::atoi(value), 1);
    } else if (name == "--times") {
      study.time_rounds = std::atoi(value);
    } else if (name == "--tables") {
      arguments.table_files.assign(values.begin(), values.end());
    } else if (name == "--full") {
      arguments.full = value;
    } else {
      throw Error(ErrorKind::usage, name, "unknown option", kAdvice);
    }
  }
  if (eye && target) {
    study.viewpoint = {*eye, *target, fov_deg};
  }
  check_names("--models", study.models, all_models());
  check_names("--filters", study.filters, names_of(reconstruction_filters()));
  check_names("--metrics", study.metrics, {gain::kMetricNames.begin(), gain::kMetricNames.end()});
  if (study.gazes.empty()) {
    study.gazes = gain::gaze_grid();
  }
  study.gazes.insert(study.gazes.end(), fixations.begin(), fixations.end());
  return arguments;
}

int run(int argc, char** argv) {
  const Arguments arguments = parse(argc, argv);
  if (!arguments.table_files.empty()) {
    gain::print_tables(arguments.table_files, arguments.full);
    return 0;
  }
  if (arguments.study.scene.empty() || arguments.study.csv.empty()) {
    throw Error(ErrorKind::usage, "", "a scene and --csv are needed", kAdvice);
  }
  gain::run_study(arguments.study);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return gazetrace::benchmark::benchmark_main(run, argc, argv);
}
