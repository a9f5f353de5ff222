// SPDX-License-Identifier: Apache-2.0
// What the sanitizers' build cannot show of single parts: loops in vectors beside the same one by one, and memory that
// is given back.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <random>
#include <vector>

#include "core/fast_math.hpp"
#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "trace/lights/light_sampling.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace::optimized_loops_test {
namespace {

double resident_mib() {
  std::ifstream statm("/proc/self/statm");
  double all = 0;
  double resident = 0;
  statm >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

// A sequence of a thousand frames makes some hundred thousand loops.
TEST(Parallel, ManyLoopsKeepNoMemory) {
  const auto loops = [](int count) {
    for (int k = 0; k < count; ++k) {
      parallel_for(16, 0, [](std::size_t) {});
    }
  };
  loops(500);
  const double before = resident_mib();
  loops(4000);
  EXPECT_LT(resident_mib() - before, 4);
}

TEST(FastMath, PowerAndItsParts) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> exponent(-30, 30);
  for (int i = 0; i < 100000; ++i) {
    const auto x = static_cast<float>(std::exp2(exponent(random)));
    const double exact = std::log2(static_cast<double>(x));
    ASSERT_NEAR(log2_fast(x), exact, 2e-7 + 1e-7 * std::fabs(exact)) << x;
    const auto y = static_cast<float>(exponent(random));
    const double power = std::exp2(static_cast<double>(y));
    ASSERT_NEAR(exp2_fast(y), power, 2e-7 * power) << y;
  }
  EXPECT_EQ(pow_fast(0.0F, 0.7F), 0.0F);
  EXPECT_EQ(pow_fast(1.0F, 0.3F), 1.0F);
}

TEST(EnvironmentLoops, ManyAtOnceAreTheSameAsOneByOne) {
  constexpr SampleKey key = make_sample_key(11, 0, 0);
  constexpr Vec3f up{0, 1, 0};
  Scene scene;
  scene.environment.radiance = ImageRgb(50, 20);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    scene.environment.radiance.pixels[i] = {static_cast<float>(hash32(i)), 1, 0};
  }
  const LightSampler lights(scene);
  constexpr std::size_t kCount = 150;
  std::vector<Vec2f> u(kCount);
  std::vector<float> select(kCount);
  std::vector<Vec3f> directions(kCount);
  const std::vector<Vec3f> zeros(kCount);
  const std::vector<Vec3f> normals(kCount, up);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    u[i] = sample_2d(key, i, 2);
    select[i] = sample_1d(key, i, 3);
    directions[i] = normalize(Vec3f{u[i].x - 0.5F, u[i].y - 0.5F, select[i] - 0.5F});
  }
  std::vector<LightSample> samples(kCount);
  std::vector<LightSampler::EnvironmentHit> hits(kCount);
  lights.sample_many(kCount, zeros.data(), normals.data(), u.data(), select.data(), samples.data());
  lights.environment_many(directions.data(), kCount, hits.data());
  for (std::size_t i = 0; i < kCount; ++i) {
    const LightSample one = lights.sample({}, up, u[i], select[i]);
    EXPECT_EQ(one.direction, samples[i].direction);
    EXPECT_EQ(one.radiance, samples[i].radiance);
    EXPECT_EQ(one.pdf, samples[i].pdf);
    EXPECT_EQ(one.valid, samples[i].valid);
    EXPECT_EQ(lights.environment(directions[i]).radiance, hits[i].radiance);
    EXPECT_EQ(lights.environment(directions[i]).pdf, hits[i].pdf);
  }
}

}  // namespace
}  // namespace gazetrace::optimized_loops_test
