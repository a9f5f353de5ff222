// SPDX-License-Identifier: Apache-2.0
// A step of processing is one file in steps/ and one line in steps.def. This header also declares what several steps
// need.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/hash.hpp"
#include "gaze/angles.hpp"
#include "gazelog/eyes.hpp"
#include "gazetrace/gaze_process.hpp"

namespace gazetrace {

struct GazeStepEntry : GazeStepInfo {
  // Changes the log and says what it did.
  std::string (*apply)(GazeLog& log, const GazeStep& step);
};

// A run of usable samples [first, end) whose neighbours are no farther apart than three median steps. Filters work
// within such runs, so that they never see blinks and losses and never reach across them.
struct FilterRun {
  std::size_t first = 0, end = 0;
};
std::vector<FilterRun> filter_runs(const GazeLog& log);

// Sets the place from a vector as place_of() gives it: a direction is normalized, and a place on a screen gets the
// validity of being on it or not.
void set_place(GazeSample& sample, GazeKind kind, const Vec3d& place);
void set_direction(GazeSample& sample, GazeKind kind, const ScreenAngles& screen, const Vec3d& direction);

struct OneEuroSettings {
  double min_cutoff_hz = 1;
  double beta = 0;  // per unit of x in a second
  double d_cutoff_hz = 1;
};

// The 1 euro filter, algorithm 1 of Casiez, Roussel & Vogel, CHI 2012, applied to points. The speed that raises the
// cutoff is the length of the filtered derivative, so that the filter does not depend on the axes.
//   dx = (x - x^ before) / T,  dx^ = lowpass(dx, d_cutoff),  cutoff = min_cutoff + beta |dx^|,
//   x^ = lowpass(x, cutoff),   lowpass: a x + (1 - a) x^ before, a = 1 / (1 + 1 / (2 pi cutoff T))
// Times must increase.
std::vector<Vec3d> one_euro_filter(const std::vector<std::int64_t>& t_ns, const std::vector<Vec3d>& x,
                                   const OneEuroSettings& settings);

// Random numbers as functions of (seed, stream, index, dimension), which depend on no order and keep no state.
class CounterRandom {
 public:
  // Streams keep apart what is drawn for different purposes.
  CounterRandom(std::uint64_t seed, std::uint64_t stream) : key_(hash_combine(seed, stream)) {}

  // In (0, 1): never 0, so that its logarithm is finite.
  [[nodiscard]] double uniform(std::uint64_t index, std::uint64_t dimension) const {
    const std::uint64_t bits = hash_combine(hash_combine(key_, index), dimension) >> 11U;
    return (static_cast<double>(bits) + 0.5) * 0x1p-53;
  }
  // Two independent normal numbers of mean 0 and variance 1 (Box & Muller 1958).
  [[nodiscard]] Vec2d normals(std::uint64_t index, std::uint64_t dimension) const {
    const double radius = std::sqrt(-2.0 * std::log(uniform(index, 2 * dimension)));
    const double angle = 2.0 * kPi * uniform(index, 2 * dimension + 1);
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

 private:
  std::uint64_t key_;
};

}  // namespace gazetrace
