// SPDX-License-Identifier: Apache-2.0
// Sequences scored apart by what the eye did, by region of the retina and by band of eccentricity.
#include "gazetrace/compare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "gazetrace/error.hpp"

namespace gazetrace::comparison_test {
namespace {

constexpr int kWidth = 90;
constexpr int kHeight = 60;

// A pixel is a third of a degree in the middle.
PlanarView third_of_a_degree() {
  const double step = std::tan(1.0 / 3 / kDegPerRad);
  return {-step * kWidth / 2, step * kHeight / 2, step, step, kWidth, kHeight};
}

MetricPicture picture(const ImageRgb& image) {
  return {image, image};
}

MetricPicture grey(float value) {
  return picture(ImageRgb(kWidth, kHeight, {value, value, value}));
}

ComparisonSettings settings_of(std::vector<std::string> metrics) {
  ComparisonSettings settings;
  settings.metrics = std::move(metrics);
  settings.view = third_of_a_degree();
  settings.metric.threads = 1;
  return settings;
}

FramePair pair_of(std::int32_t frame, float error, GazeClass gaze_class) {
  FramePair pair{frame, grey(0.5F), grey(0.5F + error), std::nullopt, gaze_class};
  if (gaze_class != GazeClass::no_gaze) {
    pair.gaze_px = Vec2d{kWidth / 2.0, kHeight / 2.0};
  }
  return pair;
}

GazeAtTime gaze(EyeMovement movement) {
  GazeAtTime result;
  result.state = GazeState::measured;
  result.movement = movement;
  return result;
}

TEST(GazeClass, FollowsWhatTheEyeDid) {
  EXPECT_EQ(gaze_class_of(gaze(EyeMovement::fixation)), GazeClass::fixation);
  EXPECT_EQ(gaze_class_of(gaze(EyeMovement::saccade)), GazeClass::in_flight);
  EXPECT_EQ(gaze_class_of(gaze(EyeMovement::blink)), GazeClass::blink);
  EXPECT_EQ(gaze_class_of(gaze(EyeMovement::lost)), GazeClass::no_gaze);
  EXPECT_EQ(gaze_class_of(gaze(EyeMovement::pursuit)), GazeClass::unclassified);
  GazeAtTime unknown;
  unknown.state = GazeState::held;
  EXPECT_EQ(gaze_class_of(unknown), GazeClass::unclassified);
  EXPECT_EQ(gaze_class_of(GazeAtTime{}), GazeClass::no_gaze);
  // A blink is one also where a policy holds the gaze before it; a held gaze otherwise is none.
  GazeAtTime held = gaze(EyeMovement::fixation);
  held.no_gaze = true;
  EXPECT_EQ(gaze_class_of(held), GazeClass::no_gaze);
  held.movement = EyeMovement::blink;
  EXPECT_EQ(gaze_class_of(held), GazeClass::blink);
}

TEST(GazeClass, FlightLastsATenthOfASecondLonger) {
  GazeAtTime landed = gaze(EyeMovement::fixation);
  landed.since_saccade_ns = 100'000'000;
  EXPECT_EQ(gaze_class_of(landed), GazeClass::in_flight);
  landed.since_saccade_ns = 100'000'001;
  EXPECT_EQ(gaze_class_of(landed), GazeClass::fixation);
}

// A saccade of 30 ms between two frames of 24 a second is not lost: the log is asked, not the frames.
TEST(GazeClass, SaccadesBetweenFramesAreSeen) {
  GazeLog log;
  std::vector<EyeMovement> movements;
  for (int i = 0; i < 200; ++i) {
    GazeSample sample;
    sample.t_ns = i * 5'000'000LL;
    sample.u = i < 100 ? 0.3 : 0.7;
    sample.v = 0.5;
    sample.validity = GazeValidity::ok;
    sample.row = i + 2;
    log.samples.push_back(sample);
    movements.push_back(i >= 100 && i < 106 ? EyeMovement::saccade : EyeMovement::fixation);
  }
  const auto class_at = [&](std::int64_t t_ms) {
    return gaze_class_of(gaze_at(log, GazeMapping{}, t_ms * 1'000'000, &movements));
  };
  EXPECT_EQ(class_at(499), GazeClass::fixation);
  EXPECT_EQ(class_at(500), GazeClass::in_flight);
  EXPECT_EQ(class_at(540), GazeClass::in_flight);
  EXPECT_EQ(class_at(625), GazeClass::in_flight);  // the last sample in flight is of 525 ms
  EXPECT_EQ(class_at(626), GazeClass::fixation);
}

TEST(Comparison, ClassesAreScoredApartAndFixationsAreTheHeadline) {
  Comparison comparison(settings_of({"mse"}), kWidth, kHeight);
  comparison.add(pair_of(1, 0.25F, GazeClass::fixation));
  comparison.add(pair_of(2, 0.125F, GazeClass::fixation));
  comparison.add(pair_of(3, 0.5F, GazeClass::in_flight));
  comparison.add(pair_of(4, 0.0F, GazeClass::blink));
  const std::vector<SequenceScores> summary = comparison.summary();
  ASSERT_EQ(summary.size(), 4U);
  EXPECT_EQ(summary[0].gaze_class, "all");
  EXPECT_EQ(summary[0].frames, 4U);
  EXPECT_DOUBLE_EQ(*summary[0].scores[0].value, (0.0625 + 0.015625 + 0.25 + 0) / 4);
  EXPECT_EQ(summary[0].worst_frame[0], 3);
  const SequenceScores& claim = headline(summary);
  EXPECT_EQ(claim.gaze_class, "fixation");
  EXPECT_EQ(claim.frames, 2U);
  EXPECT_DOUBLE_EQ(*claim.scores[0].value, (0.0625 + 0.015625) / 2);
  EXPECT_EQ(claim.worst_frame[0], 1);
  EXPECT_EQ(claim.quantiles[0][0], 0.015625);
  EXPECT_EQ(claim.quantiles[0][2], 0.0625);
  EXPECT_EQ(summary[3].gaze_class, "blink");
  EXPECT_EQ(*summary[3].scores[0].value, 0);
}

TEST(Comparison, WithoutFixationsAllFramesAreTheHeadline) {
  Comparison comparison(settings_of({"mse"}), kWidth, kHeight);
  comparison.add(pair_of(1, 0.25F, GazeClass::no_gaze));
  comparison.add(pair_of(2, 0.5F, GazeClass::unclassified));
  EXPECT_EQ(headline(comparison.summary()).gaze_class, "all");
}

// Frames without gaze have no bands, no regions and no score of a metric that needs gaze, but that metric sees them
// pass: the frame after them scores as if it had followed them.
TEST(Comparison, WithoutGazeOnlyWhatNeedsNoneIsScored) {
  ComparisonSettings settings = settings_of({"mse", "fovvideovdp"});
  settings.frames_per_second = 30;
  ImageRgb stripes(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float value = x / 3 % 2 == 0 ? 0.4F : 0.6F;
      stripes(x, y) = {value, value, value};
    }
  }
  const auto striped = [&](std::int32_t frame, GazeClass gaze_class) {
    FramePair pair = pair_of(frame, 0, gaze_class);
    pair.test = picture(stripes);
    return pair;
  };
  Comparison comparison(settings, kWidth, kHeight);
  Comparison always(settings, kWidth, kHeight);
  for (const GazeClass blind : {GazeClass::blink, GazeClass::no_gaze}) {
    const FrameScores scores = comparison.add(striped(1, blind));
    EXPECT_TRUE(scores.scores[0].value);
    EXPECT_FALSE(scores.scores[1].value);
    EXPECT_FALSE(scores.scores[0].weighted);
    EXPECT_FALSE(scores.scores[0].bands[0]);
    EXPECT_FALSE(scores.scores[0].regions[0]);
    always.add(striped(1, GazeClass::fixation));
  }
  FramePair clean = pair_of(3, 0, GazeClass::fixation);
  const double after = *comparison.add(clean).scores[1].value;
  EXPECT_EQ(after, *always.add(clean).scores[1].value);
  EXPECT_LT(after, 10);
  const std::vector<SequenceScores> summary = comparison.summary();
  EXPECT_EQ(summary[0].scored_frames, (std::vector<std::size_t>{3, 1}));
  EXPECT_EQ(*summary[0].scores[1].value, after);
  const SequenceScores& blinks = summary[2];
  ASSERT_EQ(blinks.gaze_class, "blink");
  EXPECT_FALSE(blinks.scores[1].value);
  EXPECT_FALSE(blinks.worst_frame[1]);
  EXPECT_TRUE(std::isnan(blinks.quantiles[1][1]));
}

// Errors are laid into one region each, of as many pixels as the region's solid angle asks for.
TEST(Comparison, RegionsOfTheRetina) {
  const PlanarView view = third_of_a_degree();
  const Vec2d gaze_px{30.5, 29.5};
  const Vec3d direction = view.direction(gaze_px.x, gaze_px.y);
  for (std::size_t region = 0; region < 3; ++region) {
    FramePair pair = pair_of(1, 0, GazeClass::fixation);
    pair.gaze_px = gaze_px;
    double pixels = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double deg = eccentricity_deg(view, direction, x + 0.5, y + 0.5);
        if ((deg < 2 ? 0U : deg < 6 ? 1U : 2U) == region) {
          pair.test.light(x, y) += Vec3f{0.5F, 0.5F, 0.5F};
          ++pixels;
        }
      }
    }
    ComparisonSettings settings = settings_of({"mse"});
    settings.regions.end_deg = {2, 6};
    Comparison comparison(settings, kWidth, kHeight);
    const Scores scores = comparison.add(pair).scores[0];
    for (std::size_t other = 0; other < 3; ++other) {
      EXPECT_DOUBLE_EQ(*scores.regions[other], other == region ? 0.25 : 0.0) << region << " " << other;
    }
    EXPECT_NEAR(*scores.value, 0.25 * pixels / (kWidth * kHeight), 1e-12);
  }
}

