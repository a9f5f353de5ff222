// SPDX-License-Identifier: Apache-2.0
// Sums per surface and of first hits as the tracer makes them, and the guided filter on traced frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/luminance.hpp"
#include "render/tracer_scenes.hpp"
#include "support/picture_evidence.hpp"
#include "support/reconstruct.hpp"

namespace gazetrace::surface_sums_test {
namespace {

using namespace test;

constexpr int kWidth = 96;
constexpr int kHeight = 64;

// A floor, a box on it and a lamp in view, under an even sky.
Scene lit_scene() {
  Scene scene;
  scene.materials = {diffuse_material({0.7F, 0.5F, 0.3F}), diffuse_material({0.2F, 0.4F, 0.8F}),
                     diffuse_material({0.5F, 0.5F, 0.5F}, {20, 10, 5})};
  add_mesh(scene, {quad({{{-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}}}, 0)});
  add_mesh(scene, box(0.6F, false, 1), make_affine({0, 0.7, 0}, {0, 0.2, 0, 0.98}, {1, 1, 1}));
  add_mesh(scene, {quad({{{-2, 1, -2}, {-1, 1, -2}, {-1, 2, -2}, {-2, 2, -2}}}, 2)});
  scene.environment = constant_environment({0.4F, 0.5F, 0.6F});
  return scene;
}

const Camera kCamera = camera_at({2, 2, 5}, {-0.5, 0.8, 0});

// Single pixels of 32 samples in the middle, blocks of 2 and 4 around.
SamplingMap foveated_map() {
  FoveationSettings settings;
  std::get<RegionSampling>(settings.sampling).eccentricities_deg = {5, 12};
  return make_sampling_map(settings, view_of_perspective(50 * kRadPerDeg, kWidth, kHeight), Vec3d{0, 0, -1});
}

TraceSettings with_surfaces() {
  TraceSettings settings;
  settings.surfaces = true;
  return settings;
}

TraceSettings with_halves() {
  return Reconstruction({"guided"}).trace_settings({});
}

TEST(SurfaceSums, AskingForThemChangesNoBitOfTheSums) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = foveated_map();
  const SparseFrame plain = tracer.at_rest().trace(kCamera, 0, map, {});
  const SparseFrame sparse = tracer.at_rest().trace(kCamera, 0, map, with_surfaces());
  EXPECT_TRUE(same_samples(plain, sparse, map));
  EXPECT_EQ(plain.sum_square_luminance, sparse.sum_square_luminance);
  EXPECT_EQ(plain.count, sparse.count);
  EXPECT_TRUE(plain.surfaces.empty() && plain.first_surface.empty());
}

// What a site's samples see shining and what its surfaces reflect is all of its light. The first is known where a path
// tracer of no bounces sees the same samples.
TEST(SurfaceSums, ShiningAndReflectedLightAreTheWholeSum) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = foveated_map();
  const SparseFrame sparse = tracer.at_rest().trace(kCamera, 0, map, with_surfaces());
  TraceSettings only_seen;
  only_seen.max_bounces = 0;
  const SparseFrame seen = tracer.at_rest().trace(kCamera, 0, map, only_seen);
  ASSERT_EQ(sparse.first_surface.size(), map.sites.size() + 1);
  ASSERT_EQ(sparse.first_surface.back(), sparse.surfaces.size());
  std::size_t several = 0;
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    Vec3d sum = to_double(seen.sum[i]);
    std::uint32_t count = 0;
    for (std::size_t s = sparse.first_surface[i]; s < sparse.first_surface[i + 1]; ++s) {
      const SurfaceSums& surface = sparse.surfaces[s];
      sum += to_double(surface.reflected);
      count += surface.count;
      EXPECT_GT(surface.count, 0U);
      EXPECT_LE(dot(surface.normal, surface.normal), 1.0001F * static_cast<float>(surface.count * surface.count));
    }
    several += sparse.first_surface[i + 1] - sparse.first_surface[i] > 1 ? 1 : 0;
    EXPECT_LE(count, sparse.count[i]);
    const double tolerance = 1e-5 * static_cast<double>(sparse.sum[i].x) + 1e-6;
    EXPECT_NEAR(sum.x, static_cast<double>(sparse.sum[i].x), tolerance) << i;
    EXPECT_NEAR(sum.z, static_cast<double>(sparse.sum[i].z), tolerance) << i;
  }
  EXPECT_GT(several, 20U);  // edges of box, lamp and floor
}

