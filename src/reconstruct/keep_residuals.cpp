// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/keep_residuals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/hash.hpp"
#include "core/luminance.hpp"
#include "core/parallel.hpp"
#include "foveation/sites.hpp"

namespace gazetrace {
namespace {

constexpr int kBands = 3;
constexpr float kMostShare = 4;  // of a block's residual, in a pixel that is much brighter than the rest of it
constexpr std::size_t kRowsPerTask = 8;

// Of a site, or of a pixel between sites.
struct Residual {
  Vec3f radiance;
  float replica = 0;  // of the error of its luminance
  float shown = 0;    // mean luminance of the picture
};

// Mean squares, relative to the picture's own.
struct Power {
  float residual = 0, noise = 0;
  float spread = 0;  // mean square of `noise`
};

Residual operator+(const Residual& a, const Residual& b) {
  return {a.radiance + b.radiance, a.replica + b.replica, a.shown + b.shown};
}
Residual operator*(float w, const Residual& a) {
  return {w * a.radiance, w * a.replica, w * a.shown};
}
Power operator+(const Power& a, const Power& b) {
  return {a.residual + b.residual, a.noise + b.noise, a.spread + b.spread};
}
Power operator*(float w, const Power& a) {
  return {w * a.residual, w * a.noise, w * a.spread};
}

template <class Visit>
void for_each_row(int height_px, int threads, const Visit& visit) {
  const auto rows = static_cast<std::size_t>(height_px);
  parallel_for((rows + kRowsPerTask - 1) / kRowsPerTask, threads, [&](std::size_t task) {
    for (std::size_t y = task * kRowsPerTask; y < std::min(rows, (task + 1) * kRowsPerTask); ++y) {
      visit(static_cast<int>(y));
    }
  });
}

// Binomial weights 1 2 1 in both directions, `step` blocks apart, with the blocks of the pixel's own region. Beyond the
// frame's edge the last pixel is repeated.
template <class T>
void smooth(const SamplingMap& map, int step, int threads, Image<T>& image, Image<T>& scratch) {
  const int width = map.width_px;
  const int height = map.height_px;
  const auto reach = [&](int x, int y) { return step * map.regions[map.region(x, y)].block_px; };
  for_each_row(height, threads, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const int r = reach(x, y);
      scratch(x, y) =
          0.25F * (image(std::max(x - r, 0), y) + image(std::min(x + r, width - 1), y)) + 0.5F * image(x, y);
    }
  });
  for_each_row(height, threads, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const int r = reach(x, y);
      image(x, y) =
          0.25F * (scratch(x, std::max(y - r, 0)) + scratch(x, std::min(y + r, height - 1))) + 0.5F * scratch(x, y);
    }
  });
}

// Means over squares of kTile pixels and their eight neighbours, and between their centres.
class TileMeans {
 public:
  TileMeans(const Image<Power>& image, int threads)
      : columns_((image.width_px + kTile - 1) / kTile), rows_((image.height_px + kTile - 1) / kTile) {
    std::vector<Power> sums(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    parallel_for(static_cast<std::size_t>(rows_), threads, [&](std::size_t row) {
      const int y0 = static_cast<int>(row) * kTile;
      const int y1 = std::min(y0 + kTile, image.height_px);
      for (int column = 0; column < columns_; ++column) {
        const int x0 = column * kTile;
        const int x1 = std::min(x0 + kTile, image.width_px);
        std::array<double, 3> sum{};
        for (int y = y0; y < y1; ++y) {
          for (int x = x0; x < x1; ++x) {
            const Power& p = image(x, y);
            sum[0] += static_cast<double>(p.residual);
            sum[1] += static_cast<double>(p.noise);
            sum[2] += static_cast<double>(p.spread);
          }
        }
        const double pixels = static_cast<double>((x1 - x0) * (y1 - y0));
        sums[index(column, static_cast<int>(row))] = {static_cast<float>(sum[0] / pixels),
                                                      static_cast<float>(sum[1] / pixels),
                                                      static_cast<float>(sum[2] / pixels)};
      }
    });
    means_.resize(sums.size());
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x) {
        Power& mean = means_[index(x, y)];
        for (int v = y - 1; v <= y + 1; ++v) {
          for (int u = x - 1; u <= x + 1; ++u) {
            mean = mean + (1.0F / 9) * sums[index(std::clamp(u, 0, columns_ - 1), std::clamp(v, 0, rows_ - 1))];
          }
        }
      }
    }
  }

  [[nodiscard]] Power at(int x, int y) const {
    const float u = (static_cast<float>(x) + 0.5F) / kTile - 0.5F;
    const float v = (static_cast<float>(y) + 0.5F) / kTile - 0.5F;
    const int column = static_cast<int>(std::floor(u));
    const int row = static_cast<int>(std::floor(v));
    const float fx = u - static_cast<float>(column);
    const float fy = v - static_cast<float>(row);
    const auto mean = [&](int dx, int dy) -> const Power& {
      return means_[index(std::clamp(column + dx, 0, columns_ - 1), std::clamp(row + dy, 0, rows_ - 1))];
    };
    return (1 - fy) * ((1 - fx) * mean(0, 0) + fx * mean(1, 0)) + fy * ((1 - fx) * mean(0, 1) + fx * mean(1, 1));
  }

 private:
  static constexpr int kTile = 16;
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  int columns_, rows_;
  std::vector<Power> means_;
};

