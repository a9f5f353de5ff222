// SPDX-License-Identifier: Apache-2.0
#include "cli/presets.hpp"

#include <algorithm>

#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

// "Foveated Path Tracing with Configurable Sampling and Block-Based Rendering", as far as the paper says.
Settings paper_settings(const std::string& angle_reading) {
  return {{"falloff", "regions"},   {"region-samples", "32,16,8"},
          {"region-blocks", "2,4"}, {"region-angles", "5.2,17"},
          {"region-shape", "disc"}, {"angle-reading", angle_reading},
          {"sample-unit", "block"}, {"border-blend-deg", "0"},
          {"filter", "linear"},     {"accumulate", "off"},
          {"bounces", "3"},         {"russian-roulette", "false"},
          {"diffuse", "burley"},    {"light-sampling", "mis"},
          {"pixel-filter", "box"},  {"clamp-indirect", "0"},
          {"exposure", "auto"},     {"view", "Reinhard"}};
}

const Preset* find_preset(const std::string& name) {
  const auto found =
      std::find_if(presets().begin(), presets().end(), [&](const Preset& preset) { return preset.name == name; });
  return found == presets().end() ? nullptr : &*found;
}

const Preset& preset_by_name(const std::string& name, const std::string& place) {
  const Preset* preset = find_preset(name);
  if (preset == nullptr) {
    std::vector<std::string> known;
    for (const Preset& p : presets()) {
      known.push_back(p.name);
    }
    throw Error(ErrorKind::usage, place, unknown_name_message("preset", name, known));
  }
  return *preset;
}

}  // namespace

const std::vector<Preset>& presets() {
  static const std::vector<Preset> table{
      {"paper", "the source paper, its angles as diameters: the reading that fits its timings",
       paper_settings("full-angle")},
      {"paper-radius", "the source paper, its angles as eccentricities", paper_settings("eccentricity")},
      {"default",
       "what is taken when nothing is said",
       {{"falloff", "regions"},
        {"region-samples", "32,16,8"},
        {"region-blocks", "2,4"},
        {"region-angles", "5.2,17"},
        {"region-shape", "cone"},
        {"angle-reading", "full-angle"},
        {"sample-unit", "block"},
        {"border-blend-deg", "0"},
        {"filter", "auto"},
        {"accumulate", "off"}}},
      {"reference",
       "what others are compared with: uniform at a high rate, every pixel by itself",
       {{"falloff", "uniform"},
        {"spp", "1024"},
        {"filter", "none"},
        {"accumulate", "off"},
        {"clamp-indirect", "0"},
        {"exr-pixels", "float"}}},
  };
  return table;
}

void add_preset_option(OptionTable& table, std::string& name) {
  table.group("Presets");
  table.value("--preset", name, "NAME", "A named list of settings, below all other options ('gazetrace list presets')");
  OptionEntry& entry = table.last();
  entry.assign = [&table, &name](const std::vector<std::string>& values, const std::string& place) {
    const Preset& preset = preset_by_name(values.at(0), place);
    name = preset.name;
    for (const auto& [option, value] : preset.settings) {
      const OptionEntry* target = table.find(option);
      if (target != nullptr && !*target->given) {
        target->assign_default({value}, place);
      }
    }
  };
  entry.check = [](const std::vector<std::string>& values, const std::string& place) {
    (void)preset_by_name(values.at(0), place);
  };
}

}  // namespace gazetrace
