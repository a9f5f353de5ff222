// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/command_tree.hpp"
#include "cli/exit_codes.hpp"
#include "cli/json_output.hpp"
#include "cli/option_reference.hpp"
#include "gazetrace/aovs.hpp"
#include "gazetrace/compare.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/headsets.hpp"
#include "gazetrace/job.hpp"

namespace gazetrace {
namespace {

struct ListArguments {
  std::string family;
  ColorSettings color;
  JsonOutput json;
  bool markdown = false;
};

struct Member {
  std::string name, description;
  nlohmann::ordered_json numbers = nlohmann::ordered_json::object();  // only --json has them
};

struct Family {
  std::string name;
  std::string option;  // the option that takes its names
  std::function<std::vector<Member>(const ListArguments&)> members;
};

template <class Infos>
std::vector<Member> members_of(const Infos& infos) {
  std::vector<Member> members;
  for (const auto& info : infos) {
    members.push_back({info.name, with_flags(info.description)});
  }
  return members;
}

std::vector<Member> screen_members(const ListArguments& /*arguments*/) {
  std::vector<Member> members;
  for (const NamedDisplay& display : named_displays()) {
    const DisplayGeometry& screen = display.geometry;
    const auto angle_deg = [&](double size_cm) { return 2 * std::atan2(size_cm / 2, screen.distance_cm) * kDegPerRad; };
    nlohmann::ordered_json numbers{{"width_px", screen.width_px},
                                   {"height_px", screen.height_px},
                                   {"width_cm", screen.width_cm},
                                   {"height_cm", screen.height_cm},
                                   {"distance_cm", screen.distance_cm},
                                   {"pixels_per_degree", pixels_per_degree(screen)},
                                   {"width_deg", angle_deg(screen.width_cm)},
                                   {"height_deg", angle_deg(screen.height_cm)}};
    if (screen.luminance_cd_m2 > 0) {
      numbers["luminance_cd_m2"] = screen.luminance_cd_m2;
    }
    for (const Headset& headset : headsets()) {
      if (headset.display == display.name) {
        numbers["headset"] = {{"model", headset.model},
                              {"pixels_per_degree_is", headset.density},
                              {"field_deg", nlohmann::ordered_json::array({headset.field_deg.x})},
                              {"rate_hz", headset.rate_hz},
                              {"source", headset.source}};
        if (headset.field_deg.y > 0) {
          numbers["headset"]["field_deg"].push_back(headset.field_deg.y);
        }
      }
    }
    members.push_back({display.name, with_flags(display.description), std::move(numbers)});
  }
  return members;
}

std::vector<Member> view_members(const ListArguments& arguments) {
  std::vector<Member> members;
  const ColorPipeline color(arguments.color);
  print_warnings(color.warnings());
  for (const ViewInfo& view : color.views()) {
    members.push_back({view.view, "on display '" + view.display + "'" + (view.is_default ? ", the default" : "")});
  }
  return members;
}

std::vector<Member> density_members(const ListArguments& /*arguments*/) {
  std::vector<Member> members;
  for (const DensityInfo& info : densities()) {
    std::string parameters;
    for (const NamedParameter& parameter : info.parameters) {
      parameters += fmt::format("{}{}={}", parameters.empty() ? "; " : " ", parameter.name,
                                parameter.words.empty() ? fmt::format("{:.4g}", parameter.value)
                                                        : fmt::format("{}", fmt::join(parameter.words, "|")));
    }
    members.push_back({info.name, info.description + parameters});
  }
  return members;
}

std::vector<Family> families() {
  return {
      {"samplings", "--sampling", [](const auto&) { return members_of(samplings()); }},
      {"densities", "--density", density_members},
      {"presets", "--preset",
       [](const auto&) {
         std::vector<Member> members;
         for (const Preset& preset : presets()) {
           std::string settings;
           for (const auto& [option, value] : preset.settings) {
             settings += fmt::format("{}{}={}", settings.empty() ? "" : " ", option, value);
           }
           members.push_back({preset.name, preset.description + ": " + settings});
         }
         return members;
       }},
      {"filters", "--filter", [](const auto&) { return members_of(reconstruction_filters()); }},
      {"gaze-formats", "gaze import --format",
       [](const auto&) {
         std::vector<Member> members;
         for (const GazeFormatInfo& format : gaze_formats()) {
           const bool real = format.proof == FormatProof::recording;
           members.push_back(
               {format.name, format.description +
                                 (real ? " (tried on a real recording)"
                                       : " (never tried on a real recording: on files made after its documentation)")});
         }
         return members;
       }},
      {"event-methods", "gaze events --method",
       [](const auto&) {
         std::vector<Member> members;
         for (const EventPreset& preset : event_presets()) {
           members.push_back({preset.name, fmt::format("{}: {}", to_string(preset.device), preset.description)});
         }
         return members;
       }},
      {"gaze-steps", "--gaze-process",
       [](const auto&) {
         std::vector<Member> members;
         for (const GazeStepInfo& info : gaze_steps()) {
           members.push_back({to_string(parse_gaze_step(info.name)), info.description});
         }
         return members;
       }},
      {"camera-formats", "--camera-format", [](const auto&) { return members_of(camera_formats()); }},
      {"material-extensions", "scene files", [](const auto&) { return members_of(material_extensions()); }},
      {"metrics", "--metrics", [](const auto&) { return members_of(comparison_metrics()); }},
      {"screens", "--screen", screen_members},
      {"views", "--view", view_members},
      {"aovs", "--aov", [](const auto&) { return members_of(aov_infos()); }},
  };
}

std::string family_text(const Family& family, const std::vector<Member>& members) {
  std::size_t width = 0;
  for (const Member& member : members) {
    width = std::max(width, member.name.size());
  }
  std::string text = fmt::format("{} ({})\n", family.name, family.option);
  for (const Member& member : members) {
    const std::string line = fmt::format("  {:<{}}  {}", member.name, width, member.description);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

// Longer than all families together, and so only where it is asked for.
constexpr const char* kOptions = "options";

int run_list(ListArguments arguments) {
  if (arguments.family == "falloffs") {  // understood for one version
    print_warnings({"'falloffs' are now 'samplings' and 'densities'"});
    arguments.family = "densities";
  }
  if (arguments.family == kOptions) {
    arguments.json.print(arguments.markdown ? options_as_markdown(job_schema()) : options_as_text(job_schema()),
                         [] { return options_as_json(job_schema()); });
    return exit_done;
  }
  if (arguments.markdown) {
    throw Error(ErrorKind::usage, "`markdown`", "only the options are written as a page",
                "gazetrace list options --markdown");
  }
  std::vector<std::string> known{kOptions};
  std::string text;
  nlohmann::ordered_json json;
  for (const Family& family : families()) {
    known.push_back(family.name);
    if (!arguments.family.empty() && arguments.family != family.name) {
      continue;
    }
    const std::vector<Member> members = family.members(arguments);
    text += (text.empty() ? "" : "\n") + family_text(family, members);
    json[family.name] = nlohmann::ordered_json::array();
    for (const Member& member : members) {
      json[family.name].push_back({{"name", member.name}, {"description", member.description}});
      json[family.name].back().update(member.numbers);
    }
  }
  if (text.empty()) {
    throw Error(ErrorKind::usage, "list", unknown_name_message("family", arguments.family, known));
  }
  arguments.json.print(text, [&] { return json.dump(2) + "\n"; });
  return exit_done;
}

}  // namespace

std::vector<std::string> names_of_option(const std::string& flag) {
  std::vector<std::string> names;
  for (const Family& family : families()) {
    const bool takes = family.option == flag || family.option.ends_with(" " + flag);  // "gaze events --method"
    if (takes && flag != "--view") {
      for (const Member& member : family.members({})) {
        names.push_back(member.name.substr(0, member.name.find_first_of(": ")));
      }
    }
  }
  return names;
}

Command add_list_command(CLI::App& app, const Invocation& /*invocation*/) {
  auto arguments = std::make_shared<ListArguments>();
  std::string names;
  for (const Family& family : families()) {
    names += (names.empty() ? "" : "|") + family.name;
  }
  app.add_option("family", arguments->family, "The list to print; default: all but options")
      ->type_name(names + "|" + kOptions);
  const auto options = std::make_shared<CommandOptions<ColorSettings>>(
      color_config_schema().with_headings([](const Option&) { return "Options"; }));
  options->bind(app, arguments->color);
  app.add_flag("--markdown", arguments->markdown, "Of options: a page of the manual");
  add_json_option(app, arguments->json);
  return {[arguments, options] { return run_list(*arguments); }, {}};
}

}  // namespace gazetrace
