// SPDX-License-Identifier: Apache-2.0
// results.json. The schema is said once: `describe` names the fields of a type with their keys, and a Writer and a
// Reader walk through it. Whatever changes the meaning of a field, or what must be there, changes kFormat, too.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/json_problem.hpp"
#include "core/text.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/results.hpp"
#include "results/json_node.hpp"

namespace gazetrace {
namespace {

constexpr const char* kFormat = "gazetrace-sweep-1";

template <class T, class Of>
concept Either = std::same_as<std::remove_const_t<T>, Of>;  // constant when written

// Values of each kind, as they are written and read. A number that is not finite is null.
Json written(RowRole role) {
  return to_string(role);
}
void read(const JsonNode& node, RowRole& role) {
  const std::optional<RowRole> found = row_role(node.text());
  if (!found) {
    node.fail("is no role of a row: '" + node.text() + "'");
  }
  role = *found;
}
Json written(const Vec2d& at) {
  return {at.x, at.y};
}
void read(const JsonNode& node, Vec2d& at) {
  const std::vector<JsonNode> items = node.items();
  if (items.size() != 2) {
    node.fail("is no pair of numbers");
  }
  at = {items[0].number(), items[1].number()};
}
// Settings are texts; anything else in the file is taken as a person would read it.
Json written(const NamedValues& values) {
  Json json = Json::object();
  for (const auto& [name, value] : values) {
    json[name] = value;
  }
  return json;
}
void read(const JsonNode& node, NamedValues& values) {
  for (const auto& [name, value] : node.members()) {
    values.emplace_back(name, value.shown());
  }
}
Json written(const Interval& interval);
void read(const JsonNode& node, std::optional<Interval>& interval);
template <class T>
Json written(const T& value);
template <class T>
void read(const JsonNode& node, T& value);

// Two walks through the fields of a type. A `required` field must be in the file; another one that is missing or null
// keeps its value when it is read.
class Writer {
 public:
  explicit Writer(Json& json) : json_(json) { json_ = Json::object(); }
  template <class T>
  void required(const char* key, const T& value) {
    json_[key] = written(value);
  }
  template <class T>
  void field(const char* key, const T& value) {
    json_[key] = written(value);
  }
  template <class T>
  void if_there(const char* key, const std::optional<T>& value) {
    if (value) {
      json_[key] = written(*value);
    }
  }
  void text_or_null(const char* key, const std::string& text) { json_[key] = text.empty() ? Json() : Json(text); }
  void text_if_there(const char* key, const std::string& text) {
    if (!text.empty()) {
      json_[key] = text;
    }
  }
  void choice(const char* key, bool is_first, const char* first, const char* second) {
    json_[key] = is_first ? first : second;
  }
  void derived(const char* key, std::size_t count) { json_[key] = count; }
  template <class Fields>
  void object(const char* key, const Fields& fields) {
    Writer inner(json_[key]);
    fields(inner);
  }
  void bounds(const std::optional<Interval>& interval) {
    json_["mean"] = interval ? written(interval->mean) : Json();
    json_["low"] = interval ? written(interval->low) : Json();
    json_["high"] = interval ? written(interval->high) : Json();
  }
  template <class T>
  void by_gaze(const char* key, const std::vector<ResultFloor>& floors, T ResultFloor::*member) {
    Json& json = json_[key] = Json::object();
    for (const ResultFloor& floor : floors) {
      json[floor.gaze] = written(floor.*member);
    }
  }
  void any_floor(const char* key, const std::vector<ResultFloor>& floors) {
    json_[key] = floors.empty() ? Json::object() : written(floors.front().scores);
  }

 private:
  Json& json_;
};

class Reader {
 public:
  explicit Reader(const JsonNode& node) : node_(node) {}
  template <class T>
  void required(const char* key, T& value) {
    read(node_.at(key), value);
  }
  template <class T>
  void field(const char* key, T& value) {
    if (node_.has(key)) {
      read(node_.at(key), value);
    }
  }
  template <class T>
  void if_there(const char* key, std::optional<T>& value) {
    field(key, value);
  }
  void text_or_null(const char* key, std::string& text) { field(key, text); }
  void text_if_there(const char* key, std::string& text) { field(key, text); }
  void choice(const char* key, bool& is_first, const char* first, const char* second) {
    std::string text = first;
    field(key, text);
    if (text != first && text != second) {
      node_.at(key).fail(fmt::format("is neither '{}' nor '{}'", first, second));
    }
    is_first = text == first;
  }
  void derived(const char* /*key*/, std::size_t /*count*/) {}
  template <class Fields>
  void object(const char* key, const Fields& fields) {
    if (node_.has(key)) {
      const JsonNode inner = node_.at(key);
      Reader reader(inner);
      fields(reader);
    }
  }
  // A number alone is a mean without bounds, and a mean that is null is no value.
  void bounds(std::optional<Interval>& interval) {
    interval.reset();
    if (node_.is_number()) {
      interval = Interval{node_.number(), std::nullopt, std::nullopt};
    } else if (node_.has("mean")) {
      interval = Interval{node_.at("mean").number(), std::nullopt, std::nullopt};
      if (node_.has("low") && node_.has("high")) {
        interval->low = node_.at("low").number();
        interval->high = node_.at("high").number();
        if (*interval->low > *interval->high) {
          node_.fail("has its low above its high");
        }
      }
    }
  }
  template <class T>
  void by_gaze(const char* key, std::vector<ResultFloor>& floors, T ResultFloor::*member) {
    if (!node_.has(key)) {
      return;
    }
    for (const auto& [gaze, value] : node_.at(key).members()) {
      auto floor = std::find_if(floors.begin(), floors.end(),
                                [&, &name = gaze](const ResultFloor& one) { return one.gaze == name; });
      if (floor == floors.end()) {
        floor = floors.insert(floors.end(), {gaze, {}, {}, {}});
      }
      read(value, *floor.*member);
    }
  }
  // Of files that do not tell gazes apart.
  void any_floor(const char* key, std::vector<ResultFloor>& floors) {
    if (!node_.has("floor_by_gaze") && node_.has(key)) {
      field(key, floors.emplace_back().scores);
    }
  }

