// SPDX-License-Identifier: Apache-2.0
// Predicted JOD against FovVideoVDP itself, which measures noise of known variance: the prediction knows the variance,
// the metric only the pictures.
#include "gazetrace/visible_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>
#include <string>

#include "gazetrace/error.hpp"
#include "support/visible_noise.hpp"

namespace gazetrace::visible_error_test {
namespace {

// What a prediction may be off by. The measured JOD of a single picture scatters by about 0.01.
constexpr double kJodLimit = 0.1;
constexpr double kWhiteNoiseLimit = 0.05;

struct NoiseCase {
  std::string name;
  double pixels_per_degree = 28;
  int width_px = 256, height_px = 160;
  double luminance_cd_m2 = 50;
  double contrast = 0.1;  // relative standard deviation
  double fps = 24;
  bool frozen = false;
  Vec2d gaze{0.5, 0.5};  // fraction of the picture
};

std::string case_name(const testing::TestParamInfo<NoiseCase>& info) {
  return info.param.name;
}

void PrintTo(const NoiseCase& noise, std::ostream* out) {
  *out << noise.name;
}

Vec2d gaze_px(const PlanarView& view, const Vec2d& fraction) {
  return {fraction.x * view.width_px, fraction.y * view.height_px};
}

class VisibleNoise : public testing::TestWithParam<NoiseCase> {};

TEST_P(VisibleNoise, IsPredicted) {
  const NoiseCase& c = GetParam();
  const PlanarView view = view_of(c.width_px, c.height_px, c.pixels_per_degree);
  const Vec2d gaze = gaze_px(view, c.gaze);
  const ImageGray flat(c.width_px, c.height_px, static_cast<float>(c.luminance_cd_m2));
  const ImageGray deviation(c.width_px, c.height_px, static_cast<float>(c.contrast * c.luminance_cd_m2));
  const double measured = fovvideovdp_jod(measured_q(
      view, c.fps, gaze, flat,
      [&](int frame) {
        const unsigned seed = c.frozen ? 1 : 1 + static_cast<unsigned>(frame);
        return with_noise(flat, white_noise(c.width_px, c.height_px, seed), deviation);
      },
      c.frozen ? 1 : 16));

  const VisibleErrorModel model({view, c.fps});
  const DisplayCurve curve = luminance_as_it_is();
  VisiblePicture picture{flat, curve, view.direction(gaze.x, gaze.y)};
  const VisibleFrame predicted = model.predict(picture, {{squared(deviation), white_error(), c.frozen ? 1.0 : 0.0}});
  std::printf("measured %.3f, predicted %.3f JOD\n", measured, fovvideovdp_jod(predicted.q));
  EXPECT_NEAR(fovvideovdp_jod(predicted.q), measured, kWhiteNoiseLimit);
  EXPECT_LT(measured, 9.95) << "noise that nobody sees tests nothing";
}

INSTANTIATE_TEST_SUITE_P(
    Cases, VisibleNoise,
    testing::Values(NoiseCase{"contrast_3_percent", 28, 256, 160, 50, 0.03},
                    NoiseCase{"contrast_10_percent", 28, 256, 160, 50, 0.1},
                    NoiseCase{"contrast_25_percent", 28, 256, 160, 50, 0.25}, NoiseCase{"dim", 28, 256, 160, 1, 0.2},
                    NoiseCase{"bright", 28, 256, 160, 500, 0.1}, NoiseCase{"coarse_display", 12, 256, 160, 50, 0.05},
                    NoiseCase{"fine_display", 60, 320, 200, 50, 0.3}, NoiseCase{"wide_field", 12, 640, 360, 50, 0.05},
                    NoiseCase{"gaze_in_a_corner", 12, 320, 200, 50, 0.1, 24, false, {0.05, 0.1}},
                    NoiseCase{"still", 28, 256, 160, 50, 0.05, 0}, NoiseCase{"still_12", 12, 256, 160, 50, 0.02, 0},
                    NoiseCase{"still_60", 60, 320, 200, 50, 0.2, 0},
                    NoiseCase{"frozen", 28, 256, 160, 50, 0.05, 24, true},
                    NoiseCase{"fresh_at_60_hz", 28, 256, 160, 50, 0.1, 60},
                    NoiseCase{"fresh_at_90_hz", 12, 256, 160, 50, 0.1, 90}),
    case_name);

// The spectrum decides: the same variance in blocks, or after a filter, is seen far better than white noise.
TEST(VisibleSpectra, BlocksAndFilteredNoiseArePredicted) {
  const int width = 640;
  const int height = 384;
  const DisplayCurve curve = luminance_as_it_is();
  const ImageGray flat(width, height, 50.0F);
  const ImageGray deviation(width, height, 1.5F);
  struct Kind {
    std::string name;
    ErrorSpectrum spectrum;
    std::function<ImageGray(unsigned seed)> noise;
  };
  const std::vector<Kind> kinds{
      {"blocks of 2", block_error(2), [&](unsigned seed) { return block_noise(width, height, 2, seed); }},
      {"blocks of 8", block_error(8), [&](unsigned seed) { return block_noise(width, height, 8, seed); }},
      {"Gaussian of 1", low_pass_error(1), [&](unsigned seed) { return low_pass_noise(width, height, 1, seed); }},
      {"Gaussian of 3", low_pass_error(3), [&](unsigned seed) { return low_pass_noise(width, height, 3, seed); }},
  };
  for (const double ppd : {16.0, 40.0}) {
    const PlanarView view = view_of(width, height, ppd);
    const Vec2d gaze = gaze_px(view, {0.4, 0.6});
    const VisiblePicture picture{flat, curve, view.direction(gaze.x, gaze.y)};
    const VisibleErrorModel model({view, 24});
    for (const Kind& kind : kinds) {
      const double measured = fovvideovdp_jod(measured_q(
          view, 24, gaze, flat,
          [&](int frame) { return with_noise(flat, kind.noise(static_cast<unsigned>(frame)), deviation); }, 6));
      const double predicted = fovvideovdp_jod(model.predict(picture, {{squared(deviation), kind.spectrum}}).q);
      std::printf("%s, %g pixels a degree: measured %.3f, predicted %.3f JOD\n", kind.name.c_str(), ppd, measured,
                  predicted);
      EXPECT_NEAR(predicted, measured, kJodLimit) << kind.name << ", " << ppd << " pixels a degree";
      // A spectrum that was measured from one sample of the error does as well.
      const ErrorSpectrum sampled = measured_spectrum(kind.noise(99));
      EXPECT_NEAR(fovvideovdp_jod(model.predict(picture, {{squared(deviation), sampled}}).q), measured, kJodLimit)
          << kind.name;
    }
  }
}

TEST(VisibleSpectra, GainsOfBandsAreThoseOfNoise) {
  const int side = 512;
  struct Kind {
    std::string name;
    ErrorSpectrum spectrum;
    ImageGray noise;
  };
  for (const Kind& kind : {Kind{"white", white_error(), white_noise(side, side, 1)},
                           Kind{"filtered", low_pass_error(1.5), low_pass_noise(side, side, 1.5, 3)}}) {
    const ErrorSpectrum measured = measured_spectrum(kind.noise);
    for (std::size_t b = 0; b < 6; ++b) {
      // The relative error of a variance of n independent values is about sqrt(2 / n); here four of them.
      const double values = side * side / std::exp2(2 * static_cast<double>(b)) / 4;
      EXPECT_NEAR(measured.gain[b], kind.spectrum.gain[b], (0.02 + 4 * std::sqrt(2 / values)) * kind.spectrum.gain[b])
          << kind.name << " band " << b;
    }
  }
  // A cut leaves the bands above it and takes those far below it down by the factor.
  const ErrorSpectrum white = white_error();
  const ErrorSpectrum cut = cut_error(4, 0.1, 32);
  EXPECT_NEAR(cut.gain[0], white.gain[0], 0.02 * white.gain[0]);
  EXPECT_NEAR(cut.gain[6], 0.1 * white.gain[6], 1e-6 * white.gain[6]);
  EXPECT_GT(cut.gain[2], 0.1 * white.gain[2]);
  EXPECT_LT(cut.gain[2], white.gain[2]);
}

// A picture with contrast of its own: gratings of several frequencies.
ImageGray gratings(int width_px, int height_px, double mean, double contrast) {
  ImageGray image(width_px, height_px);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const double wave = std::sin(0.9 * x + 0.3 * y) + std::sin(0.35 * x - 0.5 * y) + std::sin(0.11 * x + 0.13 * y);
      image(x, y) = static_cast<float>(mean * (1 + contrast * wave / 3));
    }
  }
  return image;
}

