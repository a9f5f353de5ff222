// SPDX-License-Identifier: Apache-2.0
// The counts that the source paper's numbers imply, what settings are refused, and the cut into sites by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "foveation/sites.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"

namespace gazetrace::sampling_map_test {
namespace {

PlanarView paper_view() {
  return view_of_display(display_by_name("paper"), {}, 3840, 2160);
}

struct PaperCase {
  const char* name;
  RegionShape shape;
  std::array<double, 2> eccentricities_deg;
  Vec2d gaze_px;
  std::array<std::uint64_t, 3> pixels;
  std::array<double, 3> ratios;  // uniform 32 spp over 32/16/8, 32/8/4, 32/2/1, as printed
};

const PaperCase kPaperCases[] = {
    {"disc, diameter, center",
     RegionShape::disc,
     {2.6, 8.5},
     {1920, 1080},
     {68488, 673600, 7552312},
     {30.64, 48.91, 88.46}},
    {"disc, radius, center",
     RegionShape::disc_by_radius,
     {5.2, 17},
     {1920, 1080},
     {273988, 2694376, 5326036},
     {11.95, 17.14, 25.40}},
    {"disc, diameter, corner", RegionShape::disc, {2.6, 8.5}, {0, 0}, {17122, 168400, 8108878}, {50.31, 91.15, 233.05}},
    {"disc, radius, corner",
     RegionShape::disc_by_radius,
     {5.2, 17},
     {0, 0},
     {68497, 673594, 7552309},
     {30.64, 48.91, 88.45}},
    {"cone, radius, center",
     RegionShape::cone,
     {5.2, 17},
     {1920, 1080},
     {275180, 2830344, 5188876},
     {11.68, 16.84, 25.17}},
    {"cone, radius, corner", RegionShape::cone, {5.2, 17}, {0, 0}, {120721, 973251, 7200428}, {23.37, 34.88, 55.30}},
    {"cone, full angle, corner",
     RegionShape::cone,
     {2.6, 8.5},
     {0, 0},
     {31606, 274269, 7988525},
     {43.49, 74.62, 161.07}},
};

const std::array<std::array<std::uint32_t, 3>, 3> kPaperRates{{{32, 16, 8}, {32, 8, 4}, {32, 2, 1}}};

double nominal_ratio(const SamplingMap& map) {
  double nominal = 0;
  for (const MapRegion& region : map.regions) {
    nominal += region.nominal_samples;
  }
  return 32.0 * map.width_px * map.height_px / nominal;
}

double to_two_digits(double value) {
  return std::round(value * 100) / 100;
}

TEST(SamplingMapPaper, CountsAndRatiosAreExact) {
  const PlanarView view = paper_view();
  for (const PaperCase& c : kPaperCases) {
    SCOPED_TRACE(c.name);
    for (std::size_t i = 0; i < kPaperRates.size(); ++i) {
      FoveationSettings settings;
      std::get<RegionSampling>(settings.sampling).shape = c.shape;
      std::get<RegionSampling>(settings.sampling).eccentricities_deg = c.eccentricities_deg;
      std::get<RegionSampling>(settings.sampling).samples = kPaperRates[i];
      const SamplingMap map = make_sampling_map(settings, view, view.direction(c.gaze_px.x, c.gaze_px.y));
      ASSERT_EQ(map.regions.size(), 3U);
      std::array<std::uint64_t, 3> counted{};
      for (const std::uint8_t region : map.region.pixels) {
        ++counted.at(region);
      }
      EXPECT_EQ(counted, c.pixels);
      for (std::size_t r = 0; r < 3; ++r) {
        EXPECT_EQ(map.regions[r].pixels, c.pixels[r]);
      }
      EXPECT_DOUBLE_EQ(to_two_digits(nominal_ratio(map)), c.ratios[i]);
      // Straddling blocks trace more than the nominal share, but little.
      const auto traced = static_cast<double>(map.samples());
      const double nominal = 32.0 * 3840 * 2160 / nominal_ratio(map);
      EXPECT_GT(traced, nominal);
      EXPECT_LT(traced, 1.005 * nominal);
    }
  }
}

TEST(SamplingMapPaper, SamplesPerPixelReading) {
  const PlanarView view = paper_view();
  const std::array<double, 3> printed{3.62, 7.02, 23.93};
  for (std::size_t i = 0; i < kPaperRates.size(); ++i) {
    FoveationSettings settings;
    std::get<RegionSampling>(settings.sampling).shape = RegionShape::disc;
    std::get<RegionSampling>(settings.sampling).unit = SampleUnit::per_pixel;
    std::get<RegionSampling>(settings.sampling).samples = kPaperRates[i];
    const SamplingMap map = make_sampling_map(settings, view, view.direction(1920, 1080));
    EXPECT_DOUBLE_EQ(to_two_digits(nominal_ratio(map)), printed[i]);
    for (const MapRegion& region : map.regions) {
      EXPECT_EQ(static_cast<double>(region.samples), region.nominal_samples);  // nothing straddles a pixel
    }
  }
}

TEST(SamplingMap, WithoutGazeEveryPixelGetsTheUniformRate) {
  FoveationSettings settings;
  settings.spp = 5;
  const PlanarView view = view_of_perspective(1.0, 130, 70);
  for (const bool by_sampling : {false, true}) {
    settings.sampling = parse_sampling(by_sampling ? "uniform" : "regions");
    const SamplingMap map =
        make_sampling_map(settings, view, by_sampling ? std::optional<Vec3d>({0, 0, -1}) : std::nullopt);
    ASSERT_EQ(map.regions.size(), 1U);
    EXPECT_EQ(map.regions[0].name, "uniform");
    EXPECT_EQ(map.regions[0].block_px, 1);
    EXPECT_EQ(map.sites.size(), 130U * 70U);
    EXPECT_EQ(map.samples(), 5U * 130U * 70U);
    EXPECT_EQ(map.regions[0].nominal_samples, 5.0 * 130 * 70);
  }
}

// 6 x 3 pixels, regions of 1-pixel and 2-pixel blocks: the second block of the first row straddles the border, the
// third is whole, and the second row of blocks is cut by the frame's lower edge.
Layout small_layout(SampleUnit unit) {
  Layout layout;
  layout.regions = {{"fovea", 1, 32, unit}, {"intermediate", 2, 16, unit}};
  layout.region = Image<std::uint8_t>(6, 3, 1);
  for (const auto& [x, y] :
       {PixelIndex{0, 0}, PixelIndex{1, 0}, PixelIndex{2, 0}, PixelIndex{0, 1}, PixelIndex{1, 1}}) {
    layout.region(x, y) = 0;
  }
  return layout;
}

TEST(SamplingMap, StraddlingAndClippedBlocksByHand) {
  const SamplingMap map = map_from_layout(small_layout(SampleUnit::per_block));
  ASSERT_EQ(map.tiles.size(), 1U);
  const auto find = [&](int bx, int by, int region) {
    for (const Site& site : map.sites) {
      if (site.block_x == bx && site.block_y == by && site.region == region) {
        return site;
      }
    }
    return Site{};
  };
  EXPECT_EQ(map.sites.size(), 5U + 5U);
  EXPECT_EQ(find(1, 0, 1).pixels, 3);     // straddles: 4 pixels but one
  EXPECT_EQ(find(1, 0, 1).samples, 16U);  // ... and keeps the block's full tau
  EXPECT_EQ(find(2, 0, 1).pixels, 4);
  EXPECT_EQ(find(0, 1, 1).pixels, 2);  // clipped by the frame
  EXPECT_EQ(find(0, 1, 1).samples, 16U);
  EXPECT_EQ(find(2, 0, 0).samples, 32U);
  EXPECT_EQ(find(0, 0, 1).pixels, 0);  // no pixel of the region, no site
  EXPECT_EQ(map.regions[1].pixels, 13U);
  EXPECT_EQ(map.regions[1].samples, 5U * 16U);
  EXPECT_EQ(map.regions[1].nominal_samples, 13.0 * 16 / 4);

  std::vector<PixelIndex> pixels{{9, 9}};
  pixels_of_site(map, find(1, 0, 1), pixels);
  ASSERT_EQ(pixels.size(), 3U);
  EXPECT_TRUE(pixels[0].x == 3 && pixels[0].y == 0);
  EXPECT_TRUE(pixels[1].x == 2 && pixels[1].y == 1);
  EXPECT_TRUE(pixels[2].x == 3 && pixels[2].y == 1);

  const ImageGray density = samples_per_pixel(map);
  EXPECT_EQ(density(0, 0), 32.0F);
  EXPECT_EQ(density(3, 0), 16.0F / 3.0F);
  EXPECT_EQ(density(4, 0), 4.0F);
  EXPECT_EQ(density(0, 2), 8.0F);
}

TEST(SamplingMap, PerPixelUnitCountsTheSitesPixels) {
  const SamplingMap map = map_from_layout(small_layout(SampleUnit::per_pixel));
  for (const Site& site : map.sites) {
    EXPECT_EQ(site.samples, (site.region == 0 ? 32U : 16U) * site.pixels);
  }
  EXPECT_EQ(map.regions[1].nominal_samples, 13.0 * 16);
}

TEST(SamplingMap, SitesOfATileFollowAZCurve) {
  Layout layout;
  layout.regions = {{"uniform", 1, 1, SampleUnit::per_pixel}};
  layout.region = Image<std::uint8_t>(128, 64, 0);
  const SamplingMap map = map_from_layout(layout);
  ASSERT_EQ(map.tiles.size(), 2U);
  // Any 64 sites in a row that start at a multiple of 64 are one 8x8 square.
  for (std::size_t first = 0; first < map.sites.size(); first += 64) {
    const int x0 = map.sites[first].block_x;
    const int y0 = map.sites[first].block_y;
    EXPECT_EQ(x0 % 8, 0);
    EXPECT_EQ(y0 % 8, 0);
    for (std::size_t i = first; i < first + 64; ++i) {
      EXPECT_EQ(map.sites[i].block_x / 8, x0 / 8);
      EXPECT_EQ(map.sites[i].block_y / 8, y0 / 8);
    }
  }
}

TEST(SamplingMap, GazeBehindTheEye) {
  const PlanarView view = view_of_perspective(1.0, 40, 30);
  FoveationSettings settings;
  for (const Vec3d gaze : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{0, 2, 1e-9}}) {
    std::get<RegionSampling>(settings.sampling).shape = RegionShape::disc;
    std::get<RegionSampling>(settings.sampling).eccentricities_deg = {5, 85};
    EXPECT_EQ(make_sampling_map(settings, view, gaze).regions[2].pixels, 1200U);
    std::get<RegionSampling>(settings.sampling).shape = RegionShape::cone;
    std::get<RegionSampling>(settings.sampling).eccentricities_deg = {5, 100};  // a cone reaches past the side
    const SamplingMap map = make_sampling_map(settings, view, gaze);
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        EXPECT_EQ(map.region(x, y) == 1, eccentricity_deg(view, gaze, x + 0.5, y + 0.5) <= 100.0);
      }
    }
  }
}

