// SPDX-License-Identifier: Apache-2.0
#include "gazetrace/job.hpp"

#include <algorithm>

#include "gazetrace/error.hpp"
#include "job/preset_by_name.hpp"

namespace gazetrace {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

// "Foveated Path Tracing with Configurable Sampling and Block-Based Rendering", as far as the paper says.
Settings paper_settings(const std::string& sampling, const std::string& eccentricities) {
  return {{"sampling", sampling},   {"region-samples", "32,16,8"},
          {"region-blocks", "2,4"}, {"region-eccentricities", eccentricities},
          {"filter", "linear"},     {"accumulate", "off"},
          {"bounces", "3"},         {"russian-roulette", "false"},
          {"diffuse", "burley"},    {"light-sampling", "mis"},
          {"guiding", "false"},     {"pixel-filter", "box"},
          {"clamp-indirect", "0"},  {"exposure", "auto"},
          {"view", "Reinhard"}};
}

}  // namespace

const std::vector<Preset>& presets() {
  static const std::vector<Preset> table{
      {"paper", "the source paper, its angles as diameters: the reading that fits its timings",
       paper_settings("regions:shape=disc", "2.6,8.5")},
      {"paper-radius", "the source paper, its angles as eccentricities",
       paper_settings("regions:shape=disc-by-radius", "5.2,17")},
      {"default",
       "the defaults of a run without a stated quality",
       {{"density", "acuity"}, {"filter", "auto"}, {"accumulate", "auto"}}},
      {"reference",
       "for comparison with others: uniform at a high rate, every pixel by itself",
       {{"sampling", "uniform"},
        {"spp", "1024"},
        {"filter", "none"},
        {"accumulate", "off"},
        {"clamp-indirect", "0"},
        {"guiding", "false"},
        {"exr-pixels", "float"}}},
  };
  return table;
}

const Preset& preset_by_name(const std::string& name, const std::string& place) {
  const auto found =
      std::find_if(presets().begin(), presets().end(), [&](const Preset& preset) { return preset.name == name; });
  if (found == presets().end()) {
    std::vector<std::string> known;
    for (const Preset& preset : presets()) {
      known.push_back(preset.name);
    }
    throw Error(ErrorKind::usage, place, unknown_name_message("preset", name, known));
  }
  return *found;
}

}  // namespace gazetrace
