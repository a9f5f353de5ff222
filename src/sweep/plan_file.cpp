// SPDX-License-Identifier: Apache-2.0
#include "sweep/plan_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "gazetrace/error.hpp"
#include "gazetrace/sweep_plan.hpp"
#include "job/settings_paths.hpp"
#include "job/toml_tree.hpp"
#include "job/toml_values.hpp"

namespace gazetrace {
namespace {

constexpr const char* kScale = "resolution-scale";
constexpr const char* kAuto = "auto";  // as many samples as a reference needs
constexpr std::array kTables{"title",   "common",    "scene",     "gaze",   "grid",
                             "setting", "published", "reference", "measure"};
// Options that decide the scene and its tree, and may therefore not differ between two rows of one scene.
bool is_of_scene(const Option& option) {
  return option.touches.has(Touch::scene) || option.touches.has(Touch::light) || option.touches.has(Touch::speed);
}

[[noreturn]] void refuse(const std::string& place, const std::string& problem, const std::string& remedy = {}) {
  throw Error(ErrorKind::input, place, problem, remedy);
}

// The options of `render` that a plan may give.
class RenderOptions {
 public:
  explicit RenderOptions(const JobSchema& schema) : options_(schema.list()) {}

  [[nodiscard]] const Option& find(const std::string& name) const { return *find_option(options_, name); }
  // The names of those that decide whose gaze is used.
  [[nodiscard]] std::vector<std::string> gaze_sources() const {
    std::vector<std::string> names;
    for (const Option* option : options_) {
      if (option->is(Trait::gaze_source)) {
        names.push_back(option->name);
      }
    }
    return names;
  }
  // Adds what a key sets, as text that its options take. `also`: keys that are known beside the options.
  // `given`: what stands in the same table.
  void add(const std::string& key, const TomlNode& node, const std::string& path, const std::vector<std::string>& also,
           const std::vector<OptionText>& given, std::vector<Assignment>& assignments) const {
    const std::string place = toml_place(path, node);
    std::vector<Option> others(also.size());
    OptionList known = options_;
    for (std::size_t i = 0; i < also.size(); ++i) {
      others[i].name = also[i];
      known.push_back(&others[i]);
    }
    const std::vector<TomlSetting> settings =
        toml_settings(key, node, given, known, path, "'gazetrace render --print-config' lists every option");
    if (settings.empty() && find_former_option(key, {}) == nullptr) {
      refuse(place, fmt::format("'{}' is empty", key), "give a value, or leave it out");
    }
    for (const TomlSetting& setting : settings) {
      if (!is_allowed(find(setting.name))) {
        refuse(place, fmt::format("'{}' has no place in a sweep", key), "leave it out");
      }
      assignments.push_back({setting.name, setting.values, place, setting.warning, setting.former});
    }
  }

 private:
  // A sweep has files of its own, and each of its frames is complete.
  static bool is_allowed(const Option& option) { return !option.is(Trait::one_run); }