// Over 1000 seeds, the variance of the sites' means, and the mean square of half the difference of their halves.
TEST(SurfaceSums, HalvesTellTheVarianceOfTheMeanOfAllSamples) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = foveated_map();
  TraceSettings settings = with_halves();
  constexpr int kSeeds = 1000;
  struct Site {
    double sum = 0, square = 0, difference = 0, difference_square = 0;
  };
  std::vector<Site> sites(map.sites.size());
  for (int seed = 0; seed < kSeeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const SparseFrame sparse = tracer.at_rest().trace(kCamera, 0, map, settings);
    ASSERT_EQ(sparse.half_difference.size(), map.sites.size());
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const double mean = luminance(to_double(sparse.sum[i])) / sparse.count[i];
      const auto difference = static_cast<double>(sparse.half_difference[i]);
      sites[i].sum += mean;
      sites[i].square += mean * mean;
      sites[i].difference += difference;
      sites[i].difference_square += difference * difference;
    }
  }
  double variance = 0;
  double replica = 0;
  double bias = 0;
  for (const Site& site : sites) {
    variance += (site.square - site.sum * site.sum / kSeeds) / (kSeeds - 1);
    replica += site.difference_square / kSeeds;
    bias += site.difference / kSeeds;
  }
  // A few dozen sites on the lamp's edge have most of the variance: the relative standard error of both sums is then
  // about sqrt(2 / (1000 seeds times 10 sites)), 1.4 %.
  EXPECT_NEAR(replica / variance, 1, 0.05);
  const double of_bias = std::sqrt(replica / kSeeds);
  EXPECT_NEAR(bias, 0, 4 * of_bias);
}

// Halves that nobody reads cost nothing: all samples are those of a single sequence.
TEST(SurfaceSums, HalvesThatNeedNotBeIndependentAreThoseOfOneSequence) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = foveated_map();
  TraceSettings settings = with_halves();
  const auto sums = [&](const TraceSettings& one) { return tracer.at_rest().trace(kCamera, 0, map, one).sum; };
  EXPECT_NE(sums(settings), sums({}));
  settings.independent_halves = false;
  EXPECT_EQ(sums(settings), sums({}));
}

TEST(SurfaceSums, SameBitsForAnyThreadCount) {
  const Scene scene = lit_scene();
  const SamplingMap map = foveated_map();
  PathTracer one(scene, threads(1));
  PathTracer two(scene, threads(2));
  const GuideSettings settings{.edge_rays = 3};
  const Guides guides_one = one.at_rest().guides(kCamera, kWidth, kHeight, settings);
  const Guides guides_two = two.at_rest().guides(kCamera, kWidth, kHeight, settings);
  EXPECT_GT(guides_one.edge_rays.size(), 300U);
  const Frame a = reconstruct(one.at_rest().trace(kCamera, 0, map, with_halves()), map, "guided", 1, &guides_one);
  const Frame b = reconstruct(two.at_rest().trace(kCamera, 0, map, with_halves()), map, "guided", 2, &guides_two);
  EXPECT_TRUE(same_picture(a.radiance, b.radiance));
  EXPECT_EQ(a.variance, b.variance);
}

// Against many samples: the fovea's pixels and the others are nearer to the truth than the linear filter's, and the
// mean of the frame is within a per cent of the truth's.
TEST(GuidedFilter, IsNearerToManySamplesThanLinear) {
  const Scene scene = lit_scene();
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = foveated_map();
  TraceSettings other;
  other.seed = 99;
  const SamplingMap full = uniform_map(kWidth, kHeight, 512);
  const Frame truth = reconstruct(tracer.at_rest().trace(kCamera, 0, full, other), full, "none");
  const SparseFrame sparse = tracer.at_rest().trace(kCamera, 0, map, with_halves());
  const Guides guides = tracer.at_rest().guides(kCamera, kWidth, kHeight, {.edge_rays = 4});
  const Frame linear = reconstruct(sparse, map, "linear");
  const Frame guided = reconstruct(sparse, map, "guided", 0, &guides);
  std::array<double, 2> linear_error{};  // of blocks, and of the fovea's pixels
  std::array<double, 2> guided_error{};
  double truth_sum = 0;
  double guided_sum = 0;
  for (std::size_t i = 0; i < truth.radiance.pixels.size(); ++i) {
    const std::size_t where = map.regions[map.region.pixels[i]].block_px == 1 ? 1 : 0;
    const Vec3d t = to_double(truth.radiance.pixels[i]);
    const Vec3d l = to_double(linear.radiance.pixels[i]) - t;
    const Vec3d g = to_double(guided.radiance.pixels[i]) - t;
    linear_error[where] += dot(l, l) / (0.01 + dot(t, t));
    guided_error[where] += dot(g, g) / (0.01 + dot(t, t));
    truth_sum += t.y;
    guided_sum += static_cast<double>(guided.radiance.pixels[i].y);
  }
  EXPECT_LT(guided_error[0], 0.25 * linear_error[0]);
  EXPECT_LT(guided_error[1], linear_error[1]);
  EXPECT_NEAR(guided_sum / truth_sum, 1, 0.01);
}

