// SPDX-License-Identifier: Apache-2.0
// Frames whose rates a pilot decides: their means stay those of uniform frames, their bits do not depend on threads,
// they spend what they are given, and what a target predicts is what comes out.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/luminance.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "pipeline/quality/pilot.hpp"
#include "render/tracer_scenes.hpp"
#include "render/tracer_statistics.hpp"

namespace gazetrace::adaptive_test {
namespace {

using namespace test;

constexpr int kWidth = 48, kHeight = 32;

// A lamp in a half-open room with a glossy body: some pixels are much noisier than others.
Scene room() {
  Scene scene;
  scene.materials = {diffuse_material({0.7F, 0.6F, 0.5F}), diffuse_material({0.9F, 0.8F, 0.7F}),
                     diffuse_material({0.5F, 0.5F, 0.5F}, {5, 4.5F, 4})};
  scene.materials[1].metallic = 1;
  scene.materials[1].roughness = 0.35F;
  scene.environment = builtin_sky();
  add_mesh(scene, {quad({{{-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}}}, 0),
                   quad({{{-3, 0, -2}, {3, 0, -2}, {3, 4, -2}, {-3, 4, -2}}}, 0)});
  add_mesh(scene, box(0.5F, false, 1), make_affine({0.3, 0.5, 0}, {0, 0.3, 0, 0.954}, {1, 1, 1}));
  add_mesh(scene, {quad({{{-0.7F, 3, -0.7F}, {0.7F, 3, -0.7F}, {0.7F, 3, 0.7F}, {-0.7F, 3, 0.7F}}}, 2)});
  return scene;
}

FrameRequest request_of(std::int32_t frame = 1) {
  return frame_request(frame, camera_at({1.5, 2.0, 5}, {0, 0.8, 0}), kWidth, kHeight);
}

FrameSettings settings_of(const std::string& sampling, const std::string& filter = "none") {
  FrameSettings settings;
  settings.foveation.sampling = parse_sampling(sampling);
  settings.foveation.spp = 16;
  settings.reconstruction.filter = filter;
  settings.threads = 2;
  return settings;
}

std::vector<double> luminances(const Frame& frame) {
  std::vector<double> values;
  for (const Vec3f& pixel : frame.radiance.pixels) {
    values.push_back(luminance(to_double(pixel)));
  }
  return values;
}

// Two one-sided tests for equivalence within half a percent, at a level of 1e-3 for each of the groups: t of 255
// degrees of freedom is 3.12. The groups are the pixels by their variance, least first: deciding on the samples that
// are kept would lower the mean where light is found by rare samples.
TEST(Adaptive, TheMeanOverSeedsIsThatOfUniformFrames) {
  constexpr int kSeeds = 256;
  constexpr std::size_t kGroups = 3;
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const std::size_t pixels = std::size_t{kWidth} * kHeight;
  std::array<std::vector<std::vector<double>>, 2> seen;  // uniform, adaptive; seed; pixel
  for (std::size_t arm = 0; arm < seen.size(); ++arm) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      FrameSettings settings = settings_of(arm == 0 ? "uniform" : "adaptive");
      settings.foveation.min_spp = 1;
      settings.trace.seed = static_cast<std::uint64_t>(seed) + 1000 * arm;
      seen[arm].push_back(luminances(FrameRenderer(tracer, settings).render(request_of()).frame));
    }
  }
  std::vector<double> spread(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    Repeats uniform;
    for (const std::vector<double>& frame : seen[0]) {
      uniform.means.push_back(frame[i]);
    }
    spread[i] = uniform.variance_of_mean();
  }
  std::vector<std::size_t> order(pixels);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return spread[a] < spread[b]; });
  for (std::size_t group = 0; group < kGroups; ++group) {
    std::array<Repeats, 2> means;
    for (std::size_t arm = 0; arm < seen.size(); ++arm) {
      for (const std::vector<double>& frame : seen[arm]) {
        double sum = 0;
        for (std::size_t i = group * pixels / kGroups; i < (group + 1) * pixels / kGroups; ++i) {
          sum += frame[order[i]];
        }
        means[arm].means.push_back(sum);
      }
    }
    const double error = std::sqrt(means[0].variance_of_mean() + means[1].variance_of_mean()) / means[0].mean();
    const double difference = means[1].mean() / means[0].mean() - 1;
    EXPECT_LT(std::abs(difference) + 3.12 * error, 0.005) << "group " << group << ": " << difference << " +- " << error;
  }
}

