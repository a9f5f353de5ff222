// SPDX-License-Identifier: Apache-2.0
#include "report/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <set>
#include <span>

#include "core/image_io.hpp"
#include "core/parallel.hpp"
#include "core/svg.hpp"
#include "core/text.hpp"
#include "gazetrace/metrics.hpp"

namespace gazetrace {
namespace {

constexpr int kLeastWidthPx = 480;   // pictures are not reduced below this
constexpr int kQuality = 90;         // JPEG
constexpr std::size_t kSampled = 6;  // pictures from which sizes are predicted

struct Form {
  int block_px = 1;  // pixels are averaged over blocks of so many pixels a side
  bool jpeg = false;
  int frame_step = 1;
};

struct Rgb8 {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> bytes;
};

Rgb8 read_rgb8(const std::string& path) {
  const ImageRgba image = read_image_rgba(path, path);
  if (image.is_linear) {
    throw Error(ErrorKind::input, path, "holds linear light, not what a display shows", "name display pictures");
  }
  Rgb8 rgb{image.width_px, image.height_px, {}};
  const std::size_t count = static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px);
  rgb.bytes.resize(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      rgb.bytes[3 * i + c] =
          image.bytes.empty()
              ? static_cast<std::uint8_t>(std::lround(255 * std::clamp(image.floats[4 * i + c], 0.0F, 1.0F)))
              : image.bytes[4 * i + c];
    }
  }
  return rgb;
}

std::uint8_t code_of_light(double light) {
  const double code = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;  // IEC 61966-2-1
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(code, 0.0, 1.0)));
}

// Averages blocks of pixels; the last block of a row or column may be smaller.
Rgb8 averaged(const Rgb8& image, int block_px) {
  if (block_px == 1) {
    return image;
  }
  std::array<double, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i) {
    light[i] = display_light(DisplayResponse::srgb, static_cast<double>(i) / 255);
  }
  Rgb8 small{(image.width_px + block_px - 1) / block_px, (image.height_px + block_px - 1) / block_px, {}};
  small.bytes.reserve(static_cast<std::size_t>(small.width_px) * static_cast<std::size_t>(small.height_px) * 3);
  for (int y = 0; y < small.height_px; ++y) {
    for (int x = 0; x < small.width_px; ++x) {
      std::array<double, 3> sum{};
      int count = 0;
      for (int v = y * block_px; v < std::min((y + 1) * block_px, image.height_px); ++v) {
        for (int u = x * block_px; u < std::min((x + 1) * block_px, image.width_px); ++u, ++count) {
          const std::size_t at = 3 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width_px) +
                                      static_cast<std::size_t>(u));
          for (std::size_t c = 0; c < 3; ++c) {
            sum[c] += light[image.bytes[at + c]];
          }
        }
      }
      for (const double channel : sum) {
        small.bytes.push_back(code_of_light(channel / count));
      }
    }
  }
  return small;
}

std::string data_uri(const Rgb8& image, const Form& form) {
  const Rgb8 small = averaged(image, form.block_px);
  EncodeOptions options;
  options.quality = kQuality;
  const std::vector<std::uint8_t> bytes = encode_image(form.jpeg ? "embedded.jpg" : "embedded.png", small.width_px,
                                                       small.height_px, 8, small.bytes, options);
  return std::string("data:image/") + (form.jpeg ? "jpeg" : "png") + ";base64," +
         base64(std::string(bytes.begin(), bytes.end()));
}

std::vector<Form> forms_of(int width_px, std::size_t frames) {
  std::vector<Form> forms{{1, false, 1}, {1, true, 1}};
  int block = 1;
  for (const int next : {2, 3, 4, 6, 8, 12, 16}) {
    if (width_px / next >= kLeastWidthPx) {
      block = next;
      forms.push_back({block, true, 1});
    }
  }
  for (int step = 2; static_cast<std::size_t>(step) < 2 * frames; step *= 2) {
    forms.push_back({block, true, step});
  }
  return forms;
}

