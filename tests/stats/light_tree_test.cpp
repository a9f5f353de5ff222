// SPDX-License-Identifier: Apache-2.0
// The tree over many lights: what it chooses against what it says, what it must never overlook, and whether its bounds
// hold what they say.
#include "trace/lights/light_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/hash.hpp"
#include "support/chi2.hpp"
#include "trace/lights/light_sampling.hpp"

namespace gazetrace::light_tree_test {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(hash64(seed)) {}
  double operator()() {
    state_ += 0x9e3779b97f4a7c15ULL;
    return static_cast<double>(hash64(state_) >> 11U) * 0x1p-53;
  }
  double operator()(double low, double high) { return low + (high - low) * (*this)(); }
  Vec3d direction() {
    const double z = (*this)(-1, 1);
    const double phi = (*this)(0, 2 * kPi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
  Vec3d in_cube(double half) { return {(*this)(-half, half), (*this)(-half, half), (*this)(-half, half)}; }

 private:
  std::uint64_t state_;
};

// Surfaces of one and of two sides, points and spots, some with a reach, one in ten black.
std::vector<LightBounds> mixed_lights(std::size_t count, double extent, Random& random) {
  std::vector<LightBounds> lights;
  for (std::size_t i = 0; i < count; ++i) {
    LightBounds light;
    light.low = random.in_cube(extent);
    light.high = light.low;
    light.axis = random.direction();
    light.intensity = i % 10 == 9 ? 0 : std::pow(10.0, random(-3, 3));
    switch (i % 4) {
      case 0:
      case 1: {
        const double size = 0.1 * extent * random();
        light.high = light.low + Vec3d{size, size * random(), size * random()};
        light.two_sided = i % 4 == 1;
        break;
      }
      case 2:
        light.normals_rad = kPi;
        light.reach_m = i % 8 == 2 ? extent * random(0.2, 1) : light.reach_m;
        break;
      default:
        light.emission_rad = random(0.05, kPi / 2);
    }
    lights.push_back(light);
  }
  return lights;
}

struct Place {
  Vec3f position, normal;
};

std::vector<Place> places(double extent, Random& random) {
  std::vector<Place> all;
  for (const double reach : {0.1, 0.7, 1.5, 30.0}) {
    for (const bool with_normal : {true, false}) {
      all.push_back({to_float(random.in_cube(extent * reach)), with_normal ? to_float(random.direction()) : Vec3f{}});
    }
  }
  return all;
}

TEST(LightTree, ChoosesAsOftenAsItSays) {
  constexpr int kSamples = 100000;
  Random random(1);
  struct Case {
    std::size_t lights;
    double extent;
  };
  const std::vector<Case> cases{{1, 1}, {2, 1}, {8, 1}, {9, 1}, {65, 1}, {1000, 1}, {100, 1e-6}, {100, 1e6}};
  int refused = 0;
  for (const Case& c : cases) {
    const auto lights = mixed_lights(c.lights, c.extent, random);
    const LightTree tree(lights);
    for (const Place& place : places(c.extent, random)) {
      std::vector<double> expected(c.lights + 1);
      double sum = 0;
      for (std::uint32_t i = 0; i < c.lights; ++i) {
        const double p = static_cast<double>(tree.probability(i, place.position, place.normal));
        EXPECT_TRUE(p >= 0 && p <= 1.000001);
        EXPECT_TRUE(lights[i].intensity > 0 || p == 0) << "a black light is never chosen";
        expected[i] = p * kSamples;
        sum += p;
      }
      // Bounds of a node may promise what none of its children can give: then nothing is chosen.
      EXPECT_LT(sum, 1.0001);
      expected[c.lights] = std::max(1 - sum, 0.0) * kSamples;
      expected[c.lights] = expected[c.lights] < 1e-3 ? 0 : expected[c.lights];
      std::vector<double> observed(c.lights + 1);
      for (int s = 0; s < kSamples; ++s) {
        const auto chosen = tree.choose(place.position, place.normal, random());
        if (chosen.probability > 0) {
          EXPECT_NEAR(chosen.probability / tree.probability(chosen.light, place.position, place.normal), 1, 1e-5);
        }
        observed[chosen.probability > 0 ? chosen.light : c.lights] += 1;
      }
      const test::Chi2 result = test::chi2_test(observed, expected);
      EXPECT_GT(result.p_value, test::sidak(8 * cases.size()))
          << c.lights << " lights: chi2 " << result.statistic << " of " << result.degrees << " degrees";
      refused += expected[c.lights] > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(refused, 0) << "the case must have come up";
}

// A light that sends anything to the point, shown by a point of the light itself, has a chance.
TEST(LightTree, OverlooksNoLightThatReachesThePoint) {
  Random random(2);
  int reaching = 0;
  for (int round = 0; round < 20; ++round) {
    const double extent = std::pow(10.0, random(-6, 6));
    const auto lights = mixed_lights(300, extent, random);
    const LightTree tree(lights);
    for (const Place& place : places(extent, random)) {
      const Vec3d position = to_double(place.position);
      const Vec3d normal = to_double(place.normal);
      for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const LightBounds& light = lights[i];
        const Vec3d on{random(light.low.x, light.high.x), random(light.low.y, light.high.y),
                       random(light.low.z, light.high.z)};
        const Vec3d way = on - position;
        const double distance = length(way);
        const Vec3d to_light = way / distance;
        double emitted = -dot(light.axis, to_light);
        emitted = light.two_sided ? std::fabs(emitted) : light.normals_rad > 3 ? 1.0 : emitted;
        const double received = dot(normal, normal) > 0 ? dot(normal, to_light) : 1.0;
        if (light.intensity > 0 && emitted > std::cos(light.emission_rad) + 1e-3 && received > 1e-3 &&
            distance < light.reach_m) {
          ++reaching;
          EXPECT_GT(tree.probability(i, place.position, place.normal), 0) << "light " << i % 4;
        }
      }
    }
  }
  EXPECT_GT(reaching, 5000);
}

TEST(LightTree, JoinedBoundsHoldBoth) {
  Random random(3);
  for (int round = 0; round < 20000; ++round) {
    LightBounds a;
    LightBounds b;
    for (LightBounds* x : {&a, &b}) {
      x->low = random.in_cube(1);
      x->high = x->low + Vec3d{random(), random(), random()};
      x->axis = random.direction();
      x->normals_rad = random() < 0.3 ? 0 : random(0, kPi);
      x->emission_rad = random(0, kPi / 2);
      x->two_sided = random() < 0.3;
      x->intensity = random();
    }
    b.axis = round % 50 == 0 ? a.axis : round % 50 == 1 ? a.axis * -1.0 : b.axis;
    const LightBounds all = join(a, b);
    EXPECT_NEAR(length(all.axis), 1, 1e-9);
    for (const LightBounds* x : {&a, &b}) {
      EXPECT_LE(all.low.x, x->low.x);
      EXPECT_GE(all.high.z, x->high.z);
      EXPECT_GE(all.emission_rad, x->emission_rad);
      EXPECT_TRUE(all.two_sided || !x->two_sided);
      // The cone's rim reaches furthest from the joint axis at their angle plus its own.
      double between = angle_between_rad(all.axis, x->axis);
      between = all.two_sided ? std::min(between, kPi - between) : between;
      EXPECT_LE(std::min(between + x->normals_rad, kPi), all.normals_rad + 1e-6);
    }
  }
}

TEST(LightTree, NearAndFacingLightsAreChosenMoreOften) {
  std::vector<LightBounds> lights(20);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].low = lights[i].high = {static_cast<double>(i), 1, 0};
    lights[i].axis = {0, i == 3 ? 1.0 : -1.0, 0};
    lights[i].intensity = 1;
  }
  const LightTree tree(lights);
  const Vec3f up{0, 1, 0};
  const float at_zero = tree.probability(0, {0, 0, 0}, up);
  EXPECT_GT(at_zero, 0.4F);
  EXPECT_GT(at_zero, 20 * tree.probability(10, {0, 0, 0}, up));
  EXPECT_EQ(tree.probability(3, {0, 0, 0}, up), 0) << "it shines away";
  EXPECT_EQ(tree.probability(0, {0, 0, 0}, {0, -1, 0}), 0) << "all are below the horizon";
  EXPECT_EQ(tree.choose({0, 0, 0}, {0, -1, 0}, 0.5).probability, 0);
}

// Intensities 60 orders of magnitude apart: nothing overflows, and the weak light keeps a chance down to the least
// share of 1e-18.
TEST(LightTree, ExtremeIntensitiesStayFinite) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    std::vector<LightBounds> lights(8);  // one node: the bounds are the lights themselves
    for (std::size_t i = 0; i < lights.size(); ++i) {
      lights[i].low = Vec3d{static_cast<double>(i), 1, 0} * scale;
      lights[i].high = lights[i].low;
      lights[i].normals_rad = kPi;
      lights[i].intensity = i == 4 ? 1e30 : i == 5 ? 1e-30 : 1e12;
    }
    const LightTree tree(lights);
    const Vec3f at = to_float(Vec3d{4, 0, 0} * scale);
    // By hand, in double: each 1 / distance^2.
    double total = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
      total += std::max(lights[i].intensity / 1e30, 1e-18) /
               (1 + (static_cast<double>(i) - 4) * (static_cast<double>(i) - 4));
    }
    EXPECT_NEAR(tree.probability(4, at, {}) * total, 1, 1e-5);
    EXPECT_NEAR(tree.probability(3, at, {}) * total / (1e-18 / 2), 1, 1e-4);
    EXPECT_NEAR(tree.probability(5, at, {}) * total / (1e-18 / 2), 1, 1e-4) << "less than the least share counts as it";
  }
}

}  // namespace
}  // namespace gazetrace::light_tree_test