TEST(RetinalRegions, DiametersAndEccentricities) {
  EXPECT_EQ(retinal_regions({5.2, 17}).end_deg, (std::array<double, 2>{5.2, 17}));
  EXPECT_THROW(retinal_regions({17, 5.2}), Error);
  EXPECT_THROW(retinal_regions({0, 5.2}), Error);
}

// What a view of the middle scores is what the metric scores without a place, to the bit, whatever rounding made of the
// view's borders; elsewhere it is not.
TEST(Comparison, FovVideoVdpKnowsWhereTheFrameLies) {
  ImageRgb stripes(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float value = (x / 3 + y / 2) % 2 == 0 ? 0.48F : 0.52F;
      stripes(x, y) = {value, value, value};
    }
  }
  const Vec2d gaze_px{20.5, 40.5};
  const DisplayGeometry screen{3 * kWidth, 3 * kHeight, 3 * 33.3, 3 * 22.2, 57.1};
  const auto jod = [&](double left_px, double top_px) {
    ComparisonSettings settings = settings_of({"fovvideovdp"});
    settings.view = view_of_display(screen, {left_px, top_px, kWidth, kHeight}, kWidth, kHeight);
    FramePair pair = pair_of(1, 0, GazeClass::fixation);
    pair.test = picture(stripes);
    pair.gaze_px = gaze_px;
    return *Comparison(settings, kWidth, kHeight).add(pair).scores[0].value;
  };
  const PlanarView middle = view_of_display(screen, {kWidth, kHeight, kWidth, kHeight}, kWidth, kHeight);
  FovVideoVdpSettings plain;
  plain.geometry = {kWidth, kHeight, middle.step_x * kWidth, middle.step_y * kHeight, 1};
  plain.threads = 1;
  const double q = FovVideoVdp(plain, kWidth, kHeight)
                       .add(display_luminance(grey(0.5F).code, {}), display_luminance(stripes, {}), gaze_px)
                       .q;
  EXPECT_EQ(jod(kWidth, kHeight), fovvideovdp_jod(q));
  EXPECT_GT(std::fabs(jod(0, 0) - fovvideovdp_jod(q)), 0.01);
}

