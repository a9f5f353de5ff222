// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/denoiser_levels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <set>
#include <utility>

#include "core/parallel.hpp"

namespace gazetrace {
namespace {

// What the network sees beside a level's own blocks, so that it knows where edges and textures go on.
constexpr int kMarginBlocks = 16;
static_assert(kMarginBlocks > kFadeBlocks, "the coarser level must cover what fades");

struct Rect {
  int x = 0, y = 0, x_end = 0, y_end = 0;  // [x, x_end) x [y, y_end)
};

int block_at(const SamplingMap& map, int x, int y) {
  return map.regions[map.region(x, y)].block_px;
}

std::set<int, std::greater<>> block_sizes(const SamplingMap& map) {
  std::set<int, std::greater<>> sizes;
  for (const MapRegion& region : map.regions) {
    if (region.pixels > 0) {
      sizes.insert(region.block_px);
    }
  }
  return sizes;
}

// In blocks, with the margin, inside the frame. Where still finer blocks lie beside coarser ones, it fades in between.
Rect blocks_of_level(const SamplingMap& map, int block_px) {
  Rect px{map.width_px, map.height_px, 0, 0};
  for (int y = 0; y < map.height_px; ++y) {
    for (int x = 0; x < map.width_px; ++x) {
      if (block_at(map, x, y) <= block_px) {
        px = {std::min(px.x, x), std::min(px.y, y), std::max(px.x_end, x + 1), std::max(px.y_end, y + 1)};
      }
    }
  }
  const int width = (map.width_px + block_px - 1) / block_px;
  const int height = (map.height_px + block_px - 1) / block_px;
  return {std::max(0, px.x / block_px - kMarginBlocks), std::max(0, px.y / block_px - kMarginBlocks),
          std::min(width, (px.x_end - 1) / block_px + 1 + kMarginBlocks),
          std::min(height, (px.y_end - 1) / block_px + 1 + kMarginBlocks)};
}

DenoiserLevel level_of(const DenoiserInput& frame, const SamplingMap& map, int block_px, int threads) {
  const Rect at = blocks_of_level(map, block_px);
  DenoiserLevel level{block_px, at.x, at.y, {}};
  DenoiserInput& input = level.input;
  input.radiance = ImageRgb(at.x_end - at.x, at.y_end - at.y);
  input.albedo = input.radiance;
  input.normal = input.radiance;
  input.samples = ImageGray(at.x_end - at.x, at.y_end - at.y);
  input.clean = frame.clean;
  if (!frame.halves[0].empty()) {
    input.halves = {input.radiance, input.radiance};
  }
  parallel_for(static_cast<std::size_t>(at.y_end - at.y), threads, [&](std::size_t row) {
    const int block_y = at.y + static_cast<int>(row);
    for (int block_x = at.x; block_x < at.x_end; ++block_x) {
      Vec3d radiance;
      Vec3d albedo;
      Vec3d normal;
      std::array<Vec3d, 2> halves;
      double samples = 0;
      int pixels = 0;
      for (int y = block_y * block_px; y < std::min((block_y + 1) * block_px, map.height_px); ++y) {
        for (int x = block_x * block_px; x < std::min((block_x + 1) * block_px, map.width_px); ++x) {
          radiance += to_double(frame.radiance(x, y));
          albedo += to_double(frame.albedo(x, y));
          normal += to_double(frame.normal(x, y));
          for (std::size_t half = 0; half < 2 && !frame.halves[half].empty(); ++half) {
            halves[half] += to_double(frame.halves[half](x, y));
          }
          samples += static_cast<double>(frame.samples(x, y));
          ++pixels;
        }
      }
      const std::size_t i = input.radiance.index(block_x - at.x, static_cast<int>(row));
      const double share = 1.0 / pixels;
      input.radiance.pixels[i] = to_float(share * radiance);
      input.albedo.pixels[i] = to_float(share * albedo);
      input.normal.pixels[i] = to_float(share * normal);
      for (std::size_t half = 0; half < 2 && !frame.halves[half].empty(); ++half) {
        input.halves[half].pixels[i] = to_float(share * halves[half]);
      }
      input.samples.pixels[i] = static_cast<float>(samples);
    }
  });
  return level;
}

// Linear between the centres of a level's blocks; beyond the outermost ones constant.
class LevelPicture {
 public:
  LevelPicture(const DenoiserLevel& level, const ImageRgb& picture) : level_(level), picture_(picture) {}

