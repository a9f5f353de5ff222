// SPDX-License-Identifier: Apache-2.0
// Tests that the directions that the BSDF samples follow its density.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "material/bsdf.hpp"
#include "support/chi2.hpp"
#include "support/reference_bsdf.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace::bsdf_chi2_test {
namespace {

constexpr int kSide = 16;  // cells along each axis
constexpr std::uint32_t kSamples = 100000;

struct Configuration {
  float roughness, metallic, mu;
};

std::vector<Configuration> configurations() {
  std::vector<Configuration> all;
  for (const float roughness : {0.0F, 1e-4F, 0.01F, 0.1F, 0.3F, 0.6F, 1.0F}) {
    for (const float metallic : {0.0F, 0.5F, 1.0F}) {
      for (const float mu : {0.01F, 0.15F, 0.5F, 0.99F}) {
        all.push_back({roughness, metallic, mu});
      }
    }
  }
  return all;
}

// The probability of a cell of the square below, by the midpoint rule with `n` points in azimuth. In the last column
// the broad lobes crowd at xi = 1, more closely the narrower the specular lobe is, so it is integrated over log(1 -
// xi). `whole` becomes false where part of the cell is below the horizon.
template <DiffuseModel kDiffuse>
double lobe_cell(const Bsdf<kDiffuse>& bsdf, const test::ReferenceGgx& ggx, const Vec3d& o, int x, int y, int n,
                 bool& whole) {
  const bool last = x == kSide - 1;
  const int steps = last ? 16 * n : n;
  double sum = 0;
  for (int j = 0; j < steps; ++j) {
    const double at = (j + 0.5) / steps;
    const double rest = last ? std::exp(-40 * at) / kSide : 1 - (x + at) / kSide;  // 1 - xi
    const double weight = last ? 40 * rest : 1.0 / kSide;
    for (int k = 0; k < n; ++k) {
      const Vec3d h = ggx.normal_at((1 - rest) / rest, (y + (k + 0.5) / n) / kSide);
      const double oh = dot(o, h);
      const Vec3d i = h * (2 * oh) - o;
      if (oh <= 0 || i.z <= 0) {
        whole = false;
        continue;
      }
      const double jacobian = 4 * oh / (ggx.distribution(h) * h.z);
      sum += static_cast<double>(bsdf.evaluate(to_float(i)).pdf) * jacobian * weight;
    }
  }
  return sum / (static_cast<double>(n) * steps * kSide);
}

// The position of a direction in the coordinates of its half-vector. The distribution of normals is uniform in them, so
// that a lobe of any width fills the square. The density is divided by that of the mapping.
template <DiffuseModel kDiffuse>
test::Chi2 run_in_lobe_coordinates(const Configuration& c, std::uint64_t seed) {
  const Surface s{{0.9F, 0.6F, 0.3F}, c.metallic, c.roughness};
  const double mu = c.mu;
  const Vec3d o{std::sqrt(1 - mu * mu), 0, mu};
  const Vec3f wo = to_float(o);
  const test::ReferenceGgx ggx(c.roughness);
  const Bsdf<kDiffuse> bsdf(s, wo);

  std::vector<double> observed(kSide * kSide + 1);
  // Plain random numbers, since the test assumes independent samples.
  std::uint64_t state = hash64(seed);
  const auto random = [&state] {
    state += 0x9e3779b97f4a7c15ULL;
    return static_cast<float>(hash64(state) >> 40U) * 0x1p-24F;
  };
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const Vec2f u{random(), random()};
    const BsdfSample chosen = bsdf.sample(u, random());
    if (!chosen.valid) {
      observed.back() += 1;
      continue;
    }
    const Vec3d h = normalize(o + to_double(chosen.direction));
    const double slope2 = (h.x * h.x + h.y * h.y) / (h.z * h.z * ggx.alpha * ggx.alpha);
    const double turns = std::atan2(h.y, h.x) / (2 * kPi);
    const auto x = std::min(static_cast<int>(slope2 / (1 + slope2) * kSide), kSide - 1);
    const auto y = std::min(static_cast<int>((turns - std::floor(turns)) * kSide), kSide - 1);
    observed[static_cast<std::size_t>(y * kSide + x)] += 1;
  }

