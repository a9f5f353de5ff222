// SPDX-License-Identifier: Apache-2.0
// Events of both eyes: microsaccades by Engbert and Kliegl's method, and what both eyes do at once.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "gazetrace/gaze_events.hpp"

namespace gazetrace::gaze_events_two_eyes_test {
namespace {

// Both eyes at 500 Hz with a little noise of their own, and steps of the azimuth by minimum jerk in 20 ms.
struct Step {
  std::size_t sample;
  double left_deg, right_deg;
};
GazeLog two_eyes(std::size_t count, const std::vector<Step>& steps) {
  GazeLog log;
  log.kind = GazeKind::direction;
  log.device = GazeDevice::desktop;
  std::uint32_t state = 7;
  const auto noise_deg = [&state] {
    state = state * 1664525U + 1013904223U;
    return (static_cast<double>(state >> 8U) / 16777216.0 - 0.5) * 0.01;
  };
  const auto direction = [](double x_deg, double y_deg) {
    return normalize(Vec3d{std::tan(x_deg * kRadPerDeg), std::tan(y_deg * kRadPerDeg), -1});
  };
  for (std::size_t i = 0; i < count; ++i) {
    double left = 0;
    double right = 0;
    for (const Step& step : steps) {
      const double s = std::clamp((static_cast<double>(i) - static_cast<double>(step.sample)) / 10, 0.0, 1.0);
      const double gone = s * s * s * (10 - 15 * s + 6 * s * s);
      left += step.left_deg * gone;
      right += step.right_deg * gone;
    }
    BothEyes eyes;
    eyes.left = {direction(left + noise_deg(), noise_deg()), 1, 1, GazeValidity::ok};
    eyes.right = {direction(right + noise_deg(), noise_deg()), 1, 1, GazeValidity::ok};
    GazeSample sample;
    sample.t_ns = static_cast<std::int64_t>(i) * 2'000'000;
    sample.direction = normalize(eyes.left.at + eyes.right.at);
    log.samples.push_back(sample);
    log.eyes.push_back(eyes);
  }
  return log;
}

std::size_t count_of(const EyeEvents& events, EyeMovement movement) {
  return static_cast<std::size_t>(std::count_if(events.events.begin(), events.events.end(),
                                                [&](const EyeEvent& e) { return e.movement == movement; }));
}

TEST(GazeEvents, EkFindsMicrosaccadesAtTheirTimes) {
  // On both sides of the degree below which a saccade is a microsaccade.
  const std::vector<Step> steps = {
      {300, 0.4, 0.4}, {700, -0.3, -0.3}, {1200, 0.8, 0.8}, {1600, 1.3, 1.3}, {2000, -3.0, -3.0}};
  const GazeLog log = two_eyes(2400, steps);
  const EyeEvents events = detect_events(log, event_preset("microsaccades"));
  std::vector<const EyeEvent*> fast;
  for (const EyeEvent& event : events.events) {
    if (event.movement == EyeMovement::saccade || event.movement == EyeMovement::microsaccade) {
      fast.push_back(&event);
    }
  }
  ASSERT_EQ(fast.size(), steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(fast[i]->movement, i < 3 ? EyeMovement::microsaccade : EyeMovement::saccade) << i;
    EXPECT_NEAR(static_cast<double>(fast[i]->first), static_cast<double>(steps[i].sample), 3) << i;
    EXPECT_NEAR(static_cast<double>(fast[i]->last), static_cast<double>(steps[i].sample + 10), 3) << i;
    EXPECT_NEAR(fast[i]->amplitude_deg, std::abs(steps[i].left_deg), 0.08) << i;
  }
}

TEST(GazeEvents, BinocularEventsAreThoseOfBothEyes) {
  const GazeLog log = two_eyes(2000, {{300, 0.4, 0.4}, {700, 0.5, 0.0}, {1200, 0.0, 0.5}, {1600, -0.3, -0.3}});
  const EventPreset& preset = event_preset("microsaccades");
  EXPECT_EQ(count_of(detect_events(one_eye(log, Eye::left), preset), EyeMovement::microsaccade), 3U);
  EXPECT_EQ(count_of(detect_events(one_eye(log, Eye::right), preset), EyeMovement::microsaccade), 3U);
  const EyeEvents both = binocular_events(log, preset);
  EXPECT_EQ(count_of(both, EyeMovement::microsaccade), 2U);
  EXPECT_EQ(both.labels[703], EyeMovement::fixation);
  GazeLog alone = log;
  alone.eyes.clear();
  EXPECT_THROW(binocular_events(alone, preset), Error);
}

}  // namespace
}  // namespace gazetrace::gaze_events_two_eyes_test