  OptionList options_;
};

// The tables with keys of their own, as options: [measure], [reference].
template <class S>
void read_table(const OptionSchema<S>& schema, const TomlNode& node, S& settings, SweepFile& file) {
  const std::string& path = file.path;
  for (const auto& [key, value] : node.members) {
    const std::string place = toml_place(path, value);
    const OptionOf<S>* option = schema.find(key);
    if (option == nullptr) {
      refuse(place, unknown_among_many("key", key, names_of(schema.list())));
    }
    try {
      option->assign(settings, toml_values(value, *option, path), key);
    } catch (const Error& error) {
      throw Error(ErrorKind::input, place, error.what());
    }
    file.places[key] = place;
  }
}

const TomlNode& checked_kind(const TomlNode& node, TomlNode::Kind kind, const std::string& path,
                             const std::string& what) {
  if (node.kind != kind) {
    refuse(toml_place(path, node), what);
  }
  return node;
}

std::vector<const TomlNode*> tables_of(const TomlNode& root, const std::string& name, const std::string& path) {
  std::vector<const TomlNode*> tables;
  if (const TomlNode* list = root.find(name)) {
    const std::string wish = fmt::format("'{0}' is a list of tables; write [[{0}]]", name);
    for (const TomlNode& item : checked_kind(*list, TomlNode::Kind::array, path, wish).items) {
      tables.push_back(&checked_kind(item, TomlNode::Kind::table, path, wish));
    }
  }
  return tables;
}

// [[scene]] and [[gaze]]: a name, short names of some options, and any other options.
std::vector<SweepFileScene> read_named(const TomlNode& root, const std::string& name, const RenderOptions& options,
                                       const std::map<std::string, std::string>& short_names,
                                       const std::vector<std::string>& needed, const std::string& path) {
  std::vector<SweepFileScene> result;
  for (const TomlNode* table : tables_of(root, name, path)) {
    SweepFileScene one;
    one.place = toml_place(path, *table);
    const std::vector<OptionText> given = given_in(*table, path);
    std::vector<std::string> also{"name"};
    for (const auto& [short_name, option] : short_names) {
      also.push_back(short_name);
    }
    for (const auto& [key, value] : table->members) {
      if (key == "name") {
        one.name = toml_scalar(value, path);
        continue;
      }
      const auto found = short_names.find(key);
      options.add(found == short_names.end() ? key : found->second, value, path, also, given, one.options);
    }
    if (one.name.empty() || one.name.find('/') != std::string::npos) {
      refuse(one.place, fmt::format("a [[{}]] needs a name without slashes", name), "add name = \"...\"");
    }
    if (std::any_of(result.begin(), result.end(), [&](const auto& other) { return other.name == one.name; })) {
      refuse(one.place, fmt::format("there are two [[{}]] named '{}'", name, one.name));
    }
    const auto is_given = [&](const std::string& option) {
      return std::any_of(one.options.begin(), one.options.end(), [&](const auto& o) { return o.option == option; });
    };
    if (std::none_of(needed.begin(), needed.end(), is_given)) {
      refuse(one.place, name == "scene" ? "this [[scene]] has no file" : "this [[gaze]] looks nowhere",
             name == "scene" ? "add path = \"scene.gltf\"" : "add log = \"FILE\" or at = [0.5, 0.5]");
    }
    result.push_back(std::move(one));
  }
  return result;
}

double read_scale(const TomlNode& node, const std::string& path) {
  double scale = 0;
  try {
    parse_value(toml_scalar(node, path), kScale, scale);
  } catch (const Error& error) {
    throw Error(ErrorKind::input, toml_place(path, node), error.what());
  }
  if (!(scale > 0 && scale <= 1)) {
    refuse(toml_place(path, node), fmt::format("{}: {} is outside 0..1", kScale, scale));
  }
  return scale;
}

void add_option(const std::string& key, const TomlNode& node, const std::vector<OptionText>& given,
                const RenderOptions& options, const std::string& path, SweepFileSetting& setting) {
  const std::string place = toml_place(path, node);
  if (key == kScale) {
    setting.resolution_scale = read_scale(node, path);
    return;
  }
  std::vector<Assignment> added;
  options.add(key, node, path, {kScale}, given, added);
  for (Assignment& assignment : added) {
    const Option& option = options.find(assignment.option);
    if (is_of_scene(option) || option.is(Trait::gaze_source)) {
      refuse(place, fmt::format("'{}' does not vary between the rows of a scene", key),
             option.is(Trait::gaze_source) ? "give it in a [[gaze]]" : "give it in [common] or a [[scene]]");
    }
    setting.options.push_back(std::move(assignment));
  }
}

std::string label_of(const SweepFileSetting& setting) {
  std::string text = setting.label;
  for (const Assignment& option : setting.options) {
    if (setting.label.empty()) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", option.option, fmt::join(option.values, ";"));
    }
  }
  if (setting.resolution_scale != 1) {
    text += fmt::format("{}{} {:g}", text.empty() ? "" : ", ", kScale, setting.resolution_scale);
  }
  return text;
}

constexpr std::size_t kMostSettings = 100'000;  // a few lists of a few values would fill any memory

std::vector<SweepFileSetting> read_settings(const TomlNode& root, const RenderOptions& options,
                                            const std::string& path) {
  std::vector<SweepFileSetting> settings;
  for (const TomlNode* table : tables_of(root, "setting", path)) {
    SweepFileSetting setting;
    setting.place = toml_place(path, *table);
    for (const auto& [key, value] : table->members) {
      if (key == "label") {
        setting.label = toml_scalar(value, path);
      } else {
        add_option(key, value, given_in(*table, path), options, path, setting);
      }
    }
    setting.label = label_of(setting);
    settings.push_back(std::move(setting));
  }
  const TomlNode* grid = root.find("grid");
  if (grid == nullptr) {
    return settings;
  }
  checked_kind(*grid, TomlNode::Kind::table, path, "'grid' is a table of lists; write [grid]");
  if (settings.empty()) {
    settings.emplace_back();
    settings.back().place = toml_place(path, *grid);
  }
  for (const auto& [key, values] : grid->members) {
    const std::string wish = fmt::format("'{}' in [grid] is a list of the values to try", key);
    checked_kind(values, TomlNode::Kind::array, path, wish);
    if (values.items.empty()) {
      refuse(toml_place(path, values), wish + ", and it is empty");
    }
    if (settings.size() * values.items.size() > kMostSettings) {
      refuse(toml_place(path, values), fmt::format("[grid] has more than {} combinations", kMostSettings),
             "give fewer values, or several plans");
    }
    std::vector<SweepFileSetting> combined;
    for (const SweepFileSetting& setting : settings) {
      for (const TomlNode& value : values.items) {
        SweepFileSetting alone;
        add_option(key, value, {}, options, path, alone);
        SweepFileSetting both = setting;
        both.options.insert(both.options.end(), alone.options.begin(), alone.options.end());
        both.resolution_scale *= alone.resolution_scale;
        both.label += (both.label.empty() ? "" : ", ") + label_of(alone);
        combined.push_back(std::move(both));
      }
    }
    settings = std::move(combined);
  }
  return settings;
}

void read_published(const TomlNode& root, SweepFile& file) {
  for (const TomlNode* node : tables_of(root, "published", file.path)) {
    SweepFilePublished one;
    OptionSchema<SweepFilePublished> schema;
    schema.value("--scene", &SweepFilePublished::scene, "NAME", "");
    schema.value("--setting", &SweepFilePublished::setting, "LABEL", "");
    schema.value("--speed-up", &SweepFilePublished::speed_up, "RATIO", "");
    schema.value("--source", &SweepFilePublished::source, "TEXT", "");
    read_table(schema, *node, one, file);
    one.place = toml_place(file.path, *node);
    const auto& settings = file.settings;
    if (std::none_of(settings.begin(), settings.end(), [&](const auto& s) { return s.label == one.setting; })) {
      refuse(one.place, fmt::format("there is no setting with the label '{}'", one.setting));
    }
    if (std::none_of(file.scenes.begin(), file.scenes.end(), [&](const auto& s) { return s.name == one.scene; })) {
      refuse(one.place, fmt::format("there is no scene '{}'", one.scene));
    }
    file.published.push_back(std::move(one));
  }
}

void read_reference(const TomlNode& root, const RenderOptions& options, SweepFile& file) {
  const TomlNode* table = root.find("reference");
  if (table == nullptr) {
    return;
  }
  if (table->kind == TomlNode::Kind::scalar && table->text == kAuto) {
    file.reference.is_auto = true;
    return;
  }
  checked_kind(*table, TomlNode::Kind::table, file.path,
               "'reference' is a table or \"auto\"; write [reference], or reference = \"auto\" at the top");
  OptionSchema<SweepFileReference> own;
  own.value("--scramblings", &SweepFileReference::scramblings, "N", "");
  own.value("--seed", &SweepFileReference::seed, "N", "");
  own.value("--most-spp", &SweepFileReference::most_spp, "SPP", "");
  own.flag("--go-on", &SweepFileReference::go_on, "");
  for (const auto& [key, value] : table->members) {
    if (key == "spp" && value.kind == TomlNode::Kind::scalar && value.text == kAuto) {
      file.reference.is_auto = true;
    } else if (own.find(key) != nullptr) {
      TomlNode alone;
      alone.members.push_back({key, value});
      read_table(own, alone, file.reference, file);
    } else {
      options.add(key, value, file.path, names_of(own.list()), given_in(*table, file.path), file.reference.options);
    }
  }
  if (file.reference.scramblings < 4 || file.reference.scramblings % 2 != 0 || file.reference.scramblings > 1024) {
    refuse(file.places["scramblings"],
           fmt::format("{} scramblings do not make two halves of at least two each", file.reference.scramblings),
           "give an even number from 4 on");
  }
  if (!(file.reference.most_spp >= 1 && file.reference.most_spp <= 1e9)) {
    refuse(file.places["most-spp"], fmt::format("{} samples a pixel are no bound", file.reference.most_spp),
           "give a number from 1 on");
  }
}

void check_names(const std::vector<std::string>& given, const std::vector<std::string>& known, const std::string& what,
                 const std::string& place) {
  for (const std::string& name : given) {
    if (!is_among(known, name)) {
      refuse(place, unknown_name_message(what, name, known));
    }
  }
}

// What the metrics are told of the display, and of themselves.
void check_viewing(SweepFile& file) {
  const ComparisonSettings& settings = file.measure.compare.settings;
  const DisplayPhotometry& display = settings.photometry;
  const auto check = [&](const char* key, double value, bool is_right, const char* wish) {
    if (!std::isfinite(value) || !is_right) {
      refuse(file.places[key], fmt::format("{}: {} is {}", key, value, wish));
    }
  };
  check("peak-cd-m2", display.peak_cd_m2, display.peak_cd_m2 > 0, "no luminance above 0");
  check("contrast", display.contrast, display.contrast > 1, "no ratio above 1");
  check("ambient-lux", display.ambient_lux, display.ambient_lux >= 0, "no illuminance from 0 on");
  check("reflectivity", display.reflectivity, display.reflectivity >= 0 && display.reflectivity <= 1, "outside 0..1");
  const double epsilon = settings.metric.relmse_epsilon;
  check("relmse-epsilon", epsilon, epsilon > 0, "not above 0");
}

void check_measure(SweepFile& file) {
  const SweepFileMeasure& m = file.measure;
  const auto within = [&](const char* key, double value, double least, double most) {
    if (!(value >= least && value <= most)) {
      refuse(file.places[key], fmt::format("{}: {} is outside {}..{}", key, value, least, most));
    }
  };
  within("repeats", m.repeats, 1, 10000);
  within("warm-up", m.warm_up, 0, 1000);
  within("reference-rate", m.reference_rate, 1, 1e6);
  within("efficiency-spp", m.efficiency_spp, 0, 1e6);
  within("leave-out", static_cast<double>(m.leave_out.ns) * 1e-9, 0, 1e6);
  check_viewing(file);
  check_names(m.baselines, {"uniform-reference-rate", "equal-samples", "equal-time", "low-resolution", "none"},
              "baseline", file.places["baselines"]);
  check_names({m.pictures}, {"png", "exr", "both", "none"}, "kind of pictures", file.places["pictures"]);
  if (is_absolute(m.compare.settings.metric.response)) {
    refuse(file.places["response"], "a sweep shows its pictures through a view, whose light is relative",
           "give srgb, gamma2.2, gamma2.4 or linear");
  }
  std::vector<std::string> known;
  for (const MetricInfo& info : comparison_metrics()) {
    known.push_back(info.name);
  }
  check_names(m.compare.metrics, known, "metric", file.places["metrics"]);
}

void read_measure(const TomlNode& root, SweepFile& file) {
  SweepFileMeasure& m = file.measure;
  m.compare.metrics = {"mse", "relmse", "psnr", "ssim", "flip", "fovvideovdp"};
  using M = SweepFileMeasure;
  OptionSchema<M> schema;
  schema.value("--repeats", &M::repeats, "N", "");
  schema.value("--warm-up", &M::warm_up, "FRAMES", "");
  schema.value("--leave-out", &M::leave_out, "DURATION", "");
  schema.value("--baselines", &M::baselines, "NAME,NAME", "");
  schema.flag("--controls", &M::controls, "");
  schema.value("--reference-rate", &M::reference_rate, "SPP", "");
  schema.value("--uniform-rates", &M::uniform_rates, "SPP,SPP", "");
  schema.repeated("--quality", &M::quality, "METRIC=VALUE", "");
  schema.value("--pictures", &M::pictures, "png|exr|both|none", "");
  schema.value("--efficiency-spp", &M::efficiency_spp, "SPP", "");
  // The settings on which scores depend, under the same names as in `compare`.
  schema.include(metric_schema(), &M::compare);
  if (const TomlNode* node = root.find("measure")) {
    read_table(schema, checked_kind(*node, TomlNode::Kind::table, file.path, "'measure' is a table; write [measure]"),
               m, file);
  }
  check_measure(file);
}

std::string text_of(const std::string& path) {
  errno = 0;
  std::ifstream input(path, std::ios::binary);
  if (!input || std::filesystem::is_directory(path)) {
    refuse(path, std::string("cannot be opened: ") + std::strerror(errno == 0 ? EISDIR : errno), "check the path");
  }
  return {std::istreambuf_iterator<char>(input), std::istreambuf_iterator<char>()};
}

}  // namespace

