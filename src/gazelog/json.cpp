// SPDX-License-Identifier: Apache-2.0
#include "gazelog/json.hpp"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/json_problem.hpp"
#include "core/text.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

// Records each leaf with the path to it. The parser does not recurse, so deep nesting only makes long paths; they are
// cut off at a depth that no recording has.
class LeafCollector : public nlohmann::json_sax<Json> {
 public:
  explicit LeafCollector(std::vector<JsonLeaf>& leaves) : leaves_(leaves) {}

  bool null() override { return leaf("null", false); }
  bool boolean(bool value) override { return leaf(value ? "true" : "false", false); }
  bool number_integer(number_integer_t value) override { return leaf(std::to_string(value), true); }
  bool number_unsigned(number_unsigned_t value) override { return leaf(std::to_string(value), true); }
  bool number_float(number_float_t /*value*/, const string_t& text) override { return leaf(text, true); }
  bool string(string_t& value) override { return leaf(value, false); }
  bool binary(binary_t& /*value*/) override { return false; }
  bool start_object(std::size_t /*count*/) override { return open(false); }
  bool end_object() override { return close("{}"); }
  bool start_array(std::size_t /*count*/) override { return open(true); }
  bool end_array() override { return close("[]"); }
  bool key(string_t& name) override {
    path_.resize(levels_.back().length);
    path_ += (path_.empty() ? "" : ".") + name;
    return true;
  }
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) override {
    problem = json_problem(error.what());
    return false;
  }
  std::string problem;

 private:
  struct Level {
    std::size_t length;  // of the path that leads here
    bool is_array;
    std::size_t count = 0;
  };

  void enter() {
    if (!levels_.empty() && levels_.back().is_array) {
      path_.resize(levels_.back().length);
      path_ += "." + std::to_string(levels_.back().count);
    }
    if (!levels_.empty()) {
      ++levels_.back().count;
    }
  }
  bool leaf(std::string text, bool is_number) {
    if (levels_.empty()) {
      problem = "it is no object";
      return false;
    }
    enter();
    leaves_.push_back({path_, std::move(text), is_number});
    return true;
  }
  bool open(bool is_array) {
    if (levels_.size() >= 32) {
      problem = "it is nested more than 32 deep";
      return false;
    }
    if (levels_.empty() && is_array) {
      problem = "it is no object";
      return false;
    }
    enter();
    levels_.push_back({path_.size(), is_array});
    return true;
  }
  bool close(const char* empty) {
    const Level level = levels_.back();
    levels_.pop_back();
    path_.resize(level.length);
    if (level.count == 0) {
      leaves_.push_back({path_, empty, false});
    }
    return true;
  }

  std::vector<JsonLeaf>& leaves_;
  std::vector<Level> levels_;
  std::string path_;
};

}  // namespace

JsonLeaves::JsonLeaves(std::string_view json, const std::string& place) {
  LeafCollector collector(leaves_);
  if (!Json::sax_parse(json.begin(), json.end(), &collector)) {
    std::string problem = collector.problem.substr(0, 120);
    for (char& c : problem) {
      c = static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
    throw Error(ErrorKind::input, place, fmt::format("is not the JSON that it should be: {}", problem),
                "the file may be cut off or of another kind");
  }
}

const JsonLeaf* JsonLeaves::find(std::string_view path) const {
  for (const JsonLeaf& leaf : leaves_) {
    if (leaf.path == path) {
      return &leaf;
    }
  }
  return nullptr;
}

bool JsonLeaves::has(std::string_view path) const {
  for (const JsonLeaf& leaf : leaves_) {
    if (leaf.path.starts_with(path) && (leaf.path.size() == path.size() || leaf.path[path.size()] == '.')) {
      return true;
    }
  }
  return false;
}

std::string JsonLeaves::text(std::string_view path) const {
  const JsonLeaf* const leaf = find(path);
  return leaf == nullptr ? std::string() : leaf->text;
}

std::optional<double> JsonLeaves::number(std::string_view path) const {
  const JsonLeaf* const leaf = find(path);
  return leaf == nullptr || !leaf->is_number ? std::nullopt : number_from(leaf->text);
}

std::vector<double> JsonLeaves::numbers(std::string_view path) const {
  std::vector<double> values;
  for (;;) {
    const JsonLeaf* const leaf = find(fmt::format("{}.{}", path, values.size()));
    // Some programs write numbers as texts.
    if (leaf == nullptr || !(leaf->is_number || leaf->text == "null" || number_from(leaf->text))) {
      return values;
    }
    values.push_back(number_from(leaf->text).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
}

std::vector<std::string> JsonLeaves::texts(std::string_view path) const {
  std::vector<std::string> values;
  for (;;) {
    const JsonLeaf* const leaf = find(fmt::format("{}.{}", path, values.size()));
    if (leaf == nullptr) {
      return values;
    }
    values.push_back(leaf->text);
  }
}

}  // namespace gazetrace
