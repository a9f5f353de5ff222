// SPDX-License-Identifier: Apache-2.0
// Checks output settings before the first ray.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gazetrace/aovs.hpp"
#include "gazetrace/cryptomatte.hpp"
#include "gazetrace/output.hpp"
#include "output/aovs.hpp"
#include "output/exr.hpp"

namespace gazetrace {
namespace {

void check_known(const char* what, const std::string& given, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), given) == known.end()) {
    throw Error(ErrorKind::usage, "", unknown_name_message(what, given, known));
  }
}

void check_exr_name(const std::string& pattern, bool require_number) {
  if (!pattern.ends_with(".exr")) {
    throw Error(ErrorKind::usage, pattern, "a scene-linear file must end in .exr");
  }
  frame_file_name(pattern, 1, require_number);
}

void check_layers(const ExrSettings& exr) {
  std::vector<std::string> sorted = exr.aovs;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end()) {
    throw Error(ErrorKind::usage, "`aov`", "'" + *twice + "' is named twice", "name it once");
  }
  const bool has_mattes = !layer_settings(exr).mattes.empty();
  if (has_mattes && exr.parts == ExrParts::single && is_lossy_compression(exr.compression)) {
    throw Error(ErrorKind::usage, "`exr-compression`",
                fmt::format("'{}' may change the identifiers of Cryptomatte layers, which are bits", exr.compression),
                "use `exr-parts` multi, which packs such layers by zip, or a lossless compression such as piz");
  }
  if (exr.crypto_ranks % 2 != 0 || exr.crypto_ranks < 2 || exr.crypto_ranks > 16) {
    throw Error(ErrorKind::usage, "`crypto-ranks`",
                fmt::format("{} is no even number from 2 to 16: a layer holds two ranks", exr.crypto_ranks), "give 6");
  }
  if (exr.sky_depth_m && (!std::isfinite(*exr.sky_depth_m) || *exr.sky_depth_m < 0)) {
    throw Error(ErrorKind::usage, "`sky-depth`", fmt::format("{} is no depth in metres", *exr.sky_depth_m),
                "leave it out for an infinite depth");
  }
}

}  // namespace

const std::vector<AovInfo>& aov_infos() {
  static const std::vector<AovInfo> kInfos{
      {"albedo", "albedo.R .G .B: the share of light that the first surface reflects, 0 to 1, linear Rec.709, half"},
      {"normal", "normal.X .Y .Z: of the first surface, world axes (+y up), unit length where a pixel sees one, half"},
      {"depth",
       "depth.Z: of the first surface along the axis of the view, metres, float; where there is none, infinite or the "
       "`sky-depth`"},
      {"diffuse_direct",
       "diffuse_direct.R .G .B: light that the diffuse lobe of the first surface sends on from a lamp, an emitter or "
       "the sky, linear Rec.709, as `exr-pixels` says; this layer and the next five add up to the picture"},
      {"diffuse_indirect", "diffuse_indirect.R .G .B: light that the same lobe sends on from other surfaces"},
      {"specular_direct", "specular_direct.R .G .B: direct light by all other lobes of the first surface"},
      {"specular_indirect", "specular_indirect.R .G .B: light from other surfaces by those lobes"},
      {"emission", "emission.R .G .B: surfaces that are seen shining, unlit ones included"},
      {"background", "background.R .G .B: the environment where it is seen itself"},
      {"position",
       "position.X .Y .Z: of the surface behind the pixel's centre, world axes (+y up), metres, float; 0 where there "
       "is none"},
      {"forward",
       "forward.u .v: where the surface behind the pixel's centre will be a frame later, in pixels from here, right "
       "and up, float"},
      {"backward", "backward.u .v: where it was a frame earlier, in the same manner"},
      {"crypto_object",
       "crypto_object00.R .G .B .A and on: Cryptomatte of the nodes of the scene's file, pairs of identifier and "
       "coverage, float"},
      {"crypto_material", "crypto_material00.R .G .B .A and on: the same of materials"},
      {"crypto_asset",
       "crypto_asset00.R .G .B .A and on: the same of the outermost nodes, with all that is below them"},
      {"samples", "samples.X: effective number of samples behind the pixel, float"},
      {"variance",
       "variance.X: of the pixel's mean luminance, squared scene-linear units, float, as far as the spread of "
       "its samples tells"},
      {"eccentricity",
       "eccentricity.X: angle between the pixel and the true gaze, as the eye sees it, degrees, float; "
       "NaN in frames without gaze"},
  };
  return kInfos;
}

const std::vector<std::string>& aov_names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const AovInfo& info : aov_infos()) {
      names.push_back(info.name);
    }
    return names;
  }();
  return kNames;
}

LayerSettings layer_settings(const ExrSettings& exr) {
  LayerSettings layers;
  const auto wants = [&](const std::string& aov) {
    return std::find(exr.aovs.begin(), exr.aovs.end(), aov) != exr.aovs.end();
  };
  layers.forward = wants("forward");
  layers.backward = wants("backward");
  layers.position = wants("position");
  layers.alpha = exr.alpha;
  layers.light = std::any_of(light_group_names().begin(), light_group_names().end(), wants);
  for (const std::string& layer : cryptomatte_layers()) {
    if (wants(layer)) {
      layers.mattes.push_back(layer);
    }
  }
  layers.coverage.ranks = exr.crypto_ranks;
  layers.coverage.rays = exr.crypto_rays;
  return layers;
}

bool show_first_hits(const std::vector<std::string>& aovs) {
  return std::any_of(aovs.begin(), aovs.end(),
                     [](const std::string& aov) { return aov == "albedo" || aov == "normal" || aov == "depth"; });
}

void check_output_settings(const OutputSettings& settings, bool several_frames) {
  if (!settings.exr.pattern.empty()) {
    check_exr_name(settings.exr.pattern, several_frames);
    check_known("EXR compression", settings.exr.compression, exr_compression_names());
  }
  for (const std::string& aov : settings.exr.aovs) {
    check_known("AOV", aov, aov_names());
    if (settings.exr.pattern.empty()) {
      throw Error(ErrorKind::usage, "`aov`", "AOVs are channels of an EXR, and none is written",
                  "add `output` frame.####.exr");
    }
  }
  check_layers(settings.exr);
  if (!settings.map_pattern.empty()) {
    check_exr_name(settings.map_pattern, several_frames);
  }
  if (settings.exr.alpha && !settings.display.pattern.empty() && !holds_alpha(settings.display)) {
    throw Error(ErrorKind::usage, settings.display.pattern, "such a file holds no alpha",
                "write .png, .tif or .exr, or leave `alpha` out");
  }
  if (!settings.display.pattern.empty()) {
    frame_file_name(settings.display.pattern, 1, several_frames);
    display_image_bits(settings.display);
    if (settings.display.quality < 1 || settings.display.quality > 100) {
      throw Error(ErrorKind::usage, "",
                  fmt::format("a JPEG quality of {} lies outside 1..100", settings.display.quality));
    }
  }
}

}  // namespace gazetrace
