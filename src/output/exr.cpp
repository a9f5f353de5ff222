// SPDX-License-Identifier: Apache-2.0
// Which layers a frame's EXR has, and what its sampling map's has.
#include "output/exr.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/parallel.hpp"
#include "gazetrace/aovs.hpp"
#include "gazetrace/cryptomatte.hpp"
#include "gazetrace/output.hpp"
#include "output/exr_describe.hpp"
#include "output/exr_picture.hpp"

namespace gazetrace {
namespace {

constexpr int kMapZipLevel = 4;  // OpenEXR's own default

std::array<std::string, 3> names_of(const std::string& layer, const char* letters) {
  return {layer + '.' + letters[0], layer + '.' + letters[1], layer + '.' + letters[2]};
}

void require(const std::string& aov, bool present) {
  if (!present) {
    throw Error(ErrorKind::usage, "", "AOV '" + aov + "' was asked for, but this frame does not have it",
                "render the frame with this AOV among those that are asked for");
  }
}

struct FrameImages {
  const Frame& frame;
  const FrameLayers& layers;
  const ImageGray* eccentricity_deg;
};

void add_depth(ExrPicture& picture, const ImageGray& depth_m, const std::optional<double>& sky_depth_m) {
  picture.add_text("gazetrace:sky_depth_m", sky_depth_m ? fmt::format("{}", *sky_depth_m) : "inf");
  if (!sky_depth_m) {
    picture.add_float("depth.Z", depth_m);
    return;
  }
  ImageGray finite = depth_m;
  std::replace(finite.pixels.begin(), finite.pixels.end(), std::numeric_limits<float>::infinity(),
               static_cast<float>(*sky_depth_m));
  picture.add_own("depth.Z", std::move(finite));
}

// Layers "crypto_object00", "crypto_object01", ... hold two ranks each: identifier and coverage, identifier and
// coverage.
void add_mattes(ExrPicture& picture, const MatteTable& table, const Coverage& coverage, int width_px, int height_px) {
  for (const auto& [name, text] : cryptomatte_attributes(table)) {
    picture.add_text(name, text);
  }
  constexpr std::array<const char*, 4> kLetters{"R", "G", "B", "A"};
  const std::size_t ranks = coverage.id.size() + coverage.id.size() % 2;
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    const std::string layer = fmt::format("{}{:02}.", table.layer, rank / 2);
    const char* const* letters = &kLetters.at(rank % 2 * 2);
    if (rank < coverage.id.size()) {
      picture.add_float(layer + letters[0], coverage.id[rank]);
      picture.add_float(layer + letters[1], coverage.share[rank]);
    } else {
      picture.add_own(layer + letters[0], ImageGray(width_px, height_px));
      picture.add_own(layer + letters[1], ImageGray(width_px, height_px));
    }
  }
}

// Whether `aov` is a Cryptomatte layer, which is then added.
bool add_cryptomatte(ExrPicture& picture, const std::string& aov, const FrameImages& images) {
  const std::vector<std::string>& known = cryptomatte_layers();
  if (std::find(known.begin(), known.end(), aov) == known.end()) {
    return false;
  }
  bool found = false;
  for (std::size_t i = 0; images.layers.tables && i < images.layers.mattes.size(); ++i) {
    const MatteTable& table = (*images.layers.tables)[i];
    if (table.layer == aov) {
      add_mattes(picture, table, images.layers.mattes[i], images.frame.radiance.width_px,
                 images.frame.radiance.height_px);
      found = true;
    }
  }
  require(aov, found);
  return true;
}

void add_motion(ExrPicture& picture, const std::string& aov, const Image<Vec2f>& motion) {
  require(aov, !motion.empty());
  ImageGray u(motion.width_px, motion.height_px);
  ImageGray v = u;
  for (std::size_t i = 0; i < motion.pixels.size(); ++i) {
    u.pixels[i] = motion.pixels[i].x;
    v.pixels[i] = motion.pixels[i].y;
  }
  picture.add_own(aov + ".u", std::move(u));
  picture.add_own(aov + ".v", std::move(v));
}

void add_aov(ExrPicture& picture, const std::string& aov, const FrameImages& images, const ExrSettings& settings) {
  const Frame& frame = images.frame;
  picture.begin_layer(aov);
  if (aov == "albedo" || aov == "normal") {
    const ImageRgb& image = aov == "albedo" ? frame.albedo : frame.normal;
    require(aov, !image.empty());
    if (aov == "albedo") {
      picture.add_color(names_of(aov, "RGB"), image, ExrPixels::half);
    } else {
      picture.add_half_rgb(names_of(aov, "XYZ"), image);
    }
  } else if (aov == "depth") {
    require(aov, !frame.depth_m.empty());
    add_depth(picture, frame.depth_m, settings.sky_depth_m);
  } else if (aov == "samples") {
    picture.add_float("samples.X", frame.sample_count);
  } else if (aov == "variance") {
    picture.add_float("variance.X", frame.variance);
  } else if (aov == "eccentricity") {
    if (images.eccentricity_deg != nullptr) {
      picture.add_float("eccentricity.X", *images.eccentricity_deg);
    } else {
      // A frame without gaze has no eccentricity; the channel is written all the same, so that all frames of a sequence
      // have the same channels.
      picture.add_constant("eccentricity.X", std::numeric_limits<float>::quiet_NaN());
    }
  } else if (aov == "forward" || aov == "backward") {
    add_motion(picture, aov, aov == "forward" ? images.layers.motion.forward_px : images.layers.motion.backward_px);
  } else if (aov == "position") {
    require(aov, !images.layers.motion.position_m.empty());
    picture.add_float_rgb(names_of(aov, "XYZ"), images.layers.motion.position_m);
  } else if (const auto& groups = light_group_names(); std::find(groups.begin(), groups.end(), aov) != groups.end()) {
    require(aov, images.layers.light.size() == groups.size());
    const auto group = static_cast<std::size_t>(std::find(groups.begin(), groups.end(), aov) - groups.begin());
    picture.add_color(names_of(aov, "RGB"), images.layers.light[group], settings.pixels);
  } else if (!add_cryptomatte(picture, aov, images)) {
    throw Error(ErrorKind::usage, "", unknown_name_message("AOV", aov, aov_names()));
  }
}

}  // namespace

