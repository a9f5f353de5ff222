// SPDX-License-Identifier: Apache-2.0
// Rows of one or more scenes, arranged for comparisons.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foveation_gain/bootstrap.hpp"
#include "foveation_gain/rows.hpp"
#include "foveation_gain/study.hpp"

namespace gazetrace::gain {

enum class Rival : std::uint8_t { equal_samples, equal_time, low_resolution, in_blocks };
inline constexpr std::array<Rival, 4> kRivals{Rival::equal_samples, Rival::equal_time, Rival::low_resolution,
                                              Rival::in_blocks};
inline constexpr std::array<const char*, kRivals.size()> kRivalNames{"equal samples", "equal time", "low resolution",
                                                                     "in blocks"};

struct Comparison {
  double own = 0, other = 0;  // means of the errors
  Interval effect;            // relMSE: geometric mean of own / other; FLIP, JOD: mean of own - other
  bool beneath_floor = false;
  std::size_t leaves = 0, gazes = 0;
  std::size_t continued = 0;  // of them, beyond the measured times
};
// "wins", "loses", "even": the interval lies on one side or not; "floor": beneath it nothing is claimed; "few": of less
// than kFewestGazes no interval is to be trusted; "beyond": most of it lies beyond the measured times.
inline constexpr std::size_t kFewestGazes = 6;
std::string verdict(const Comparison& comparison, Metric metric);

class Results {
 public:
  explicit Results(const std::vector<Row>& rows);

  [[nodiscard]] const std::vector<std::string>& scenes() const { return scenes_; }
  [[nodiscard]] const std::vector<std::string>& models() const { return models_; }
  [[nodiscard]] const std::vector<std::string>& filters() const { return filters_; }
  [[nodiscard]] const std::vector<std::string>& setups() const { return setups_; }
  [[nodiscard]] bool has_times() const { return !times_.empty(); }
  [[nodiscard]] std::size_t gazes() const;  // of all scenes

  // Of an arm against another; `scene`: only this one, or all where empty.
  [[nodiscard]] Comparison compare(const std::string& model, const std::string& filter, Rival rival, Metric metric,
                                   std::size_t column) const;
  [[nodiscard]] Comparison compare_arms(const std::string& arm, const std::string& other, const std::string& filter,
                                        Metric metric, std::size_t column, const std::string& scene = "") const;
  // Times the budget at which uniform through the same filter has the same error, within the measured rates.
  [[nodiscard]] Interval equal_rate(const std::string& model, const std::string& filter, Metric metric) const;
  // The larger of all deviations of a model's samples from those of uniform at rate 1.
  [[nodiscard]] double sample_deviation() const;
  // Over all rounds, the median of each stage; empty: not timed. A gaze that was not timed takes as long as the timed
  // ones by the mean, and so does the arm where no gaze is named; with `spp` their tracing is scaled to so many
  // samples.
  [[nodiscard]] std::optional<double> time_ms(const std::string& scene, const std::string& arm,
                                              const std::string& filter, const std::string& gaze,
                                              std::optional<double> spp = std::nullopt) const;
  [[nodiscard]] double mean_share(std::size_t column) const;
  [[nodiscard]] double mean_floor(Metric metric, std::size_t column, const std::string& scene = "") const;

 private:
  struct Pair {
    double own = 0, other = 0;
    bool continued = false;
  };
  struct Place {
    const std::string& scene;
    const std::string& gaze;
    int seed = 0;
  };
  template <class PairAt>
  [[nodiscard]] Comparison compare_pairs(Metric metric, std::size_t column, const std::string& scene,
                                         const PairAt& pair_at) const;
  [[nodiscard]] const Row* score(const Place& place, const std::string& arm, const std::string& filter) const;
  [[nodiscard]] std::optional<double> error(const Place& place, const std::string& arm, const std::string& filter,
                                            Metric metric, std::size_t column) const;
  [[nodiscard]] std::optional<Pair> at_equal_time(const Place& place, const std::string& model,
                                                  const std::string& filter, Metric metric, std::size_t column) const;

  std::vector<std::string> scenes_, models_, filters_, setups_;
  std::map<std::string, std::vector<std::string>> gazes_;  // of a scene
  int seeds_ = 0;
  std::map<std::string, Row> rows_;                              // scores and floors by what they are of
  std::map<std::string, std::vector<Row>> times_;                // all rounds, by scene, arm, filter, gaze
  std::map<std::string, std::vector<std::string>> timed_gazes_;  // by scene, arm, filter
};

}  // namespace gazetrace::gain