// Everything to the right of x = `edge_m`, `distance` ahead of a camera at the origin, shines white before a black sky.
Scene shining_edge(double distance, const Material& material, double edge_m = 0) {
  Scene scene;
  scene.materials = {material};
  const auto z = static_cast<float>(-distance);
  const auto x = static_cast<float>(edge_m);
  add_mesh(scene, {quad({{{x, -50, z}, {50, -50, z}, {50, 50, z}, {x, 50, z}}}, 0)});
  return scene;
}

Material unlit_white() {
  Material material = diffuse_material({1, 1, 1});
  material.unlit = true;
  return material;
}

const Camera kAhead = camera_at({0, 0, 0}, {0, 0, -1}, 20);
double pixels_per_tangent() {
  return kHeight / (2 * std::tan(10 * kRadPerDeg));
}

// Mean squares of the shifts of the samples that hit the right half of a picture, far from its edges.
double mean_square_shift(const PosedScene& scene, const Camera& camera) {
  const SamplingMap map = uniform_map(kWidth, kHeight, 64);
  const SparseFrame sparse = scene.trace(camera, 0, map, with_halves());
  EXPECT_EQ(sparse.first_hits.size(), map.sites.size());
  double sum = 0;
  int sites = 0;
  for (std::size_t i = 0; i < sparse.first_hits.size(); ++i) {
    if (map.sites[i].block_x > kWidth * 3 / 4) {
      sum += static_cast<double>(sparse.first_hits[i].square_shift_px2) / sparse.count[i];
      ++sites;
    }
  }
  return sum / sites;
}

TEST(FirstHits, AreSummedWhereSurfacesAre) {
  const Scene scene = shining_edge(4, unlit_white());
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(8, 8, 2);
  EXPECT_TRUE(tracer.at_rest().trace(kAhead, 0, map, {}).first_hits.empty());
  const SparseFrame sparse = tracer.at_rest().trace(kAhead, 0, map, with_halves());
  ASSERT_EQ(sparse.first_hits.size(), map.sites.size());
  for (std::size_t i = 0; i < map.sites.size(); ++i) {
    EXPECT_EQ(sparse.first_hits[i].shone, sparse.sum[i]) << "nothing is lit here, all light is seen directly";
    EXPECT_EQ(sparse.first_hits[i].square_shift_px2, 0.0F) << "a pinhole at rest";
  }
}

// A point at distance d blurs into a disc of radius R |1/d - 1/f| in tangents, whose mean square radius is half its
// square. In focus nothing is shifted. The sky is at no distance: 1/d = 0.
TEST(FirstHits, ALensShiftsThemOverTheCircleOfConfusion) {
  constexpr double kLens = 0.1, kFocus = 4;
  Camera lens = kAhead;
  lens.lens = {kLens, kFocus};
  for (const double distance : {2.0, 4.0, 12.0, 1e30}) {
    const Scene scene = distance < 1e3 ? shining_edge(distance, unlit_white()) : Scene();
    PathTracer tracer(scene, threads(2));
    const double radius_px = kLens * std::fabs(1 / distance - 1 / kFocus) * pixels_per_tangent();
    EXPECT_NEAR(mean_square_shift(tracer.at_rest(), lens), radius_px * radius_px / 2,
                0.02 * radius_px * radius_px + 1e-4)
        << distance;
  }
}

// What moves evenly by a length L while the shutter is open is off its middle by L^2 / 12 in the mean square, whether
// the camera moves or the surface does.
TEST(FirstHits, AnOpenShutterShiftsThemByTheMotion) {
  constexpr double kDistance = 4, kSlide = 0.3;
  const double length_px = kSlide / kDistance * pixels_per_tangent();
  Camera sliding = kAhead;
  for (const double x : {-kSlide / 2, kSlide / 2}) {
    sliding.shutter_poses.push_back(look_at({x, 0, 0}, {x, 0, -1}, {0, 1, 0}));
  }
  Scene scene = shining_edge(kDistance, unlit_white());
  PathTracer still(scene, threads(2));
  EXPECT_NEAR(mean_square_shift(still.at_rest(), sliding), length_px * length_px / 12, 0.01 * length_px * length_px);

  scene.motions.push_back({[](std::int64_t t) {
    return make_affine({kSlide * 1e-9 * static_cast<double>(t), 0, 0}, {}, {1, 1, 1});
  }});
  scene.instances[0].motion = 0;
  PathTracer moving(scene, threads(2));
  EXPECT_NEAR(mean_square_shift(moving.at({-500'000'000, 500'000'000}), kAhead), length_px * length_px / 12,
              0.01 * length_px * length_px);
}

