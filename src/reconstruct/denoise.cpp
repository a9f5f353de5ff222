// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/denoise.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "core/parallel.hpp"
#include "reconstruct/open_image_denoise.hpp"

namespace gazetrace {
namespace {

// Over how many pixels (standard deviation) the halves are asked, of fine and of coarse residuals.
constexpr int kFineAround = 6;
constexpr int kCoarseAround = 2 * kCoarsePx;
// Errors count relative to the light, which counts as at least this share of the picture's mean.
constexpr double kLeastLight = 0.01;
// A half goes through the network where one of so many has kSamplesOfBlend: a small fovea of many samples has a wide
// margin of few.
constexpr std::size_t kLeastPart = 32;
// Nothing is given back to pixels with half of kSamplesOfBlend, everything from kSamplesOfBlend on.
float share_of_samples(float samples) {
  return std::clamp(2 * samples / kSamplesOfBlend - 1, 0.0F, 1.0F);
}

// Three boxes, one after the other, are a Gaussian of about this standard deviation. Rows of the result are columns of
// the picture.
ImageRgb blurred_across(const ImageRgb& picture, int sigma, int threads) {
  const int width = picture.width_px;
  ImageRgb out(picture.height_px, width);
  parallel_for(static_cast<std::size_t>(picture.height_px), threads, [&](std::size_t y) {
    std::vector<Vec3d> row(static_cast<std::size_t>(width));
    std::vector<Vec3d> from(row.size());
    for (std::size_t x = 0; x < row.size(); ++x) {
      row[x] = to_double(picture.pixels[y * row.size() + x]);
    }
    const auto at = [&](int x) -> const Vec3d& { return from[static_cast<std::size_t>(std::clamp(x, 0, width - 1))]; };
    const double share = 1.0 / (2 * sigma + 1);
    for (int box = 0; box < 3; ++box) {
      std::swap(row, from);
      Vec3d sum;
      for (int x = -sigma; x <= sigma; ++x) {
        sum += at(x);
      }
      for (int x = 0; x < width; ++x) {
        row[static_cast<std::size_t>(x)] = share * sum;
        sum += at(x + sigma + 1) - at(x - sigma);
      }
    }
    for (std::size_t x = 0; x < row.size(); ++x) {
      out.pixels[x * static_cast<std::size_t>(picture.height_px) + y] = to_float(row[x]);
    }
  });
  return out;
}

ImageRgb blurred(const ImageRgb& picture, int sigma, int threads) {
  return blurred_across(blurred_across(picture, sigma, threads), sigma, threads);
}

template <class Value>
ImageRgb picture_of(const ImageRgb& like, int threads, const Value& value) {
  ImageRgb out(like.width_px, like.height_px);
  parallel_for(static_cast<std::size_t>(like.height_px), threads, [&](std::size_t y) {
    const std::size_t begin = y * static_cast<std::size_t>(like.width_px);
    for (std::size_t i = begin; i < begin + static_cast<std::size_t>(like.width_px); ++i) {
      out.pixels[i] = value(i);
    }
  });
  return out;
}

ImageRgb difference(const ImageRgb& a, const ImageRgb& b, int threads) {
  return picture_of(a, threads, [&](std::size_t i) { return a.pixels[i] - b.pixels[i]; });
}

// What samples have beyond the network's picture: the half that it was shown, the other half, and the frame.
struct Residuals {
  ImageRgb shown, other, all;
};

// The part of `residuals` that is coarser; they keep the finer part.
Residuals take_coarse(Residuals& residuals, int threads) {
  const auto split = [&](ImageRgb& picture) {
    ImageRgb coarse = blurred(picture, kCoarsePx, threads);
    picture = difference(picture, coarse, threads);
    return coarse;
  };
  return {split(residuals.shown), split(residuals.other), split(residuals.all)};
}

// Adds to `picture` the share of the residuals that both halves have around a pixel: their product over the mean of
// their squares. A single bright pixel of either half so lessens it.
void give_back(const Residuals& residuals, int around, const ImageRgb& scale, const ImageGray& samples, int threads,
               ImageRgb& picture) {
  const ImageRgb moments = blurred(picture_of(picture, threads,
                                              [&](std::size_t i) {
                                                const Vec3f shown = scale.pixels[i] * residuals.shown.pixels[i];
                                                const Vec3f other = scale.pixels[i] * residuals.other.pixels[i];
                                                const float squares = dot(shown, shown) + dot(other, other);
                                                return Vec3f{dot(shown, other), 0.5F * squares, 0};
                                              }),
                                   around, threads);
  picture = picture_of(picture, threads, [&](std::size_t i) {
    const Vec3f moment = moments.pixels[i];
    const float share = moment.y > 0 ? std::clamp(moment.x / moment.y, 0.0F, 1.0F) : 0.0F;
    return picture.pixels[i] + (share * share_of_samples(samples.pixels[i])) * residuals.all.pixels[i];
  });
}

ImageRgb blend(const DenoiserInput& input, const ImageRgb& denoised, int threads) {
  const DenoiserInput half{.radiance = input.halves[0],
                           .albedo = input.albedo,
                           .normal = input.normal,
                           .samples = {},
                           .halves = {},
                           .clean = input.clean};
  const ImageRgb network = open_image_denoise(half, threads, DenoiserNetwork::balanced);
  Residuals residuals{difference(without_outliers(input.halves[0]), network, threads),
                      difference(without_outliers(input.halves[1]), network, threads),
                      difference(without_outliers(input.radiance), denoised, threads)};
  const Vec3d sum = std::accumulate(denoised.pixels.begin(), denoised.pixels.end(), Vec3d{},
                                    [](const Vec3d& all, const Vec3f& one) { return all + to_double(one); });
  const double mean = (sum.x + sum.y + sum.z) / (3 * static_cast<double>(denoised.pixels.size()));
  const auto least = static_cast<float>(kLeastLight * mean);
  const ImageRgb scale = picture_of(denoised, threads, [&](std::size_t i) {
    const Vec3f light = denoised.pixels[i];
    return Vec3f{1 / (light.x + least), 1 / (light.y + least), 1 / (light.z + least)};
  });
  const Residuals coarse = take_coarse(residuals, threads);
  ImageRgb result = denoised;
  give_back(residuals, kFineAround, scale, input.samples, threads, result);
  give_back(coarse, kCoarseAround, scale, input.samples, threads, result);
  return picture_of(result, threads, [&](std::size_t i) {
    const Vec3f light = result.pixels[i];
    return Vec3f{std::max(light.x, 0.0F), std::max(light.y, 0.0F), std::max(light.z, 0.0F)};
  });
}

}  // namespace

DenoiserWork denoiser_work(const SamplingMap& map) {
  // Where frames join, sites have the samples of all, and tiles the frame's own.
  const auto is_in_a_part = [&](float samples) {
    std::size_t many = 0;
    for (const MapTile& tile : map.tiles) {
      const bool has_many = static_cast<float>(tile.samples) >= samples * static_cast<float>(tile.site_count);
      many += has_many ? tile.site_count : 0;
    }
    return kLeastPart * many >= map.sites.size();
  };
  if (is_in_a_part(kSamplesOfBlend)) {
    return DenoiserWork::with_halves;
  }
  return is_in_a_part(kSamplesOfUsual) ? DenoiserWork::usual : DenoiserWork::fast;
}

ImageRgb denoise(const DenoiserInput& input, DenoiserWork work, int threads) {
  if (work != DenoiserWork::with_halves) {
    return open_image_denoise(input, threads,
                              work == DenoiserWork::fast ? DenoiserNetwork::fast : DenoiserNetwork::usual);
  }
  ImageRgb denoised = open_image_denoise(input, threads, DenoiserNetwork::high);
  const std::vector<float>& samples = input.samples.pixels;
  const auto many = std::count_if(samples.begin(), samples.end(), [](float one) { return one >= kSamplesOfBlend; });
  const bool blends = !input.halves[0].empty() && kLeastPart * static_cast<std::size_t>(many) >= samples.size();
  return blends ? blend(input, denoised, threads) : denoised;
}

}  // namespace gazetrace
