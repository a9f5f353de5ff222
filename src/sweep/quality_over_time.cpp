// SPDX-License-Identifier: Apache-2.0
#include "sweep/quality_over_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "results/lookup.hpp"
#include "sweep/scorer.hpp"

namespace gazetrace {
namespace {

bool is_uniform(RowRole role) {
  return role == RowRole::uniform_reference_rate || role == RowRole::equal_samples || role == RowRole::equal_time ||
         role == RowRole::uniform_rate;
}

// Whether a row is a point of the curve of uniform or of foveated rendering. What is rendered on fewer pixels is on
// neither.
bool is_on_uniform_curve(const MeasuredRow& row) {
  return row.resolution_scale == 1 && (is_uniform(row.role) || (row.role == RowRole::test && !row.is_foveated));
}
bool is_on_foveated_curve(const MeasuredRow& row) {
  return row.resolution_scale == 1 && row.role == RowRole::test && row.is_foveated;
}

std::optional<QualityAtTime> point_of(const MeasuredRow& row, const std::string& metric) {
  const auto parts = row.scores.find(metric);
  if (parts == row.scores.end() || !parts->second.contains("whole")) {
    return std::nullopt;
  }
  return QualityAtTime{row.time_s->mean, parts->second.at("whole").value->mean};
}

std::string place_of(const MeasuredRow& row) {
  return row.scene + "/" + row.gaze;
}

std::optional<double> floor_of(const std::vector<ResultReference>& references, const MeasuredRow& row,
                               const std::string& metric) {
  const auto found = std::find_if(references.begin(), references.end(),
                                  [&](const ResultReference& reference) { return reference.key == row.reference; });
  return found == references.end() ? std::nullopt : find_floor(&*found, row.gaze, metric, "whole");
}

// Everything that a row varies except how many samples it takes: rows that agree in it lie on one curve.
std::string family_of(const MeasuredRow& row) {
  static constexpr std::array<std::string_view, 2> kRates{"spp", "region-samples"};
  std::string text;
  for (const auto& [option, value] : row.settings) {
    if (std::find(kRates.begin(), kRates.end(), option) == kRates.end()) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", option, value);
    }
  }
  return text;
}

// A curve of uniform rendering, and the foveated ones that share everything but the sampling with it.
struct QualityCurves {
  struct Foveated {
    std::vector<QualityAtTime> points;
    const MeasuredRow* any = nullptr;
  };
  std::vector<QualityAtTime> uniform;
  std::map<std::string, Foveated> foveated;  // by family
};

// Where no family has a second rate, what the rows vary is itself what trades time for quality: then all of them
// together are one curve.
void join_single_points(QualityCurves& curves) {
  const bool all_single = std::all_of(curves.foveated.begin(), curves.foveated.end(),
                                      [](const auto& family) { return family.second.points.size() == 1; });
  if (!all_single || curves.foveated.size() < 2) {
    return;
  }
  QualityCurves::Foveated joined;
  for (const auto& [family, one] : curves.foveated) {
    joined.points.push_back(one.points.front());
    joined.any = one.any;
  }
  curves.foveated = {{std::string(), joined}};
}

}  // namespace

std::map<std::string, std::map<std::string, std::vector<std::string>>> pareto_fronts(
    const std::vector<std::string>& metrics, const std::vector<MeasuredRow>& rows) {
  std::map<std::string, std::map<std::string, std::vector<std::string>>> fronts;
  std::map<std::string, std::set<std::string>> references;  // by place
  for (const MeasuredRow& row : rows) {
    references[place_of(row)].insert(row.reference);
  }
  const auto front_of = [&](const MeasuredRow& row) {
    const std::string place = place_of(row);
    return references.at(place).size() == 1 ? place : place + "/" + row.reference;
  };
  for (const std::string& metric : metrics) {
    std::map<std::string, std::pair<std::vector<QualityAtTime>, std::vector<std::string>>> by_place;
    for (const MeasuredRow& row : rows) {
      const auto point = point_of(row, metric);
      if (point && row.role != RowRole::wrong_gaze) {
        auto& [points, ids] = by_place[front_of(row)];
        points.push_back(*point);
        ids.push_back(row.id);
      }
    }
    for (const auto& [place, points] : by_place) {
      for (const std::size_t i : pareto_front(points.first, direction_of(metric))) {
        fronts[metric][place].push_back(points.second[i]);
      }
    }
  }
  return fronts;
}

std::vector<ResultFixedQuality> speed_ups_at_quality(const SweepMeasure& measure,
                                                     const std::vector<ResultReference>& references,
                                                     const std::vector<MeasuredRow>& rows) {
  std::vector<ResultFixedQuality> speed_ups;
  for (const auto& [metric, level] : measure.fixed_quality) {
    std::map<std::string, QualityCurves> places;
    for (const MeasuredRow& row : rows) {
      QualityCurves& curves = places[place_of(row) + "/" + row.reference + "/" + row.curve];
      const auto point = point_of(row, metric);
      if (point && is_on_uniform_curve(row)) {
        curves.uniform.push_back(*point);
      } else if (point && is_on_foveated_curve(row)) {
        QualityCurves::Foveated& foveated = curves.foveated[family_of(row)];
        foveated.points.push_back(*point);
        foveated.any = &row;
      }
    }
    for (auto& [name, curves] : places) {
      if (curves.uniform.empty()) {
        continue;
      }
      join_single_points(curves);
      for (const auto& [family, foveated] : curves.foveated) {
        ResultFixedQuality one{metric, foveated.any->scene, foveated.any->gaze, family, level, {}};
        const auto floor = floor_of(references, *foveated.any, metric);
        if (floor && is_better(metric, level, *floor)) {
          one.result.why = fmt::format("the reference itself is only known to {:.4g}", *floor);
        } else {
          one.result = speed_up_at_quality(curves.uniform, foveated.points, direction_of(metric), level);
        }
        speed_ups.push_back(std::move(one));
      }
    }
  }
  return speed_ups;
}

}  // namespace gazetrace