TEST(Comparison, RefusesLightThatNoDisplayHas) {
  const auto refuses = [](const auto& change) {
    ComparisonSettings settings = settings_of({"mse"});
    change(settings);
    EXPECT_THROW(check_comparison(settings), Error);
    EXPECT_THROW(Comparison(settings, kWidth, kHeight), Error);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double value : {0.0, -1.0, kNan, kInfinity}) {
    refuses([&](ComparisonSettings& s) { s.photometry.peak_cd_m2 = value; });
    refuses([&](ComparisonSettings& s) { s.metric.peak_cd_m2 = value; });
    refuses([&](ComparisonSettings& s) { s.photometry.contrast = value; });
    refuses([&](ComparisonSettings& s) { s.metric.relmse_epsilon = value; });
  }
  refuses([](ComparisonSettings& s) { s.photometry.contrast = 1; });
  for (const double value : {-0.01, kNan, kInfinity}) {
    refuses([&](ComparisonSettings& s) { s.photometry.ambient_lux = value; });
    refuses([&](ComparisonSettings& s) { s.photometry.reflectivity = value; });
  }
  refuses([](ComparisonSettings& s) { s.photometry.reflectivity = 1.01; });
  // 60000 lux at 0.5 % are 95 cd/m2 of black.
  refuses([](ComparisonSettings& s) { s.photometry = {DisplayResponse::srgb, 80, 1000, 60000, 0.005}; });
  ComparisonSettings absolute = settings_of({"mse"});
  absolute.photometry = {DisplayResponse::pq, 80, 1000, 60000, 0.005};
  absolute.metric.response = DisplayResponse::pq;
  EXPECT_NO_THROW(check_comparison(absolute));
}

