// SPDX-License-Identifier: Apache-2.0
// Areas of interest: shapes, files, visits and transitions, all by hand; and the figures of a report on gaze.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "gazetrace/gaze_aois.hpp"
#include "gazetrace/gaze_report.hpp"
#include "gazetrace/gaze_synth.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace {
namespace {

std::string error_of(const std::string& path, const std::optional<DisplayGeometry>& display = std::nullopt) {
  try {
    load_aois(path, display);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(GazeAois, ShapesHoldTheirPlaces) {
  const Aoi rectangle{"r", AoiShape::rectangle, {{0.2, 0.1}, {0.5, 0.4}}, "", ""};
  EXPECT_TRUE(contains(rectangle, {0.2, 0.1}));
  EXPECT_TRUE(contains(rectangle, {0.3, 0.3}));
  EXPECT_FALSE(contains(rectangle, {0.51, 0.3}));
  EXPECT_FALSE(contains(rectangle, {std::nan(""), 0.3}));
  const Aoi ellipse{"e", AoiShape::ellipse, {{0.5, 0.5}, {0.2, 0.1}}, "", ""};
  EXPECT_TRUE(contains(ellipse, {0.69, 0.5}));
  EXPECT_FALSE(contains(ellipse, {0.65, 0.58}));
  // An L, whose notch is outside.
  const Aoi polygon{"p", AoiShape::polygon, {{0, 0}, {1, 0}, {1, 0.5}, {0.5, 0.5}, {0.5, 1}, {0, 1}}, "", ""};
  EXPECT_TRUE(contains(polygon, {0.9, 0.25}));
  EXPECT_TRUE(contains(polygon, {0.25, 0.9}));
  EXPECT_FALSE(contains(polygon, {0.75, 0.75}));
  EXPECT_TRUE(contains(polygon, {0.5, 0.75}));  // on the border
  EXPECT_TRUE(contains(polygon, {0.25, 0.5}));  // level with a corner
  EXPECT_FALSE(contains(polygon, {-0.1, 0.5}));
  EXPECT_FALSE(contains(polygon, {1.1, 0.5}));
}

TEST(GazeAois, FilesInTomlAndJson) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.toml")
      << "unit = \"px\"\ndisplay-px = [200, 100]\n[[aoi]]\nname = \"a\"\nrectangle = [20, 10, 100, "
         "50]\n[[aoi]]\nname = \"v\"\nnode = \"vase*\"\nmaterial = \"glaze\"\n";
  const std::vector<Aoi> areas = load_aois(folder / "a.toml", std::nullopt);
  ASSERT_EQ(areas.size(), 2U);
  EXPECT_EQ(areas[0].points[1], (Vec2d{0.5, 0.5}));
  EXPECT_EQ(areas[1].shape, AoiShape::object);
  EXPECT_EQ(areas[1].material, "glaze");
  std::ofstream(folder / "a.json") << R"({"aoi": [{"name": "e", "ellipse": [0.5, 0.5, 0.1, 0.2]},
    {"name": "p", "polygon": [[0, 0], [1, 0], [0, 1]]}]})";
  EXPECT_EQ(load_aois(folder / "a.json", std::nullopt)[1].points.size(), 3U);

  const auto refused = [&](const std::string& text, const std::string& said) {
    std::ofstream(folder / "bad.toml") << text;
    EXPECT_NE(error_of(folder / "bad.toml").find(said), std::string::npos) << error_of(folder / "bad.toml");
  };
  refused("unit = \"px\"\n[[aoi]]\nname = \"a\"\nrectangle = [0, 0, 1, 1]\n",
          "bad.toml:1: are of a display whose size");
  refused("[[aoi]]\nname = \"a\"\nrectangle = [0, 0, 1]\n", "bad.toml:3: is not left, top, right, bottom");
  refused("[[aoi]]\nname = \"a\"\nrectangle = [0.5, 0, 0.4, 1]\n", "has no area");
  refused("[[aoi]]\nname = \"a\"\nrectangel = [0, 0, 1, 1]\n", "did you mean 'rectangle'");
  refused("[[aoi]]\nname = \"a\"\n", "needs one shape");
  refused("[[aoi]]\nnode = \"a\"\n", "has no name");
  refused("[[aoi]]\nname=\"a\"\nnode=\"a\"\n[[aoi]]\nname=\"a\"\nnode=\"b\"\n", "a second area is called 'a'");
  refused("title = 3\n", "unknown key 'title'");
  refused("", "names no area");
}