TEST(VisibleMasking, ContrastOfThePictureHidesNoise) {
  const int width = 256;
  const int height = 160;
  const PlanarView view = view_of(width, height, 28);
  const Vec2d gaze = gaze_px(view, {0.5, 0.5});
  const DisplayCurve curve = luminance_as_it_is();
  const VisibleErrorModel model({view, 24});
  const ImageGray flat(width, height, 50.0F);
  const ImageGray reference = gratings(width, height, 50, 0.9);
  const auto share = [](ImageGray image, float of_it) {
    for (float& value : image.pixels) {
      value *= of_it;
    }
    return image;
  };
  const ImageGray deviation = share(reference, 0.1F);
  const auto frame_of = [&](int frame) {
    return with_noise(reference, white_noise(width, height, 7 + static_cast<unsigned>(frame)), deviation);
  };
  const double measured = fovvideovdp_jod(measured_q(view, 24, gaze, reference, frame_of, 12));
  const Vec3d direction = view.direction(gaze.x, gaze.y);
  const auto predicted = [&](const ImageGray& luminance, bool holds_the_error) {
    VisiblePicture picture{luminance, curve, direction};
    picture.holds_the_error = holds_the_error;
    return fovvideovdp_jod(model.predict(picture, {{squared(share(luminance, 0.1F))}}).q);
  };
  std::printf("measured %.3f, predicted %.3f, on an even field %.3f JOD\n", measured, predicted(reference, false),
              predicted(flat, false));
  EXPECT_NEAR(predicted(reference, false), measured, kJodLimit);
  EXPECT_GT(measured, predicted(flat, false) + 0.15) << "gratings that mask nothing test nothing";
  // From a noisy picture: the noise in it must not be taken for contrast that masks.
  const ImageGray noisy = frame_of(100);
  EXPECT_NEAR(predicted(noisy, true), measured, kJodLimit);
  const float much = 0.25F;
  const ImageGray noisy_flat = with_noise(flat, white_noise(width, height, 5), share(flat, much));
  VisiblePicture even{noisy_flat, curve, direction};
  const std::vector<ErrorComponent> errors{{squared(share(flat, much))}};
  const double q = model.predict(even, errors).q;
  even.holds_the_error = false;
  const double q_masked = model.predict(even, errors).q;
  const double q_flat = model.predict({flat, curve, direction}, errors).q;
  EXPECT_NEAR(fovvideovdp_jod(q), fovvideovdp_jod(q_flat), kJodLimit);
  EXPECT_LT(q_masked, 0.95 * q_flat) << "noise that masks nothing tests nothing";
  std::printf("noise of 25 %%: %.3f; taken from a noisy picture %.3f, with its noise as masking %.3f JOD\n",
              fovvideovdp_jod(q_flat), fovvideovdp_jod(q), fovvideovdp_jod(q_masked));
}

