// SPDX-License-Identifier: Apache-2.0
// results.json into ReportData. Every complaint names the place as a path of keys.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/text.hpp"
#include "gazetrace/report.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "gazetrace-sweep-1";

// A value and where it stands.
class Node {
 public:
  Node(const Json& json, std::string file, std::string path)
      : json_(json), file_(std::move(file)), path_(std::move(path)) {}

  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(ErrorKind::input, file_ + (path_.empty() ? "" : ": " + path_), problem,
                "write it again with gazetrace sweep");
  }
  [[nodiscard]] bool has(const std::string& key) const {
    return json_.is_object() && json_.contains(key) && !json_.at(key).is_null();
  }
  [[nodiscard]] Node at(const std::string& key) const {
    if (!json_.is_object()) {
      fail("is no object");
    }
    if (!json_.contains(key)) {
      fail("has no '" + key + "'");
    }
    return {json_.at(key), file_, path_.empty() ? key : path_ + "." + key};
  }
  [[nodiscard]] std::vector<Node> items() const {
    if (!json_.is_array()) {
      fail("is no list");
    }
    std::vector<Node> nodes;
    nodes.reserve(json_.size());
    for (std::size_t i = 0; i < json_.size(); ++i) {
      nodes.emplace_back(json_[i], file_, fmt::format("{}[{}]", path_, i));
    }
    return nodes;
  }
  [[nodiscard]] std::vector<std::pair<std::string, Node>> members() const {
    if (!json_.is_object()) {
      fail("is no object");
    }
    std::vector<std::pair<std::string, Node>> nodes;
    for (const auto& [key, value] : json_.items()) {
      nodes.emplace_back(key, Node{value, file_, path_.empty() ? key : path_ + "." + key});
    }
    return nodes;
  }
  [[nodiscard]] bool is_null() const { return json_.is_null(); }
  [[nodiscard]] bool is_number() const { return json_.is_number(); }
  [[nodiscard]] double number() const {
    if (!json_.is_number()) {
      fail("is no number");
    }
    return json_.get<double>();
  }
  [[nodiscard]] std::string text() const {
    if (!json_.is_string()) {
      fail("is no text");
    }
    return json_.get<std::string>();
  }
  [[nodiscard]] bool truth() const {
    if (!json_.is_boolean()) {
      fail("is neither true nor false");
    }
    return json_.get<bool>();
  }
  // Of any kind, for people: texts without quotes, lists with commas.
  [[nodiscard]] std::string shown() const {
    if (json_.is_string()) {
      return json_.get<std::string>();
    }
    if (json_.is_number_float()) {
      return fmt::format("{:.6g}", json_.get<double>());
    }
    if (json_.is_array()) {
      std::string list;
      for (const Node& item : items()) {
        list += (list.empty() ? "" : ", ") + item.shown();
      }
      return list;
    }
    return json_.is_null() ? "not set" : json_.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

 private:
  const Json& json_;
  std::string file_, path_;
};

std::string text_or(const Node& node, const std::string& key, const std::string& otherwise = {}) {
  return node.has(key) ? node.at(key).text() : otherwise;
}

std::optional<double> number_or_none(const Node& node, const std::string& key) {
  return node.has(key) ? std::optional(node.at(key).number()) : std::nullopt;
}

ReportSettingsList settings_of(const Node& node, const std::string& key) {
  ReportSettingsList list;
  if (node.has(key)) {
    for (const auto& [name, value] : node.at(key).members()) {
      list.emplace_back(name, value.shown());
    }
  }
  return list;
}

std::optional<Estimate> estimate_of(const Node& node) {
  if (node.is_null()) {
    return std::nullopt;
  }
  if (node.is_number()) {
    return Estimate{node.number(), std::nullopt, std::nullopt};
  }
  if (!node.has("mean")) {
    return std::nullopt;
  }
  Estimate estimate{node.at("mean").number(), number_or_none(node, "low"), number_or_none(node, "high")};
  if (!estimate.low || !estimate.high) {
    estimate.low = estimate.high = std::nullopt;
  } else if (*estimate.low > *estimate.high) {
    node.fail("has its low above its high");
  }
  return estimate;
}

