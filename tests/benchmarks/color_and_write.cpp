// SPDX-License-Identifier: Apache-2.0
// CPU milliseconds per megapixel of everything between the last ray and the finished files, by stage and by choice.
//   gazetrace_color_and_write [PICTURE.hdr|.exr] [WIDTH HEIGHT]
// The frame is the picture (or a made one) stretched to the size, times noise of a standard deviation of 15 %, about
// what 16 samples a pixel leave. Times are of the whole process, so threads share the work but do not shrink the
// figure.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <random>

#include "core/image_io.hpp"
#include "gazetrace/color.hpp"
#include "gazetrace/output.hpp"

using namespace gazetrace;

namespace {

std::int64_t process_cpu_ns() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

// Gradients, stripes and a few highlights in all hues.
ImageRgb made_picture() {
  ImageRgb picture(1024, 512);
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      const float u = static_cast<float>(x) / 1024;
      const float v = static_cast<float>(y) / 512;
      const float stripes = 0.6F + 0.4F * std::sin(60 * u + 25 * std::sin(9 * v));
      const float glow = 8 * std::exp(-90 * ((u - 0.7F) * (u - 0.7F) + (v - 0.3F) * (v - 0.3F)));
      const Vec3f hue{0.5F + 0.4F * std::sin(6 * u), 0.5F + 0.3F * std::sin(6 * v + 2),
                      0.4F + 0.3F * std::sin(4 * u + v)};
      picture(x, y) = hue * (stripes * 0.35F) + Vec3f{1, 0.8F, 0.5F} * glow;
    }
  }
  return picture;
}

ImageRgb noisy_frame(const ImageRgb& picture, int width, int height) {
  std::mt19937 generator(1);
  std::normal_distribution<float> normal;
  ImageRgb frame(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec3f& pixel = picture(x * picture.width_px / width, y * picture.height_px / height);
      frame(x, y) = pixel * std::max(0.0F, 1 + 0.15F * normal(generator));
    }
  }
  return frame;
}

// The least of three runs.
double cpu_ms(const std::function<void()>& work) {
  double best = 1e30;
  for (int run = 0; run < 3; ++run) {
    const std::int64_t begin = process_cpu_ns();
    work();
    best = std::min(best, static_cast<double>(process_cpu_ns() - begin) * 1e-6);
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  const int width = argc > 3 ? std::atoi(argv[2]) : 1920;
  const int height = argc > 3 ? std::atoi(argv[3]) : 1080;
  Frame frame;
  frame.radiance = noisy_frame(argc > 1 ? read_picture(argv[1]).rgb : made_picture(), width, height);
  const double megapixels = 1e-6 * width * height;
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  const FrameHeader header;

  ExposureSettings exposure{ExposureMode::log_average};
  const double ev = choose_exposure_ev(frame.radiance, exposure);
  const auto row = [&](const std::string& stage, double ms, const std::string& path = {}) {
    fmt::print("{:<44} {:8.1f}", stage, ms / megapixels);
    if (!path.empty()) {
      fmt::print(" {:8.2f}", static_cast<double>(std::filesystem::file_size(path)) * 1e-6 / megapixels);
      std::filesystem::remove(path);
    }
    fmt::print("\n");
  };
  fmt::print("{} x {}, exposure {:.2f} EV\n{:<44} {:>8} {:>8}\n", width, height, ev, "", "ms/MP", "MB/MP");

  double sum = cpu_ms([&] { choose_exposure_ev(frame.radiance, exposure); });
  row("exposure, log-average", sum);

  DisplayImage shown;
  for (const char* view : {"ACES SDR", "sRGB", "Reinhard"}) {
    ColorSettings settings;
    settings.view = view;
    const ColorPipeline color(settings);
    const std::int64_t begin = process_cpu_ns();
    color.prepare(width, height, 8);
    const double prepared = static_cast<double>(process_cpu_ns() - begin) * 1e-6;
    const double ms = cpu_ms([&] { shown = color.apply(frame.radiance, ev, 8); });
    row(fmt::format("color, {} (once: {:.0f} ms)", view, prepared), ms);
    sum += view == std::string("ACES SDR") ? ms : 0;
  }
  const ColorPipeline aces{ColorSettings{}};
  row("color, ACES SDR, 16 bits", cpu_ms([&] { shown = aces.apply(frame.radiance, ev, 16); }));
  shown = aces.apply(frame.radiance, ev, 8);

  for (const char* name : {"png", "jpg", "tif", "dpx"}) {
    const std::string path = (folder / (std::string("gazetrace_benchmark.") + name)).string();
    const double ms = cpu_ms([&] { write_display_image(path, shown, header, {}); });
    row(fmt::format("display image, .{}", name), ms, path);
    sum += name == std::string("png") ? ms : 0;
  }
  const std::string path = (folder / "gazetrace_benchmark.exr").string();
  for (const ExrPixels pixels : {ExrPixels::half, ExrPixels::float32}) {
    for (const char* compression : {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "dwaa"}) {
      for (const int level : {1, 4, 6}) {
        const bool has_level = compression[0] == 'z';
        if (level > 1 && !has_level) {
          break;
        }
        ExrSettings settings;
        settings.pixels = pixels;
        settings.compression = compression;
        settings.zip_level = level;
        const double ms = cpu_ms([&] { write_frame_exr(path, frame, nullptr, header, settings); });
        row(fmt::format("EXR, {}, {}{}", pixels == ExrPixels::half ? "half" : "float", compression,
                        has_level ? fmt::format(" level {}", level) : ""),
            ms, path);
        sum += pixels == ExrPixels::half && compression == std::string("piz") ? ms : 0;
      }
    }
  }
  row("sum: exposure + baked ACES + PNG + half piz", sum);
}
