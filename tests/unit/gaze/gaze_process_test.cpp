// SPDX-License-Identifier: Apache-2.0
// Steps of processing against closed forms, statistics with stated bounds, and what they must leave alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "gaze/process/gaze_step.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_process.hpp"
#include "gazetrace/gaze_synth.hpp"

namespace gazetrace::gaze_process_test {
namespace {

// A screen 1 m wide and high at 1 m: u and v as functions of seconds; NaN is lost.
GazeLog screen_log(std::size_t count, std::int64_t step_ns, const std::function<Vec2d(double)>& place) {
  GazeLog log;
  log.source = "hand.csv";
  log.recording_geometry = DisplayGeometry{1000, 1000, 100, 100, 100, 0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    GazeSample sample;
    sample.t_ns = static_cast<std::int64_t>(i) * step_ns;
    sample.row = static_cast<std::int64_t>(i) + 1;
    const Vec2d at = place(static_cast<double>(sample.t_ns) * 1e-9);
    sample.u = at.x;
    sample.v = at.y;
    sample.validity = std::isnan(at.x) ? GazeValidity::lost : GazeValidity::ok;
    log.samples.push_back(sample);
  }
  return log;
}

GazeLog processed(const GazeLog& log, const std::vector<std::string>& steps) {
  std::vector<GazeStep> parsed;
  for (const std::string& step : steps) {
    parsed.push_back(parse_gaze_step(step));
  }
  return process_gaze(log, parsed).log;
}

const double kLost = std::nan("");

TEST(GazeProcess, TextAndStepAreTheSame) {
  for (const GazeStepInfo& info : gaze_steps()) {
    const GazeStep step = parse_gaze_step(info.name);
    const GazeStep again = parse_gaze_step(to_string(step));
    ASSERT_EQ(again.parameters.size(), info.parameters.size());
    for (std::size_t i = 0; i < info.parameters.size(); ++i) {
      EXPECT_EQ(again.parameters[i].value, info.parameters[i].value) << to_string(step);
    }
  }
  EXPECT_EQ(to_string(parse_gaze_step("fill-gaps: max = 1.5ms , angle=2deg")), "fill-gaps:max=1500000ns,angle=2deg");
  EXPECT_EQ(parse_gaze_step("fill-gaps:max=0.1s").duration_ns("max"), 100'000'000);
}

TEST(GazeProcess, BadStepsAreNamed) {
  const auto message = [](const char* text) -> std::string {
    try {
      parse_gaze_step(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(message("medain").find("did you mean 'median'"), std::string::npos);
  EXPECT_NE(message("median:sample=3").find("did you mean 'samples'"), std::string::npos);
  EXPECT_NE(message("median:samples").find("has no value"), std::string::npos);
  EXPECT_NE(message("median:samples=3.5").find("whole number"), std::string::npos);
  EXPECT_NE(message("fill-gaps:max=75").find("a duration with its unit"), std::string::npos);
  EXPECT_NE(message("drop:share=1.5").find("a share from 0 to 1"), std::string::npos);
  EXPECT_NE(message("noise:sd=nan").find("degrees"), std::string::npos);
  EXPECT_NE(message("snap-to-landing:a=1").find("no parameters"), std::string::npos);
}

TEST(GazeProcess, NoStepChangesNothing) {
  SynthSettings settings;
  settings.lost_share = 0.1;
  const GazeLog log = synthesize_gaze(settings).log;
  const ProcessedGaze same = process_gaze(log, {});
  EXPECT_TRUE(same.reports.empty());
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    EXPECT_EQ(same.log.samples[i].validity, log.samples[i].validity);
  }
}

TEST(GazeProcess, MedianRemovesASpikeAndKeepsAnEdge) {
  const GazeLog log = screen_log(40, 10'000'000, [](double t) {
    return Vec2d{std::abs(t - 0.1) < 1e-6 ? 0.9 : t < 0.195 ? 0.2 : 0.6, 0.5};
  });
  const GazeLog out = processed(log, {"median:samples=3"});
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_EQ(out.samples[i].u, i < 20 ? 0.2 : 0.6) << i;
    EXPECT_EQ(out.samples[i].v, 0.5);
  }
  GazeLog head = log;
  head.kind = GazeKind::direction;
  for (GazeSample& s : head.samples) {
    s.direction = {std::sin(s.u), 0, -std::cos(s.u)};
  }
  const GazeLog turned = processed(head, {"median:samples=3"});
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_NEAR(std::atan2(turned.samples[i].direction.x, -turned.samples[i].direction.z), i < 20 ? 0.2 : 0.6, 1e-15);
  }
  EXPECT_THROW(processed(log, {"median:samples=4"}), Error);
}

TEST(GazeProcess, SavitzkyGolayKeepsPolynomials) {
  for (const int order : {0, 1, 2, 3, 4}) {
    const auto polynomial = [&](double t) {
      double value = 0.3;
      for (int p = 1; p <= order; ++p) {
        value += std::pow(t - 0.1, p) / p;
      }
      return Vec2d{value, 1 - value};
    };
    GazeLog log = screen_log(100, 2'000'000, polynomial);
    // Uneven steps too: the fit is over the samples' own times.
    for (std::size_t i = 0; i < log.samples.size(); i += 3) {
      log.samples[i].t_ns += 700'000;
      const Vec2d at = polynomial(static_cast<double>(log.samples[i].t_ns) * 1e-9);
      log.samples[i].u = at.x;
      log.samples[i].v = at.y;
    }
    const GazeLog out = processed(log, {"savitzky-golay:window=19ms,order=" + std::to_string(order)});
    for (std::size_t i = 0; i < 100; ++i) {
      EXPECT_NEAR(out.samples[i].u, log.samples[i].u, 1e-11) << order << " " << i;
      EXPECT_NEAR(out.samples[i].v, log.samples[i].v, 1e-11);
    }
  }
  // One order higher is not kept.
  const GazeLog cubic = screen_log(100, 2'000'000, [](double t) { return Vec2d{100 * t * t * t * t, 0.5}; });
  EXPECT_GT(std::abs(processed(cubic, {"savitzky-golay"}).samples[50].u - cubic.samples[50].u), 1e-8);
}

// The classic table: order 2 over 5 samples weighs -3 12 17 12 -3 over 35.
TEST(GazeProcess, SavitzkyGolayHasTheTabledWeights) {
  const GazeLog log = screen_log(41, 2'000'000, [](double t) {
    return Vec2d{std::abs(t - 0.04) < 1e-6 ? 1.0 : 0.0, 0};
  });
  const GazeLog out = processed(log, {"savitzky-golay:window=8ms"});
  const double expected[] = {-3.0 / 35, 12.0 / 35, 17.0 / 35, 12.0 / 35, -3.0 / 35};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(out.samples[18 + i].u, expected[i], 1e-14);
  }
  EXPECT_NEAR(out.samples[17].u, 0, 1e-14);
}

double amplitude_after(double frequency_hz, const std::string& step) {
  const GazeLog log = screen_log(4000, 1'000'000, [&](double t) {
    return Vec2d{0.5 + 0.1 * std::sin(2 * kPi * frequency_hz * t), 0.5 + 0.1 * std::cos(2 * kPi * frequency_hz * t)};
  });
  const GazeLog out = processed(log, {step});
  double sine = 0;
  double cosine = 0;
  // Away from the ends, over whole periods.
  for (std::size_t i = 1000; i < 3000; ++i) {
    const double phase = 2 * kPi * frequency_hz * static_cast<double>(i) * 1e-3;
    sine += (out.samples[i].u - 0.5) * std::sin(phase);
    cosine += (out.samples[i].u - 0.5) * std::cos(phase);
  }
  EXPECT_NEAR(cosine / 1000 / 0.1, 0, 1e-9) << "phase at " << frequency_hz;
  return sine / 1000 / 0.1;
}

TEST(GazeProcess, ButterworthHasItsGainAndNoPhase) {
  for (const int order : {2, 4, 6}) {
    const std::string step = "butterworth:cutoff=50,order=" + std::to_string(order);
    // Two passes: half the amplitude, 6 dB, at the cut-off.
    EXPECT_NEAR(amplitude_after(50, step), 0.5, 1e-9);
    for (const double f : {5.0, 20.0, 100.0, 200.0}) {
      const double ratio = std::tan(kPi * f / 1000) / std::tan(kPi * 50 / 1000);
      EXPECT_NEAR(amplitude_after(f, step), 1 / (1 + std::pow(ratio, 2 * order)), 1e-9) << order << " " << f;
    }
  }
}

TEST(GazeProcess, ButterworthKeepsLinesAndIsSymmetric) {
  const GazeLog line = screen_log(300, 1'000'000, [](double t) { return Vec2d{0.2 + t, 0.8 - 2 * t}; });
  const GazeLog out = processed(line, {"butterworth:cutoff=30"});
  for (std::size_t i = 0; i < 300; ++i) {
    EXPECT_NEAR(out.samples[i].u, line.samples[i].u, 1e-4) << i;
  }
  const GazeLog impulse = screen_log(1001, 1'000'000, [](double t) {
    return Vec2d{std::abs(t - 0.5) < 1e-6 ? 1.0 : 0.0, 0};
  });
  const GazeLog bell = processed(impulse, {"butterworth:cutoff=30"});
  for (std::size_t k = 1; k < 400; ++k) {
    EXPECT_NEAR(bell.samples[500 - k].u, bell.samples[500 + k].u, 1e-12);
  }
  EXPECT_THROW(processed(line, {"butterworth:cutoff=500"}), Error);
  EXPECT_THROW(processed(line, {"butterworth:order=3"}), Error);
}

// Casiez et al. 2012, algorithm 1, by hand: T = 0.1 s, min cut-off 1 Hz, beta 0.5, derivative cut-off 1 Hz.
//   a(1 Hz) = 1 / (1 + 1 / (2 pi 0.1)) = 0.38586954509503757
//   x = 0, 1, 1
//   i = 1: dx = 10, dx^ = 3.8586954509503757, cutoff = 2.9293477254751878, a = 0.6479439535, x^ = a
//   i = 2: dx = (1 - 0.6479...) / 0.1, and so on
TEST(GazeProcess, OneEuroFollowsThePaper) {
  const auto filtered = one_euro_filter({0, 100'000'000, 200'000'000}, {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, {1, 0.5, 1});
  ASSERT_EQ(filtered.size(), 3U);
  EXPECT_EQ(filtered[0].x, 0);
  const double a1 = 0.38586954509503757;
  const double first = 2 * kPi * 2.9293477254751878 * 0.1 / (1 + 2 * kPi * 2.9293477254751878 * 0.1);
  EXPECT_NEAR(filtered[1].x, first, 1e-15);
  const double derivative = a1 * (1 - first) * 10 + (1 - a1) * 3.8586954509503757;
  const double w = 2 * kPi * (1 + 0.5 * derivative) * 0.1;
  EXPECT_NEAR(filtered[2].x, w / (1 + w) + (1 - w / (1 + w)) * first, 1e-15);
}

TEST(GazeProcess, OneEuroComesToRestAndLagsWhenSlow) {
  const GazeLog step = screen_log(2000, 2'000'000, [](double t) { return Vec2d{t < 1 ? 0.3 : 0.7, 0.5}; });
  const GazeLog out = processed(step, {"one-euro"});
  EXPECT_NEAR(out.samples[499].u, 0.3, 1e-12);
  EXPECT_GT(out.samples[505].u, 0.3);
  EXPECT_LT(out.samples[505].u, 0.7);
  EXPECT_NEAR(out.samples[1999].u, 0.7, 1e-6);
}

TEST(GazeProcess, FillsShortGapsInFixationsOnly) {
  // 10 ms steps; gaps of 3 samples (40 ms) at 10, of 8 (90 ms) at 30, of 3 across a 5 deg jump at 50, a blink at 70.
  const auto make = [] {
    GazeLog log = screen_log(100, 10'000'000, [](double t) {
      const auto i = static_cast<int>(std::lround(t * 100));
      const bool lost = (i >= 10 && i < 13) || (i >= 30 && i < 38) || (i >= 50 && i < 53) || (i >= 70 && i < 73);
      return Vec2d{lost ? kLost : i < 50 ? 0.5 + 0.0001 * i : 0.6, lost ? kLost : 0.5};
    });
    log.samples[71].validity = GazeValidity::blink;
    return log;
  };
  const GazeLog out = processed(make(), {"fill-gaps"});
  for (std::size_t i = 0; i < 100; ++i) {
    const bool filled = i >= 10 && i < 13;
    EXPECT_EQ(out.samples[i].validity == GazeValidity::interpolated, filled) << i;
    if (filled) {
      EXPECT_NEAR(out.samples[i].u, 0.5 + 0.0001 * static_cast<double>(i), 1e-15);
    }
  }
  EXPECT_EQ(process_gaze(make(), {parse_gaze_step("fill-gaps")}).reports.at(0),
            "fill-gaps:max=75ms,angle=1deg: 1 gaps filled, 3 samples; left: 1 longer, 1 blinks, 1 across a saccade");
  // Where the log itself names a blink or a saccade, the gap stays.
  for (const GazeEventType type : {GazeEventType::blink, GazeEventType::saccade}) {
    GazeLog named = make();
    named.events.push_back({type, Eye::cyclopean, 105'000'000, 115'000'000, "", 0});
    EXPECT_EQ(processed(named, {"fill-gaps"}).samples[11].validity, GazeValidity::lost);
  }
  // Without angles nobody knows whether the gaze moved.
  GazeLog unknown = make();
  unknown.recording_geometry.reset();
  EXPECT_THROW(processed(unknown, {"fill-gaps"}), Error);
}

TEST(GazeProcess, BlinksArePaddedOnceAndNotIntoEachOther) {
  GazeLog log = screen_log(100, 10'000'000, [](double t) {
    const auto i = static_cast<int>(std::lround(t * 100));
    return (i >= 40 && i < 50) || (i >= 55 && i < 65) ? Vec2d{kLost, kLost} : Vec2d{0.5, 0.5};
  });
  const GazeLog out = processed(log, {"pad-blinks:before=20ms,after=30ms"});
  for (std::size_t i = 0; i < 100; ++i) {
    const bool padded = (i >= 38 && i < 40) || (i >= 50 && i < 55) || (i >= 65 && i < 68);
    EXPECT_EQ(out.samples[i].validity == GazeValidity::blink, padded) << i;
  }
  // A loss of 5 s is no blink.
  const GazeLog away = screen_log(600, 10'000'000, [](double t) {
    return t > 0.495 && t < 5.5 ? Vec2d{kLost, kLost} : Vec2d{0.5, 0.5};
  });
  EXPECT_TRUE(is_usable(processed(away, {"pad-blinks"}).samples[49].validity));
}

TEST(GazeProcess, NoiseHasTheStatedSpreadInDegrees) {
  for (const GazeKind kind : {GazeKind::screen, GazeKind::direction}) {
    SynthSettings settings;
    settings.kind = kind;
    settings.duration_ns = 20'000'000'000;
    const GazeLog log = synthesize_gaze(settings).log;
    const GazeDirections before = gaze_directions(log);
    const GazeDirections after = gaze_directions(processed(log, {"noise:sd=0.4,seed=3"}));
    double squares = 0;
    for (std::size_t i = 0; i < before.t_ns.size(); ++i) {
      squares += std::pow(angle_between_rad(before.direction[i], after.direction[i]) * kDegPerRad / 0.4, 2);
    }
    // Chi-square of two degrees of freedom a sample; 4.9 standard deviations of its normal limit are 1e-6.
    const double freedom = 2.0 * static_cast<double>(before.t_ns.size());
    EXPECT_NEAR(squares, freedom, 4.9 * std::sqrt(2 * freedom));
  }
}

TEST(GazeProcess, NoiseAndLossDependOnSeedAndTimeAlone) {
  const GazeLog log = synthesize_gaze({}).log;
  GazeLog part = log;
  part.samples.erase(part.samples.begin(), part.samples.begin() + 1000);
  const GazeLog whole = processed(log, {"noise", "drop"});
  const GazeLog rest = processed(part, {"noise", "drop"});
  const GazeLog other = processed(log, {"noise:seed=2", "drop:seed=2"});
  bool differs = false;
  for (std::size_t i = 1000; i < log.samples.size(); ++i) {
    EXPECT_EQ(whole.samples[i].u, rest.samples[i - 1000].u);
    EXPECT_EQ(whole.samples[i].validity, rest.samples[i - 1000].validity);
    differs = differs || whole.samples[i].u != other.samples[i].u;
  }
  EXPECT_TRUE(differs);
}

TEST(GazeProcess, DropsTheStatedShare) {
  SynthSettings settings;
  settings.duration_ns = 100'000'000'000;
  const GazeLog log = synthesize_gaze(settings).log;
  for (const double share : {0.0, 0.05, 0.5, 1.0}) {
    const GazeLog out = processed(log, {"drop:share=" + std::to_string(share)});
    const auto lost = std::count_if(out.samples.begin(), out.samples.end(),
                                    [](const GazeSample& s) { return s.validity == GazeValidity::lost; });
    const auto count = static_cast<double>(log.samples.size());
    // Binomial; 4.9 standard deviations are 1e-6.
    EXPECT_NEAR(static_cast<double>(lost), share * count, 4.9 * std::sqrt(count * share * (1 - share)) + 0.5);
  }
}

TEST(GazeProcess, OffsetTurnsTheGaze) {
  SynthSettings settings;
  settings.kind = GazeKind::direction;
  const GazeLog log = synthesize_gaze(settings).log;
  const GazeLog out = processed(log, {"offset:x=2,y=0"});
  const GazeLog up = processed(log, {"offset:y=1.5deg"});
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    EXPECT_NEAR(angle_between_rad(log.samples[i].direction, out.samples[i].direction) * kDegPerRad, 2, 1e-9);
    EXPECT_GT(up.samples[i].direction.y, log.samples[i].direction.y);
    EXPECT_NEAR(angle_between_rad(log.samples[i].direction, up.samples[i].direction) * kDegPerRad, 1.5, 1e-9);
  }
}

TEST(GazeProcess, SnappedSaccadesAreWhereTheyLand) {
  SynthSettings settings;
  settings.drift_deg = 0;
  const SynthGaze synth = synthesize_gaze(settings);
  const ProcessedGaze snapped = process_gaze(synth.log, {parse_gaze_step("snap-to-landing")});
  EXPECT_TRUE(snapped.has_oracle);
  EXPECT_NE(snapped.reports.at(0).find("(oracle)"), std::string::npos);
  std::size_t checked = 0;
  for (const EyeEvent& event : synth.truth.events) {
    if (event.movement == EyeMovement::saccade && event.last + 20 < synth.log.samples.size()) {
      const std::size_t middle = (event.first + event.last) / 2;
      // Below 30 deg/s, where the saccade is over for I-VT, an eye that comes to rest has less than 0.05 deg to go.
      EXPECT_NEAR(snapped.log.samples[middle].u, synth.log.samples[event.last + 8].u, 0.05 / 42.0);
      ++checked;
    }
  }
  EXPECT_GT(checked, 20U);
}

TEST(GazeProcess, FiltersNeverReachOverALoss) {
  // Two levels with one lost sample between: every filter leaves both flat.
  const GazeLog log = screen_log(201, 2'000'000, [](double t) {
    return std::abs(t - 0.2) < 1e-6 ? Vec2d{kLost, kLost} : Vec2d{t < 0.2 ? 0.2 : 0.8, 0.5};
  });
  for (const char* const step : {"median:samples=9", "savitzky-golay", "one-euro", "butterworth"}) {
    const GazeLog out = processed(log, {step});
    for (std::size_t i = 0; i < 201; ++i) {
      if (i != 100) {
        EXPECT_NEAR(out.samples[i].u, i < 100 ? 0.2 : 0.8, 1e-9) << step << " " << i;
      }
    }
    EXPECT_EQ(out.samples[100].validity, GazeValidity::lost);
  }
}

TEST(GazeProcess, EveryStepTakesAnEmptyAndALostLog) {
  GazeLog empty = screen_log(0, 1, [](double) { return Vec2d{}; });
  GazeLog lost = screen_log(5, 1'000'000, [](double) { return Vec2d{kLost, kLost}; });
  GazeLog one = screen_log(1, 1, [](double) { return Vec2d{0.5, 0.5}; });
  for (const GazeStepInfo& info : gaze_steps()) {
    EXPECT_EQ(processed(empty, {info.name}).samples.size(), 0U);
    EXPECT_EQ(processed(lost, {info.name}).samples.size(), 5U);
    EXPECT_EQ(processed(one, {info.name}).samples.size(), 1U);
  }
}

}  // namespace
}  // namespace gazetrace::gaze_process_test