std::optional<Estimate> estimate_at(const Node& node, const std::string& key) {
  return node.has(key) ? estimate_of(node.at(key)) : std::nullopt;
}

std::vector<std::string> texts_of(const Node& node, const std::string& key) {
  std::vector<std::string> texts;
  if (node.has(key)) {
    for (const Node& item : node.at(key).items()) {
      texts.push_back(item.text());
    }
  }
  return texts;
}

std::vector<double> numbers_of(const Node& node, const std::string& key) {
  std::vector<double> numbers;
  if (node.has(key)) {
    for (const Node& item : node.at(key).items()) {
      numbers.push_back(item.number());
    }
  }
  return numbers;
}

std::vector<std::string> band_names(const std::vector<double>& edges_deg) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < edges_deg.size(); ++i) {
    names.push_back(i + 1 < edges_deg.size() ? fmt::format("{:g}-{:g}", edges_deg[i], edges_deg[i + 1])
                                             : fmt::format("{:g}+", edges_deg[i]));
  }
  return names;
}

ReportFrame frame_of(const Node& node) {
  ReportFrame frame;
  frame.index = static_cast<std::int32_t>(node.at("index").number());
  frame.t_s = number_or_none(node, "t_s").value_or(0);
  frame.time_s = number_or_none(node, "time_s");
  frame.event = text_or(node, "event", "none");
  if (const std::vector<double> gaze = numbers_of(node, "gaze_px"); gaze.size() == 2) {
    frame.gaze_px = Vec2d{gaze[0], gaze[1]};
  }
  frame.rings_px = numbers_of(node, "rings_px");
  frame.png = text_or(node, "png");
  frame.flip_png = text_or(node, "flip_png");
  if (node.has("scores")) {
    for (const auto& [metric, value] : node.at("scores").members()) {
      frame.scores[metric] = value.is_null() ? std::nullopt : std::optional(value.number());
    }
  }
  return frame;
}

ReportRow row_of(const Node& node) {
  ReportRow row;
  row.id = node.at("id").text();
  row.scene = node.at("scene").text();
  row.gaze = text_or(node, "gaze");
  row.role = node.at("role").text();
  row.of = text_or(node, "of");
  row.label = text_or(node, "label", row.id);
  row.reference = text_or(node, "reference");
  if (node.has("baselines")) {
    for (const auto& [role, id] : node.at("baselines").members()) {
      row.baselines[role] = id.text();
    }
  }
  row.settings = settings_of(node, "settings");
  row.time_s = estimate_at(node, "time_s");
  row.speed_up = estimate_at(node, "speed_up");
  row.end_to_end = number_or_none(node, "end_to_end");
  row.reached = estimate_at(node, "reached");
  row.samples = number_or_none(node, "samples");
  row.spp_mean = number_or_none(node, "spp_mean");
  row.rays = number_or_none(node, "rays");
  row.peak_mib = number_or_none(node, "peak_mib");
  row.efficiency = number_or_none(node, "efficiency");
  if (node.has("scores")) {
    for (const auto& [metric, parts] : node.at("scores").members()) {
      for (const auto& [part, value] : parts.members()) {
        const bool resolved = !value.has("resolved") || value.at("resolved").truth();
        row.scores[metric].push_back({part, estimate_of(value), resolved});
      }
    }
  }
  if (node.has("published")) {
    for (const Node& other : node.at("published").items()) {
      row.published.push_back({other.at("speed_up").number(), other.at("source").text()});
    }
  }
  if (node.has("frames")) {
    for (const Node& frame : node.at("frames").items()) {
      row.frames.push_back(frame_of(frame));
    }
  }
  return row;
}

ReportFloor floor_of(const Node& node) {
  ReportFloor floor;
  for (const auto& [metric, parts] : node.members()) {
    for (const auto& [part, value] : parts.members()) {
      if (!value.is_null()) {
        floor[metric][part] = value.number();
      }
    }
  }
  return floor;
}

