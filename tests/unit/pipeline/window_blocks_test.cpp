// SPDX-License-Identifier: Apache-2.0
// The blocks of a part of a frame are those of the frame, though its rates are lower than elsewhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "foveation/site_images.hpp"
#include "gazetrace/foveation.hpp"
#include "pipeline/frame_part.hpp"

namespace gazetrace::window_blocks_test {
namespace {

constexpr int kSide = 256;
constexpr int kX = 192, kY = 64, kWindow = 64;

PlanarView view_of(int side) {
  return view_of_perspective(0.5, side, side);
}

int block_at(const SamplingMap& map, int x, int y) {
  return map.regions[map.region(x, y)].block_px;
}

TEST(WindowBlocks, AreThoseOfTheFrame) {
  for (const Sampling& sampling : {Sampling(density_of_picture()), Sampling(AdaptiveSampling{})}) {
    FoveationSettings settings;
    settings.sampling = sampling;
    // From 64 samples a pixel on the left to a sixteenth on the right.
    ImageGray rates(kSide, kSide);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        rates(x, y) = static_cast<float>(64 * std::exp2(-10.0 * x / kSide));
      }
    }
    MapContext whole;
    whole.density = &rates;
    const SamplingMap frame = make_sampling_map(settings, view_of(kSide), std::nullopt, whole);
    const ImageGray expected = expected_spp_of(frame);
    const ImageGray part = cut_out(expected, PixelRect{kX, kY, kWindow, kWindow});
    MapContext context;
    context.density = &part;
    context.full_rate_spp = *std::max_element(expected.pixels.begin(), expected.pixels.end());
    const SamplingMap window = make_sampling_map(settings, view_of(kWindow), std::nullopt, context);
    int alike = 0;
    for (int y = 0; y < kWindow; ++y) {
      for (int x = 0; x < kWindow; ++x) {
        alike += block_at(window, x, y) == block_at(frame, kX + x, kY + y) ? 1 : 0;
      }
    }
    EXPECT_GT(block_at(frame, kSide - 1, kY), 1);
    // Where blocks just have as many samples as they must, the mean of one may be beneath that: a column of eight
    // pixels.
    EXPECT_GE(alike, (kWindow - 8) * kWindow) << to_string(sampling);
  }
}

}  // namespace
}  // namespace gazetrace::window_blocks_test