std::vector<Residual> residuals_of_sites(const FilterInput& input, const SurfacePicture& picture) {
  const SamplingMap& map = input.map;
  std::vector<Residual> residuals(map.sites.size());
  parallel_for(map.tiles.size(), input.threads, [&](std::size_t t) {
    const MapTile& tile = map.tiles[t];
    for (std::size_t i = tile.first_site; i < tile.first_site + tile.site_count; ++i) {
      if (input.values.count(i) == 0 || !input.pass_through.needs_filtering(i)) {
        continue;
      }
      Vec3f mean;
      float replica = 0;
      for_each_pixel(map, map.sites[i], [&](int x, int y) {
        const std::size_t p = picture.radiance.index(x, y);
        mean += picture.radiance.pixels[p];
        replica += picture.replica.pixels[p];
      });
      const float share = 1.0F / static_cast<float>(map.sites[i].pixels);
      Residual& residual = residuals[i];
      residual.radiance = input.values.value(i).radiance - share * mean;
      residual.shown = share * luminance(mean);
      const float difference = input.sparse.half_difference[i];
      if (difference != 0) {
        residual.replica = difference - share * replica;
      } else {
        // Of a single sample nobody knows what of its residual is noise. All of it with a sign of its own: around a
        // pixel such noise cancels out as the noise of the samples does.
        const float sign = (hash32(static_cast<std::uint32_t>(i) ^ 0x5bd1e995U) & 1U) != 0 ? 1.0F : -1.0F;
        residual.replica = sign * luminance(residual.radiance);
      }
    }
  });
  return residuals;
}

// Interpolates between the centres of blocks. The pixels of a block share its residual in proportion to what they show:
// what is wrong with light is wrong by a factor.
Image<Residual> residuals_of_pixels(const FilterInput& input, const SurfacePicture& picture,
                                    const std::vector<Residual>& of_site, const Image<std::uint32_t>& site_of_pixel) {
  const SamplingMap& map = input.map;
  Image<Residual> residuals(map.width_px, map.height_px);
  for_each_row(map.height_px, input.threads, [&](int y) {
    for (int x = 0; x < map.width_px; ++x) {
      const int block = map.regions[map.region(x, y)].block_px;
      if (block == 1) {
        residuals(x, y) = of_site[site_of_pixel(x, y)];
        continue;
      }
      const auto size = static_cast<float>(block);
      const float u = (static_cast<float>(x) + 0.5F) / size - 0.5F;
      const float v = (static_cast<float>(y) + 0.5F) / size - 0.5F;
      const float fx = u - std::floor(u);
      const float fy = v - std::floor(v);
      const auto site = [&](int dx, int dy) -> const Residual& {
        const int px = (static_cast<int>(std::floor(u)) + dx) * block + block / 2;
        const int py = (static_cast<int>(std::floor(v)) + dy) * block + block / 2;
        return of_site[site_of_pixel(std::clamp(px, 0, map.width_px - 1), std::clamp(py, 0, map.height_px - 1))];
      };
      residuals(x, y) = ((1.0F - fx) * (1.0F - fy)) * site(0, 0) + (fx * (1.0F - fy)) * site(1, 0) +
                        ((1.0F - fx) * fy) * site(0, 1) + (fx * fy) * site(1, 1);
      const float shown = residuals(x, y).shown;
      const float here = luminance(picture.radiance(x, y));
      residuals(x, y) = (shown > 0 ? std::min(here / shown, kMostShare) : 1.0F) * residuals(x, y);
    }
  });
  return residuals;
}

