// SPDX-License-Identifier: Apache-2.0
// Pictures and textures of any shape: narrow and wide fields of view, one pixel and sixteen thousand, many samples.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "render/tracer_scenes.hpp"
#include "support/reconstruct.hpp"
#include "trace/kernel/kernel.hpp"
#include "trace/samples/sample_list.hpp"

namespace gazetrace::extreme_frame_test {
namespace {

using namespace test;

TraceSettings emission_only() {
  TraceSettings settings;
  settings.max_bounces = 0;
  return settings;
}

// An emissive rectangle at z = 0 from (x0, y0) to (x1, y1).
Geometry plate(double x0, double y0, double x1, double y1) {
  const auto corner = [](double x, double y) { return to_float(Vec3d{x, y, 0}); };
  return quad({{corner(x0, y0), corner(x1, y0), corner(x1, y1), corner(x0, y1)}}, 0);
}

// A plate over the middle half of each side covers exactly the pixels in the middle.
TEST(ExtremeFrame, FieldsOfViewFromATenthOfADegreeTo179) {
  for (const double yfov_deg : {0.1, 1.0, 90.0, 170.0, 179.0}) {
    const double distance = 100;
    const double half = distance * std::tan(yfov_deg / 2 * kRadPerDeg);
    Scene scene;
    scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
    add_mesh(scene, {plate(-half, -half / 2, half, half / 2)});
    PathTracer tracer(scene, threads(1));
    const SamplingMap map = uniform_map(64, 32, 16);
    const SparseFrame frame =
        tracer.at_rest().trace(camera_at({0, 0, distance}, {0, 0, 0}, yfov_deg), 1, map, emission_only());
    EXPECT_EQ(frame.stats.non_finite_samples + frame.stats.rejected_rays, 0U);
    for (std::size_t i = 0; i < map.sites.size(); ++i) {
      const Site& site = map.sites[i];
      const bool inside = site.block_x >= 16 && site.block_x < 48 && site.block_y >= 8 && site.block_y < 24;
      EXPECT_EQ(frame.sum[i].y, inside ? 16.0F : 0.0F) << yfov_deg << ": " << site.block_x << ' ' << site.block_y;
    }
  }
}

// A white room is white everywhere at any field of view, so no direction of a wide picture is lost.
TEST(ExtremeFrame, AWideViewOfAFurnace) {
  Scene scene;
  scene.materials = {diffuse_material({1, 1, 1})};
  add_mesh(scene, box(0.5F, false, 0), make_affine({0, 0, -0.8}, normalize(Quatd{0.2, 0.1, 0, 1}), {1, 1, 1}));
  scene.environment = constant_environment({1, 1, 1});
  PathTracer tracer(scene, threads(2));
  TraceSettings settings;
  settings.diffuse = DiffuseModel::matte;
  for (const double yfov_deg : {0.1, 179.0}) {
    const SparseFrame frame =
        tracer.at_rest().trace(camera_at({0, 0, 0}, {0, 0, -1}, yfov_deg), 1, uniform_map(48, 32, 64), settings);
    EXPECT_EQ(frame.stats.non_finite_samples + frame.stats.rejected_rays, 0U);
    EXPECT_NEAR(mean_radiance(frame).y, 1, 2e-3) << yfov_deg;
  }
}

TEST(ExtremeFrame, OnePixel) {
  Scene scene;
  scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
  add_mesh(scene, {plate(0, -9, 9, 9)});  // the right half
  PathTracer tracer(scene, threads(1));
  const SamplingMap map = uniform_map(1, 1, 1024);
  const SparseFrame frame = tracer.at_rest().trace(camera_at({0, 0, 5}, {0, 0, 0}), 1, map, emission_only());
  ASSERT_EQ(frame.sum.size(), 1U);
  EXPECT_EQ(frame.sum[0].y, 512.0F);  // a net: exactly half of the samples on either side
  const Frame dense = reconstruct(frame, map, "linear");
  EXPECT_EQ(dense.radiance(0, 0).y, 0.5F);
}

double status_mib(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(field, 0) == 0) {
      return std::stod(line.substr(field.size() + 1)) / 1024;
    }
  }
  return 0;
}

