// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "core/image_io.hpp"
#include "gazetrace/output.hpp"
#include "output/gaze_text.hpp"
#include "output/written_file.hpp"

namespace gazetrace {
namespace {

struct Format {
  std::string_view suffix;
  int min_bits, max_bits;
  bool has_alpha;
  int max_side_px;  // what the file's header or the library that writes it can hold; some of these end the process
};
constexpr std::array<Format, 6> kFormats{{{".png", 8, 16, true, 1000000},
                                          {".jpg", 8, 8, false, 65500},
                                          {".jpeg", 8, 8, false, 65500},
                                          {".tif", 8, 16, true, 1000000},
                                          {".tiff", 8, 16, true, 1000000},
                                          {".dpx", 10, 10, false, 1000000}}};

const Format& format_of(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  for (const Format& format : kFormats) {
    if (format.suffix == suffix) {
      return format;
    }
  }
  if (suffix == ".mp4" || suffix == ".mov" || suffix == ".mkv" || suffix == ".webm" || suffix == ".avi") {
    throw Error(ErrorKind::usage, path, "a video is made of pictures",
                "render .exr or .png first, and then take 'gazetrace video'");
  }
  throw Error(ErrorKind::usage, path,
              suffix.empty() ? "a display image needs a suffix" : "no display image ends in " + suffix,
              "use .png, .jpg, .jpeg, .tif, .tiff or .dpx, or .exr for scene-linear light");
}

template <class T>
std::vector<std::uint8_t> with_alpha(const std::vector<std::uint8_t>& rgb, const ImageGray& alpha) {
  constexpr std::size_t kColor = 3 * sizeof(T);
  constexpr auto kOne = static_cast<float>(std::numeric_limits<T>::max());
  std::vector<std::uint8_t> rgba(alpha.pixels.size() * (kColor + sizeof(T)));
  for (std::size_t i = 0; i < alpha.pixels.size(); ++i) {
    const T code = static_cast<T>(std::lround(alpha.pixels[i] * kOne));
    std::memcpy(&rgba[i * (kColor + sizeof(T))], &rgb[i * kColor], kColor);
    std::memcpy(&rgba[i * (kColor + sizeof(T)) + kColor], &code, sizeof(T));
  }
  return rgba;
}

}  // namespace

bool holds_alpha(const DisplaySettings& settings) {
  return format_of(settings.pattern).has_alpha;
}

int display_image_bits(const DisplaySettings& settings) {
  const Format& format = format_of(settings.pattern);
  if (settings.bits != 8 && settings.bits != 16) {
    throw Error(ErrorKind::usage, settings.pattern,
                fmt::format("a display image has 8 or 16 bits a channel, not {}", settings.bits));
  }
  if (format.min_bits == 10) {
    return 16;  // rounded to 10 bits when it is written
  }
  if (settings.bits > format.max_bits) {
    throw Error(ErrorKind::usage, settings.pattern, fmt::format("JPEG holds 8 bits a channel, not {}", settings.bits),
                "write PNG or TIFF, or 8 bits");
  }
  return settings.bits;
}

void check_display_image_size(const DisplaySettings& settings, int width_px, int height_px) {
  if (settings.pattern.empty()) {
    return;
  }
  const Format& format = format_of(settings.pattern);
  if (std::max(width_px, height_px) > format.max_side_px) {
    throw Error(ErrorKind::usage, settings.pattern,
                fmt::format("{}x{} pixels are more than such a file can hold ({} a side)", width_px, height_px,
                            format.max_side_px),
                "write PNG or EXR");
  }
}

WrittenFile write_display_image(const std::string& path, const DisplayImage& image, const FrameHeader& header,
                                const DisplaySettings& settings, const ImageGray* alpha) {
  const Format& format = format_of(path);
  EncodeOptions options;
  options.file_bits = std::clamp(image.bits, format.min_bits, format.max_bits);
  options.quality = settings.quality;
  options.software = header.software;
  options.note = fmt::format("gazetrace:settings_digest={} frame={}", header.settings_digest, header.frame);
  options.note += fmt::format(" t_video_ns={} exposure_ev={}", header.t_video_ns, header.exposure_ev);
  if (const GazeAtTime& gaze = header.gaze_true; gaze.state != GazeState::none || gaze.no_gaze || gaze.movement) {
    options.note += " " + gaze_words(gaze);
  }
  options.has_alpha = alpha != nullptr;
  const std::vector<std::uint8_t> bytes =
      encode_image(path, image.width_px, image.height_px, image.bits,
                   alpha == nullptr  ? image.bytes
                   : image.bits == 8 ? with_alpha<std::uint8_t>(image.bytes, *alpha)
                                     : with_alpha<std::uint16_t>(image.bytes, *alpha),
                   options);
  return write_frame_file(path, header.frame, std::as_bytes(std::span(bytes)));
}

}  // namespace gazetrace