TEST(VisibleError, UnevenVarianceAndTwoComponentsArePredicted) {
  const int width = 320;
  const int height = 192;
  const PlanarView view = view_of(width, height, 20);
  const Vec2d gaze = gaze_px(view, {0.3, 0.5});
  const DisplayCurve curve = luminance_as_it_is();
  const ImageGray flat(width, height, 40.0F);
  // Pixels of noise on the left, blocks on the right, and in patches ten times as much.
  ImageGray fine(width, height);
  ImageGray blocky(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float deviation = (x / 40 + y / 40) % 4 == 0 ? 4.0F : 0.4F;
      (x < width / 2 ? fine : blocky)(x, y) = deviation;
    }
  }
  const double measured = fovvideovdp_jod(measured_q(
      view, 30, gaze, flat,
      [&](int frame) {
        const auto seed = static_cast<unsigned>(2 * frame);
        return with_noise(with_noise(flat, white_noise(width, height, seed), fine),
                          block_noise(width, height, 4, seed + 1), blocky);
      },
      12));
  const VisibleErrorModel model({view, 30});
  const VisiblePicture picture{flat, curve, view.direction(gaze.x, gaze.y)};
  const std::vector<ErrorComponent> errors{{squared(fine)}, {squared(blocky), block_error(4)}};
  const VisibleFrame predicted = model.predict(picture, errors, true);
  EXPECT_NEAR(fovvideovdp_jod(predicted.q), measured, kJodLimit);

  // The density's mean is Q, and it lies where the error is.
  double mean = 0;
  double patches = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double share = static_cast<double>(predicted.density(x, y)) / (width * height);
      EXPECT_GE(share, 0);
      mean += share;
      patches += (x / 40 + y / 40) % 4 == 0 ? share : 0;
    }
  }
  EXPECT_NEAR(mean, predicted.q, 1e-3 * predicted.q);
  EXPECT_GT(patches, 0.8 * mean);
}