TEST(SamplingMap, BordersBelongToTheInnerRegion) {
  // Angles of zero, the gaze on a pixel's centre: that pixel's distance is 0 exactly.
  const PlanarView view = view_of_perspective(1.0, 41, 31);
  FoveationSettings settings;
  for (const RegionShape shape : {RegionShape::cone, RegionShape::disc}) {
    std::get<RegionSampling>(settings.sampling).shape = shape;
    std::get<RegionSampling>(settings.sampling).eccentricities_deg = {0, 0};
    const SamplingMap both = make_sampling_map(settings, view, view.direction(7.5, 20.5));
    EXPECT_EQ(both.region(7, 20), 0);
    EXPECT_EQ(both.regions[0].pixels, 1U);
    EXPECT_EQ(both.regions[1].pixels, 0U);
    EXPECT_EQ(both.regions[2].pixels, 41U * 31U - 1);
  }
  // The whole sphere: 180 degrees are inside.
  std::get<RegionSampling>(settings.sampling).shape = RegionShape::cone;
  std::get<RegionSampling>(settings.sampling).eccentricities_deg = {0, 180};
  EXPECT_EQ(make_sampling_map(settings, view, -view.direction(7.5, 20.5)).regions[1].pixels, 41U * 31U);
}

TEST(SamplingMap, EccentricityImageIsTheAngleAtThePixelCentre) {
  const PlanarView view = paper_view();
  const ImageGray image = eccentricity_image(view, view.direction(0, 0));
  EXPECT_NEAR(image(0, 0), 0.0, 0.02);
  // Corner to opposite corner of a 70.848 x 39.852 cm display seen from 60 cm.
  const double half_diagonal = std::hypot(70.848, 39.852) / 2;
  EXPECT_NEAR(image(3839, 2159), 2 * std::atan(half_diagonal / 60) * kDegPerRad, 0.02);
}

