// SPDX-License-Identifier: Apache-2.0
// Light from far away: a picture, a constant, or the built-in sky.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "core/image_io.hpp"
#include "core/srgb.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {
namespace {

constexpr int kSkyWidthPx = 512, kSkyHeightPx = 256;

Vec3d mix(const Vec3d& a, const Vec3d& b, double t) {
  return a * (1 - t) + b * t;
}

// A gradient over elevation that is smooth at the horizon, and a wide glow around the sun's direction. This is not a
// model of the atmosphere: it has the colours of a clear day and about its ratio of light (4 : 1 from the sun's side),
// without a sun disc, which would need many samples.
Vec3d sky_radiance(const Vec3d& direction) {
  constexpr Vec3d kZenith{0.16, 0.32, 0.72};
  constexpr Vec3d kHorizon{0.78, 0.86, 0.95};
  constexpr Vec3d kGround{0.20, 0.18, 0.15};
  constexpr Vec3d kGlow{2.4, 2.0, 1.4};
  const Vec3d sun = normalize(Vec3d{0.55, 0.62, -0.56});
  const double up = std::max(direction.y, 0.0);
  const Vec3d above = mix(kHorizon, kZenith, 1.0 - std::pow(1.0 - up, 3.0));
  const double t = std::clamp((direction.y + 0.08) / 0.16, 0.0, 1.0);
  const Vec3d base = mix(kGround, above, t * t * (3 - 2 * t));
  const double glow = std::exp(-(1.0 - dot(direction, sun)) / 0.08);
  return base + kGlow * (glow * t);
}

// The picture, what is made of it and its file, while the tables are made by which its light is sampled.
constexpr std::uint64_t kBytesOfAPixel = 32;

// Whether the picture is the cross of a cube: its faces lie on six of four by three or three by four places, and
// nothing lies at the corners.
bool is_cross(const ImageRgb& rgb) {
  const bool is_wide = 3 * rgb.width_px == 4 * rgb.height_px;
  if (!is_wide && 4 * rgb.width_px != 3 * rgb.height_px) {
    return false;
  }
  const int face = rgb.width_px / (is_wide ? 4 : 3);
  const auto is_of_one_color = [&](int column, int row) {
    const Vec3f first = rgb(column * face, row * face);
    for (int y = row * face; y < (row + 1) * face; ++y) {
      for (int x = column * face; x < (column + 1) * face; ++x) {
        if (rgb(x, y) != first) {
          return false;
        }
      }
    }
    return true;
  };
  const int right = is_wide ? 3 : 2;
  const int bottom = is_wide ? 2 : 3;
  return is_of_one_color(0, 0) && is_of_one_color(right, 0) && is_of_one_color(0, bottom) &&
         is_of_one_color(right, bottom) && !is_of_one_color(1, 1);
}

void check_layout(const Picture& picture, const std::string& path, Warnings& warnings) {
  const PictureFacts& facts = picture.facts;
  const std::int64_t width = facts.width_px;
  const std::int64_t height = facts.height_px;
  constexpr std::int64_t kLeastFacePx = 4;  // smaller pictures are of one light
  const bool is_large = std::min(width, height) >= kLeastFacePx;
  if (facts.is_cube_map || (is_large && (width == 6 * height || height == 6 * width || is_cross(picture.rgb)))) {
    throw Error(ErrorKind::input, path, "it is a cube map; an environment is a latitude-longitude map",
                "convert it, for example by 'oiiotool' or 'cmft'");
  }
  if (is_large && std::abs(width - 2 * height) > std::max<std::int64_t>(2, height / 50)) {
    warnings.push_back(path + ": has " + std::to_string(width) + " x " + std::to_string(height) +
                       " pixels; it is read as a latitude-longitude map, which is twice as wide as high. Light probes, "
                       "mirror balls and crosses of cubes are not");
  }
}

// Light of code values; infinite halves, which are brighter than a half can be, become the largest half.
void make_light(Picture& picture, const std::string& path, Warnings& warnings) {
  constexpr float kLargestHalf = 65504;
  std::uint64_t infinite = 0;
  std::uint64_t bad = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < picture.rgb.pixels.size(); ++i) {
    Vec3f& pixel = picture.rgb.pixels[i];
    if (!picture.facts.is_linear) {
      pixel = {light_of_srgb(pixel.x), light_of_srgb(pixel.y), light_of_srgb(pixel.z)};
    }
    if (is_finite(pixel)) {
      continue;
    }
    if (picture.facts.is_half) {
      for (float* const value : {&pixel.x, &pixel.y, &pixel.z}) {
        *value = *value > kLargestHalf ? kLargestHalf : *value;
      }
    }
    if (is_finite(pixel)) {
      ++infinite;
    } else {
      first = bad++ == 0 ? i : first;
    }
  }
  if (bad > 0) {
    const auto width = static_cast<std::size_t>(picture.rgb.width_px);
    throw Error(ErrorKind::input, path,
                std::to_string(bad) + (bad == 1 ? " pixel is" : " pixels are") + " not finite, the first at " +
                    std::to_string(first % width) + ", " + std::to_string(first / width),
                "repair the picture");
  }
  if (infinite > 0) {
    warnings.push_back(path + ": " + std::to_string(infinite) +
                       " pixels are infinite, brighter than the file's half floats can hold; they are read as 65504, "
                       "so that a sun there is too dark");
  }
  if (!picture.facts.is_linear) {
    warnings.push_back(path + ": holds display values, which are taken for sRGB; no light in it is brighter than 1");
  }
}

}  // namespace