// Over the first 250 ms of a clip, fresh noise is frozen in part.
TEST(VisibleError, TheBeginningOfAClipIsPredicted) {
  const int width = 256;
  const int height = 160;
  const PlanarView view = view_of(width, height, 24);
  const Vec2d gaze = gaze_px(view, {0.5, 0.5});
  const DisplayCurve curve = luminance_as_it_is();
  const ImageGray flat(width, height, 50.0F);
  const ImageGray deviation(width, height, 2.5F);
  const int frames = 12;
  const double measured = fovvideovdp_jod(measured_q(
      view, 24, gaze, flat,
      [&](int frame) { return with_noise(flat, white_noise(width, height, static_cast<unsigned>(frame)), deviation); },
      frames, true));
  const VisibleErrorModel model({view, 24});
  std::vector<double> q;
  VisiblePicture picture{flat, curve, view.direction(gaze.x, gaze.y)};
  const std::vector<ErrorComponent> errors{{squared(deviation)}};
  for (int frame = 0; frame < frames; ++frame) {
    picture.frames_before = frame;
    q.push_back(model.predict(picture, errors).q);
  }
  EXPECT_NEAR(visible_jod(q), measured, kJodLimit);
  EXPECT_LT(q.front(), 0.85 * q.back());  // what stands still is seen less well than what flickers
}

// Noise that is partly kept from frame to frame, as an exponential mean keeps it.
TEST(VisibleError, CorrelationOverTimeIsPredicted) {
  const int width = 256;
  const int height = 160;
  const PlanarView view = view_of(width, height, 24);
  const Vec2d gaze = gaze_px(view, {0.5, 0.5});
  const DisplayCurve curve = luminance_as_it_is();
  const ImageGray flat(width, height, 50.0F);
  const ImageGray deviation(width, height, 2.5F);
  const double correlation = 0.8;
  const auto fresh = static_cast<float>(std::sqrt(1 - correlation * correlation));
  ImageGray kept = white_noise(width, height, 1000);
  const double measured = fovvideovdp_jod(measured_q(
      view, 24, gaze, flat,
      [&](int frame) {
        const ImageGray next = white_noise(width, height, static_cast<unsigned>(frame));
        for (std::size_t i = 0; i < kept.pixels.size(); ++i) {
          kept.pixels[i] = static_cast<float>(correlation) * kept.pixels[i] + fresh * next.pixels[i];
        }
        return with_noise(flat, kept, deviation);
      },
      40));
  const VisibleErrorModel model({view, 24});
  const VisiblePicture picture{flat, curve, view.direction(gaze.x, gaze.y)};
  const auto predicted = [&](double c) {
    return fovvideovdp_jod(model.predict(picture, {{squared(deviation), white_error(), c}}).q);
  };
  std::printf("measured %.3f, predicted %.3f; fresh %.3f, frozen %.3f JOD\n", measured, predicted(correlation),
              predicted(0), predicted(1));
  EXPECT_NEAR(predicted(correlation), measured, kJodLimit / 2);
  EXPECT_GT(predicted(1), predicted(correlation) + kJodLimit / 2);
}