TEST(Adaptive, SameBitsForAnyNumberOfThreads) {
  const Scene scene = room();
  for (const char* filter : {"none", "guided"}) {
    std::vector<RenderedFrame> frames;
    for (const int count : {1, 3}) {
      PathTracer tracer(scene, threads(count));
      FrameSettings settings = settings_of("adaptive", filter);
      settings.foveation.target.relmse = 0.02;
      settings.threads = count;
      frames.push_back(FrameRenderer(tracer, settings).render(request_of()));
    }
    EXPECT_EQ(frames[0].frame.radiance, frames[1].frame.radiance) << filter;
    EXPECT_EQ(frames[0].prediction.relmse, frames[1].prediction.relmse);
    EXPECT_EQ(frames[0].pilot.samples, frames[1].pilot.samples);
  }
}

// The pilot's samples are none of the frame's: another seed of the frame leaves its picture as noisy, and a frame of
// the same rates from outside has the same bits.
TEST(Adaptive, TheFrameIsThatOfItsRatesWithNothingOfThePilot) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  const FrameSettings settings = settings_of("adaptive");
  const TracedFrame traced = FrameRenderer(tracer, settings).trace(request_of());
  TraceSettings trace = settings.trace;
  trace.guiding_field = tracer.at({0, 0}).train_guiding(request_of().camera, kWidth, kHeight, trace).field;
  const SparseFrame again = tracer.at({0, 0}).trace(request_of().camera, 1, traced.map, trace);
  EXPECT_EQ(traced.sparse.sum, again.sum);
  EXPECT_EQ(traced.sparse.count, again.count);
  EXPECT_GT(traced.pilot.samples, 0U);
}

TEST(Adaptive, ABudgetCountsThePilot) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  FrameSettings settings = settings_of("adaptive");
  for (const double spp : {5.0, 24.0}) {
    settings.foveation.spp = spp;
    const TracedFrame traced = FrameRenderer(tracer, settings).trace(request_of());
    EXPECT_NEAR(static_cast<double>(traced.sparse.stats.samples + traced.pilot.samples), spp * kWidth * kHeight, 2);
  }
  settings.foveation.spp = 0.5;
  EXPECT_THROW((void)FrameRenderer(tracer, settings).trace(request_of()), Error);
}

TEST(Adaptive, RatesKeepTheirLimits) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  FrameSettings settings = settings_of("adaptive");
  settings.foveation.spp = 10;
  settings.foveation.min_spp = 6;
  settings.foveation.max_spp = 12;
  const TracedFrame traced = FrameRenderer(tracer, settings).trace(request_of());
  for (std::size_t i = 0; i < traced.map.sites.size(); ++i) {
    const double rate = traced.map.expected(i) / traced.map.sites[i].pixels;
    // The pilot's samples and the interpolation between its pixels shift rates a little.
    ASSERT_GT(rate, 6 * 0.9);
    ASSERT_LT(rate, 12 * 1.1);
  }
}

// At one pixel a cell and without a filter, what the pilot predicts is a matter of statistics alone. The variance of
// independent samples is an upper bound: stratified ones leave less.
TEST(Adaptive, WhatATargetPredictsComesOut) {
  const Scene scene = room();
  PathTracer tracer(scene, threads(2));
  FrameSettings fine = settings_of("uniform");
  fine.foveation.spp = 4096;
  fine.trace.seed = 99;
  const std::vector<double> truth = luminances(FrameRenderer(tracer, fine).render(request_of()).frame);
  double before = 0;
  for (const double target : {0.02, 0.005}) {
    double measured = 0;
    double samples = 0;
    constexpr int kSeeds = 8;
    for (int seed = 1; seed <= kSeeds; ++seed) {
      FrameSettings settings = settings_of("adaptive");
      settings.foveation.spp.reset();
      settings.foveation.target.relmse = target;
      settings.trace.seed = static_cast<std::uint64_t>(seed);
      const RenderedFrame rendered = FrameRenderer(tracer, settings).render(request_of());
      EXPECT_NEAR(*rendered.prediction.relmse / target, 1, 0.02);
      samples += static_cast<double>(rendered.samples.samples) / kSeeds;
      const std::vector<double> values = luminances(rendered.frame);
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const double error = values[i] - truth[i];
        measured += error * error / (truth[i] * truth[i] + 0.01) / static_cast<double>(truth.size()) / kSeeds;
      }
    }
    EXPECT_LT(measured, 1.25 * target);
    EXPECT_GT(measured, 0.25 * target);
    EXPECT_GT(samples, 2 * before);
    before = samples;
  }
}

}  // namespace
}  // namespace gazetrace::adaptive_test