Environment load_environment(const std::string& path, double rotation_deg, double exposure_ev,
                             std::uint64_t memory_bytes) {
  Environment environment;
  PictureLimits limits = kPictureLimits;
  limits.most_pixels =
      std::max<std::uint64_t>(1, (memory_bytes > 0 ? memory_bytes : most_memory_bytes()) / kBytesOfAPixel);
  Picture picture = read_picture(path, limits);
  check_layout(picture, path, environment.warnings);
  make_light(picture, path, environment.warnings);
  environment.radiance = std::move(picture.rgb);
  environment.rotation_rad = rotation_deg * kRadPerDeg;
  environment.source = path;
  const auto scale = static_cast<float>(std::exp2(exposure_ev));
  ImageRgb& image = environment.radiance;
  std::size_t negative = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    Vec3f& pixel = image.pixels[i];
    if (!is_finite(pixel * scale)) {
      const auto width = static_cast<std::size_t>(image.width_px);
      throw Error(
          ErrorKind::input, path,
          "pixel " + std::to_string(i % width) + ", " + std::to_string(i / width) + " overflows at this exposure",
          "lower the environment's exposure");
    }
    // Primaries that were converted leave values that are below 0 by rounding alone.
    const float rounding = -1e-6F * std::max({pixel.x, pixel.y, pixel.z, 0.0F});
    negative += std::min({pixel.x, pixel.y, pixel.z}) < rounding ? 1 : 0;
    pixel = Vec3f{std::max(pixel.x, 0.0F), std::max(pixel.y, 0.0F), std::max(pixel.z, 0.0F)} * scale;
  }
  if (negative > 0) {
    environment.warnings.push_back(path + ": " + std::to_string(negative) +
                                   " pixels had negative values, which were set to 0");
  }
  return environment;
}

Environment constant_environment(const Vec3f& radiance) {
  if (!is_finite(radiance) || radiance.x < 0 || radiance.y < 0 || radiance.z < 0) {
    throw Error(ErrorKind::usage, "environment", "a constant radiance must be finite and not negative");
  }
  Environment environment;
  environment.radiance = ImageRgb(1, 1, radiance);
  environment.source = "constant";
  return environment;
}

Environment builtin_sky(double rotation_deg, double exposure_ev) {
  Environment environment;
  environment.radiance = ImageRgb(kSkyWidthPx, kSkyHeightPx);
  environment.rotation_rad = rotation_deg * kRadPerDeg;
  environment.source = "built-in sky";
  const double scale = std::exp2(exposure_ev);
  for (int y = 0; y < kSkyHeightPx; ++y) {
    const double theta = (y + 0.5) / kSkyHeightPx * kPi;
    for (int x = 0; x < kSkyWidthPx; ++x) {
      const double azimuth = ((x + 0.5) / kSkyWidthPx - 0.5) * 2 * kPi;  // from -z towards +x
      const Vec3d direction{std::sin(theta) * std::sin(azimuth), std::cos(theta), -std::sin(theta) * std::cos(azimuth)};
      environment.radiance(x, y) = to_float(sky_radiance(direction) * scale);
    }
  }
  return environment;
}

}  // namespace gazetrace