  std::vector<double> expected(observed.size());
  double sum = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      bool whole = true;
      double cell = lobe_cell(bsdf, ggx, o, x, y, 12, whole);
      if (!whole) {  // the horizon passes through the cell
        cell = lobe_cell(bsdf, ggx, o, x, y, 48, whole);
      }
      expected[static_cast<std::size_t>(y * kSide + x)] = cell * kSamples;
      sum += cell;
    }
  }
  EXPECT_LE(sum, 1.01);
  expected.back() = std::max(1 - sum, 0.0) * kSamples;
  return test::chi2_test(observed, expected);
}

template <DiffuseModel kDiffuse>
void run_all(std::uint64_t seed) {
  const std::vector<Configuration> all = configurations();
  const double level = test::sidak(2 * all.size());
  for (const Configuration& c : all) {
    const test::Chi2 result = run_in_lobe_coordinates<kDiffuse>(c, ++seed);
    EXPECT_GT(result.p_value, level) << "roughness " << c.roughness << " metallic " << c.metallic << " cosine " << c.mu
                                     << ": chi2 " << result.statistic << " of " << result.degrees << " degrees";
  }
}

TEST(BsdfSampling, BurleyFollowsItsDensity) {
  run_all<DiffuseModel::burley>(1000);
}

TEST(BsdfSampling, LambertFollowsItsDensity) {
  run_all<DiffuseModel::lambert>(2000);
}

// The same over plain directions, where the lobes are broad enough; this checks the coordinates above.
TEST(BsdfSampling, FollowsItsDensityOverTheHemisphere) {
  constexpr int kRows = 16;
  constexpr int kColumns = 32;
  constexpr std::array kRoughness{0.5F, 0.75F, 1.0F};
  constexpr std::array kCosines{0.2F, 0.6F, 0.95F};
  for (const float roughness : kRoughness) {
    for (const float mu : kCosines) {
      const Vec3f wo{std::sqrt(1 - mu * mu), 0, mu};
      const Bsdf<DiffuseModel::burley> bsdf({{0.5F, 0.5F, 0.5F}, 0.5F, roughness}, wo);
      std::vector<double> observed(kRows * kColumns + 1);
      std::uint64_t state = hash64(static_cast<std::uint64_t>(1000 * roughness + 10 * mu));
      const auto random = [&state] {
        state += 0x9e3779b97f4a7c15ULL;
        return static_cast<float>(hash64(state) >> 40U) * 0x1p-24F;
      };
      for (std::uint32_t i = 0; i < kSamples; ++i) {
        const Vec2f u{random(), random()};
        const BsdfSample chosen = bsdf.sample(u, random());
        if (!chosen.valid) {
          observed.back() += 1;
          continue;
        }
        const double turns = std::atan2(chosen.direction.y, chosen.direction.x) / (2 * kPi);
        const auto row = std::min(static_cast<int>(chosen.direction.z * kRows), kRows - 1);
        const auto column = std::min(static_cast<int>((turns - std::floor(turns)) * kColumns), kColumns - 1);
        observed[static_cast<std::size_t>(row * kColumns + column)] += 1;
      }
      std::vector<double> expected(observed.size());
      double sum = 0;
      for (int cell = 0; cell < kRows * kColumns; ++cell) {
        double density = 0;
        for (int k = 0; k < 64; ++k) {
          const double z = (cell / kColumns + (static_cast<double>(k / 8) + 0.5) / 8) / kRows;
          const double turns = (cell % kColumns + (k % 8 + 0.5) / 8) / kColumns;
          const double r = std::sqrt(1 - z * z);
          density += static_cast<double>(
              bsdf.evaluate(to_float({r * std::cos(2 * kPi * turns), r * std::sin(2 * kPi * turns), z})).pdf);
        }
        const double probability = density / 64 * 2 * kPi / (kRows * kColumns);
        expected[static_cast<std::size_t>(cell)] = probability * kSamples;
        sum += probability;
      }
      expected.back() = std::max(1 - sum, 0.0) * kSamples;
      EXPECT_GT(test::chi2_test(observed, expected).p_value, test::sidak(kRoughness.size() * kCosines.size()))
          << roughness << ' ' << mu;
    }
  }
}

}  // namespace
}  // namespace gazetrace::bsdf_chi2_test
