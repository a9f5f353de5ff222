// SPDX-License-Identifier: Apache-2.0
// Names, identifiers and manifests of Cryptomatte layers.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gazetrace/cryptomatte.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace::cryptomatte_test {
namespace {

// Published values of MurmurHash3_x86_32.
TEST(Cryptomatte, HashesAsMurmurHash3Does) {
  EXPECT_EQ(murmur3_32(""), 0U);
  EXPECT_EQ(murmur3_32("", 1), 0x514e28b7U);
  EXPECT_EQ(murmur3_32("", 0xffffffffU), 0x81f16f39U);
  EXPECT_EQ(murmur3_32("test"), 0xba6bd213U);
  EXPECT_EQ(murmur3_32("test", 0x9747b28cU), 0x704b81dcU);
  EXPECT_EQ(murmur3_32("Hello, world!"), 0xc0363e43U);
  EXPECT_EQ(murmur3_32("Hello, world!", 0x9747b28cU), 0x24884cbaU);
  EXPECT_EQ(murmur3_32("The quick brown fox jumps over the lazy dog"), 0x2e4ff723U);
  EXPECT_EQ(murmur3_32("The quick brown fox jumps over the lazy dog", 0x9747b28cU), 0x2fa826cdU);
}

// From the manifests of the specification's sample pictures.
TEST(Cryptomatte, NamesHaveTheIdentifiersOfTheSamples) {
  EXPECT_EQ(cryptomatte_id("bunny"), 0x13851a76U);
  EXPECT_EQ(cryptomatte_id("default"), 0x42c9679fU);
}

// A name's bits must survive programs that flush denormal numbers and mend what is not a number.
TEST(Cryptomatte, EveryIdentifierIsAnOrdinaryNumber) {
  int mended = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string name = "object " + std::to_string(i);
    const std::uint32_t hash = murmur3_32(name);
    const std::uint32_t id = cryptomatte_id(name);
    EXPECT_TRUE(std::isnormal(std::bit_cast<float>(id))) << name;
    if (!std::isnormal(std::bit_cast<float>(hash))) {
      ++mended;
      EXPECT_EQ(id, hash ^ 0x00800000U) << name;
    } else {
      EXPECT_EQ(id, hash) << name;
    }
  }
  EXPECT_GT(mended, 100);  // 2 of 256 exponents: 156 are expected
}

Scene small_scene() {
  Scene scene;
  scene.materials.resize(3);
  scene.materials[0].name = "glass \"clear\"";
  scene.materials[2].name = "wood";
  scene.instances = {{0, {}, -1, -1, "leg", "table"}, {0, {}, -1, -1, "leg", "chair"}, {0, {}, -1, -1, "lamp", "lamp"}};
  return scene;
}

TEST(Cryptomatte, ATableNamesWhatItsLayerIsAbout) {
  const Scene scene = small_scene();
  const MatteTable objects = matte_table(scene, "crypto_object");
  EXPECT_FALSE(objects.surfaces.by_material);
  EXPECT_THAT(objects.surfaces.ids,
              testing::ElementsAre(cryptomatte_id("leg"), cryptomatte_id("leg"), cryptomatte_id("lamp")));
  const MatteTable assets = matte_table(scene, "crypto_asset");
  EXPECT_THAT(assets.surfaces.ids,
              testing::ElementsAre(cryptomatte_id("table"), cryptomatte_id("chair"), cryptomatte_id("lamp")));
  const MatteTable materials = matte_table(scene, "crypto_material");
  EXPECT_TRUE(materials.surfaces.by_material);
  const auto manifest = nlohmann::json::parse(materials.manifest);
  EXPECT_EQ(manifest.size(), 3U);
  for (const char* name : {"glass \"clear\"", "#1", "wood"}) {
    EXPECT_EQ(manifest.at(name), fmt::format("{:08x}", cryptomatte_id(name)));
  }
  EXPECT_THROW(matte_table(scene, "crypto_light"), Error);
}

TEST(Cryptomatte, TheHeaderHasTheFourAttributes) {
  const auto attributes = cryptomatte_attributes(matte_table(small_scene(), "crypto_object"));
  ASSERT_EQ(attributes.size(), 4U);
  EXPECT_EQ(attributes[0], (std::pair<std::string, std::string>{"cryptomatte/f834d0a/name", "crypto_object"}));
  EXPECT_EQ(attributes[1], (std::pair<std::string, std::string>{"cryptomatte/f834d0a/hash", "MurmurHash3_32"}));
  EXPECT_EQ(attributes[2],
            (std::pair<std::string, std::string>{"cryptomatte/f834d0a/conversion", "uint32_to_float32"}));
  EXPECT_EQ(attributes[3].first, "cryptomatte/f834d0a/manifest");
}

}  // namespace
}  // namespace gazetrace::cryptomatte_test