// One over the mean square of the picture around each pixel. Squares are taken in relation to it, so that a bright
// neighbour does not decide for all.
ImageGray relative_scale(const FilterInput& input, const SurfacePicture& picture, const Image<Residual>& residuals,
                         Image<Power>& power, Image<Power>& scratch) {
  const SamplingMap& map = input.map;
  for_each_row(map.height_px, input.threads, [&](int y) {
    for (int x = 0; x < map.width_px; ++x) {
      const float light = luminance(picture.radiance(x, y));
      const float noise = residuals(x, y).replica;
      power(x, y) = {light * light + noise * noise, 0, 0};
    }
  });
  for (const int step : {1, 2, 4}) {
    smooth(map, step, input.threads, power, scratch);
  }
  ImageGray scale(map.width_px, map.height_px);
  for_each_row(map.height_px, input.threads, [&](int y) {
    for (int x = 0; x < map.width_px; ++x) {
      scale(x, y) = 1.0F / (power(x, y).residual + 1e-30F);
    }
  });
  return scale;
}

// The share of a residual that is no noise: what follows from the signal that is there on average far around and from
// the noise near the pixel (a rare bright sample is noise there), and more where the signal near the pixel is beyond
// doubt. `near` was smoothed twice.
float share_to_keep(const Power& near, const Power& wide, float doubt) {
  // The sum of the squares of the weights 1 4 6 4 1 / 16 in both directions: that many squares are independent.
  constexpr float kWeightsSquared = 0.0748F;
  const float deviation = std::sqrt(2 * kWeightsSquared * std::max(near.spread, wide.spread));
  const float near_signal = near.residual - near.noise - doubt * deviation;
  const float wide_signal = wide.residual - wide.noise;
  return std::max(near_signal > 0 ? near_signal / near.residual : 0.0F,
                  wide_signal > 0 ? wide_signal / (wide_signal + std::max(0.5F * near.noise, wide.noise)) : 0.0F);
}

}  // namespace

void keep_residuals(const FilterInput& input, const SmoothingSettings& settings,
                    const Image<std::uint32_t>& site_of_pixel, SurfacePicture& picture) {
  const SamplingMap& map = input.map;
  Image<Residual> finer = residuals_of_pixels(input, picture, residuals_of_sites(input, picture), site_of_pixel);
  Image<Residual> coarser(map.width_px, map.height_px);
  Image<Residual> scratch(map.width_px, map.height_px);
  Image<Power> power(map.width_px, map.height_px);
  Image<Power> power_scratch(map.width_px, map.height_px);
  ImageRgb kept(map.width_px, map.height_px);
  const ImageGray scale = relative_scale(input, picture, finer, power, power_scratch);
  for (int band = 0; band < kBands; ++band) {
    const int step = 1 << band;
    const bool last = band + 1 == kBands;
    coarser = finer;
    if (!last) {
      smooth(map, step, input.threads, coarser, scratch);
    }
    const auto detail = [&](int x, int y) { return last ? finer(x, y) : finer(x, y) + -1.0F * coarser(x, y); };
    for_each_row(map.height_px, input.threads, [&](int y) {
      for (int x = 0; x < map.width_px; ++x) {
        const Residual d = detail(x, y);
        const float light = luminance(d.radiance);
        const float noise = scale(x, y) * d.replica * d.replica;
        power(x, y) = Power{scale(x, y) * light * light, noise, noise * noise};
      }
    });
    const TileMeans wide(power, input.threads);
    smooth(map, step, input.threads, power, power_scratch);
    smooth(map, step, input.threads, power, power_scratch);
    for_each_row(map.height_px, input.threads, [&](int y) {
      for (int x = 0; x < map.width_px; ++x) {
        const Residual d = detail(x, y);
        const Power p = power(x, y);
        const float share = share_to_keep(p, wide.at(x, y), settings.residual_doubt);
        const std::size_t i = kept.index(x, y);
        kept.pixels[i] += share * d.radiance;
        const float rest = 1.0F - share;
        const float noise = p.noise / scale(x, y);
        const float bias = std::max(p.residual - p.noise, 0.0F) / scale(x, y);
        if (band == 0) {
          picture.variance.pixels[i] *= rest * rest;
          picture.error.pixels[i] *= rest * rest;
        }
        picture.variance.pixels[i] += share * share * noise;
        picture.error.pixels[i] += share * share * noise + rest * rest * bias;
      }
    });
    std::swap(finer, coarser);
  }
  for_each_row(map.height_px, input.threads, [&](int y) {
    for (int x = 0; x < map.width_px; ++x) {
      const std::size_t i = kept.index(x, y);
      if (input.pass_through.needs_filtering(site_of_pixel(x, y))) {
        const Vec3f value = picture.radiance.pixels[i] + kept.pixels[i];
        picture.radiance.pixels[i] = {std::max(value.x, 0.0F), std::max(value.y, 0.0F), std::max(value.z, 0.0F)};
      }
    }
  });
}

}  // namespace gazetrace
