// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "aoi/cells.hpp"
#include "gazetrace/gaze_aois.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kNone = "(none)";

std::string name_of(const AoiAnalysis& analysis, std::size_t area) {
  std::string name = area < analysis.areas.size() ? analysis.areas[area].name : kNone;
  for (char& c : name) {
    c = c == '\t' || c == '\n' || c == '\r' ? ' ' : c;
  }
  return name;
}

std::string share(double value) {
  return std::isfinite(value) ? fmt::format("{:.3f}", value) : "n/a";
}

double milliseconds(const AoiFixation& fixation) {
  return static_cast<double>(fixation.duration_ns) * 1e-6;
}

double part(double value, double whole) {
  return whole > 0 ? value / whole : std::nan("");
}

}  // namespace

std::string aoi_fixations_as_tsv(const AoiAnalysis& analysis) {
  std::string text = "onset_ns\toffset_ns\tduration_ms\tu\tv\taoi\tshare\n";
  for (const AoiFixation& fixation : analysis.fixations) {
    fmt::format_to(std::back_inserter(text), "{}\t{}\t{}\t{}\t{}\t{}\t{}\n", fixation.event.begin_ns,
                   fixation.event.end_ns, number_cell(milliseconds(fixation)), number_cell(fixation.event.u),
                   number_cell(fixation.event.v), name_of(analysis, fixation.aoi.value_or(analysis.areas.size())),
                   share(fixation.share));
  }
  return text;
}

std::string aoi_figures_as_tsv(const AoiAnalysis& analysis) {
  std::string text =
      "aoi\tfixations\tfixation_ms\tfixation_share\tvisits\tdwell_ms\tfirst_fixation_at_ms\tfirst_fixation_ms\n";
  for (std::size_t i = 0; i < analysis.figures.size(); ++i) {
    const AoiFigures& f = analysis.figures[i];
    fmt::format_to(std::back_inserter(text), "{}\t{}\t{}\t{}\t{}\t{}\t{}\t{}\n", name_of(analysis, i), f.fixations,
                   number_cell(f.fixation_ms), share(part(f.fixation_ms, analysis.fixation_ms)), f.visits,
                   number_cell(f.dwell_ms), number_cell(f.first_fixation_at_ms), number_cell(f.first_fixation_ms));
  }
  return text;
}

std::string aoi_transitions_as_tsv(const AoiAnalysis& analysis) {
  std::string text = "from";
  for (std::size_t i = 0; i < analysis.transitions.size(); ++i) {
    text += "\t" + name_of(analysis, i);
  }
  text += '\n';
  for (std::size_t i = 0; i < analysis.transitions.size(); ++i) {
    text += name_of(analysis, i);
    for (const std::size_t count : analysis.transitions[i]) {
      text += fmt::format("\t{}", count);
    }
    text += '\n';
  }
  return text;
}

std::string aois_as_json(const AoiAnalysis& analysis) {
  Json fixations = Json::array();
  for (const AoiFixation& f : analysis.fixations) {
    fixations.push_back({{"onset_ns", f.event.begin_ns},
                         {"offset_ns", f.event.end_ns},
                         {"duration_ms", milliseconds(f)},
                         {"u", number_or_null<Json>(f.event.u)},
                         {"v", number_or_null<Json>(f.event.v)},
                         {"aoi", f.aoi ? Json(analysis.areas[*f.aoi].name) : Json(nullptr)},
                         {"share", number_or_null<Json>(f.share)}});
  }
  Json figures = Json::array();
  for (std::size_t i = 0; i < analysis.figures.size(); ++i) {
    const AoiFigures& f = analysis.figures[i];
    figures.push_back({{"aoi", i < analysis.areas.size() ? Json(analysis.areas[i].name) : Json(nullptr)},
                       {"fixations", f.fixations},
                       {"fixation_ms", f.fixation_ms},
                       {"fixation_share", number_or_null<Json>(part(f.fixation_ms, analysis.fixation_ms))},
                       {"visits", f.visits},
                       {"dwell_ms", f.dwell_ms},
                       {"first_fixation_at_ms", number_or_null<Json>(f.first_fixation_at_ms)},
                       {"first_fixation_ms", number_or_null<Json>(f.first_fixation_ms)}});
  }
  const Json json{
      {"aois", std::move(figures)}, {"transitions", analysis.transitions}, {"fixations", std::move(fixations)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