// Light beyond a float's range leaves nothing to divide.
TEST(Comparison, ScoresThatAreNoNumberAreRefused) {
  ComparisonSettings settings = settings_of({"mse", "temporal_bias"});
  settings.frames_per_second = 4;
  settings.photometry.peak_cd_m2 = 1e300;
  Comparison comparison(settings, kWidth, kHeight);
  for (int frame = 1; frame < 4; ++frame) {
    comparison.add(pair_of(frame, 0.25F, GazeClass::fixation));
  }
  try {
    comparison.add(pair_of(4, 0.25F, GazeClass::fixation));
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("temporal_bias"), testing::HasSubstr("frame 4")));
  }
}

TEST(Comparison, ExposuresOfHdrFlipAreThoseOfTheFirstFrame) {
  ComparisonSettings settings = settings_of({"hdr_flip"});
  const ImageRgb light(8, 8, {0.5F, 0.5F, 0.5F});
  const FlipExposures wanted = flip_exposures(light, {});
  fix_flip_exposures(settings, light);
  EXPECT_EQ(settings.metric.hdr_flip.start_ev, wanted.start_ev);
  EXPECT_EQ(settings.metric.hdr_flip.stop_ev, wanted.stop_ev);
  EXPECT_EQ(settings.metric.hdr_flip.count, wanted.count);
  settings.metric.hdr_flip = {FlipToneMapper::aces, -1, 1, 3};
  fix_flip_exposures(settings, light);
  EXPECT_EQ(settings.metric.hdr_flip.start_ev, -1);
  ComparisonSettings other = settings_of({"mse"});
  fix_flip_exposures(other, light);
  EXPECT_FALSE(other.metric.hdr_flip.start_ev);
}

TEST(Comparison, MetricsThatNeedGazeNeedAScreen) {
  ComparisonSettings settings = settings_of({"fovvideovdp"});
  settings.view.reset();
  EXPECT_THROW(Comparison(settings, kWidth, kHeight), Error);
}

}  // namespace
}  // namespace gazetrace::comparison_test