EyeEvent fixation(double u, std::int64_t begin_ms, std::int64_t end_ms) {
  EyeEvent event;
  event.movement = EyeMovement::fixation;
  event.u = u;
  event.v = 0.5;
  event.begin_ns = begin_ms * 1'000'000;
  event.end_ns = end_ms * 1'000'000;
  return event;
}

TEST(GazeAois, VisitsDwellsAndTransitions) {
  GazeLog log;
  log.samples.resize(2);
  log.samples[0].t_ns = 100'000'000;
  log.samples[1].t_ns = 110'000'000;
  const std::vector<Aoi> areas{{"left", AoiShape::rectangle, {{0, 0}, {0.3, 1}}, "", ""},
                               {"right", AoiShape::rectangle, {{0.7, 0}, {1, 1}}, "", ""}};
  EyeEvents events;
  // A step of the clock is 10 ms, so that each fixation lasts that much longer than from its first sample to its last.
  // left, left, none, right, left: the pause between the first two belongs to the visit.
  events.events = {fixation(0.1, 200, 400), fixation(0.2, 450, 550), fixation(0.5, 600, 700), fixation(0.9, 750, 1050),
                   fixation(0.2, 1100, 1200)};
  const AoiAnalysis found = analyse_aois(log, events, areas, std::nullopt, nullptr);
  const AoiFigures& left = found.figures[0];
  EXPECT_EQ(left.fixations, 3U);
  EXPECT_EQ(left.visits, 2U);
  EXPECT_DOUBLE_EQ(left.fixation_ms, 430);
  EXPECT_DOUBLE_EQ(left.dwell_ms, 470);
  EXPECT_DOUBLE_EQ(left.first_fixation_at_ms, 100);
  EXPECT_DOUBLE_EQ(left.first_fixation_ms, 210);
  EXPECT_DOUBLE_EQ(found.figures[1].dwell_ms, 310);
  EXPECT_DOUBLE_EQ(found.figures[2].fixation_ms, 110);
  EXPECT_EQ(found.transitions[0], (std::vector<std::size_t>{0, 0, 1}));
  EXPECT_EQ(found.transitions[1], (std::vector<std::size_t>{1, 0, 0}));
  EXPECT_EQ(found.transitions[2], (std::vector<std::size_t>{0, 1, 0}));
  EXPECT_EQ(aoi_transitions_as_tsv(found),
            "from\tleft\tright\t(none)\nleft\t0\t0\t1\nright\t1\t0\t0\n(none)\t0\t1\t0\n");
  log.trial = GazeTrial{1, "", 150'000'000, 2'000'000'000, 0};
  EXPECT_DOUBLE_EQ(analyse_aois(log, events, areas, std::nullopt, nullptr).figures[0].first_fixation_at_ms, 50);
}

TEST(GazeAois, AFixationOnABorderHasHalfAShare) {
  SynthSettings synth;
  synth.duration_ns = 1'000'000'000;
  GazeLog log = synthesize_gaze(synth).log;
  EyeEvent event = fixation(0.5, 0, 100);
  event.direction = {0, 0, -1};
  EyeEvents events;
  events.events = {event};
  const AoiAnalysis found = analyse_aois(log, events, {{"left", AoiShape::rectangle, {{0, 0}, {0.5, 1}}, "", ""}},
                                         GazeUncertainty{0.5, 0.1}, nullptr);
  ASSERT_TRUE(found.fixations[0].aoi);
  EXPECT_NEAR(found.fixations[0].share, 0.5, 0.01);
}

TEST(GazeReport, QualityCountsWhatIsMissing) {
  // 100 Hz, two blocks of 1 s with a pause of 10 s; a quarter of the first is lost, and 10 rows of the second are not
  // there at all.
  GazeLog log;
  log.kind = GazeKind::direction;
  log.nominal_rate_hz = 100;
  for (std::int64_t block = 0; block < 2; ++block) {
    const std::int64_t begin_ns = block * 11'000'000'000;
    for (std::int64_t i = 0; i < 100; ++i) {
      if (block == 1 && i >= 40 && i < 50) {
        continue;
      }
      GazeSample sample;
      sample.t_ns = begin_ns + i * 10'000'000;
      sample.validity = block == 0 && i >= 75 ? GazeValidity::lost : GazeValidity::ok;
      log.samples.push_back(sample);
    }
    log.events.push_back({GazeEventType::segment, Eye::cyclopean, begin_ns, begin_ns + 990'000'000, "", 0});
  }
  log.calibrations = {{0, Eye::left, 0.4, 0.9, 1}, {0, Eye::right, 0.6, 1.1, 2}};
  const GazeQuality q = measure_quality(log);
  EXPECT_EQ(q.usable, 165U);
  EXPECT_NEAR(q.duration_s, 2, 1e-9);
  EXPECT_NEAR(q.data_loss, 35.0 / 200, 1e-9);
  EXPECT_NEAR(q.effective_rate_hz, 82.5, 1e-9);
  EXPECT_NEAR(q.accuracy_deg, 0.5, 1e-12);
  EXPECT_NEAR(q.accuracy_max_deg, 1.1, 1e-12);
}

TEST(GazeReport, TheFitFindsThePowerLaw) {
  std::vector<EyeEvent> events;
  for (int i = 0; i < 40; ++i) {
    EyeEvent event;
    event.movement = EyeMovement::saccade;
    event.amplitude_deg = 0.6 + 0.5 * i;
    event.peak_velocity_deg_s = 90 * std::pow(event.amplitude_deg, 0.55);
    events.push_back(event);
  }
  const MainSequence fit = fit_main_sequence(events);
  EXPECT_EQ(fit.saccades, 40U);
  EXPECT_NEAR(fit.factor, 90, 1e-6);
  EXPECT_NEAR(fit.exponent, 0.55, 1e-9);
  EXPECT_NEAR(fit.correlation, 1, 1e-9);
  events.resize(4);
  EXPECT_TRUE(std::isnan(fit_main_sequence(events).factor));
}

// Precision of synthetic gaze is that of its noise: sqrt(2) sd in each axis from sample to sample, sd about the mean.
TEST(GazeReport, PrecisionIsThatOfTheNoise) {
  SynthSettings settings;
  settings.duration_ns = 30'000'000'000;
  settings.drift_deg = 0;
  settings.fixation_s = 2;  // the flanks of saccades belong to the stretches that are measured
  settings.noise_deg = 0.05;
  const GazeReport report = gaze_report(synthesize_gaze(settings).log, {});
  const GazeQuality& q = report.quality.front();
  EXPECT_EQ(q.precision_unit, "deg");
  EXPECT_NEAR(q.precision_rms_s2s, 0.05 * 2, 0.006);
  EXPECT_NEAR(q.precision_sd, 0.05 * std::sqrt(2.0), 0.006);
  EXPECT_TRUE(std::isnan(q.accuracy_deg));
  EXPECT_NE(report.html.find("not known"), std::string::npos);
  EXPECT_EQ(report.html.find("<script"), std::string::npos);
  EXPECT_EQ(report.html.find("http://"), report.html.find("http://www.w3.org"));  // it loads nothing
}

TEST(GazeUncertainty, ComesFromTheLog) {
  SynthSettings synthetic;
  synthetic.rate_hz = 1000;
  synthetic.drift_deg = 0;
  synthetic.noise_deg = 0.1;
  GazeLog log = synthesize_gaze(synthetic).log;
  EXPECT_TRUE(std::isnan(uncertainty_of(log).accuracy_deg));
  // Two coordinates of 0.1 deg each.
  EXPECT_NEAR(uncertainty_of(log).precision_deg, 0.1 * std::sqrt(2.0), 0.03);
  log.calibrations = {{0, Eye::left, 0.4, 1, 1}, {0, Eye::right, 0.6, 1, 2}};
  EXPECT_NEAR(uncertainty_of(log).accuracy_deg, 0.5, 1e-12);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(known_uncertainty({kNan, 0.3}, log).accuracy_deg, 0.5, 1e-12);
  EXPECT_EQ(known_uncertainty({kNan, 0.3}, log).precision_deg, 0.3);
  EXPECT_EQ(known_uncertainty({0.7, kNan}, log).accuracy_deg, 0.7);
}

}  // namespace
}  // namespace gazetrace