// From map to dense frame. The bound is the size of the arrays: a site (12 bytes) and its sums (20), the region map
// (1), and the frame's five numbers (20), each at least once; twice that leaves room for growing and sorting.
TEST(ExtremeFrame, SixteenThousandPixelsWide) {
  constexpr int kWidth = 16384, kHeight = 256;
  Scene scene;
  scene.materials = {diffuse_material({0, 0, 0}, {1, 1, 1})};
  add_mesh(scene, {plate(-1, -1, 1, 0)});  // the lower half
  Camera camera = camera_at({0, 0, 5}, {0, 0, 0});
  camera.projection.kind = ProjectionKind::orthographic;
  camera.projection.ymag_m = 1.0 / 64;  // 64 times as wide: exactly from -1 to 1
  PathTracer tracer(scene, threads(2));
  std::ofstream("/proc/self/clear_refs") << "5";  // forgets the peak so far
  const double before_mib = status_mib("VmRSS");
  const SamplingMap map = uniform_map(kWidth, kHeight, 1);
  const SparseFrame sparse = tracer.at_rest().trace(camera, 1, map, emission_only());
  const Frame frame = reconstruct(sparse, map, "linear");
  const double peak_mib = status_mib("VmHWM");
  const double megapixels = kWidth * kHeight * 1e-6;
  std::printf("peak memory: %.1f MiB more than before, %.1f MiB a megapixel\n", peak_mib - before_mib,
              (peak_mib - before_mib) / megapixels);
  EXPECT_LT(peak_mib - before_mib, 2 * 53 * megapixels * 1e6 / 1048576);
  // Corners at 1 m are floats to 2^-23 m and a pixel is 2^-13 m wide: a sample within 2^-10 of a pixel from the edge
  // may fall on either side of it, none elsewhere.
  int beside_edge = 0;
  int elsewhere = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool wrong = frame.radiance(x, y).y != (y >= kHeight / 2 ? 1.0F : 0.0F);
      const bool near = y == kHeight / 2 || y == kHeight / 2 - 1;
      beside_edge += wrong && near ? 1 : 0;
      elsewhere += wrong && !near ? 1 : 0;
    }
  }
  EXPECT_EQ(elsewhere, 0);
  EXPECT_LE(beside_edge, 2 * kWidth / 1024);
}

// 65536 samples per pixel, compared with the same samples summed in long double.
TEST(ExtremeFrame, ManySamplesLoseNothingInTheSum) {
  Scene scene;
  scene.materials = {diffuse_material({0.7F, 0.6F, 0.5F}), diffuse_material({0, 0, 0}, {0.1F, 7.0F, 1e-3F})};
  add_mesh(scene, {quad({{{-3, 0, 3}, {3, 0, 3}, {3, 0, -3}, {-3, 0, -3}}}, 0)});
  add_mesh(scene, {quad({{{-1, 3, -1}, {1, 3, -1}, {1, 3, 1}, {-1, 3, 1}}}, 1)});
  scene.environment = constant_environment({0.1F, 0.2F, 0.3F});
  constexpr std::uint32_t kSpp = 65536;
  const Camera camera = camera_at({2, 3, 4}, {0, 0, 0});
  const SamplingMap map = uniform_map(2, 1, kSpp);
  TraceSettings settings;
  settings.max_bounces = 2;
  const TracerOptions options = threads(2);
  const SparseFrame frame = PathTracer(scene, options).at_rest().trace(camera, 1, map, settings);

  const RenderScene render_scene(scene, options);
  const LightSampler lights(scene);
  const CameraRays rays(camera, 1);
  const FrameContext context = make_frame_context(scene, render_scene, lights, rays, settings);
  const NamedKernel& kernel = choose_kernel(render_scene, false);
  const PixelFilterSampler filter(PixelFilter::box);
  const auto work = std::make_unique<Workspace>();
  KernelCounts counts;
  SampleList list(map, 0, static_cast<std::uint32_t>(map.sites.size()), 0, 1);
  std::vector<std::array<long double, 3>> sums(map.sites.size());
  std::vector<float> in_float(map.sites.size());
  while (const int count = list.next(filter, work->samples)) {
    kernel.run(context, *work, count, counts);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      auto& sum = sums[work->samples.site[i]];
      sum[0] += work->radiance.r[i];
      sum[1] += work->radiance.g[i];
      sum[2] += work->radiance.b[i];
      in_float[work->samples.site[i]] += work->radiance.g[i];
    }
  }
  for (std::size_t s = 0; s < sums.size(); ++s) {
    EXPECT_EQ(frame.count[s], kSpp);
    EXPECT_EQ(frame.sum[s].x, static_cast<float>(sums[s][0]));
    EXPECT_EQ(frame.sum[s].y, static_cast<float>(sums[s][1]));
    EXPECT_EQ(frame.sum[s].z, static_cast<float>(sums[s][2]));
    std::printf("site %zu: %.9g; a sum in float would be off by %.2g of it\n", s, static_cast<double>(frame.sum[s].y),
                std::fabs(static_cast<double>(in_float[s]) / static_cast<double>(sums[s][1]) - 1));
  }
}