  [[nodiscard]] Vec3f at(int x, int y) const {
    const auto [x0, x1, u] = between(x, level_.x_blocks, picture_.width_px);
    const auto [y0, y1, v] = between(y, level_.y_blocks, picture_.height_px);
    return (1 - v) * ((1 - u) * picture_(x0, y0) + u * picture_(x1, y0)) +
           v * ((1 - u) * picture_(x0, y1) + u * picture_(x1, y1));
  }

 private:
  struct Between {
    int low, high;
    float share;  // of `high`
  };
  [[nodiscard]] Between between(int px, int origin_blocks, int count) const {
    const float place = (static_cast<float>(px) + 0.5F) / static_cast<float>(level_.block_px) - 0.5F -
                        static_cast<float>(origin_blocks);
    const float inside = std::clamp(place, 0.0F, static_cast<float>(count - 1));
    const int low = std::min(static_cast<int>(inside), std::max(0, count - 2));
    return {low, std::min(low + 1, count - 1), inside - static_cast<float>(low)};
  }

  const DenoiserLevel& level_;
  const ImageRgb& picture_;
};

// The mean over the square of 2 * radius + 1 values around each, of those that there are, along rows and then columns.
ImageGray box_mean(const ImageGray& of, int radius, int threads) {
  ImageGray rows(of.width_px, of.height_px);
  const auto mean_along = [radius](int count, const auto& read, const auto& write) {
    double sum = 0;
    for (int i = 0; i < std::min(radius, count); ++i) {
      sum += static_cast<double>(read(i));
    }
    for (int i = 0; i < count; ++i) {
      sum += i + radius < count ? static_cast<double>(read(i + radius)) : 0;
      sum -= i - radius - 1 >= 0 ? static_cast<double>(read(i - radius - 1)) : 0;
      write(i, static_cast<float>(sum / (std::min(i + radius, count - 1) - std::max(i - radius, 0) + 1)));
    }
  };
  parallel_for(static_cast<std::size_t>(of.height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    mean_along(
        of.width_px, [&](int x) { return of(x, y); }, [&](int x, float mean) { rows(x, y) = mean; });
  });
  ImageGray means(of.width_px, of.height_px);
  parallel_for(static_cast<std::size_t>(of.width_px), threads, [&](std::size_t column) {
    const int x = static_cast<int>(column);
    mean_along(
        of.height_px, [&](int y) { return rows(x, y); }, [&](int y, float mean) { means(x, y) = mean; });
  });
  return means;
}

// How much of a level shows at each pixel: nothing beyond its border, all of it far enough behind.
ImageGray shown_of_level(const SamplingMap& map, int block_px, int fade_px, int threads) {
  ImageGray inside(map.width_px, map.height_px);
  for (int y = 0; y < map.height_px; ++y) {
    for (int x = 0; x < map.width_px; ++x) {
      inside(x, y) = block_at(map, x, y) <= block_px ? 1.0F : 0.0F;
    }
  }
  ImageGray shown = box_mean(inside, fade_px, threads);
  for (std::size_t i = 0; i < shown.pixels.size(); ++i) {
    shown.pixels[i] = inside.pixels[i] > 0 ? std::clamp(2 * shown.pixels[i] - 1, 0.0F, 1.0F) : 0.0F;
  }
  return shown;
}

}  // namespace

std::vector<DenoiserLevel> denoiser_levels(const DenoiserInput& frame, const SamplingMap& map, int threads) {
  std::vector<DenoiserLevel> levels;
  for (const int block_px : block_sizes(map)) {
    levels.push_back(level_of(frame, map, block_px, threads));
  }
  return levels;
}

ImageRgb blend_levels(const std::vector<DenoiserLevel>& levels, const std::vector<ImageRgb>& pictures,
                      const SamplingMap& map, int threads) {
  ImageRgb frame(map.width_px, map.height_px);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const LevelPicture picture(levels[i], pictures[i]);
    const ImageGray shown =
        i == 0 ? ImageGray(map.width_px, map.height_px, 1)
               : shown_of_level(map, levels[i].block_px, kFadeBlocks * levels[i - 1].block_px, threads);
    parallel_for(static_cast<std::size_t>(map.height_px), threads, [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < map.width_px; ++x) {
        const float share = shown(x, y);
        if (share > 0) {
          frame(x, y) = share < 1 ? (1 - share) * frame(x, y) + share * picture.at(x, y) : picture.at(x, y);
        }
      }
    });
  }
  return frame;
}

}  // namespace gazetrace
