// SPDX-License-Identifier: Apache-2.0
#include "gazelog/row_samples.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/enum_name.hpp"
#include "gazelog/units.hpp"
#include "gazetrace/gaze_read.hpp"

namespace gazetrace {
namespace {

class Facts {
 public:
  void add(std::string what, std::string value, Evidence evidence, std::string detail = {}) {
    facts.push_back({std::move(what), std::move(value), evidence, std::move(detail)});
  }
  template <class Value>
  void add_named(std::string what, const Concluded<Value>& concluded) {
    add(std::move(what), std::string(to_string(concluded.value)), concluded.evidence, concluded.detail);
  }
  void add_text(std::string what, const Concluded<std::string>& concluded) {
    if (!concluded.value.empty()) {
      add(std::move(what), concluded.value, concluded.evidence, concluded.detail);
    }
  }

  std::vector<GazeFact> facts;
};

void add_places(const RawGaze& raw, const Conventions& c, Facts& facts) {
  facts.add_text("position columns", c.position_columns);
  if (c.unit.value != PositionUnit::automatic) {
    facts.add_named("position unit", c.unit);
  }
  if (c.form != PlaceForm::position) {
    facts.add_named("axes", c.axes);
    if (c.x_is_turned) {
      facts.add("handedness", c.x_is_turned->value ? "x was turned already; turned back" : "as the format has it",
                c.x_is_turned->evidence, c.x_is_turned->detail);
    }
  } else {
    facts.add_named("origin", c.origin);
  }
  if (c.display && c.display->evidence == Evidence::statistics && raw.kind == GazeKind::screen) {
    facts.add("display size", fmt::format("{}x{} px", c.display->value.width_px, c.display->value.height_px),
              Evidence::statistics, c.display->detail);
  }
  if (c.flip_x) {
    facts.add("left and right", "exchanged", Evidence::option);
  }
  if (c.flip_y) {
    facts.add("top and bottom", "exchanged", Evidence::option);
  }
}

std::string_view evidence_in_words(Evidence evidence) {
  return name_of(evidence,
                 {"stated by you", "stated in the sidecar", "stated in the file", "certain by the format", "inferred"});
}

}  // namespace

std::string decisions_in_words(const std::vector<GazeFact>& facts) {
  std::string text;
  for (const GazeFact& fact : facts) {
    text += fmt::format("  {:<17} {} ({}{}{})\n", fact.what, fact.value, evidence_in_words(fact.evidence),
                        fact.detail.empty() ? "" : ": ", fact.detail);
  }
  return text;
}

std::vector<GazeFact> facts_in_words(const RawGaze& raw, const Conventions& conventions) {
  Facts facts;
  facts.add_text("time column", conventions.time_column);
  const Concluded<int>& exponent = conventions.time_exponent;
  facts.add("time unit", time_unit_text(exponent.value), exponent.evidence, exponent.detail);
  facts.facts.insert(facts.facts.end(), raw.notes.begin(), raw.notes.end());
  add_places(raw, conventions, facts);
  if (conventions.eye_taken) {
    const auto& [taken, evidence, detail] = *conventions.eye_taken;
    facts.add("eye", std::string(name_of(taken.eye, {"left", "right", "mean", "combined"})), evidence,
              taken.is_alone ? "alone" : detail);
  }
  return facts.facts;
}

}  // namespace gazetrace