// Shares of the samples, by the alpha of the surface in front, within five standard deviations.
TEST(FirstHits, BlendedSurfacesAreCountedAsOftenAsTheyAreSeen) {
  Material half = unlit_white();
  half.alpha_mode = AlphaMode::blend;
  half.base_color.w = 0.3F;
  const Scene scene = shining_edge(4, half);
  PathTracer tracer(scene, threads(2));
  const SamplingMap map = uniform_map(kWidth, kHeight, 4);
  const SparseFrame sparse = tracer.at_rest().trace(kAhead, 0, map, with_halves());
  double seen = 0;
  double samples = 0;
  for (std::size_t i = 0; i < sparse.first_hits.size(); ++i) {
    seen += sparse.first_hits[i].blended;
    samples += map.sites[i].block_x >= kWidth / 2 ? sparse.count[i] : 0;
    EXPECT_EQ(static_cast<float>(sparse.first_hits[i].blended), sparse.first_hits[i].shone.y);
  }
  EXPECT_NEAR(seen / samples, 0.3, 5 * std::sqrt(0.3 * 0.7 / samples));
}

// The root mean square of what is wrong with the columns from `first` on, and the same with a pixel's own samples.
struct ColumnErrors {
  double guided = 0, none = 0, pinhole = 0;
};
template <class Truth>
ColumnErrors errors_of_columns(const Scene& scene, const Camera& camera, const SamplingMap& map, int first, int end,
                               const Truth& truth) {
  PathTracer tracer(scene, threads(2));
  const SparseFrame sparse = tracer.at_rest().trace(camera, 0, map, with_halves());
  const Guides guides = tracer.at_rest().guides(camera, kWidth, kHeight, {.edge_rays = 4});
  const Frame guided = reconstruct(sparse, map, "guided", 0, &guides);
  const Frame none = reconstruct(sparse, map, "none");
  ColumnErrors sum;
  const auto square = [](double a) { return a * a; };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = first; x < end; ++x) {
      const double t = truth(x);
      sum.guided += square(static_cast<double>(guided.radiance(x, y).y) - t);
      sum.none += square(static_cast<double>(none.radiance(x, y).y) - t);
      sum.pinhole += square(static_cast<double>(guides.emission(x, y).y) - t);
    }
  }
  const double pixels = kHeight * (end - first);
  return {std::sqrt(sum.guided / pixels), std::sqrt(sum.none / pixels), std::sqrt(sum.pinhole / pixels)};
}

// An edge between white and black crosses a column of pixels, under a sky half of which is hidden, so that light is
// noisy. How much of a pixel is white is known as well as by that many random samples: its standard error is
// sqrt(c (1 - c) / n) of the white. Five rays know it worse, and so does the samples' own mean, which is noisy.
TEST(GuidedFilter, SamplesSayHowMuchOfAPixelIsCovered) {
  constexpr double kBlack = 0.3;  // of the pixel
  constexpr int kColumn = kWidth / 2;
  constexpr std::uint32_t kSpp = 64;
  const double edge_m = kBlack / pixels_per_tangent() * 4;
  Scene scene = shining_edge(4, diffuse_material({0.8F, 0.8F, 0.8F}), edge_m);
  scene.environment = constant_environment({1, 1, 1});
  scene.materials.push_back(diffuse_material({0, 0, 0}));
  const auto x = static_cast<float>(edge_m);
  add_mesh(scene, {quad({{{-50, -50, -4}, {x, -50, -4}, {x, 50, -4}, {-50, 50, -4}}}, 1)});
  add_mesh(scene, {quad({{{-50, 0, 1}, {-50, 50, 1}, {50, 50, 1}, {50, 0, 1}}}, 1)});  // behind the camera
  PathTracer tracer(scene, threads(2));
  TraceSettings other = with_halves();
  other.seed = 99;
  const SamplingMap full = uniform_map(kWidth, kHeight, 512);
  const Frame many = reconstruct(tracer.at_rest().trace(kAhead, 0, full, other), full, "none");
  const SamplingMap map = uniform_map(kWidth, kHeight, kSpp);
  const SparseFrame sparse = tracer.at_rest().trace(kAhead, 0, map, with_halves());
  const Guides guides = tracer.at_rest().guides(kAhead, kWidth, kHeight, {.edge_rays = 4});
  const Frame guided = reconstruct(sparse, map, "guided", 0, &guides);
  const Frame none = reconstruct(sparse, map, "none");
  double of_guided = 0;
  double of_none = 0;
  for (int y = 0; y < kHeight; ++y) {
    double white = 0;
    for (int k = 1; k <= 8; ++k) {
      white += static_cast<double>(many.radiance(kColumn + k, y).y) / 8;
    }
    const auto square = [&](const Frame& frame) {
      const double off = static_cast<double>(frame.radiance(kColumn, y).y) / white - (1 - kBlack);
      return off * off / kHeight;
    };
    of_guided += square(guided);
    of_none += square(none);
  }
  const double of_random = kBlack * (1 - kBlack) / kSpp;
  EXPECT_LT(of_guided, of_random);
  EXPECT_LT(of_guided, of_none);
}

