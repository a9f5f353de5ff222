// SPDX-License-Identifier: Apache-2.0
// FLIP, computed in tiles that stay in the second-level cache: every tile reads its pixels and a rim as wide as the
// kernels, and does all steps up to the final value. Section numbers are those of Andersson et al. 2020.
//
// The opponent space YyCxCz is linear in x = X/Xn, y = Y/Yn, z = Z/Zn, so the filters are applied to y, x - y and y -
// z; the scales 116, 500 and 200 would cancel.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/fast_math.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/metrics.hpp"
#include "metrics/flip_kernels.hpp"
#include "metrics/tone_curve.hpp"

namespace gazetrace {
namespace {

constexpr int kTileWidth = 128;
constexpr int kTileHeight = 64;
constexpr int kLanes = 16;

// Linear Rec.709 to XYZ relative to D65 white, and back.
constexpr double kWhiteX = 0.950428545;
constexpr double kWhiteZ = 1.088900371;
constexpr float kXr = static_cast<float>(10135552.0 / 24577794.0 / kWhiteX);
constexpr float kXg = static_cast<float>(8788810.0 / 24577794.0 / kWhiteX);
constexpr float kXb = static_cast<float>(4435075.0 / 24577794.0 / kWhiteX);
constexpr float kYr = static_cast<float>(2613072.0 / 12288897.0);
constexpr float kYg = static_cast<float>(8788810.0 / 12288897.0);
constexpr float kYb = static_cast<float>(887015.0 / 12288897.0);
constexpr float kZr = static_cast<float>(1425312.0 / 73733382.0 / kWhiteZ);
constexpr float kZg = static_cast<float>(8788810.0 / 73733382.0 / kWhiteZ);
constexpr float kZb = static_cast<float>(70074185.0 / 73733382.0 / kWhiteZ);
constexpr float kRx = static_cast<float>(3.241003275 * kWhiteX);
constexpr float kRy = -1.537398934F;
constexpr float kRz = static_cast<float>(-0.498615861 * kWhiteZ);
constexpr float kGx = static_cast<float>(-0.969224334 * kWhiteX);
constexpr float kGy = 1.875930071F;
constexpr float kGz = static_cast<float>(0.041554224 * kWhiteZ);
constexpr float kBx = static_cast<float>(0.055639423 * kWhiteX);
constexpr float kBy = -0.204011202F;
constexpr float kBz = static_cast<float>(1.057148933 * kWhiteZ);

// Section 4.1.3: exponent of the colour distance, its largest value, and the knee of the remapping.
constexpr float kColorExponent = 0.7F;
constexpr float kColorMax = 41.2760984F;  // between green and blue
constexpr float kKnee = 0.4F * kColorMax;
constexpr float kKneeValue = 0.95F;

using Plane = std::vector<float>;

constexpr int rounded_up(int count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

struct Tile {
  int x0_px, y0_px, width_px, height_px;  // the pixels that are scored
  int rim_px;
  int stride;  // of planes with a rim, a multiple of the lanes
  [[nodiscard]] int rows_with_rim() const { return height_px + 2 * rim_px; }
  [[nodiscard]] std::size_t size_with_rim() const {
    return static_cast<std::size_t>(stride) * static_cast<std::size_t>(rows_with_rim());
  }
  [[nodiscard]] std::size_t row_with_rim(int y) const {
    return static_cast<std::size_t>(stride) * static_cast<std::size_t>(y);
  }
};

struct RgbTile {
  Plane r, g, b;
};

// Outside the picture the pixels of its border are repeated.
RgbTile load(const ImageRgb& image, const Tile& tile) {
  RgbTile rgb{Plane(tile.size_with_rim()), Plane(tile.size_with_rim()), Plane(tile.size_with_rim())};
  for (int row = 0; row < tile.rows_with_rim(); ++row) {
    const int y = std::clamp(tile.y0_px - tile.rim_px + row, 0, image.height_px - 1);
    for (int column = 0; column < tile.stride; ++column) {
      const int x = std::clamp(tile.x0_px - tile.rim_px + column, 0, image.width_px - 1);
      const Vec3f& pixel = image(x, y);
      const std::size_t i = tile.row_with_rim(row) + static_cast<std::size_t>(column);
      rgb.r[i] = pixel.x;
      rgb.g[i] = pixel.y;
      rgb.b[i] = pixel.z;
    }
  }
  return rgb;
}

// The planes y, x - y and y - z of display light.
struct OpponentTile {
  Plane achromatic, red_green, blue_yellow;
};

void to_opponent(const RgbTile& light, OpponentTile& opponent) {
  const std::size_t count = light.r.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float r = std::min(std::max(light.r[i], 0.0F), 1.0F);
    const float g = std::min(std::max(light.g[i], 0.0F), 1.0F);
    const float b = std::min(std::max(light.b[i], 0.0F), 1.0F);
    const float x = kXr * r + kXg * g + kXb * b;
    const float y = kYr * r + kYg * g + kYb * b;
    const float z = kZr * r + kZg * g + kZb * b;
    opponent.achromatic[i] = y;
    opponent.red_green[i] = x - y;
    opponent.blue_yellow[i] = y - z;
  }
}

// The sums of inputs that lie `step` apart, weighted by the kernel, for kTileWidth outputs.
void convolve(const float* in, std::size_t step, const std::vector<float>& kernel, float* out) {
  const std::size_t taps = kernel.size();
  for (int x = 0; x < kTileWidth; x += kLanes) {
    std::array<float, kLanes> sum{};
    for (std::size_t k = 0; k < taps; ++k) {
      const float weight = kernel[k];
      const float* from = in + k * step + x;
      for (std::size_t j = 0; j < kLanes; ++j) {
        sum[j] += weight * from[j];
      }
    }
    std::copy(sum.begin(), sum.end(), out + x);
  }
}

// Every row of a tile with its rim, filtered along x; kTileWidth wide.
void filter_rows(const Plane& in, const Tile& tile, const std::vector<float>& kernel, Plane& out) {
  const auto inset = static_cast<std::size_t>(tile.rim_px) - (kernel.size() - 1) / 2;
  for (int row = 0; row < tile.rows_with_rim(); ++row) {
    convolve(&in[tile.row_with_rim(row) + inset], 1, kernel, &out[static_cast<std::size_t>(row * kTileWidth)]);
  }
}

using Row = std::array<float, kTileWidth>;

// Row `row` of the scored part, filtered along y.
void filter_column(const Plane& in, const Tile& tile, int row, const std::vector<float>& kernel, Row& out) {
  const int radius = static_cast<int>(kernel.size() - 1) / 2;
  const auto first = static_cast<std::size_t>((row + tile.rim_px - radius) * kTileWidth);
  convolve(&in[first], kTileWidth, kernel, out.data());
}

// CIE 1976 f(t).
inline float lab_f(float t) {
  constexpr float kDelta = 6.0F / 29.0F;
  const float root = pow_fast(t, 1.0F / 3.0F);
  const float line = t * (1.0F / (3.0F * kDelta * kDelta)) + 4.0F / 29.0F;
  return t > kDelta * kDelta * kDelta ? root : line;
}

// The features of one picture that are compared: Hunt-adjusted L*a*b* after the filters (sections 4.1.1 and 4.1.2), and
// the strengths of edges and points (4.2). Planes are kTileWidth wide.
struct Features {
  explicit Features(const Tile& tile)
      : lightness(static_cast<std::size_t>(tile.height_px * kTileWidth)),
        a(lightness.size()),
        b(lightness.size()),
        edge(lightness.size()),
        point(lightness.size()) {}
  Plane lightness, a, b, edge, point;
};

void to_lab(const Row& achromatic, const Row& red_green, const Row& blue_yellow_1, const Row& blue_yellow_2,
            float* lightness, float* a, float* b) {
  for (std::size_t i = 0; i < kTileWidth; ++i) {
    const float y = achromatic[i];
    const float x = y + red_green[i];
    const float z = y - (blue_yellow_1[i] + blue_yellow_2[i]);
    const float red = std::min(std::max(kRx * x + kRy * y + kRz * z, 0.0F), 1.0F);
    const float green = std::min(std::max(kGx * x + kGy * y + kGz * z, 0.0F), 1.0F);
    const float blue = std::min(std::max(kBx * x + kBy * y + kBz * z, 0.0F), 1.0F);
    const float fx = lab_f(kXr * red + kXg * green + kXb * blue);
    const float fy = lab_f(kYr * red + kYg * green + kYb * blue);
    const float fz = lab_f(kZr * red + kZg * green + kZb * blue);
    const float light = 116.0F * fy - 16.0F;
    lightness[i] = light;
    a[i] = 0.01F * light * 500.0F * (fx - fy);
    b[i] = 0.01F * light * 200.0F * (fy - fz);
  }
}

void magnitude(const Row& x, const Row& y, float* out) {
  for (std::size_t i = 0; i < kTileWidth; ++i) {
    out[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
  }
}

// The buffers of a tile, used for both pictures and for all exposures in turn.
struct Scratch {
  explicit Scratch(const Tile& tile)
      : opponent{Plane(tile.size_with_rim()), Plane(tile.size_with_rim()), Plane(tile.size_with_rim())} {
    for (Plane& plane : filtered) {
      plane.resize(static_cast<std::size_t>(tile.rows_with_rim() * kTileWidth));
    }
  }
  OpponentTile opponent;
  std::array<Plane, 7> filtered;
};

void find_features(const RgbTile& light, const Tile& tile, const FlipKernels& kernels, Scratch& scratch,
                   Features& features) {
  to_opponent(light, scratch.opponent);
  const OpponentTile& opponent = scratch.opponent;
  auto& [achromatic, red_green, blue_yellow_1, blue_yellow_2, smooth, edge, point] = scratch.filtered;
  filter_rows(opponent.achromatic, tile, kernels.achromatic, achromatic);
  filter_rows(opponent.red_green, tile, kernels.red_green, red_green);
  filter_rows(opponent.blue_yellow, tile, kernels.blue_yellow_1, blue_yellow_1);
  filter_rows(opponent.blue_yellow, tile, kernels.blue_yellow_2, blue_yellow_2);
  filter_rows(opponent.achromatic, tile, kernels.gaussian, smooth);
  filter_rows(opponent.achromatic, tile, kernels.edge, edge);
  filter_rows(opponent.achromatic, tile, kernels.point, point);
  Row r0;
  Row r1;
  Row r2;
  Row r3;
  for (int row = 0; row < tile.height_px; ++row) {
    const auto at = static_cast<std::size_t>(row * kTileWidth);
    filter_column(achromatic, tile, row, kernels.achromatic, r0);
    filter_column(red_green, tile, row, kernels.red_green, r1);
    filter_column(blue_yellow_1, tile, row, kernels.blue_yellow_1, r2);
    filter_column(blue_yellow_2, tile, row, kernels.blue_yellow_2, r3);
    to_lab(r0, r1, r2, r3, &features.lightness[at], &features.a[at], &features.b[at]);
    filter_column(edge, tile, row, kernels.gaussian, r0);
    filter_column(smooth, tile, row, kernels.edge, r1);
    magnitude(r0, r1, &features.edge[at]);
    filter_column(point, tile, row, kernels.gaussian, r0);
    filter_column(smooth, tile, row, kernels.point, r1);
    magnitude(r0, r1, &features.point[at]);
  }
}

// Sections 4.1.3, 4.2 and 4.3.
void difference(const Features& reference, const Features& test, Plane& out) {
  const std::size_t count = out.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float da = reference.a[i] - test.a[i];
    const float db = reference.b[i] - test.b[i];
    const float hyab = std::fabs(reference.lightness[i] - test.lightness[i]) + std::sqrt(da * da + db * db);
    const float e = pow_fast(hyab, kColorExponent);
    const float low = e * (kKneeValue / kKnee);
    const float high = kKneeValue + (e - kKnee) * ((1.0F - kKneeValue) / (kColorMax - kKnee));
    const float color = std::min(e < kKnee ? low : high, 1.0F);
    const float edge = std::fabs(reference.edge[i] - test.edge[i]);
    const float point = std::fabs(reference.point[i] - test.point[i]);
    const float feature = std::sqrt(std::max(edge, point) * 0.707106781F);
    out[i] = pow_fast(color, 1.0F - std::min(feature, 1.0F));
  }
}

void check(const ImageRgb& reference, const ImageRgb& test, double pixels_per_degree) {
  if (reference.empty() || reference.width_px != test.width_px || reference.height_px != test.height_px) {
    throw Error(ErrorKind::usage, "flip", "the two pictures differ in size or are empty");
  }
  constexpr double kMost = 2000;  // kernels of 600 pixels
  if (!(pixels_per_degree > 0) || pixels_per_degree > kMost) {
    throw Error(ErrorKind::usage, "flip", "pixels per degree must be above 0 and at most 2000");
  }
}

// Calls body(tile) for all tiles of a picture.
template <class Body>
void for_each_tile(const ImageRgb& image, const FlipKernels& kernels, int threads, const Body& body) {
  const int columns = (image.width_px + kTileWidth - 1) / kTileWidth;
  const int rows = (image.height_px + kTileHeight - 1) / kTileHeight;
  const int rim = std::max(kernels.csf_radius_px, kernels.feature_radius_px);
  parallel_for(static_cast<std::size_t>(columns * rows), threads, [&](std::size_t i) {
    Tile tile{};
    tile.x0_px = static_cast<int>(i) % columns * kTileWidth;
    tile.y0_px = static_cast<int>(i) / columns * kTileHeight;
    tile.width_px = std::min(kTileWidth, image.width_px - tile.x0_px);
    tile.height_px = std::min(kTileHeight, image.height_px - tile.y0_px);
    tile.rim_px = rim;
    tile.stride = rounded_up(kTileWidth + 2 * rim);
    body(tile);
  });
}

}  // namespace

ImageGray flip_map(const ImageRgb& reference_light, const ImageRgb& test_light, double pixels_per_degree, int threads) {
  check(reference_light, test_light, pixels_per_degree);
  const FlipKernels kernels = make_flip_kernels(pixels_per_degree);
  ImageGray map(reference_light.width_px, reference_light.height_px);
  for_each_tile(reference_light, kernels, threads, [&](const Tile& tile) {
    Scratch scratch(tile);
    Features reference(tile);
    Features test(tile);
    find_features(load(reference_light, tile), tile, kernels, scratch, reference);
    find_features(load(test_light, tile), tile, kernels, scratch, test);
    Plane error(reference.lightness.size());
    difference(reference, test, error);
    for (int row = 0; row < tile.height_px; ++row) {
      std::copy_n(&error[static_cast<std::size_t>(row * kTileWidth)], tile.width_px,
                  &map(tile.x0_px, tile.y0_px + row));
    }
  });
  return map;
}

HdrFlipMap hdr_flip_map(const ImageRgb& reference, const ImageRgb& test, const FlipExposures& exposures,
                        FlipToneMapper tone_mapper, double pixels_per_degree, int threads) {
  check(reference, test, pixels_per_degree);
  check_flip_exposures(exposures);
  const FlipKernels kernels = make_flip_kernels(pixels_per_degree);
  HdrFlipMap map{ImageGray(reference.width_px, reference.height_px),
                 ImageGray(reference.width_px, reference.height_px)};
  for_each_tile(reference, kernels, threads, [&](const Tile& tile) {
    const RgbTile reference_light = load(reference, tile);
    const RgbTile test_light = load(test, tile);
    RgbTile toned = reference_light;
    Scratch scratch(tile);
    Features reference_features(tile);
    Features test_features(tile);
    Plane error(reference_features.lightness.size());
    for (int i = 0; i < exposures.count; ++i) {
      const float scale = std::exp2(static_cast<float>(exposure_ev(exposures, i)));
      tone_map(tone_mapper, scale, reference_light.r, reference_light.g, reference_light.b, toned.r, toned.g, toned.b);
      find_features(toned, tile, kernels, scratch, reference_features);
      tone_map(tone_mapper, scale, test_light.r, test_light.g, test_light.b, toned.r, toned.g, toned.b);
      find_features(toned, tile, kernels, scratch, test_features);
      difference(reference_features, test_features, error);
      const float share = exposures.count > 1 ? static_cast<float>(i) / static_cast<float>(exposures.count - 1) : 0.0F;
      for (int row = 0; row < tile.height_px; ++row) {
        const float* from = &error[static_cast<std::size_t>(row * kTileWidth)];
        const std::size_t to = map.values.index(tile.x0_px, tile.y0_px + row);
        for (std::size_t x = 0; x < static_cast<std::size_t>(tile.width_px); ++x) {
          if (from[x] > map.values.pixels[to + x]) {
            map.values.pixels[to + x] = from[x];
            map.exposure.pixels[to + x] = share;
          }
        }
      }
    }
  });
  return map;
}

}  // namespace gazetrace
