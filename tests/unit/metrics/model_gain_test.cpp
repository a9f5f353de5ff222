// SPDX-License-Identifier: Apache-2.0
// The model's gain, held against FovVideoVDP itself: noise at uniform rates and at the model's rates, with as many
// samples less as the gain says, must score the same.
#include "gazetrace/model_gain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gazetrace/error.hpp"
#include "support/visible_noise.hpp"

namespace gazetrace::model_gain_test {
namespace {

TEST(ModelGain, TheMetricSeesEqualNoise) {
  const int width = 640;
  const int height = 400;
  const double fps = 24;
  const double luminance = 30;
  // Noise of a contrast of 1 at one sample would be cut at black; four samples a pixel are about the least.
  const PlanarView view = view_of(width, height, 9);
  const Vec2d gaze{200, 200};
  ModelGainSettings settings;
  settings.view = view;
  settings.frames_per_second = fps;
  settings.luminance_cd_m2 = luminance;
  settings.target_jod = 9.3;
  const ModelGain model = model_gain(settings, view.direction(gaze.x, gaze.y), white_error());
  EXPECT_GT(model.gain, 1.15);
  EXPECT_NEAR(model.uniform_spp / model.allocated_spp, model.gain, 1e-9);

  const ImageGray flat(width, height, static_cast<float>(luminance));
  const int cell = (width + model.density.width_px - 1) / model.density.width_px;
  double samples = 0;
  const auto deviation = [&](bool allocated) {
    ImageGray image(width, height);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double density = static_cast<double>(model.density(x / cell, y / cell));
        const double spp = allocated ? model.allocated_spp * density : model.uniform_spp;
        samples += allocated ? spp / (width * height) : 0;
        image(x, y) = static_cast<float>(luminance / std::sqrt(spp));
      }
    }
    return image;
  };
  const auto jod = [&](const ImageGray& noise_of) {
    return fovvideovdp_jod(measured_q(
        view, fps, gaze, flat,
        [&](int frame) { return with_noise(flat, white_noise(width, height, static_cast<unsigned>(frame)), noise_of); },
        4));
  };
  const double uniform = jod(deviation(false));
  const double allocated = jod(deviation(true));
  EXPECT_NEAR(samples, model.allocated_spp, 0.02 * model.allocated_spp);
  EXPECT_NEAR(uniform, settings.target_jod, 0.1);
  EXPECT_NEAR(allocated, uniform, 0.03);
}

TEST(ModelGain, ASmallFieldHasNothingToGain) {
  ModelGainSettings settings;
  settings.view = view_of(64, 64, 64);
  const Vec3d middle{0, 0, -1};
  const ModelGain small = model_gain(settings, middle, white_error());
  EXPECT_NEAR(small.gain, 1, 0.02);
  settings.view = view_of(2048, 2048, 32);
  settings.frames_per_second = 24;
  const ModelGain large = model_gain(settings, middle, white_error());
  EXPECT_GT(large.gain, small.gain + 0.1);
  // Noise of low frequency hardly fades towards the periphery, so that taking it away leaves more to gain.
  EXPECT_GT(model_gain(settings, middle, cut_error(4, 0.1, 32)).gain, large.gain + 0.1);
  EXPECT_LT(model_gain(settings, middle, low_pass_error(4)).gain, large.gain);
  for (const double impossible : {10.0, 4.9}) {
    settings.target_jod = impossible;
    EXPECT_THROW((void)model_gain(settings, middle, white_error()), Error);
  }
}

}  // namespace
}  // namespace gazetrace::model_gain_test