// Rates by the weights against uniform rates, for noise whose size differs from place to place: FovVideoVDP itself must
// see as much of it with the samples that allocation_gain() says are enough.
TEST(VisibleError, RatesByTheWeightsSaveWhatTheGainSays) {
  const int width = 640;
  const int height = 384;
  const PlanarView view = view_of(width, height, 12);
  const Vec2d gaze = gaze_px(view, {0.3, 0.5});
  const DisplayCurve curve = luminance_as_it_is();
  ImageGray picture(width, height);
  ImageGray one_sample(width, height);  // variance
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture(x, y) = 40.0F + 20.0F * std::sin(0.02F * static_cast<float>(x));
      const float relative =
          0.5F + 0.4F * std::sin(0.05F * static_cast<float>(y)) * std::cos(0.03F * static_cast<float>(x));
      one_sample(x, y) = relative * relative * picture(x, y) * picture(x, y);
    }
  }
  const auto over = [&](const ImageGray& rates, double spp) {
    ImageGray variance = one_sample;
    for (std::size_t i = 0; i < variance.pixels.size(); ++i) {
      variance.pixels[i] /= static_cast<float>(spp) * rates.pixels[i];
    }
    return variance;
  };
  const double uniform_spp = 60;
  const ImageGray even(width, height, 1.0F);
  const VisibleErrorModel model({view, 24});
  const VisiblePicture seen{picture, curve, view.direction(gaze.x, gaze.y), false};
  const ImageGray uniform = over(even, uniform_spp);
  const ImageGray weights = model.weights(seen, {{uniform}});
  const double q = model.predict(seen, {{uniform}}).q;
  double pooled = 0;
  for (std::size_t i = 0; i < weights.pixels.size(); ++i) {
    pooled += std::pow(static_cast<double>(weights.pixels[i] * std::sqrt(uniform.pixels[i])), kVisiblePooling);
  }
  EXPECT_NEAR(pooled / static_cast<double>(weights.pixels.size()), q, 0.05 * q);

  const ImageGray rates = visible_allocation(weights, one_sample);
  const double gain = allocation_gain(weights, one_sample);
  const ImageGray allocated = over(rates, uniform_spp / gain);
  const double predicted_uniform = fovvideovdp_jod(q);
  const double predicted_allocated = fovvideovdp_jod(model.predict(seen, {{allocated}}).q);
  const auto measured = [&](ImageGray deviation) {
    for (float& value : deviation.pixels) {
      value = std::sqrt(value);
    }
    return fovvideovdp_jod(measured_q(
        view, 24, gaze, picture,
        [&](int frame) {
          return with_noise(picture, white_noise(width, height, static_cast<unsigned>(frame)), deviation);
        },
        6));
  };
  const double measured_uniform = measured(uniform);
  const double measured_allocated = measured(allocated);
  std::printf("gain %.3f; uniform: predicted %.3f, measured %.3f; allocated: predicted %.3f, measured %.3f JOD\n", gain,
              predicted_uniform, measured_uniform, predicted_allocated, measured_allocated);
  EXPECT_GT(gain, 1.5);
  EXPECT_NEAR(predicted_allocated, predicted_uniform, 0.03);
  EXPECT_NEAR(measured_uniform, predicted_uniform, kWhiteNoiseLimit);
  EXPECT_NEAR(measured_allocated, measured_uniform, 0.03);
}

TEST(VisibleError, CoarseCellsPredictTheSame) {
  const int width = 640;
  const int height = 360;
  const PlanarView view = view_of(width, height, 30);
  const DisplayCurve curve = luminance_as_it_is();
  const Vec3d gaze = view.direction(200, 150);
  const std::vector<ErrorComponent> errors{{ImageGray(width, height, 9.0F)}};
  const ImageGray flat(width, height, 60.0F);
  const double q = VisibleErrorModel({view, 24}).predict({flat, curve, gaze}, errors).q;
  for (const int cell : {2, 4, 8}) {
    const VisibleErrorModel model({view, 24, cell});
    const ImageGray coarse(model.width_px(), model.height_px(), 60.0F);
    const std::vector<ErrorComponent> coarse_errors{{ImageGray(model.width_px(), model.height_px(), 9.0F)}};
    EXPECT_NEAR(fovvideovdp_jod(model.predict({coarse, curve, gaze}, coarse_errors).q), fovvideovdp_jod(q), 0.02);
  }
}

// A pilot that shows every fourth pixel holds the noise of single pixels, which must not be taken for masking contrast.
TEST(VisibleError, NoiseOfAPilotDoesNotMask) {
  const int cell = 4;
  const PlanarView view = view_of(640, 384, 20);
  const DisplayCurve curve = luminance_as_it_is();
  const VisibleErrorModel model({view, 24, cell});
  const Vec3d gaze = view.direction(320, 192);
  const ImageGray flat(model.width_px(), model.height_px(), 50.0F);
  const ImageGray deviation(model.width_px(), model.height_px(), 10.0F);
  const ImageGray pilot = with_noise(flat, white_noise(flat.width_px, flat.height_px, 8), deviation);
  const std::vector<ErrorComponent> errors{{squared(deviation)}};
  VisiblePicture picture{pilot, curve, gaze};
  const double jod = fovvideovdp_jod(model.predict(picture, errors).q);
  picture.holds_the_error = false;
  const double masked = fovvideovdp_jod(model.predict(picture, errors).q);
  const double even = fovvideovdp_jod(model.predict({flat, curve, gaze}, errors).q);
  std::printf("even field %.3f, pilot %.3f, with its noise as masking %.3f JOD\n", even, jod, masked);
  EXPECT_NEAR(jod, even, kJodLimit);
  EXPECT_GT(masked, even + kJodLimit);
}

