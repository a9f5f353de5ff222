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
constexpr float kMostLight = 1e18F;
constexpr std::size_t kRowsPerTask = 8;

struct SiteResidual {
  Vec3f radiance;
  float replica = 0;  // of the error of its luminance
  float shown = 0;    // mean luminance of the picture
};

// Several floats per pixel, beside each other: all of a row are smoothed in one loop, which becomes vectors.
template <int kChannels>
struct Channels {
  using Pixel = std::array<float, kChannels>;
  int width_px, height_px;
  std::vector<float> values;

  Channels(int width, int height)
      : width_px(width),
        height_px(height),
        values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * kChannels) {}
  [[nodiscard]] float* row(int y) { return values.data() + offset(0, y); }
  [[nodiscard]] Pixel at(int x, int y) const {
    Pixel pixel;
    std::copy_n(values.data() + offset(x, y), kChannels, pixel.data());
    return pixel;
  }
  void put(int x, int y, const Pixel& pixel) { std::copy_n(pixel.data(), kChannels, values.data() + offset(x, y)); }

 private:
  [[nodiscard]] std::size_t offset(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x)) * kChannels;
  }
};
using Residuals = Channels<4>;  // red, green, blue, and a replica of the error of their luminance
using Powers = Channels<3>;     // as Power

Vec3f radiance_of(const Residuals::Pixel& residual) {
  return {residual[0], residual[1], residual[2]};
}

// Mean squares, relative to the picture's own.
struct Power {
  float residual = 0, noise = 0;
  float spread = 0;  // mean square of `noise`
};
Power power_of(const Powers::Pixel& pixel) {
  return {pixel[0], pixel[1], pixel[2]};
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

// visit(begin, end, reach) for the runs of pixels of one region in row y; `reach` is `step` blocks of it.
template <class Visit>
void for_each_run(const SamplingMap& map, int y, int step, const Visit& visit) {
  const std::uint8_t* regions = &map.region(0, y);
  for (int x = 0; x < map.width_px;) {
    const std::uint8_t region = regions[x];
    int end = x + 1;
    while (end < map.width_px && regions[end] == region) {
      ++end;
    }
    visit(x, end, step * map.regions[region].block_px);
    x = end;
  }
}

// Of `count` floats: a quarter of each of two, and half of the one between.
inline void binomial(const float* before, const float* own, const float* after, std::ptrdiff_t count, float* out) {
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    out[k] = 0.25F * (before[k] + after[k]) + 0.5F * own[k];
  }
}

// Binomial weights 1 2 1 in both directions, `step` blocks apart, with the blocks of the pixel's own region. Beyond the
// frame's edge the last pixel is repeated.
template <int kChannels>
void smooth(const SamplingMap& map, int step, int threads, Channels<kChannels>& image, Channels<kChannels>& scratch) {
  const int width = map.width_px;
  const int height = map.height_px;
  for_each_row(height, threads, [&](int y) {
    const float* in = image.row(y);
    float* out = scratch.row(y);
    const auto pixels = [&](int x, int before, int after, int count) {
      binomial(in + std::ptrdiff_t{before} * kChannels, in + std::ptrdiff_t{x} * kChannels,
               in + std::ptrdiff_t{after} * kChannels, std::ptrdiff_t{count} * kChannels,
               out + std::ptrdiff_t{x} * kChannels);
    };
    for_each_run(map, y, step, [&](int begin, int end, int reach) {
      const int inside = std::clamp(reach, begin, end);
      const int inside_end = std::clamp(width - reach, inside, end);
      for (int x = begin; x < inside; ++x) {
        pixels(x, std::max(x - reach, 0), std::min(x + reach, width - 1), 1);
      }
      pixels(inside, inside - reach, inside + reach, inside_end - inside);
      for (int x = inside_end; x < end; ++x) {
        pixels(x, std::max(x - reach, 0), std::min(x + reach, width - 1), 1);
      }
    });
  });
  for_each_row(height, threads, [&](int y) {
    for_each_run(map, y, step, [&](int begin, int end, int reach) {
      const std::ptrdiff_t at = std::ptrdiff_t{begin} * kChannels;
      binomial(scratch.row(std::max(y - reach, 0)) + at, scratch.row(y) + at,
               scratch.row(std::min(y + reach, height - 1)) + at, std::ptrdiff_t{end - begin} * kChannels,
               image.row(y) + at);
    });
  });
}

