// SPDX-License-Identifier: Apache-2.0
// The vestibulo-ocular handedness test, described at VorTest.
#include <algorithm>
#include <cmath>

#include "core/statistics.hpp"
#include "gaze/angles.hpp"
#include "gaze/inspect/inspect.hpp"

namespace gazetrace {
namespace {

constexpr std::int64_t kStretchNs = 250'000'000;
constexpr std::int64_t kSpanNs = 50'000'000;  // the span of each speed, as single samples are too noisy
constexpr double kLeastHeadDegPerS = 5, kMostHeadDegPerS = 150;
constexpr std::size_t kLeastStretches = 8;
constexpr double kMostChance = 0.01;  // of the sign test, two-sided
constexpr double kLeastRatio = 1.15;

// A sample with the head at its time.
struct Seen {
  std::int64_t t_ns;
  Vec3d direction;
  Quatd head;
};

std::vector<Seen> with_head(const GazeLog& log) {
  std::vector<Seen> seen;
  seen.reserve(log.samples.size());
  HeadWalker head(log.head);
  for (const GazeSample& sample : log.samples) {
    const bool has_head = sample.t_ns >= log.head.front().t_ns && sample.t_ns <= log.head.back().t_ns;
    if (has_head && is_usable(sample.validity) && is_finite(sample.direction)) {
      seen.push_back({sample.t_ns, sample.direction, head.orientation(sample.t_ns)});
    }
  }
  return seen;
}

// Degrees per second, about the head's own axes.
Vec3d head_speed(const Seen& a, const Seen& b) {
  const Quatd& p = a.head;
  Quatd turn = Quatd{-p.x, -p.y, -p.z, p.w} * b.head;
  if (turn.w < 0) {
    turn = {-turn.x, -turn.y, -turn.z, -turn.w};
  }
  const Vec3d axis{turn.x, turn.y, turn.z};
  const double sine = length(axis);
  const double angle = 2 * std::atan2(sine, turn.w);
  const double seconds = static_cast<double>(b.t_ns - a.t_ns) * 1e-9;
  return sine > 0 ? axis * (angle * kDegPerRad / sine / seconds) : Vec3d{};
}

double world_speed(const Seen& a, const Seen& b, char flipped) {
  const auto turned = [&](Vec3d d) {
    d.x *= flipped == 'x' ? -1 : 1;
    d.y *= flipped == 'y' ? -1 : 1;
    return d;
  };
  const double angle = angle_between_rad(rotate(a.head, turned(a.direction)), rotate(b.head, turned(b.direction)));
  return angle * kDegPerRad / (static_cast<double>(b.t_ns - a.t_ns) * 1e-9);
}

// The two-sided probability that a fair coin deviates from one half at least as far.
double sign_test(std::size_t heads, std::size_t n) {
  const std::size_t few = std::min(heads, n - heads);
  double chance = 0;
  for (std::size_t k = 0; k <= few; ++k) {
    const auto nn = static_cast<double>(n);
    const auto kk = static_cast<double>(k);
    chance += std::exp(std::lgamma(nn + 1) - std::lgamma(kk + 1) - std::lgamma(nn - kk + 1) - nn * std::log(2.0));
  }
  return std::min(1.0, 2 * chance);
}

struct Speeds {
  std::vector<double> yaw, pitch, as_read, flipped_x, flipped_y;
};

VorTest decide(char axis, const std::vector<std::array<double, 2>>& stretches) {
  VorTest test;
  test.axis = axis;
  test.stretches = stretches.size();
  std::vector<double> as_read;
  std::vector<double> flipped;
  for (const auto& [read, other] : stretches) {
    test.steadier_as_read += read < other ? 1 : 0;
    as_read.push_back(read);
    flipped.push_back(other);
  }
  if (stretches.empty()) {
    return test;
  }
  test.speed_as_read_deg_s = lower_quantile(as_read, 0.5);
  test.speed_flipped_deg_s = lower_quantile(flipped, 0.5);
  if (test.stretches < kLeastStretches || sign_test(test.steadier_as_read, test.stretches) > kMostChance) {
    return test;
  }
  const bool right = 2 * test.steadier_as_read > test.stretches;
  const double ratio =
      right ? test.speed_flipped_deg_s / test.speed_as_read_deg_s : test.speed_as_read_deg_s / test.speed_flipped_deg_s;
  if (ratio >= kLeastRatio) {
    test.verdict = right ? AxisVerdict::confirmed : AxisVerdict::flipped;
  }
  return test;
}

}  // namespace

std::vector<VorTest> test_vor(const GazeLog& log) {
  if (log.kind != GazeKind::direction || log.head.size() < 2) {
    return {};
  }
  const std::vector<Seen> seen = with_head(log);
  std::vector<std::array<double, 2>> for_x;
  std::vector<std::array<double, 2>> for_y;
  for (std::size_t begin = 0; begin < seen.size();) {
    Speeds s;
    std::size_t i = begin;
    std::size_t ahead = begin;
    for (; i < seen.size() && seen[i].t_ns - seen[begin].t_ns < kStretchNs; ++i) {
      while (ahead < seen.size() && seen[ahead].t_ns - seen[i].t_ns < kSpanNs) {
        ++ahead;
      }
      // Nothing is known across a loss.
      if (ahead == seen.size() || seen[ahead].t_ns - seen[i].t_ns > 2 * kSpanNs) {
        continue;
      }
      const Vec3d head = head_speed(seen[i], seen[ahead]);
      s.yaw.push_back(head.y);
      s.pitch.push_back(head.x);
      s.as_read.push_back(world_speed(seen[i], seen[ahead], ' '));
      s.flipped_x.push_back(world_speed(seen[i], seen[ahead], 'x'));
      s.flipped_y.push_back(world_speed(seen[i], seen[ahead], 'y'));
    }
    begin = i;
    if (s.yaw.size() < 5) {
      continue;
    }
    // Medians are used because a saccade within the stretch takes less than half of it.
    const double yaw = std::abs(lower_quantile(s.yaw, 0.5));
    const double pitch = std::abs(lower_quantile(s.pitch, 0.5));
    const double as_read = lower_quantile(s.as_read, 0.5);
    if (yaw >= kLeastHeadDegPerS && yaw <= kMostHeadDegPerS && yaw > pitch) {
      for_x.push_back({as_read, lower_quantile(s.flipped_x, 0.5)});
    } else if (pitch >= kLeastHeadDegPerS && pitch <= kMostHeadDegPerS && pitch > yaw) {
      for_y.push_back({as_read, lower_quantile(s.flipped_y, 0.5)});
    }
  }
  return {decide('x', for_x), decide('y', for_y)};
}

}  // namespace gazetrace
