// SPDX-License-Identifier: Apache-2.0
// Areas of interest: shapes, files, visits and transitions, all by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "gazetrace/gaze_aois.hpp"
#include "gazetrace/gaze_objects.hpp"
#include "gazetrace/gaze_synth.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::gaze_aois_test {
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
}  // namespace gazetrace::gaze_aois_test