 private:
  const JsonNode& node_;
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
  io.field("model_gain", viewing.model_gain);
  io.field("model_gain_cut_4_cpd", viewing.model_gain_cut_4_cpd);
}

template <class Io, Either<ResultMetric> T>
void describe(Io& io, T& metric) {
  io.required("name", metric.name);
  io.field("unit", metric.unit);
  io.choice("better", metric.is_lower_better, "lower", "higher");
  io.field("note", metric.note);
}

template <class Io, Either<ResultReference> T>
void describe(Io& io, T& reference) {
  io.required("name", reference.scene);
  io.object("reference", [&](auto& inner) {
    inner.field("key", reference.key);
    inner.field("spp", reference.spp);
    inner.field("frames_rendered", reference.pictures);
    inner.field("seeds", reference.seeds);
    inner.derived("scramblings", reference.seeds.size());
    inner.field("directory", reference.directory);
    inner.field("png", reference.png);
    inner.any_floor("floor", reference.floors);
    inner.by_gaze("floor_by_gaze", reference.floors, &ResultFloor::scores);
    inner.by_gaze("band_pixel_share_by_gaze", reference.floors, &ResultFloor::band_pixel_share);
    inner.by_gaze("shares_by_gaze", reference.floors, &ResultFloor::event_shares);
  });
}

template <class Io, Either<ResultScore> T>
void describe(Io& io, T& score) {
  io.bounds(score.value);
  io.field("resolved", score.is_resolved);
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
  io.text_if_there("task", row.task);
  io.object("time_s", [&](auto& inner) {
    inner.bounds(row.time_s);
    inner.field("values", row.times_s);
  });
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
  io.field("model_gain", fixed.model_gain);
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
  io.object("color", [&](auto& inner) { inner.field("view", results.view); });
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

Json written(const Interval& interval) {
  Json json;
  Writer(json).bounds(interval);
  return json;
}
void read(const JsonNode& node, std::optional<Interval>& interval) {
  Reader(node).bounds(interval);
}

template <class T>
concept Described = requires(Writer& writer, Reader& reader, const T& given, T& taken) {
  describe(writer, given);
  describe(reader, taken);
};
template <class T>
concept Optional = std::same_as<T, std::optional<typename T::value_type>>;
template <class T>
concept Map = std::same_as<T, std::map<std::string, typename T::mapped_type>>;
template <class T>
concept List = std::same_as<T, std::vector<typename T::value_type>>;

template <class T>
Json written(const T& value) {
  if constexpr (Described<T>) {
    Json json;
    Writer writer(json);
    describe(writer, value);
    return json;
  } else if constexpr (Optional<T>) {
    return value ? written(*value) : Json();
  } else if constexpr (Map<T>) {
    Json json = Json::object();
    for (const auto& [name, one] : value) {
      json[name] = written(one);
    }
    return json;
  } else if constexpr (List<T>) {
    Json json = Json::array();
    for (const auto& one : value) {
      json.push_back(written(one));
    }
    return json;
  } else if constexpr (std::floating_point<T>) {
    return std::isfinite(value) ? Json(value) : Json();
  } else {
    return value;
  }
}

template <class T>
void read(const JsonNode& node, T& value) {
  if constexpr (Described<T>) {
    Reader reader(node);
    describe(reader, value);
  } else if constexpr (Optional<T>) {
    value.reset();
    if (!node.is_null()) {
      read(node, value.emplace());
    }
  } else if constexpr (Map<T>) {
    for (const auto& [name, one] : node.members()) {
      if (!one.is_null() || Optional<typename T::mapped_type>) {
        read(one, value[name]);
      }
    }
  } else if constexpr (List<T>) {
    for (const JsonNode& item : node.items()) {
      read(item, value.emplace_back());
    }
  } else if constexpr (std::floating_point<T>) {
    value = node.is_null() ? std::numeric_limits<T>::quiet_NaN() : node.number();
  } else if constexpr (std::same_as<T, bool>) {
    value = node.truth();
  } else if constexpr (std::integral<T>) {
    value = node.whole_number<T>();
  } else {
    value = node.text();
  }
}

void check_format(const JsonNode& root) {
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
  Json json;
  Writer writer(json);
  writer.field("format", std::string(kFormat));
  describe(writer, results);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Results read_results(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code failed;
  const std::string file = fs::is_directory(path, failed) ? (fs::path(path) / "results.json").string() : path;
  const fs::file_type type = fs::status(file, failed).type();
  if (type == fs::file_type::none) {
    throw Error(ErrorKind::input, file, "cannot be opened: " + failed.message(), "check the path");
  }
  if (type != fs::file_type::regular) {
    throw Error(ErrorKind::input, file, "there is no such file", "name results.json of a sweep, or its folder");
  }
  Json json;
  try {
    json = Json::parse(read_file_bytes(file));
  } catch (const Json::exception& e) {
    throw Error(ErrorKind::input, file, "is no JSON: " + json_problem(e.what()), "write it again with gazetrace sweep");
  }
  const JsonNode root(json, file, "");
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