WrittenExr write_frame_exr(const std::string& path, const Frame& frame, const ImageGray* eccentricity_deg,
                           const FrameHeader& header, const ExrSettings& settings, int threads,
                           const FrameLayers& layers) {
  ExrPicture picture(frame.radiance.width_px, frame.radiance.height_px, settings, resolve_threads(threads));
  picture.place(header.window);
  describe(picture.header(), header, settings.space);
  picture.begin_layer("beauty");
  picture.add_color({"R", "G", "B"}, frame.radiance, settings.pixels);
  if (settings.alpha) {
    require("alpha", !layers.alpha.empty());
    picture.add_share("A", layers.alpha);
  }
  for (const std::string& aov : settings.aovs) {
    add_aov(picture, aov, {frame, layers, eccentricity_deg}, settings);
  }
  WrittenFile file = picture.write(path, header.frame);
  return {picture.clamped(), std::move(file)};
}

WrittenFile write_sampling_map_exr(const std::string& path, const SamplingMap& map, const ImageGray* eccentricity_deg,
                                   const FrameWindow& window) {
  ImageGray region(map.width_px, map.height_px);
  std::copy(map.region.pixels.begin(), map.region.pixels.end(), region.pixels.begin());
  const ImageGray density = samples_per_pixel(map);
  ExrSettings settings;
  settings.compression = "zip";
  settings.zip_level = kMapZipLevel;
  ExrPicture picture(map.width_px, map.height_px, settings, 1);
  picture.place(window);
  picture.begin_layer("map");
  for (std::size_t i = 0; i < map.regions.size(); ++i) {
    add_text(picture.header(), fmt::format("region_{}", i), map.regions[i].name);
  }
  picture.add_float("region", region);
  picture.add_float("samples_per_pixel", density);
  if (eccentricity_deg != nullptr) {
    picture.add_float("eccentricity", *eccentricity_deg);
  }
  return picture.write(path, 0);
}

WrittenFile write_density_exr(const std::string& path, const ImageGray& density, std::int32_t frame,
                              const FrameWindow& window) {
  ExrSettings settings;
  settings.compression = "zip";
  settings.zip_level = kMapZipLevel;
  ExrPicture picture(density.width_px, density.height_px, settings, 1);
  picture.place(window);
  picture.begin_layer("density");
  picture.add_float("Y", density);
  return picture.write(path, frame);
}

}  // namespace gazetrace