ReportScene scene_of(const Node& node) {
  ReportScene scene;
  scene.name = node.at("name").text();
  if (!node.has("reference")) {
    return scene;
  }
  const Node reference = node.at("reference");
  for (const char* const key : {"spp", "seeds", "scramblings"}) {
    if (reference.has(key)) {
      scene.reference_text +=
          (scene.reference_text.empty() ? "" : ", ") + std::string(key) + " " + reference.at(key).shown();
    }
  }
  scene.key = text_or(reference, "key");
  scene.reference_pattern = text_or(reference, "png");
  if (reference.has("floor")) {
    scene.floor = floor_of(reference.at("floor"));
  }
  if (reference.has("floor_by_gaze")) {
    for (const auto& [gaze, floor] : reference.at("floor_by_gaze").members()) {
      scene.floor_by_gaze[gaze] = floor_of(floor);
    }
  }
  return scene;
}

ReportData data_of(const Node& root) {
  if (text_or(root, "format") != kFormat) {
    root.fail(std::string("is no ") + kFormat + " file");
  }
  ReportData data;
  data.title = text_or(root, "title", "Sweep");
  data.plan_file = text_or(root, "plan_file");
  data.methods = text_or(root, "methods");
  data.build = settings_of(root, "build");
  data.machine = settings_of(root, "machine");
  data.viewing = settings_of(root, "viewing");
  data.color = settings_of(root, "color");
  data.common_settings = settings_of(root, "common_settings");
  data.varied = texts_of(root, "varied");
  data.bands = band_names(numbers_of(root, "bands_deg"));
  if (root.has("band_pixel_share")) {
    for (const auto& [gaze, shares] : root.at("band_pixel_share").members()) {
      for (const Node& share : shares.items()) {
        data.band_pixel_share[gaze].push_back(share.number());
      }
    }
  }
  if (root.has("shares")) {
    for (const auto& [gaze, shares] : root.at("shares").members()) {
      for (const auto& [event, share] : shares.members()) {
        data.event_shares[gaze][event] = share.number();
      }
    }
  }
  for (const Node& node : root.at("metrics").items()) {
    data.metrics.push_back(
        {node.at("name").text(), text_or(node, "unit"), text_or(node, "note"), text_or(node, "better") != "higher"});
  }
  for (const Node& node : root.at("scenes").items()) {
    data.scenes.push_back(scene_of(node));
  }
  for (const Node& node : root.at("rows").items()) {
    data.rows.push_back(row_of(node));
  }
  if (root.has("pareto")) {
    for (const auto& [metric, groups] : root.at("pareto").members()) {
      for (const auto& [group, ids] : groups.members()) {
        for (const Node& id : ids.items()) {
          data.pareto[metric][group].push_back(id.text());
        }
      }
    }
  }
  if (root.has("fixed_quality")) {
    for (const Node& node : root.at("fixed_quality").items()) {
      data.fixed_quality.push_back({node.at("metric").text(), text_or(node, "scene"), text_or(node, "gaze"),
                                    text_or(node, "curve"), text_or(node, "bound"), text_or(node, "why"),
                                    number_or_none(node, "at"), number_or_none(node, "speed_up")});
    }
  }
  if (root.has("controls")) {
    for (const Node& node : root.at("controls").items()) {
      data.controls.push_back({text_or(node, "scene"), text_or(node, "gaze"), text_or(node, "of"),
                               node.at("metric").text(), text_or(node, "wrong"), text_or(node, "why"),
                               number_or_none(node, "right_score"), number_or_none(node, "wrong_score"),
                               node.at("sensitive").truth()});
    }
  }
  data.notes = texts_of(root, "notes");
  return data;
}

}  // namespace

ReportData read_results(const std::string& path) {
  namespace fs = std::filesystem;
  const std::string file = fs::is_directory(path) ? (fs::path(path) / "results.json").string() : path;
  if (!fs::is_regular_file(file)) {
    throw Error(ErrorKind::input, file, "there is no such file", "name results.json of a sweep, or its folder");
  }
  Json json;
  try {
    json = Json::parse(read_file_bytes(file));
  } catch (const Json::exception& e) {
    throw Error(ErrorKind::input, file, std::string("is no JSON: ") + e.what(), "write it again with gazetrace sweep");
  }
  ReportData data = data_of(Node(json, file, ""));
  data.directory = fs::path(file).parent_path().string();
  return data;
}

}  // namespace gazetrace
