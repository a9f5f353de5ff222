// SPDX-License-Identifier: Apache-2.0
// The exposure of a frame, fixed or computed from its own log-average luminance.
//
//   L_avg = exp( mean over blocks of ln L_block ),  ev = log2( key / L_avg )
//
// Reinhard et al. 2002, "Photographic tone reproduction for digital images", eq. (1) and (2), with two changes. L is
// the mean over a block, not a pixel: by Jensen's inequality the log-average of noisy pixels lies below that of their
// means, so the exposure of a foveated frame would depend on its sample counts. And instead of adding a delta to every
// luminance, which shifts dark scenes, blocks at or below kBlackLuminance carry no information and are left out.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "core/luminance.hpp"
#include "gazetrace/color.hpp"

namespace gazetrace {
namespace {

constexpr int kBlockPx = 16;
constexpr double kBlackLuminance = 1e-6;

// Where block `i` of `count` ends; the last one takes the remainder, so that no block is smaller than kBlockPx.
int block_end(int i, int count, int size) {
  return i + 1 == count ? size : (i + 1) * kBlockPx;
}

std::optional<double> log_average_luminance(const ImageRgb& radiance) {
  const int columns = std::max(1, radiance.width_px / kBlockPx);
  const int rows = std::max(1, radiance.height_px / kBlockPx);
  double log_sum = 0;
  std::size_t lit_blocks = 0;
  for (int row = 0; row < rows; ++row) {
    const int y_end = block_end(row, rows, radiance.height_px);
    for (int column = 0; column < columns; ++column) {
      const int x_end = block_end(column, columns, radiance.width_px);
      double sum = 0;
      std::size_t count = 0;
      for (int y = row * kBlockPx; y < y_end; ++y) {
        const Vec3f* pixel = &radiance.pixels[radiance.index(column * kBlockPx, y)];
        for (int x = column * kBlockPx; x < x_end; ++x, ++pixel) {
          const double shone = luminance(to_double(*pixel));
          if (std::isfinite(shone)) {
            sum += shone;
            ++count;
          }
        }
      }
      const double mean = count == 0 ? 0 : sum / static_cast<double>(count);
      if (mean > kBlackLuminance) {
        log_sum += std::log(mean);
        ++lit_blocks;
      }
    }
  }
  if (lit_blocks == 0) {
    return std::nullopt;
  }
  return std::exp(log_sum / static_cast<double>(lit_blocks));
}

}  // namespace

double choose_exposure_ev(const ImageRgb& radiance, const ExposureSettings& settings) {
  if (settings.mode == ExposureMode::fixed || radiance.empty()) {
    return settings.ev;
  }
  const std::optional<double> luminance = log_average_luminance(radiance);
  return luminance ? settings.ev + std::log2(settings.key / *luminance) : settings.ev;
}

}  // namespace gazetrace
