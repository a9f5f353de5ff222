// SPDX-License-Identifier: Apache-2.0
// Tables of directions field from paths: densities, their samples, and when a table is worth its time.
#include "trace/guiding/guiding_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace gazetrace::guiding_field_test {
namespace {

constexpr double kSphere = 4 * kPi;

Vec3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  for (;;) {
    const Vec3f v{normal(random), normal(random), normal(random)};
    const float length = std::sqrt(dot(v, v));
    if (length > 1e-3F) {
      return v * (1.0F / length);
    }
  }
}

// Pearson's statistic in standard deviations of its distribution, which for a hundred bins is about normal.
double chi_square_z(const std::vector<double>& seen, const std::vector<double>& expected) {
  double sum = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    sum += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
  }
  const auto freedom = static_cast<double>(seen.size() - 1);
  return (sum - freedom) / std::sqrt(2 * freedom);
}

// Directions above a floor by the cosine, `light` of each, from places in a square of one metre.
template <class Light>
std::vector<TrainingRecord> records_of_floor(std::uint32_t count, const Light& light, const Vec3f& corner = {}) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::vector<TrainingRecord> records;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float radius = std::sqrt(uniform(random));
    const float angle = uniform(random) * static_cast<float>(2 * kPi);
    const Vec3f direction{radius * std::cos(angle), std::sqrt(1 - radius * radius), radius * std::sin(angle)};
    const Vec3f position = corner + Vec3f{uniform(random), 0.0F, uniform(random)};
    const float pdf = direction.y / static_cast<float>(kPi);
    records.push_back({position, {0, 1, 0}, direction, pdf, pdf, light(direction), i});
  }
  return records;
}

float light_of_window(const Vec3f& direction) {
  return direction.x > 0.7F && direction.y > 0.3F ? 10.0F : 0.1F;
}

TEST(DirectionBins, CoverTheSphereInEqualParts) {
  std::mt19937 random(1);
  constexpr std::size_t kSamples = 1 << 20;
  std::vector<double> seen(kDirectionBins);
  for (std::size_t i = 0; i < kSamples; ++i) {
    ++seen.at(bin_of(random_direction(random)).index());
  }
  EXPECT_LT(chi_square_z(seen, std::vector<double>(kDirectionBins, double{kSamples} / kDirectionBins)), 5);
  for (std::size_t band = 0; band < kBands; ++band) {
    for (std::size_t sector = 0; sector < kSectors; ++sector) {
      for (const Vec2f at : {Vec2f{0.01F, 0.01F}, Vec2f{0.99F, 0.01F}, Vec2f{0.5F, 0.5F}, Vec2f{0.99F, 0.99F}}) {
        const DirectionBin bin = bin_of(direction_in({band, sector}, at));
        EXPECT_EQ(bin.band, band);
        EXPECT_EQ(bin.sector, sector);
      }
    }
  }
}

TEST(GuidingField, TablesAreDensitiesAndSamplesFollowThem) {
  const GuidingField field(records_of_floor(20000, light_of_window), 1);
  const std::int32_t cell = field.cell_at({0.5F, 0, 0.5F}, {0, 1, 0});
  ASSERT_GE(cell, 0);
  const DirectionTable& table = field.table(cell);

  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  double integral = 0;
  constexpr int kDirections = 1 << 20;
  for (int i = 0; i < kDirections; ++i) {
    const auto pdf = static_cast<double>(table.pdf(random_direction(random)));
    EXPECT_GT(pdf, 0);
    integral += pdf * kSphere / kDirections;
  }
  EXPECT_NEAR(integral, 1, 0.02);

  // In other parts than the table's own: rotated, so that a mistake in both would show.
  const auto turned = [](const Vec3f& v) {
    return Vec3f{0.36F * v.x + 0.48F * v.y - 0.8F * v.z, -0.8F * v.x + 0.6F * v.y,
                 0.48F * v.x + 0.64F * v.y + 0.6F * v.z};
  };
  std::vector<double> expected(kDirectionBins), seen(kDirectionBins);
  constexpr int kSamples = 200000;
  constexpr int kQuadrature = 8;
  for (std::size_t bin = 0; bin < kDirectionBins; ++bin) {
    for (int y = 0; y < kQuadrature * 16; ++y) {
      for (int x = 0; x < kQuadrature * 16; ++x) {
        const Vec2f at{(static_cast<float>(x) + 0.5F) / (kQuadrature * 16),
                       (static_cast<float>(y) + 0.5F) / (kQuadrature * 16)};
        const Vec3f direction = direction_in({bin / kSectors, bin % kSectors}, at);
        expected.at(bin_of(turned(direction)).index()) += static_cast<double>(table.pdf(direction)) * kSphere *
                                                          kSamples /
                                                          (kDirectionBins * 256.0 * kQuadrature * kQuadrature);
      }
    }
  }
  for (int i = 0; i < kSamples; ++i) {
    const DirectionTable::Sample sample = table.sample({uniform(random), uniform(random)});
    EXPECT_NEAR(static_cast<double>(dot(sample.direction, sample.direction)), 1, 1e-5);
    ++seen.at(bin_of(turned(sample.direction)).index());
  }
  EXPECT_LT(chi_square_z(seen, expected), 5);
}