// An edge out of focus becomes the share of a disc that lies on one side of a line u radii off its centre:
// 1/2 + (u sqrt(1 - u^2) + asin u) / pi.
TEST(GuidedFilter, AnEdgeOutOfFocusIsAsWideAsItsDisc) {
  constexpr double kLens = 0.1, kFocus = 4, kDistance = 2;
  Camera lens = kAhead;
  lens.lens = {kLens, kFocus};
  const double radius_px = kLens * (1 / kDistance - 1 / kFocus) * pixels_per_tangent();
  ASSERT_GT(radius_px, 4);
  const auto covered = [&](int x) {
    const double u = std::clamp((x + 0.5 - 0.5 * kWidth) / radius_px, -1.0, 1.0);
    return 0.5 + (u * std::sqrt(1 - u * u) + std::asin(u)) / kPi;
  };
  const Scene scene = shining_edge(kDistance, unlit_white());
  for (const std::uint32_t spp : {4U, 32U}) {
    const ColumnErrors errors =
        errors_of_columns(scene, lens, uniform_map(kWidth, kHeight, spp), kWidth / 2 - 6, kWidth / 2 + 6, covered);
    EXPECT_GT(errors.pinhole, 0.15);
    EXPECT_LT(errors.guided, 0.7 * errors.none) << spp;
  }
}

// In focus, an edge through the middle of blocks of 4 pixels stays where it is and as sharp as it is.
TEST(GuidedFilter, AnEdgeInFocusStaysSharpThroughALens) {
  constexpr int kEdge = 86;
  constexpr double kFocus = 4;
  const SamplingMap map = foveated_map();
  ASSERT_EQ(map.regions[map.region(kEdge, kHeight / 2)].block_px, 4);
  Camera lens = kAhead;
  lens.lens = {0.1, kFocus};
  Scene scene = shining_edge(kFocus, unlit_white(), (kEdge - kWidth / 2) / pixels_per_tangent() * kFocus);
  // The sky would be out of focus.
  scene.materials.push_back(diffuse_material({0, 0, 0}));
  const float edge = scene.meshes[0].geometries[0].positions[0].x;
  add_mesh(scene, {quad({{{-50, -50, -4}, {edge, -50, -4}, {edge, 50, -4}, {-50, 50, -4}}}, 1)});
  const ColumnErrors errors =
      errors_of_columns(scene, lens, map, 0, kWidth, [](int x) { return x < kEdge ? 0.0 : 1.0; });
  EXPECT_GT(errors.none, 0.05);
  EXPECT_LT(errors.guided, 1e-3);
}

// Each ray sees a half-transparent surface or what is behind it. Their mean is a grey, and no pattern of dots.
TEST(GuidedFilter, HalfTransparentSurfacesAreNotStippled) {
  Material half = unlit_white();
  half.alpha_mode = AlphaMode::blend;
  half.base_color.w = 0.5F;
  const Scene scene = shining_edge(4, half);
  const ColumnErrors errors = errors_of_columns(scene, kAhead, uniform_map(kWidth, kHeight, 4), kWidth / 2 + 4,
                                                kWidth - 4, [](int) { return 0.5; });
  EXPECT_NEAR(errors.none, 0.25, 0.03);  // of four samples
  EXPECT_NEAR(errors.pinhole, 0.5, 0.01);
  EXPECT_LT(errors.guided, 0.5 * errors.none);
}

}  // namespace
}  // namespace gazetrace::surface_sums_test