TEST(VisibleError, NothingIsSeenOfNothing) {
  const PlanarView view = view_of(64, 40, 20);
  const DisplayCurve curve = luminance_as_it_is();
  const ImageGray flat(64, 40, 10.0F);
  const VisibleErrorModel model({view, 24});
  const VisiblePicture picture{flat, curve, view.direction(32, 20)};
  EXPECT_EQ(model.predict(picture, {}).q, 0);
  const VisibleFrame none = model.predict(picture, {{ImageGray(64, 40)}}, true);
  EXPECT_EQ(none.q, 0);
  for (const float value : none.density.pixels) {
    EXPECT_EQ(value, 0);
  }
  // Weights are known without an error.
  for (const float value : model.weights(picture, {{ImageGray(64, 40)}}).pixels) {
    EXPECT_TRUE(std::isfinite(value) && value > 0);
  }
}

// What a display clips is not seen, and hostile pixels do no harm.
TEST(VisibleError, ClippedAndHostilePixels) {
  const PlanarView view = view_of(64, 40, 20);
  const DisplayCurve curve = linear_display_curve({}, 0);
  const VisibleErrorModel model({view, 24});
  const Vec3d gaze = view.direction(32, 20);
  const ImageGray clipped(64, 40, 8.0F);
  EXPECT_EQ(model.predict({clipped, curve, gaze}, {{ImageGray(64, 40, 1.0F)}}).q, 0);
  ImageGray hostile(64, 40, 0.5F);
  hostile(3, 3) = std::numeric_limits<float>::quiet_NaN();
  hostile(4, 3) = std::numeric_limits<float>::infinity();
  hostile(5, 3) = -1;
  ImageGray error(64, 40, 0.01F);
  error(10, 10) = std::numeric_limits<float>::quiet_NaN();
  error(11, 10) = std::numeric_limits<float>::infinity();
  error(12, 10) = -1;
  const VisiblePicture picture{hostile, curve, gaze};
  EXPECT_TRUE(std::isfinite(model.predict(picture, {{error}}, true).q));
  for (const float value : model.weights(picture, {{error}}).pixels) {
    EXPECT_TRUE(std::isfinite(value) && value > 0);
  }
}

TEST(VisibleError, ThreadsChangeNoBit) {
  const PlanarView view = view_of(97, 65, 20);
  const DisplayCurve curve = luminance_as_it_is();
  const ImageGray picture = gratings(97, 65, 50, 0.5);
  const ImageGray error = squared(white_noise(97, 65, 3));
  const Vec3d gaze = view.direction(20, 30);
  const VisibleErrorModel one({view, 24, 1, 1});
  const VisibleErrorModel three({view, 24, 1, 3});
  const VisibleFrame a = one.predict({picture, curve, gaze}, {{error}}, true);
  const VisibleFrame b = three.predict({picture, curve, gaze}, {{error}}, true);
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.density, b.density);
  const ImageGray weights = one.weights({picture, curve, gaze}, {{error}});
  EXPECT_EQ(weights, three.weights({picture, curve, gaze}, {{error}}));
  EXPECT_EQ(visible_allocation(weights, error, 1), visible_allocation(weights, error, 3));
}

TEST(VisibleError, RefusesWhatDoesNotFit) {
  const PlanarView view = view_of(64, 40, 20);
  EXPECT_THROW(VisibleErrorModel({view_of(64, 7, 20), 24}), Error);
  EXPECT_THROW(VisibleErrorModel({view, 24, 3}), Error);
  EXPECT_THROW(VisibleErrorModel({view, 2}), Error);
  const VisibleErrorModel model({view, 24});
  const DisplayCurve curve = luminance_as_it_is();
  const ImageGray small(32, 40, 1.0F);
  const ImageGray right(64, 40, 1.0F);
  EXPECT_THROW((void)model.predict({small, curve}, {}), Error);
  EXPECT_THROW((void)model.predict({right, curve}, {{small}}), Error);
  EXPECT_THROW((void)model.predict({right, curve}, {{right, white_error(), 1.5}}), Error);
  EXPECT_THROW(visible_allocation(small, right), Error);
  EXPECT_THROW(block_error(0), Error);
}

}  // namespace
}  // namespace gazetrace::visible_error_test
