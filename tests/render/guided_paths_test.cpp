// SPDX-License-Identifier: Apache-2.0
// Paths that draw directions from what the frame has guided: means that do not change, less noise where the sky is
// hidden, the same bits for any thread count.
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "core/luminance.hpp"
#include "gazetrace/frame_renderer.hpp"
#include "render/tracer_scenes.hpp"
#include "render/tracer_statistics.hpp"
#include "support/picture_evidence.hpp"
#include "trace/guiding/guiding_field.hpp"

namespace gazetrace::guided_paths_test {
namespace {

using namespace test;

constexpr int kRepeats = 32;
constexpr int kGuidingWidth = 256, kGuidingHeight = 192;

// A room with a hole in a wall, through which a bright sky shines. Its floor may be polished, its box varnished.
Scene room(bool glossy, bool layered) {
  Scene scene;
  scene.materials.push_back(diffuse_material({0.7F, 0.6F, 0.5F}));
  scene.materials.push_back(diffuse_material({0.8F, 0.8F, 0.8F}));
  if (glossy) {
    scene.materials[0].metallic = 0.6F;
    scene.materials[0].roughness = 0.35F;
  }
  if (layered) {
    scene.materials[1].clearcoat.factor = 0.8F;
    scene.materials[1].clearcoat.roughness = 0.3F;
  }
  const auto wall = [](const std::array<Vec3f, 4>& corners) { return quad(corners, 1); };
  add_mesh(scene, {quad({{{-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}}}, 0),
                   wall({{{-3, 3, -3}, {3, 3, -3}, {3, 3, 3}, {-3, 3, 3}}}),
                   wall({{{-3, 0, -3}, {3, 0, -3}, {3, 3, -3}, {-3, 3, -3}}}),
                   wall({{{-3, 0, 3}, {-3, 3, 3}, {3, 3, 3}, {3, 0, 3}}}),
                   wall({{{-3, 0, 3}, {-3, 0, -3}, {-3, 3, -3}, {-3, 3, 3}}}),
                   wall({{{3, 0, -3}, {3, 0, 3}, {3, 1.4F, 3}, {3, 1.4F, -3}}}),
                   wall({{{3, 1.4F, -3}, {3, 1.4F, 1.5F}, {3, 3, 1.5F}, {3, 3, -3}}})});
  add_mesh(scene, box(0.5F, false, 1), make_affine({0.3, 0.5, 0}, {0, 0.3, 0, 0.954}, {1, 1, 1}));
  scene.environment = builtin_sky();
  return scene;
}

const Camera kCamera = camera_at({-2.5, 1.6, 2.0}, {0.8, 0.7, 0});

std::shared_ptr<const GuidingField> train(PathTracer& tracer, const TraceSettings& settings) {
  return tracer.at_rest().train_guiding(kCamera, kGuidingWidth, kGuidingHeight, settings).field;
}

Repeats repeat(PathTracer& tracer, const SamplingMap& map, TraceSettings settings) {
  Repeats result;
  for (int i = 0; i < kRepeats; ++i) {
    settings.seed = static_cast<std::uint64_t>(i + 1);
    result.means.push_back(mean_radiance(tracer.at_rest().trace(kCamera, 1, map, settings)).y);
  }
  return result;
}

// Tables that know nothing of the scene: narrow lobes at random, as bad as they can be.
std::shared_ptr<const GuidingField> nonsense_field() {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  std::vector<TrainingRecord> records;
  for (std::uint32_t i = 0; i < 60000; ++i) {
    const Vec3f place{3 * uniform(random), 1.5F + 1.5F * uniform(random), 3 * uniform(random)};
    const Vec3f toward = to_float(normalize(Vec3d{uniform(random) + 1e-3, uniform(random), uniform(random)}));
    for (const Vec3f& normal :
         {Vec3f{0, 1, 0}, Vec3f{0, -1, 0}, Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}}) {
      const bool bright = toward.x + 0.3F * toward.z > 0.8F * std::sin(7 * place.x);
      records.push_back({place, normal, toward, 0.08F, 0.08F, bright ? 1.0F : 0.01F, i});
    }
  }
  return std::make_shared<const GuidingField>(records, 1);
}

// Standard errors are 0.2 to 0.5 % of the mean.
TEST(GuidedPaths, MeansDoNotChange) {
  const std::shared_ptr<const GuidingField> nonsense = nonsense_field();
  ASSERT_TRUE(nonsense->pays());
  struct Case {
    bool glossy, layered;
    DiffuseModel diffuse;
  };
  // Matte surfaces have neither gloss nor layers: the other three rooms of them have the same bits.
  for (const Case& c : {Case{false, false, DiffuseModel::matte}, Case{false, false, DiffuseModel::lambert},
                        Case{false, true, DiffuseModel::lambert}, Case{true, false, DiffuseModel::lambert},
                        Case{true, true, DiffuseModel::lambert}}) {
    const Scene scene = room(c.glossy, c.layered);
    PathTracer tracer(scene, threads(2));
    const SamplingMap map = uniform_map(24, 16, 32);
    TraceSettings settings;
    settings.diffuse = c.diffuse;
    const Repeats plain = repeat(tracer, map, settings);
    TraceSettings guided = settings;
    guided.guiding_field = train(tracer, settings);
    ASSERT_NE(guided.guiding_field, nullptr);
    const Repeats with_field = repeat(tracer, map, guided);
    EXPECT_LT(std::fabs(welch_t(plain, with_field)), kCriticalT) << plain.mean() << " " << with_field.mean();
    EXPECT_LT(std::sqrt(with_field.variance_of_mean()), 0.01 * with_field.mean()) << "too noisy to mean anything";
    EXPECT_NE(plain.means, with_field.means);
    guided.guiding_field = nonsense;
    guided.light_sampling = LightSampling::mis;
    const Repeats misled = repeat(tracer, map, guided);
    EXPECT_LT(std::fabs(welch_t(plain, misled)), kCriticalT) << plain.mean() << " " << misled.mean();
    // Without light samples nothing corrects a wrong density.
    guided.light_sampling = LightSampling::bsdf_only;
    const Repeats alone = repeat(tracer, map, guided);
    EXPECT_LT(std::fabs(welch_t(plain, alone)), kCriticalT) << plain.mean() << " " << alone.mean();
  }
}

// Paths may also hit emitters, whose densities are not those of the sky, end by roulette, and pass through a curtain.
TEST(GuidedPaths, MeansDoNotChangeUnderLamps) {
  Scene scene = room(true, false);
  scene.environment = {};
  scene.materials.push_back(diffuse_material({0.5F, 0.5F, 0.5F}, {9, 8, 7}));
  scene.materials.push_back(diffuse_material({0.3F, 0.8F, 0.3F}));
  scene.materials.back().base_color.w = 0.4F;
  scene.materials.back().alpha_mode = AlphaMode::blend;
  add_mesh(scene, {quad({{{-1, 2.9F, -1}, {0, 2.9F, -1}, {0, 2.9F, 1}, {-1, 2.9F, 1}}}, 2),
                   quad({{{-2.9F, 0.2F, 1}, {-2.9F, 0.2F, 0.6F}, {-2.9F, 0.9F, 0.6F}, {-2.9F, 0.9F, 1}}}, 2),
                   quad({{{-2, 2, -2}, {2, 2, -2}, {2, 2, 2}, {-2, 2, 2}}}, 3)});
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(24, 16, 64);
  TraceSettings settings;
  settings.max_bounces = 6;
  const Repeats plain = repeat(tracer, map, settings);
  settings.russian_roulette = true;
  for (const std::shared_ptr<const GuidingField>& light : {train(tracer, settings), nonsense_field()}) {
    settings.guiding_field = light;
    const Repeats guided = repeat(tracer, map, settings);
    EXPECT_LT(std::fabs(welch_t(plain, guided)), kCriticalT) << plain.mean() << " " << guided.mean();
    EXPECT_LT(std::sqrt(guided.variance_of_mean()), 0.01 * guided.mean()) << "too noisy to mean anything";
  }
}

TEST(GuidedPaths, LessNoiseInARoom) {
  const Scene scene = room(false, false);
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(48, 32, 16);
  TraceSettings settings;
  settings.max_bounces = 3;  // the noise of roulette is what training does not change
  settings.russian_roulette = false;
  settings.light_sampling = LightSampling::mis;
  const auto variance_of = [&](const TraceSettings& own) {
    Repeats repeats;
    for (int i = 0; i < kRepeats; ++i) {
      TraceSettings seeded = own;
      seeded.seed = static_cast<std::uint64_t>(i + 1);
      const SparseFrame frame = tracer.at_rest().trace(kCamera, 1, map, seeded);
      double sum = 0;
      for (std::size_t site = 0; site < frame.sum.size(); ++site) {
        const double n = frame.count[site];
        const double mean = static_cast<double>(luminance(frame.sum[site])) / n;
        sum += static_cast<double>(frame.sum_square_luminance[site]) / n - mean * mean;
      }
      repeats.means.push_back(sum / static_cast<double>(frame.sum.size()));
    }
    return repeats;
  };
  const Repeats plain = variance_of(settings);
  settings.guiding_field = train(tracer, settings);
  ASSERT_NE(settings.guiding_field, nullptr);
  const Repeats guided = variance_of(settings);
  EXPECT_GT(welch_t(plain, guided), kCriticalT) << plain.mean() << " " << guided.mean();
}

TEST(GuidedPaths, SameBitsForAnyThreads) {
  const Scene scene = room(true, true);
  const SamplingMap map = uniform_map(48, 32, 4);
  const auto traced = [&](int count, std::uint64_t training_seed) {
    PathTracer tracer(scene, threads(count));
    TraceSettings settings;
    settings.seed = training_seed;
    TrainedGuiding training = tracer.at_rest().train_guiding(kCamera, kGuidingWidth, kGuidingHeight, settings);
    EXPECT_GT(training.paths, 5000U);
    EXPECT_LE(training.paths, 6200U);
    settings.guiding_field = training.field;
    settings.seed = 3;
    return tracer.at_rest().trace(kCamera, 1, map, settings);
  };
  const SparseFrame one = traced(1, 3);
  EXPECT_TRUE(same_samples(one, traced(2, 3), map));
  EXPECT_TRUE(same_samples(one, traced(7, 3), map));
  EXPECT_FALSE(same_samples(one, traced(1, 4), map));
}

FrameRequest request_of(std::int32_t frame) {
  return frame_request(frame, kCamera, kGuidingWidth, kGuidingHeight);
}

FrameSettings one_sample() {
  FrameSettings settings;
  settings.foveation.sampling = UniformSampling{};
  settings.foveation.spp = 1;
  settings.reconstruction.filter = "none";
  return settings;
}

TEST(GuidedPaths, FramesAtRestTrainOnce) {
  const Scene scene = room(false, false);
  PathTracer tracer(scene, threads(2));
  const FrameRenderer renderer(tracer, one_sample());
  TrainedField known;
  EXPECT_GT(renderer.trace(request_of(1), known).pilot.training_paths, 5000U);
  const TracedFrame second = renderer.trace(request_of(2), known);
  EXPECT_EQ(second.pilot.training_paths, 0U);
  EXPECT_TRUE(same_samples(second.sparse, renderer.trace(request_of(2)).sparse, second.map));

  FrameRequest moved = request_of(3);
  moved.camera = camera_at({-2.4, 1.6, 2.0}, {0.8, 0.7, 0});
  const TracedFrame third = renderer.trace(moved, known);
  EXPECT_GT(third.pilot.training_paths, 5000U);
  EXPECT_TRUE(same_samples(third.sparse, renderer.trace(moved).sparse, third.map));
  EXPECT_GT(renderer.trace(request_of(4), known).pilot.training_paths, 5000U);
}

// By default, and counted as what it is.
TEST(GuidedPaths, AFrameIsTrainedBeforeItIsTraced) {
  const Scene scene = room(false, false);
  PathTracer tracer(scene, threads(2));
  const FrameRequest request = request_of(1);
  FrameSettings settings = one_sample();
  const TracedFrame frame = FrameRenderer(tracer, settings).trace(request);

  TraceSettings by_hand = settings.trace;
  by_hand.guiding_field = train(tracer, by_hand);
  ASSERT_NE(by_hand.guiding_field, nullptr);
  EXPECT_TRUE(same_samples(frame.sparse, tracer.at_rest().trace(kCamera, 1, frame.map, by_hand), frame.map));
  EXPECT_EQ(frame.sparse.stats.samples, static_cast<std::uint64_t>(kGuidingWidth) * kGuidingHeight);
  EXPECT_EQ(frame.pilot.samples, 0U);
  EXPECT_GT(frame.pilot.training_paths, 5000U);
  EXPECT_EQ(frame.pilot.rays_primary, 0U);
  EXPECT_GT(frame.times.guiding_ms, 0);
  EXPECT_EQ(frame.times.pilot_ms, 0);

  settings.trace.guiding = false;
  const TracedFrame plain = FrameRenderer(tracer, settings).trace(request);
  EXPECT_FALSE(same_samples(frame.sparse, plain.sparse, frame.map));
  EXPECT_EQ(plain.pilot.training_paths, 0U);
}

TEST(GuidedPaths, NothingToFind) {
  Scene scene = room(false, false);
  scene.environment = {};
  PathTracer tracer(scene, threads(2));
  EXPECT_EQ(train(tracer, {}), nullptr) << "it is dark";
  const Scene lit = room(false, false);
  PathTracer other(lit, threads(2));
  TraceSettings settings;
  settings.light_sampling = LightSampling::light_only;
  EXPECT_EQ(train(other, settings), nullptr);
  settings.light_sampling = LightSampling::mis;
  settings.max_bounces = 0;
  EXPECT_EQ(train(other, settings), nullptr);
}

}  // namespace
}  // namespace gazetrace::guided_paths_test
