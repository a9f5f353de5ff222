// SPDX-License-Identifier: Apache-2.0
#include "sweep/shares.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>

#include "core/atomic_file.hpp"
#include "core/text.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/output.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

// Guides, filter, metrics and files cost about as much as so many samples a pixel.
constexpr double kSamplesOfAPixel = 2;
// Rates that the search for equal time tries, as a rule; each is a rendering without scores.
constexpr int kUsualRateTries = 3;

double samples_of(const PlannedRow& row, double spp, int repeats) {
  double pixels = 0;
  for (const FrameRequest& request : row.plan.frames) {
    pixels += static_cast<double>(request.width_px) * request.height_px;
  }
  return (spp + kSamplesOfAPixel) * pixels * repeats;
}

// Of what follows from the test alone: its baselines of equal samples and time, and its costs by region.
double samples_beside(const SweepPlan& plan, const PlannedRow& test, double spp) {
  const int repeats = plan.measure.repeats;
  double samples = 0;
  for (const PlannedRow& row : baselines_of_samples(plan, test, spp)) {
    samples += samples_of(row, planned_spp(row), repeats);
  }
  if (plan.measure.baselines.equal_time && is_foveated(plan.tests[test.test])) {
    samples += samples_of(test, spp, repeats + kUsualRateTries);
  }
  if (const std::optional<PlannedRow> row = cost_row(plan, test)) {
    samples += samples_of(*row, planned_spp(*row), 1);
  }
  return samples;
}

// What is measured by one task: rows of the same pixels, and what follows from them.
struct Unit {
  const SceneRows* rows = nullptr;
  const PlannedRow* first = nullptr;
};

struct Divided {
  std::vector<SceneRows> scenes;
  std::vector<Unit> units;  // in the order of the rows, so that baselines lie near their tests
  std::string digest;
};

Divided units_of(const SweepPlan& plan, std::uint32_t count) {
  Divided divided;
  std::vector<std::string> notes;
  for (std::size_t scene = 0; scene < plan.scenes.size(); ++scene) {
    divided.scenes.emplace_back(plan, scene, notes);
  }
  NamedValues parts{{"count", std::to_string(count)}, {"repeats", std::to_string(plan.measure.repeats)}};
  for (const SceneRows& rows : divided.scenes) {
    for (const PlannedRow& row : rows) {
      if (&deciding_row(rows, row) == &row) {
        divided.units.push_back({&rows, &row});
        parts.emplace_back(row.row.id, row.digest);
      }
    }
  }
  divided.digest = digest_settings(parts);
  return divided;
}

double predicted_samples(const SweepPlan& plan, const Unit& unit) {
  const double spp = planned_spp(*unit.first);
  double samples = samples_of(*unit.first, spp, plan.measure.repeats);
  for (const PlannedRow* row : unit.rows->sharing(*unit.first)) {
    if (row->row.role == RowRole::test) {
      samples += samples_beside(plan, *row, spp);
    }
  }
  return samples;
}

// Each unit goes where its middle lies in the whole: tasks get neighbours, and about the same cost.
std::vector<SweepShare> shares_by_cost(const SweepPlan& plan, const std::vector<Unit>& units, std::uint32_t count) {
  std::vector<double> costs;
  for (const Unit& unit : units) {
    costs.push_back(predicted_samples(plan, unit));
  }
  const double whole = std::accumulate(costs.begin(), costs.end(), 0.0);
  std::vector<SweepShare> shares(count);
  double before = 0;
  for (std::size_t i = 0; i < units.size(); ++i) {
    const auto at = static_cast<std::size_t>((before + costs[i] / 2) / whole * count);
    SweepShare& share = shares[std::min<std::size_t>(at, count - 1)];
    share.rows.push_back(units[i].first->row.id);
    share.samples += costs[i];
    before += costs[i];
  }
  return shares;
}

std::string text_of(const std::string& digest, const std::vector<SweepShare>& shares) {
  Json chunks = Json::array();
  for (const SweepShare& share : shares) {
    chunks.push_back({{"rows", share.rows}, {"samples", share.samples}});
  }
  return Json{{"format", "gazetrace-sweep-chunks-1"}, {"digest", digest}, {"chunks", chunks}}.dump(1) + "\n";
}

// Nothing where there is no such file, or a damaged one, which is made again.
std::optional<std::vector<SweepShare>> written_shares(const std::string& path, const Divided& divided,
                                                      std::uint32_t count) {
  try {
    const Json json = Json::parse(read_text_file(path));
    if (json.at("digest") != divided.digest) {
      return std::nullopt;
    }
    std::vector<SweepShare> shares;
    for (const Json& chunk : json.at("chunks")) {
      shares.push_back({chunk.at("rows").get<std::vector<std::string>>(), chunk.at("samples")});
    }
    return shares.size() == count ? std::optional(shares) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace

const PlannedRow& deciding_row(const SceneRows& rows, const PlannedRow& row) {
  return *rows.sharing(row).front();
}

std::vector<SweepShare> divide_sweep(const SweepPlan& plan, std::uint32_t count) {
  return shares_by_cost(plan, units_of(plan, count).units, count);
}

std::set<std::string> rows_of_task(const SweepPlan& plan, const SweepTask& task) {
  const Divided divided = units_of(plan, task.count);
  const std::string path = fmt::format("{}/chunks.{}.{}.json", plan.directory, task.count, divided.digest.substr(0, 8));
  std::optional<std::vector<SweepShare>> shares = written_shares(path, divided, task.count);
  if (!shares) {
    shares = shares_by_cost(plan, divided.units, task.count);
    const std::string text = text_of(divided.digest, *shares);
    if (!create_file_once(path, std::as_bytes(std::span(text.data(), text.size())))) {
      if (const auto first = written_shares(path, divided, task.count)) {
        shares = first;
      } else {
        write_text_atomically(path, text);  // damaged
      }
    }
  }
  const std::vector<std::string>& rows = shares->at(task.number - 1).rows;
  return {rows.begin(), rows.end()};
}

}  // namespace gazetrace