// Means over squares of kTile pixels and their eight neighbours, and between their centres.
class TileMeans {
 public:
  TileMeans(const Powers& image, int threads)
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
            const Power p = power_of(image.at(x, y));
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

  // So many pixels are in a mean.
  static constexpr int kTile = 16;
  static constexpr int kPixels = 9 * kTile * kTile;

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
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  int columns_, rows_;
  std::vector<Power> means_;
};

std::vector<SiteResidual> residuals_of_sites(const FilterInput& input, const SurfacePicture& picture) {
  const SamplingMap& map = input.map;
  std::vector<SiteResidual> residuals(map.sites.size());
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
      SiteResidual& residual = residuals[i];
      residual.radiance = input.values.value(i).radiance - share * mean;
      residual.shown = share * luminance(mean);
      if (input.values.count(i) > 1) {
        residual.replica = input.sparse.half_difference[i] - share * replica;
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
Residuals residuals_of_pixels(const FilterInput& input, const SurfacePicture& picture,
                              const std::vector<SiteResidual>& of_site, const Image<std::uint32_t>& site_of_pixel) {
  const SamplingMap& map = input.map;
  Residuals residuals(map.width_px, map.height_px);
  const auto put = [&](int x, int y, float share, const SiteResidual& r) {
    residuals.put(x, y, {share * r.radiance.x, share * r.radiance.y, share * r.radiance.z, share * r.replica});
  };
  for_each_row(map.height_px, input.threads, [&](int y) {
    for (int x = 0; x < map.width_px; ++x) {
      const int block = map.regions[map.region(x, y)].block_px;
      if (block == 1) {
        put(x, y, 1, of_site[site_of_pixel(x, y)]);
        continue;
      }
      const auto size = static_cast<float>(block);
      const float u = (static_cast<float>(x) + 0.5F) / size - 0.5F;
      const float v = (static_cast<float>(y) + 0.5F) / size - 0.5F;
      const float fx = u - std::floor(u);
      const float fy = v - std::floor(v);
      SiteResidual sum;
      const auto add = [&](int dx, int dy, float weight) {
        const int px = (static_cast<int>(std::floor(u)) + dx) * block + block / 2;
        const int py = (static_cast<int>(std::floor(v)) + dy) * block + block / 2;
        const SiteResidual& r =
            of_site[site_of_pixel(std::clamp(px, 0, map.width_px - 1), std::clamp(py, 0, map.height_px - 1))];
        sum.radiance += weight * r.radiance;
        sum.replica += weight * r.replica;
        sum.shown += weight * r.shown;
      };
      add(0, 0, (1.0F - fx) * (1.0F - fy));
      add(1, 0, fx * (1.0F - fy));
      add(0, 1, (1.0F - fx) * fy);
      add(1, 1, fx * fy);
      const float here = luminance(picture.radiance(x, y));
      put(x, y, sum.shown > 0 ? std::min(here / sum.shown, kMostShare) : 1.0F, sum);
    }
  });
  return residuals;
}

// One over the mean square of the picture around each pixel. Squares are taken in relation to it, so that a bright
// neighbour does not decide for all.
ImageGray relative_scale(const FilterInput& input, const SurfacePicture& picture, const Residuals& residuals,
                         Powers& power, Powers& scratch) {
  const SamplingMap& map = input.map;
  for_each_row(map.height_px, input.threads, [&](int y) {
    for (int x = 0; x < map.width_px; ++x) {
      // Without a limit, squares of light near the end of float's range would not be finite.
      const float light = std::min(luminance(picture.radiance(x, y)), kMostLight);
      const float noise = std::clamp(residuals.at(x, y)[3], -kMostLight, kMostLight);
      power.put(x, y, {light * light + noise * noise, 0, 0});
    }
  });
  for (const int step : {1, 2, 4}) {
    smooth(map, step, input.threads, power, scratch);
  }
  ImageGray scale(map.width_px, map.height_px);
  for_each_row(map.height_px, input.threads, [&](int y) {
    for (int x = 0; x < map.width_px; ++x) {
      scale(x, y) = 1.0F / (power.at(x, y)[0] + 1e-30F);
    }
  });
  return scale;
}

// The share of a residual that is no noise: what follows from the signal that is there on average far around and from
// the noise near the pixel (a rare bright sample is noise there), and more where there is more signal near the pixel.
// Both signals must be beyond doubt. `near` was smoothed twice; `wide` is the mean of `independent` squares.
float share_to_keep(const Power& near, const Power& wide, float independent, float doubt) {
  // The sum of the squares of the weights 1 4 6 4 1 / 16 in both directions: one over the number of squares in `near`.
  constexpr float kWeightsSquared = 0.0748F;
  // Less doubt far around: signal that is missed there costs more than noise that is kept.
  constexpr float kWideDoubt = 2;
  const float spread = 2 * std::max(near.spread, wide.spread);
  const float near_signal = near.residual - near.noise - doubt * std::sqrt(kWeightsSquared * spread);
  const float wide_signal = wide.residual - wide.noise - kWideDoubt * std::sqrt(2 * wide.spread / independent);
  const float share =
      std::max(near_signal > 0 ? near_signal / near.residual : 0.0F,
               wide_signal > 0 ? wide_signal / (wide_signal + std::max(0.5F * near.noise, wide.noise)) : 0.0F);
  return share > 0 ? std::min(share, 1.0F) : 0.0F;  // no number where squares were infinite
}

// Of a residual whose replica is far beyond what residuals and noise are far around, one half of the samples knows
// nothing: a rare bright sample. It fades by the square of the excess, and the smoothed light around it keeps what the
// sample brought. `replica`: relative, as squares are in `wide`.
float share_of_confirmed(float replica_squared, const Power& wide, float most_deviations) {
  const float most = most_deviations * most_deviations * std::max(wide.residual, wide.noise);
  return replica_squared > most ? most / replica_squared : 1.0F;
}

}  // namespace

void keep_residuals(const FilterInput& input, const SmoothingSettings& settings,
                    const Image<std::uint32_t>& site_of_pixel, SurfacePicture& picture) {
  const SamplingMap& map = input.map;
  Residuals finer = residuals_of_pixels(input, picture, residuals_of_sites(input, picture), site_of_pixel);
  Residuals coarser(map.width_px, map.height_px);
  Residuals scratch(map.width_px, map.height_px);
  Powers power(map.width_px, map.height_px);
  Powers power_scratch(map.width_px, map.height_px);
  ImageRgb kept(map.width_px, map.height_px);
  const ImageGray scale = relative_scale(input, picture, finer, power, power_scratch);
  for (int band = 0; band < kBands; ++band) {
    const int step = 1 << band;
    const bool last = band + 1 == kBands;
    coarser = finer;
    if (!last) {
      smooth(map, step, input.threads, coarser, scratch);
    }
    const auto detail = [&](int x, int y) {
      Residuals::Pixel d = finer.at(x, y);
      if (!last) {
        const Residuals::Pixel c = coarser.at(x, y);
        for (std::size_t k = 0; k < d.size(); ++k) {
          d[k] -= c[k];
        }
      }
      return d;
    };
    for_each_row(map.height_px, input.threads, [&](int y) {
      for (int x = 0; x < map.width_px; ++x) {
        const Residuals::Pixel d = detail(x, y);
        const float light = luminance(radiance_of(d));
        const float noise = scale(x, y) * d[3] * d[3];
        power.put(x, y, {scale(x, y) * light * light, noise, noise * noise});
      }
    });
    const TileMeans wide(power, input.threads);
    // Residuals of a band are alike over `step` blocks.
    const float independent = static_cast<float>(TileMeans::kPixels) / static_cast<float>(step * step);
    smooth(map, step, input.threads, power, power_scratch);
    smooth(map, step, input.threads, power, power_scratch);
    for_each_row(map.height_px, input.threads, [&](int y) {
      for (int x = 0; x < map.width_px; ++x) {
        const Residuals::Pixel d = detail(x, y);
        const Power p = power_of(power.at(x, y));
        const auto block = static_cast<float>(map.regions[map.region(x, y)].block_px);
        const Power around = wide.at(x, y);
        const float doubt = doubt_of_few(static_cast<float>(input.values.count(site_of_pixel(x, y))), settings);
        const float share = share_of_confirmed(scale(x, y) * d[3] * d[3], around, settings.most_deviations) *
                            share_to_keep(p, around, independent / (block * block), doubt * settings.residual_doubt);
        const std::size_t i = kept.index(x, y);
        kept.pixels[i] += share * radiance_of(d);
        const float rest = 1.0F - share;
        constexpr float kMost = kMostLight * kMostLight;
        const float noise = std::min(kMost, p.noise / scale(x, y));  // kMost also for what is no number
        const float bias = std::min(kMost, std::max(0.0F, p.residual - p.noise) / scale(x, y));
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