std::string refusal(const FoveationSettings& settings) {
  try {
    check_foveation(settings);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::usage);
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return e.what();
  }
  return "";
}

TEST(CheckFoveation, ADensityHasAValueForEachParameterOrNone) {
  DensitySampling density;
  density.model = "mar";  // slope, foveal, relative-to
  for (const std::vector<double>& values : {std::vector<double>{0.03}, {0.03, 0.02}, {0.03, 0.02, 0, 0}}) {
    density.values = values;
    FoveationSettings settings;
    settings.sampling = density;
    EXPECT_THAT(refusal(settings), testing::HasSubstr("`density`: mar has 3 parameters, and"));
  }
}

TEST(CheckFoveation, NamesTheFieldAndWhatIsAllowed) {
  using testing::HasSubstr;
  EXPECT_EQ(refusal({}), "");
  FoveationSettings s;
  s.spp = 0;
  EXPECT_THAT(refusal(s), testing::AllOf(HasSubstr("`spp`"), HasSubstr("up to 1000000")));
  s = {};
  std::get<RegionSampling>(s.sampling).samples = {32, 0, 8};
  EXPECT_THAT(refusal(s), HasSubstr("`region-samples`"));
  s = {};
  std::get<RegionSampling>(s.sampling).blocks_px = {2, 65};
  EXPECT_THAT(refusal(s), testing::AllOf(HasSubstr("`region-blocks`"), HasSubstr("1 to 64")));
  std::get<RegionSampling>(s.sampling).blocks_px = {0, 4};
  EXPECT_THAT(refusal(s), HasSubstr("`region-blocks`"));
  s = {};
  std::get<RegionSampling>(s.sampling).eccentricities_deg = {17, 5.2};
  EXPECT_THAT(refusal(s), testing::AllOf(HasSubstr("`region-eccentricities`"), HasSubstr("smaller angle first")));
  std::get<RegionSampling>(s.sampling).eccentricities_deg = {-1, 5};
  EXPECT_THAT(refusal(s), HasSubstr("`region-eccentricities`"));
  std::get<RegionSampling>(s.sampling).eccentricities_deg = {5, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THAT(refusal(s), HasSubstr("`region-eccentricities`"));
  std::get<RegionSampling>(s.sampling).eccentricities_deg = {5, 180};
  EXPECT_EQ(refusal(s), "");
  std::get<RegionSampling>(s.sampling).shape = RegionShape::disc_by_radius;  // tan(a/2)
  EXPECT_THAT(refusal(s), HasSubstr("0 to below 180"));
  std::get<RegionSampling>(s.sampling).shape = RegionShape::disc;
  EXPECT_THAT(refusal(s), HasSubstr("0 to below 90"));
}

TEST(SamplingText, IsReadBackAsItWas) {
  for (const SamplingTraits& traits : samplings()) {
    EXPECT_EQ(to_string(parse_sampling(traits.name)), traits.name);
  }
  EXPECT_EQ(to_string(parse_sampling("regions:unit=pixel,shape=disc")), "regions:shape=disc,unit=pixel");
  EXPECT_EQ(to_string(parse_sampling("regions:shape=cone,unit=block")), "regions");
  for (const auto& [text, words] :
       {std::pair("regoins", "did you mean 'regions'"),
        std::pair("uniform:unit=pixel", "no parameters such as 'unit=pixel'"),
        std::pair("regions:unit=inch", "block, pixel"), std::pair("regions:unit", "no value")}) {
    try {
      parse_sampling(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_THAT(std::string(error.what()), testing::HasSubstr(words));
    }
  }
}

// The mean is met whatever the sampling, and where the samples go stays: rates are in the same proportion.
TEST(SamplingMap, RegionsAreScaledToTheMeanThatIsAskedFor) {
  const PlanarView view = view_of_display(display_by_name("paper"), {}, 480, 270);
  const Vec3d gaze = view.direction(200, 100);
  const SamplingMap own = make_sampling_map({}, view, gaze);
  FoveationSettings settings;
  settings.spp = 0.75;
  const SamplingMap scaled = make_sampling_map(settings, view, gaze);
  EXPECT_NEAR(static_cast<double>(scaled.samples()), 0.75 * 480 * 270, 1.01);
  const double scale = 0.75 * 480 * 270 / static_cast<double>(own.samples());
  ASSERT_EQ(scaled.sites.size(), own.sites.size());
  for (std::size_t i = 0; i < own.sites.size(); ++i) {
    ASSERT_NEAR(scaled.expected(i), scale * own.sites[i].samples, 1e-5);
  }
}

TEST(SamplingMap, RefusesWhatIsNoGazeOrNoFrame) {
  const PlanarView view = view_of_perspective(1.0, 8, 8);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Vec3d gaze : {Vec3d{0, 0, 0}, Vec3d{kNan, 0, -1}, Vec3d{0, INFINITY, -1}}) {
    EXPECT_THROW(make_sampling_map({}, view, gaze), Error);
  }
  PlanarView empty = view;
  empty.width_px = 0;
  EXPECT_THROW(make_sampling_map({}, empty, std::nullopt), Error);
}

}  // namespace
}  // namespace gazetrace::sampling_map_test