TEST(GuidingField, NumbersAtTheirEndsGiveDirections) {
  const GuidingField field(records_of_floor(20000, light_of_window), 1);
  const DirectionTable& table = field.table(field.cell_at({0.5F, 0, 0.5F}, {0, 1, 0}));
  for (const float x : {0.0F, 0x1.fffffep-1F}) {
    for (const float y : {0.0F, 0x1.fffffep-1F}) {
      const DirectionTable::Sample sample = table.sample({x, y});
      EXPECT_GT(sample.pdf, 0) << x << " " << y;
      EXPECT_NEAR(static_cast<double>(dot(sample.direction, sample.direction)), 1, 1e-5);
    }
  }
  for (const Vec3f& axis :
       {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, -1, 0}, Vec3f{0, 0, 1}, Vec3f{0, 0, -1}}) {
    EXPECT_GT(table.pdf(axis), 0);
  }
}

// The variance that a share would have had, by numerical integration of light^2 / density over the hemisphere.
TEST(GuidingField, TheShareIsNearTheBestThereIs) {
  const GuidingField field(records_of_floor(50000, light_of_window), 1);
  const std::int32_t cell = field.cell_at({0.5F, 0, 0.5F}, {0, 1, 0});
  const auto moment = [&](double share) {
    std::mt19937 random(3);
    double sum = 0;
    constexpr int kDirections = 200000;
    for (int i = 0; i < kDirections; ++i) {
      Vec3f direction = random_direction(random);
      direction.y = std::fabs(direction.y);
      const double light = static_cast<double>(light_of_window(direction) * direction.y);
      const double density = (1 - share) * static_cast<double>(direction.y) / kPi +
                             share * static_cast<double>(field.table(cell).pdf(direction));
      sum += light * light / density;
    }
    return sum * kSphere / 2 / kDirections;
  };
  EXPECT_TRUE(field.pays());
  EXPECT_TRUE(field.promises());
  double best = std::numeric_limits<double>::infinity();
  for (const double share : {0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9}) {
    best = std::min(best, moment(share));
  }
  EXPECT_LE(moment(static_cast<double>(field.share(cell))), 1.05 * best);
  EXPECT_LT(best, 0.5 * moment(0));
}

// Paths that follow what earlier ones have found bring directions of another density than the BSDF's.
template <class Light>
std::vector<TrainingRecord> records_of_guided_paths(const Light& light) {
  std::vector<TrainingRecord> records = records_of_floor(50000, light);
  std::mt19937 random(9);
  for (TrainingRecord& record : records) {
    if (random() % 8 != 0) {  // evenly over the quarter sphere on one side
      record.direction = random_direction(random);
      record.direction.x = -std::fabs(record.direction.x);
      record.direction.y = std::fabs(record.direction.y);
    }
    record.bsdf_pdf = record.direction.y / static_cast<float>(kPi);
    record.pdf = 0.125F * record.bsdf_pdf + (record.direction.x < 0 ? 0.875F / static_cast<float>(kPi) : 0.0F);
    record.radiance = light(record.direction);
  }
  return records;
}

// A table goes by light times cosine, so that the side with twice the light has two thirds of it.
TEST(GuidingField, GuidedPathsTeachWhatOthersTeach) {
  const auto light = [](const Vec3f& direction) { return direction.x > 0 ? 2.0F : 1.0F; };
  for (const std::vector<TrainingRecord>& records : {records_of_floor(50000, light), records_of_guided_paths(light)}) {
    const GuidingField field(records, 1);
    const std::int32_t floor = field.cell_at({0.5F, 0, 0.5F}, {0, 1, 0});
    double bright_side = 0;
    for (std::size_t bin = 0; bin < kDirectionBins; ++bin) {
      const Vec3f direction = direction_in({bin / kSectors, bin % kSectors}, {0.5F, 0.5F});
      bright_side += direction.x > 0 ? static_cast<double>(field.table(floor).pdf(direction)) : 0.0;
    }
    EXPECT_NEAR(bright_side * kSphere / kDirectionBins, 2.0 / 3, 0.03);
  }
}

// The table is better than what these paths followed, and no better than the BSDF.
TEST(GuidingField, ATableIsJudgedBesideTheBsdf) {
  const GuidingField field(records_of_guided_paths([](const Vec3f&) { return 1.0F; }), 1);
  EXPECT_FALSE(field.pays());
  EXPECT_FALSE(field.promises());
}

TEST(GuidingField, EvenLightIsNotWorthATable) {
  const GuidingField field(records_of_floor(50000, [](const Vec3f&) { return 1.0F; }), 1);
  EXPECT_FALSE(field.pays());
  EXPECT_FALSE(field.promises());
}