// Column (or row) i of the texture holds i in its first two channels.
Texture numbered_texture(int width, int height) {
  Texture texture;
  texture.nearest = true;
  texture.wrap_u = texture.wrap_v = TextureWrap::clamp;
  for (int w = width, h = height;; w = std::max(w / 2, 1), h = std::max(h / 2, 1)) {
    Texture::Level level{w, h,
                         std::vector<std::uint8_t>(4 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h))};
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const int i = (width > height ? x * (width / w) : y * (height / h));
        std::uint8_t* texel =
            &level.rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x))];
        texel[0] = static_cast<std::uint8_t>(i / 256);
        texel[1] = static_cast<std::uint8_t>(i % 256);
        texel[2] = 255;
        texel[3] = 255;
      }
    }
    texture.levels.push_back(std::move(level));
    if (w == 1 && h == 1) {
      return texture;
    }
  }
}

TEST(ExtremeFrame, TexturesOfSixteenThousandTexelsAndOfOne) {
  for (const bool wide : {true, false}) {
    Scene scene;
    scene.materials = {diffuse_material({1, 1, 1})};
    scene.materials[0].unlit = true;
    scene.materials[0].base_color_texture.texture = 0;
    scene.textures = {wide ? numbered_texture(16384, 64) : numbered_texture(64, 16384)};
    // Turned so that its long side is along that of the picture.
    Geometry face = plate(-1, -1, 1, 1);
    if (!wide) {
      face.uv0 = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    }
    add_mesh(scene, {face});
    Camera camera = camera_at({0, 0, 5}, {0, 0, 0});
    camera.projection.kind = ProjectionKind::orthographic;
    camera.projection.ymag_m = 1.0 / 16384;
    PathTracer tracer(scene, threads(2));
    const SamplingMap map = uniform_map(16384, 1, 4);
    const SparseFrame frame = tracer.at_rest().trace(camera, 1, map, emission_only());
    int off = 0;
    for (std::size_t i = 0; i < map.sites.size(); ++i) {
      EXPECT_EQ(frame.sum[i].z, 4.0F);
      const double index =
          (256.0 * static_cast<double>(frame.sum[i].x) + static_cast<double>(frame.sum[i].y)) * 255 / 4;
      // Rounding of the coordinates may move a sample on a texel's border to the neighbour.
      ASSERT_NEAR(index, map.sites[i].block_x, 1);
      off += std::fabs(index - map.sites[i].block_x) > 1e-3 ? 1 : 0;
    }
    EXPECT_LT(off, 16384 / 50);
  }
  for (const TextureWrap wrap : {TextureWrap::repeat, TextureWrap::clamp, TextureWrap::mirror}) {
    for (const bool nearest : {false, true}) {
      Scene scene;
      scene.materials = {diffuse_material({1, 1, 1})};
      scene.materials[0].unlit = true;
      scene.materials[0].base_color_texture.texture = 0;
      Texture one;
      one.nearest = nearest;
      one.wrap_u = one.wrap_v = wrap;
      one.levels = {{1, 1, {51, 102, 204, 255}}};
      scene.textures = {one};
      Geometry face = plate(-1, -1, 1, 1);
      face.uv0 = {{-1e6F, 7}, {3.5F, 7}, {3.5F, -1e6F}, {-1e6F, -1e6F}};
      add_mesh(scene, {face});
      PathTracer tracer(scene, threads(1));
      const SparseFrame frame =
          tracer.at_rest().trace(camera_at({0, 0, 5}, {0, 0, 0}, 10), 1, uniform_map(8, 8, 4), emission_only());
      for (const Vec3f& sum : frame.sum) {
        EXPECT_NEAR(sum.x, 4 * 0.2, 1e-6);
        EXPECT_NEAR(sum.y, 4 * 0.4, 1e-6);
        EXPECT_NEAR(sum.z, 4 * 0.8, 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace gazetrace::extreme_frame_test