SweepFile read_sweep_file(const std::string& path, const JobSchema& schema) {
  SweepFile file;
  file.path = path;
  const TomlNode root = parse_toml(text_of(path), path);
  for (const auto& [key, node] : root.members) {
    if (!is_among(kTables, key)) {
      const std::string problem = unknown_name_message("key", key, {kTables.begin(), kTables.end()});
      if (root.find("scene") != nullptr && root.find("scene")->kind == TomlNode::Kind::scalar) {
        refuse(toml_place(path, node), "this is the job of a render, and no plan of a sweep",
               "render it with 'gazetrace render --config " + path + "', or write its options under [common]");
      }
      refuse(toml_place(path, node), problem);
    }
  }
  const RenderOptions options(schema);
  file.title = root.find("title") != nullptr ? toml_scalar(*root.find("title"), path) : path;
  if (const TomlNode* common = root.find("common")) {
    checked_kind(*common, TomlNode::Kind::table, path, "'common' is a table; write [common]");
    for (const auto& [key, value] : common->members) {
      options.add(key, value, path, {}, given_in(*common, path), file.common);
    }
  }
  file.scenes = read_named(root, "scene", options, {{"path", "scene"}, {"environment", "env"}}, {"scene"}, path);
  file.gazes = read_named(root, "gaze", options, {{"log", "gaze"}, {"at", "gaze-at"}}, options.gaze_sources(), path);
  if (file.scenes.empty()) {
    refuse(path, "there is no scene", "add [[scene]] with a name and a path");
  }
  file.settings = read_settings(root, options, path);
  if (file.settings.empty()) {
    refuse(path, "there is nothing to measure", "add a [grid] or a [[setting]]");
  }
  for (const SweepFileSetting& setting : file.settings) {
    for (const Assignment& option : setting.options) {
      if (!is_among(file.varied, option.option)) {
        file.varied.push_back(option.option);
      }
    }
  }
  read_published(root, file);
  read_reference(root, options, file);
  read_measure(root, file);
  return file;
}

bool is_sweep_plan(const std::string& path) {
  try {
    const TomlNode root = parse_toml(text_of(path), path);
    return std::any_of(root.members.begin(), root.members.end(), [](const TomlMember& member) {
      return is_among(kTables, member.key) && member.node.kind != TomlNode::Kind::scalar;
    });
  } catch (const Error&) {
    return false;  // the reader of jobs says what is wrong
  }
}

std::string place_of(const SweepFile& file, const std::string& key) {
  const auto found = file.places.find(key);
  return found == file.places.end() ? file.path : found->second;
}

}  // namespace gazetrace