std::vector<std::string> paths_with(const std::vector<std::vector<std::string>>& paths_of_frames, int frame_step) {
  std::set<std::string> seen;
  std::vector<std::string> paths;
  for (std::size_t i = 0; i < paths_of_frames.size(); i += static_cast<std::size_t>(frame_step)) {
    for (const std::string& path : paths_of_frames[i]) {
      if (seen.insert(path).second) {
        paths.push_back(path);
      }
    }
  }
  return paths;
}

// Predicts the bytes of all pictures from a few that are spread evenly among them.
double foretold_bytes(const std::vector<Rgb8>& sampled, const Form& form, std::size_t count, int threads) {
  std::vector<double> sizes(sampled.size());
  parallel_for(sampled.size(), threads,
               [&](std::size_t i) { sizes[i] = static_cast<double>(data_uri(sampled[i], form).size()); });
  double sum = 0;
  for (const double size : sizes) {
    sum += size;
  }
  return sum / static_cast<double>(sampled.size()) * static_cast<double>(count);
}

std::string statement_of(const Form& form, const Rgb8& first, std::size_t frames) {
  std::string text =
      form.block_px == 1
          ? fmt::format("Pictures are shown at full size, {} x {} pixels", first.width_px, first.height_px)
          : fmt::format("Pictures are reduced from {} x {} pixels by averaging {} x {} of them in linear light",
                        first.width_px, first.height_px, form.block_px, form.block_px);
  text +=
      form.jpeg ? fmt::format(", as JPEG of quality {}: small differences are its own", kQuality) : ", without loss";
  if (form.frame_step > 1) {
    text += fmt::format("; every {}th of {} frames", form.frame_step, frames);
  }
  return text + ".";
}

}  // namespace

EmbeddedPictures embed_pictures(const std::vector<std::vector<std::string>>& paths_of_frames, double max_bytes,
                                int threads) {
  EmbeddedPictures result;
  const std::vector<std::string> all = paths_with(paths_of_frames, 1);
  std::vector<Rgb8> sampled;
  for (std::size_t i = 0; i < std::min(kSampled, all.size()); ++i) {
    const std::string& path = all[i * all.size() / std::min(kSampled, all.size())];
    try {
      sampled.push_back(read_rgb8(path));
    } catch (const Error&) {
      continue;  // warned about when all have been read
    }
  }
  if (sampled.empty()) {
    result.statement = "There are no pictures.";
    if (!all.empty()) {
      result.warnings.push_back("no picture could be read, such as " + all.front());
    }
    return result;
  }
  for (const Form& form : forms_of(sampled.front().width_px, paths_of_frames.size())) {
    const std::vector<std::string> paths = paths_with(paths_of_frames, form.frame_step);
    if (foretold_bytes(sampled, form, paths.size(), threads) > max_bytes) {
      continue;
    }
    std::vector<EmbeddedPicture> pictures(paths.size());
    std::vector<std::string> problems(paths.size());
    parallel_for(paths.size(), threads, [&](std::size_t i) {
      try {
        const Rgb8 image = read_rgb8(paths[i]);
        pictures[i] = {data_uri(image, form), image.width_px, image.height_px};
      } catch (const Error& e) {
        problems[i] = e.what();
      }
    });
    double bytes = 0;
    for (const EmbeddedPicture& picture : pictures) {
      bytes += static_cast<double>(picture.data_uri.size());
    }
    if (bytes > max_bytes) {
      continue;
    }
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (problems[i].empty()) {
        result.of_path.emplace(paths[i], std::move(pictures[i]));
      } else {
        result.warnings.push_back(problems[i]);
      }
    }
    result.frame_step = form.frame_step;
    result.statement = statement_of(form, sampled.front(), paths_of_frames.size());
    return result;
  }
  result.statement = "No picture fits into the page's limit.";
  return result;
}

}  // namespace gazetrace