// Two rooms with windows on opposite sides, and ceilings above the same floor.
TEST(GuidingField, PlacesAndFacingsHaveTablesOfTheirOwn) {
  std::vector<TrainingRecord> records = records_of_floor(20000, light_of_window);
  const auto mirrored = [](const Vec3f& direction) {
    return light_of_window({-direction.x, direction.y, direction.z});
  };
  for (const TrainingRecord& record : records_of_floor(20000, mirrored, {20, 0, 0})) {
    records.push_back(record);
  }
  const GuidingField field(records, 1);
  const auto pdf = [&](const Vec3f& place, const Vec3f& direction) {
    return field.table(field.cell_at(place, {0, 1, 0})).pdf(direction);
  };
  const Vec3f right{0.8F, 0.6F, 0};
  const Vec3f left{-0.8F, 0.6F, 0};
  EXPECT_GT(pdf({0.5F, 0, 0.5F}, right), 3 * pdf({0.5F, 0, 0.5F}, left));
  EXPECT_GT(pdf({20.5F, 0, 0.5F}, left), 3 * pdf({20.5F, 0, 0.5F}, right));
  EXPECT_LT(field.cell_at({0.5F, 0, 0.5F}, {0, -1, 0}), 0) << "no path left a ceiling";
  // Outside of all that was seen, the nearest place answers.
  EXPECT_EQ(field.cell_at({-100, -100, -100}, {0, 1, 0}), field.cell_at({0, 0, 0}, {0, 1, 0}));
  EXPECT_GE(field.cell_at({std::numeric_limits<float>::quiet_NaN(), 0, 0}, {0, 1, 0}), -1);
  EXPECT_GT(field.bytes(), 0U);
}

TEST(GuidingField, NothingAndBadRecords) {
  EXPECT_FALSE(GuidingField().pays());
  EXPECT_FALSE(GuidingField({}, 1).pays());
  EXPECT_LT(GuidingField({}, 1).cell_at({0, 0, 0}, {0, 1, 0}), 0);
  EXPECT_LT(GuidingField().cell_at({0, 0, 0}, {0, 1, 0}), 0);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const std::vector<TrainingRecord> good = records_of_floor(5000, light_of_window);
  std::vector<TrainingRecord> records = good;
  for (const float bad : {kInfinity, -kInfinity, std::numeric_limits<float>::quiet_NaN(), -1.0F}) {
    TrainingRecord record = good.front();
    record.radiance = bad;
    records.push_back(record);
    record = good.front();
    record.pdf = bad;
    records.push_back(record);
    record = good.front();
    record.bsdf_pdf = bad;
    records.push_back(record);
  }
  records.push_back(good.front());
  records.back().pdf = 0;
  records.push_back(good.front());
  records.back().bsdf_pdf = 0;
  const GuidingField field(records, 1);
  const GuidingField expected(good, 1);
  ASSERT_EQ(field.cell_count(), expected.cell_count());
  for (std::int32_t cell = 0; cell < static_cast<std::int32_t>(field.cell_count()); ++cell) {
    EXPECT_EQ(field.table(cell).sector, expected.table(cell).sector);
    EXPECT_EQ(field.share(cell), expected.share(cell));
  }
  // One bright path in a thousand dark ones draws all to itself nowhere.
  records = records_of_floor(1000, [](const Vec3f&) { return 1.0F; });
  records[17].radiance = 1e30F;
  const GuidingField firefly(records, 1);
  const std::int32_t cell = firefly.cell_at({0.5F, 0, 0.5F}, {0, 1, 0});
  ASSERT_GE(cell, 0);
  EXPECT_GT(firefly.table(cell).pdf({-records[17].direction.x, records[17].direction.y, -records[17].direction.z}),
            0.01F);
}

TEST(GuidingField, ThreadsMakeNoDifference) {
  std::vector<TrainingRecord> records;
  std::mt19937 random(5);
  for (std::uint32_t i = 0; i < 40000; ++i) {
    const Vec3f direction = random_direction(random);
    Vec3f normal = random_direction(random);
    normal = dot(normal, direction) < 0 ? normal * -1.0F : normal;
    records.push_back({random_direction(random), normal, direction, 0.1F, 0.1F, light_of_window(direction), i});
  }
  const GuidingField one(records, 1);
  const GuidingField four(records, 4);
  ASSERT_EQ(one.cell_count(), four.cell_count());
  EXPECT_GT(one.cell_count(), 30U);
  for (std::int32_t cell = 0; cell < static_cast<std::int32_t>(one.cell_count()); ++cell) {
    EXPECT_EQ(one.table(cell).band, four.table(cell).band);
    EXPECT_EQ(one.table(cell).sector, four.table(cell).sector);
    EXPECT_EQ(one.share(cell), four.share(cell));
  }
}

}  // namespace
}  // namespace gazetrace::guiding_field_test
