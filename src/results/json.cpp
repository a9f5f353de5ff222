// SPDX-License-Identifier: Apache-2.0
// results.json. One schema, said once: `describe` names the fields of a type with their keys, and is walked by a Writer
// and by a Reader alike. What does not fit that form has its `written` and its `read` side by side. Whatever changes
// the meaning of a field, or what must be there, changes kFormat too.
#include <fmt/format.h>

#include <cmath>
#include <concepts>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/text.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/results.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "gazetrace-sweep-1";

template <class T, class Of>
concept Either = std::same_as<std::remove_const_t<T>, Of>;  // constant when written

// A value and where it stands. Every complaint names the place as a path of keys.
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
  template <std::integral T>
  [[nodiscard]] T whole_number() const {
    const double value = number();
    if (std::floor(value) != value || value < static_cast<double>(std::numeric_limits<T>::min()) ||
        value > static_cast<double>(std::numeric_limits<T>::max())) {
      fail("is no such whole number");
    }
    return json_.get<T>();
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

// Values, as they are written and read everywhere: a number that is not finite is null, and null is no value.
template <class T>
Json written(const T& value);
template <class T>
void read(const Node& node, T& value);

// The fields of a type.
class Writer {
 public:
  explicit Writer(Json& json) : json_(json) {}
  template <class T>
  void required(const char* key, const T& value) {
    json_[key] = written(value);
  }
  template <class T>
  void field(const char* key, const T& value) {
    json_[key] = written(value);
  }
  // Null where it is empty.
  void text_or_null(const char* key, const std::string& text) { json_[key] = text.empty() ? Json() : Json(text); }
  // Left out where it is empty.
  template <class T>
  void if_there(const char* key, const std::optional<T>& value) {
    if (value) {
      json_[key] = written(value);
    }
  }
  // A field of an object that holds nothing else.
  void inside(const char* object, const char* key, const std::string& text) { json_[object][key] = text; }
  // An interval that has the values of the repeats beside its bounds.
  void times(const char* key, const std::optional<Interval>& interval, const std::vector<double>& values);

 private:
  Json& json_;
};

class Reader {
 public:
  explicit Reader(const Node& node) : node_(node) {}
  template <class T>
  void required(const char* key, T& value) {
    read(node_.at(key), value);
  }
  // What is missing or null stays as it is.
  template <class T>
  void field(const char* key, T& value) {
    if (node_.has(key)) {
      read(node_.at(key), value);
    }
  }
  void text_or_null(const char* key, std::string& text) { field(key, text); }
  template <class T>
  void if_there(const char* key, std::optional<T>& value) {
    field(key, value);
  }
  void inside(const char* object, const char* key, std::string& text) {
    if (node_.has(object)) {
      const Node inner = node_.at(object);
      Reader(inner).field(key, text);
    }
  }
  void times(const char* key, std::optional<Interval>& interval, std::vector<double>& values);

 private:
  const Node& node_;
};

template <class Io, Either<ResultBuild> T>
void describe(Io& io, T& build) {
  io.field("version", build.version);
  io.field("digest", build.digest);
  io.field("compiler", build.compiler);
  io.field("march", build.march);
}

template <class Io, Either<ResultMachine> T>
void describe(Io& io, T& machine) {
  io.field("cpu", machine.cpu);
  io.field("threads", machine.threads);
}

template <class Io, Either<ResultViewing> T>
void describe(Io& io, T& viewing) {
  io.field("size_px", viewing.size_px);
  io.field("ppd", viewing.pixels_per_degree);
  io.field("width_deg", viewing.width_deg);
  io.field("peak_cd_m2", viewing.peak_cd_m2);
  io.field("contrast", viewing.contrast);
  io.field("ambient_lux", viewing.ambient_lux);
}

template <class Io, Either<ResultFrame> T>
void describe(Io& io, T& frame) {
  io.required("index", frame.index);
  io.field("t_s", frame.t_s);
  io.field("time_s", frame.time_s);
  io.field("event", frame.event);
  io.field("gaze_px", frame.gaze_px);
  io.field("rings_px", frame.rings_px);
  io.text_or_null("png", frame.png);
  io.text_or_null("flip_png", frame.flip_png);
  io.field("scores", frame.scores);
}

template <class Io, Either<PublishedSpeedUp> T>
void describe(Io& io, T& published) {
  io.required("speed_up", published.speed_up);
  io.required("source", published.source);
}

template <class Io, Either<ResultRow> T>
void describe(Io& io, T& row) {
  io.required("id", row.id);
  io.required("scene", row.scene);
  io.field("gaze", row.gaze);
  io.required("role", row.role);
  io.text_or_null("of", row.of);
  io.field("label", row.label);
  io.field("curve", row.curve);
  io.text_or_null("wrong", row.wrong);
  io.field("baselines", row.baselines);
  io.field("settings", row.settings);
  io.field("resolution_scale", row.resolution_scale);
  io.field("reference", row.reference);
  io.times("time_s", row.time_s, row.times_s);
  io.field("output_s", row.output_s);
  io.field("samples", row.samples);
  io.field("spp_mean", row.spp_mean);
  io.field("rays", row.rays);
  io.field("peak_mib", row.peak_mib);
  io.field("speed_up", row.speed_up);
  io.field("end_to_end", row.end_to_end);
  io.field("efficiency", row.efficiency);
  io.field("published", row.published);
  io.if_there("reached", row.reached);
  io.field("scores", row.scores);
  io.field("frames", row.frames);
}

template <class Io, Either<ResultFixedQuality> T>
void describe(Io& io, T& fixed) {
  io.required("metric", fixed.metric);
  io.required("at", fixed.at);
  io.field("scene", fixed.scene);
  io.field("gaze", fixed.gaze);
  io.field("curve", fixed.curve);
  io.field("speed_up", fixed.result.speed_up);
  io.field("bound", fixed.result.bound);
  io.field("why", fixed.result.why);
}

template <class Io, Either<ResultControl> T>
void describe(Io& io, T& control) {
  io.field("scene", control.scene);
  io.field("gaze", control.gaze);
  io.required("metric", control.metric);
  io.field("of", control.of);
  io.field("wrong", control.wrong);
  io.field("right_score", control.right_score);
  io.field("wrong_score", control.wrong_score);
  io.required("sensitive", control.is_sensitive);
  io.field("why", control.why);
}

template <class Io, Either<Results> T>
void describe(Io& io, T& results) {
  io.field("title", results.title);
  io.field("plan_file", results.plan_file);
  io.field("build", results.build);
  io.field("machine", results.machine);
  io.field("viewing", results.viewing);
  io.inside("color", "view", results.view);
  io.field("common_settings", results.common_settings);
  io.field("varied", results.varied);
  io.field("repeats", results.repeats);
  io.field("bands_deg", results.bands_deg);
  io.field("regions_deg", results.regions_deg);
  io.field("band_pixel_share", results.band_pixel_share);
  io.field("shares", results.event_shares);
  io.required("metrics", results.metrics);
  io.required("scenes", results.references);
  io.required("rows", results.rows);
  io.field("pareto", results.pareto);
  io.field("fixed_quality", results.fixed_quality);
  io.field("controls", results.controls);
  io.field("notes", results.notes);
  io.field("methods", results.methods);
}

// What follows are the kinds of values: how each is written, and how it is read.

template <class T>
concept Described = requires(Writer& writer, Reader& reader, const T& written_value, T& read_value) {
  describe(writer, written_value);
  describe(reader, read_value);
};

template <class T>
struct Value;  // of one kind: written(value), read(node, value)

template <Described T>
struct Value<T> {
  static Json written(const T& value) {
    Json json = Json::object();
    Writer writer(json);
    describe(writer, value);
    return json;
  }
  static void read(const Node& node, T& value) {
    Reader reader(node);
    describe(reader, value);
  }
};

template <>
struct Value<double> {
  static Json written(double value) { return std::isfinite(value) ? Json(value) : Json(); }
  static void read(const Node& node, double& value) {
    value = node.is_null() ? std::numeric_limits<double>::quiet_NaN() : node.number();
  }
};
template <>
struct Value<bool> {
  static Json written(bool value) { return value; }
  static void read(const Node& node, bool& value) { value = node.truth(); }
};
template <std::integral T>
struct Value<T> {
  static Json written(T value) { return value; }
  static void read(const Node& node, T& value) { value = node.whole_number<T>(); }
};
template <>
struct Value<std::string> {
  static Json written(const std::string& value) { return value; }
  static void read(const Node& node, std::string& value) { value = node.text(); }
};
template <>
struct Value<RowRole> {
  static Json written(RowRole value) { return to_string(value); }
  static void read(const Node& node, RowRole& value) {
    const std::optional<RowRole> role = row_role(node.text());
    if (!role) {
      node.fail("is no role of a row: '" + node.text() + "'");
    }
    value = *role;
  }
};
template <class T>
struct Value<std::optional<T>> {
  static Json written(const std::optional<T>& value) { return value ? gazetrace::written(*value) : Json(); }
  static void read(const Node& node, std::optional<T>& value) {
    value.reset();
    if (!node.is_null()) {
      gazetrace::read(node, value.emplace());
    }
  }
};
template <class T>
struct Value<std::vector<T>> {
  static Json written(const std::vector<T>& values) {
    Json json = Json::array();
    for (const T& value : values) {
      json.push_back(gazetrace::written(value));
    }
    return json;
  }
  static void read(const Node& node, std::vector<T>& values) {
    values.clear();
    for (const Node& item : node.items()) {
      gazetrace::read(item, values.emplace_back());
    }
  }
};
template <class T>
struct Value<std::map<std::string, T>> {
  static Json written(const std::map<std::string, T>& values) {
    Json json = Json::object();
    for (const auto& [name, value] : values) {
      json[name] = gazetrace::written(value);
    }
    return json;
  }
  static void read(const Node& node, std::map<std::string, T>& values) {
    values.clear();
    for (const auto& [name, value] : node.members()) {
      gazetrace::read(value, values[name]);
    }
  }
};
// Parts of a score; one that is null is left out.
template <>
struct Value<ScoreParts> {
  static Json written(const ScoreParts& parts) {
    Json json = Json::object();
    for (const auto& [part, value] : parts) {
      json[part] = gazetrace::written(value);
    }
    return json;
  }
  static void read(const Node& node, ScoreParts& parts) {
    parts.clear();
    for (const auto& [part, value] : node.members()) {
      if (!value.is_null()) {
        parts[part] = value.number();
      }
    }
  }
};
// Settings are texts; what else stands in the file is taken as a person would read it.
template <>
struct Value<NamedValues> {
  static Json written(const NamedValues& values) {
    Json json = Json::object();
    for (const auto& [name, value] : values) {
      json[name] = value;
    }
    return json;
  }
  static void read(const Node& node, NamedValues& values) {
    values.clear();
    for (const auto& [name, value] : node.members()) {
      values.emplace_back(name, value.shown());
    }
  }
};
template <>
struct Value<std::optional<Vec2d>> {
  static Json written(const std::optional<Vec2d>& at) { return at ? Json{at->x, at->y} : Json(); }
  static void read(const Node& node, std::optional<Vec2d>& at) {
    std::vector<double> numbers;
    gazetrace::read(node, numbers);
    at.reset();
    if (numbers.size() == 2) {
      at = Vec2d{numbers[0], numbers[1]};
    }
  }
};
template <>
struct Value<std::array<int, 2>> {
  static Json written(const std::array<int, 2>& size) { return {size[0], size[1]}; }
  static void read(const Node& node, std::array<int, 2>& size) {
    std::vector<int> numbers;
    gazetrace::read(node, numbers);
    if (numbers.size() != 2) {
      node.fail("is no pair of numbers");
    }
    size = {numbers[0], numbers[1]};
  }
};

// A mean that is null is no value. Bounds come in pairs; a number alone is a mean without them.
template <>
struct Value<Interval> {
  static Json written(const Interval& interval) {
    return {{"mean", gazetrace::written(interval.mean)},
            {"low", gazetrace::written(interval.low)},
            {"high", gazetrace::written(interval.high)}};
  }
};
template <>
struct Value<std::optional<Interval>> {
  static Json written(const std::optional<Interval>& value) { return value ? gazetrace::written(*value) : Json(); }
  static void read(const Node& node, std::optional<Interval>& value) {
    value.reset();
    if (node.is_number()) {
      value = Interval{node.number(), std::nullopt, std::nullopt};
    } else if (node.has("mean")) {
      Interval& interval = value.emplace(Interval{node.at("mean").number(), std::nullopt, std::nullopt});
      if (node.has("low") && node.has("high")) {
        interval.low = node.at("low").number();
        interval.high = node.at("high").number();
        if (*interval.low > *interval.high) {
          node.fail("has its low above its high");
        }
      }
    }
  }
};

const Interval kNothing{std::numeric_limits<double>::quiet_NaN(), std::nullopt, std::nullopt};

template <>
struct Value<ResultScore> {
  static Json written(const ResultScore& score) {
    Json json = gazetrace::written(score.value.value_or(kNothing));
    json["resolved"] = score.is_resolved;
    return json;
  }
  static void read(const Node& node, ResultScore& score) {
    gazetrace::read(node, score.value);
    score.is_resolved = !node.has("resolved") || node.at("resolved").truth();
  }
};

template <>
struct Value<ResultMetric> {
  static Json written(const ResultMetric& metric) {
    return {{"name", metric.name},
            {"unit", metric.unit},
            {"better", metric.is_lower_better ? "lower" : "higher"},
            {"note", metric.note}};
  }
  static void read(const Node& node, ResultMetric& metric) {
    Reader reader(node);
    std::string better;
    reader.required("name", metric.name);
    reader.field("unit", metric.unit);
    reader.field("better", better);
    reader.field("note", metric.note);
    metric.is_lower_better = better != "higher";
  }
};

// A scene and the reference that it is measured against. What is known by gaze stands in one object for each kind;
// "floor" is that of the first gaze, and of all where the file does not tell them apart.
template <>
struct Value<ResultReference> {
  static Json written(const ResultReference& reference) {
    Json floors = Json::object();
    Json bands = Json::object();
    Json events = Json::object();
    for (const ResultFloor& floor : reference.floors) {
      bands[floor.gaze] = gazetrace::written(floor.band_pixel_share);
      events[floor.gaze] = gazetrace::written(floor.event_shares);
      floors[floor.gaze] = gazetrace::written(floor.scores);
    }
    const Json first = floors.empty() ? Json::object() : floors.begin().value();
    return {{"name", reference.scene},
            {"reference",
             {{"key", reference.key},
              {"spp", gazetrace::written(reference.spp)},
              {"frames_rendered", reference.pictures},
              {"seeds", gazetrace::written(reference.seeds)},
              {"scramblings", reference.seeds.size()},
              {"directory", reference.directory},
              {"png", reference.png},
              {"floor", first},
              {"floor_by_gaze", std::move(floors)},
              {"band_pixel_share_by_gaze", std::move(bands)},
              {"shares_by_gaze", std::move(events)}}}};
  }
  static void read(const Node& node, ResultReference& reference) {
    reference.scene = node.at("name").text();
    if (!node.has("reference")) {
      return;
    }
    const Node inner = node.at("reference");
    Reader reader(inner);
    reader.field("key", reference.key);
    reader.field("spp", reference.spp);
    reader.field("frames_rendered", reference.pictures);
    reader.field("seeds", reference.seeds);
    reader.field("directory", reference.directory);
    reader.field("png", reference.png);
    std::map<std::string, std::vector<double>> bands;
    std::map<std::string, std::map<std::string, double>> events;
    reader.field("band_pixel_share_by_gaze", bands);
    reader.field("shares_by_gaze", events);
    if (inner.has("floor_by_gaze")) {
      for (const auto& [gaze, scores] : inner.at("floor_by_gaze").members()) {
        ResultFloor& floor = reference.floors.emplace_back(ResultFloor{gaze, {}, bands[gaze], events[gaze]});
        gazetrace::read(scores, floor.scores);
      }
    } else if (inner.has("floor")) {
      gazetrace::read(inner.at("floor"), reference.floors.emplace_back().scores);
    }
  }
};

template <class T>
Json written(const T& value) {
  return Value<T>::written(value);
}
template <class T>
void read(const Node& node, T& value) {
  Value<T>::read(node, value);
}

void Writer::times(const char* key, const std::optional<Interval>& interval, const std::vector<double>& values) {
  json_[key] = written(interval.value_or(kNothing));
  json_[key]["values"] = written(values);
}
void Reader::times(const char* key, std::optional<Interval>& interval, std::vector<double>& values) {
  field(key, interval);
  if (node_.has(key) && node_.at(key).has("values")) {
    read(node_.at(key).at("values"), values);
  }
}

void check_format(const Node& root) {
  const std::string format = root.has("format") ? root.at("format").text() : std::string();
  if (format.empty()) {
    root.fail(fmt::format("is no {} file: it has no 'format'", kFormat));
  }
  if (format != kFormat) {
    root.fail(fmt::format("is of the format '{}', and this version reads {} only", format, kFormat));
  }
}

}  // namespace

std::string results_json(const Results& results) {
  Json json{{"format", kFormat}};
  Writer writer(json);
  describe(writer, results);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Results read_results(const std::string& path) {
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
  const Node root(json, file, "");
  check_format(root);
  Results results;
  results.title = "Sweep";
  Reader reader(root);
  describe(reader, results);
  for (ResultRow& row : results.rows) {
    row.label = row.label.empty() ? row.id : row.label;
  }
  results.directory = fs::path(file).parent_path().string();
  return results;
}

}  // namespace gazetrace
