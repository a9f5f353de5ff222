// SPDX-License-Identifier: Apache-2.0
#include "output/exr_mean.hpp"

#include <OpenEXR/ImfCompression.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <sstream>

#include "core/exr_reader.hpp"
#include "gazetrace/cryptomatte.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/light_groups.hpp"
#include "output/exr_describe.hpp"
#include "output/exr_layers.hpp"
#include "output/exr_picture.hpp"

namespace gazetrace {
namespace {

constexpr const char* kMeanOf = "mean_of";
constexpr const char* kSamplesLayer = "samples.X";
// A pixel without samples holds what its neighbors lend it, which counts only where no picture has any samples there.
constexpr double kNoSamples = 1e-30;

enum class Joined { mean, variance, sum, first };

std::string text_of(const Imf::Header& header, const std::string& name) {
  const auto* text = header.findTypedAttribute<Imf::StringAttribute>("gazetrace:" + name);
  return text == nullptr ? std::string() : text->value();
}

Joined how_to_join(const std::string& channel, const std::string& path) {
  const std::string layer = channel.find('.') == std::string::npos ? "" : channel.substr(0, channel.rfind('.'));
  const auto is_one_of = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), layer) != names.end();
  };
  if (layer.empty() || layer == "albedo" || layer == "normal" || is_one_of(light_group_names())) {
    return Joined::mean;
  }
  if (layer == "variance" || layer == "samples") {
    return layer == "variance" ? Joined::variance : Joined::sum;
  }
  const std::vector<std::string>& mattes = cryptomatte_layers();
  if (is_one_of({"depth", "position", "forward", "backward", "eccentricity"}) ||
      std::any_of(mattes.begin(), mattes.end(), [&](const std::string& matte) { return layer.starts_with(matte); })) {
    return Joined::first;
  }
  throw Error(ErrorKind::input, path, fmt::format("nothing is known of the layer '{}'", layer), "leave it out");
}

SeedSamples seeds_of(const Imf::Header& header) {
  SeedSamples seeds;
  std::istringstream words(text_of(header, kMeanOf));
  for (std::string word; words >> word;) {
    const std::size_t colon = word.find(':');
    seeds[word.substr(0, colon)] = colon == std::string::npos ? 0 : std::strtod(word.c_str() + colon + 1, nullptr);
  }
  if (const std::string seed = text_of(header, "seed"); seeds.empty() && !seed.empty()) {
    seeds[seed] = 0;
  }
  return seeds;
}

// One of the pictures, and how many samples each of its pixels has.
struct Render {
  std::vector<ExrLayers> parts;
  ImageGray samples;
  SeedSamples seeds;
};

Render read_render(const std::string& path) {
  Render render{read_exr_layers(path), {}, {}};
  const Imf::Header& header = render.parts.front().header;
  for (const ExrLayers& part : render.parts) {
    if (const auto found = part.channels.find(kSamplesLayer); found != part.channels.end()) {
      render.samples = found->second;
    }
  }
  if (render.samples.empty()) {
    const double all = std::strtod(text_of(header, "samples_per_pixel").c_str(), nullptr);
    if (!(all > 0)) {
      throw Error(ErrorKind::input, path, "does not say how many samples each pixel has, by which it is weighted",
                  "render it with `accumulate` off, or with `aov` samples");
    }
    const Imath::Box2i window = header.dataWindow();
    render.samples =
        ImageGray(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, static_cast<float>(all));
  }
  render.seeds = seeds_of(header);
  if (text_of(header, kMeanOf).empty() && !render.seeds.empty()) {
    const std::vector<float>& samples = render.samples.pixels;
    render.seeds.begin()->second =
        std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
  }
  return render;
}

class Sums {
 public:
  void add(const Render& render, const std::string& path) {
    const std::vector<float>& samples = render.samples.pixels;
    weights_.resize(samples.size());
    check_size(samples.size(), path);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      weights_[i] += weight(samples[i]);
    }
    const bool first = channels_.empty();
    std::size_t known = 0;
    for (const ExrLayers& part : render.parts) {
      for (const auto& [name, image] : part.channels) {
        if (!first && !channels_.contains(name)) {
          refuse_layers(path);
        }
        check_size(image.pixels.size(), path);
        add_channel(how_to_join(name, path), image, samples, channels_[name]);
        ++known;
      }
    }
    if (known != channels_.size()) {
      refuse_layers(path);
    }
  }

  [[nodiscard]] ImageGray value(const std::string& name, const ImageGray& like) const {
    const Joined joined = how_to_join(name, "");
    const std::vector<double>& sums = channels_.at(name);
    ImageGray out = like;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const double divisor = joined == Joined::mean       ? weights_[i]
                             : joined == Joined::variance ? weights_[i] * weights_[i]
                                                          : 1.0;
      out.pixels[i] = static_cast<float>(sums[i] / divisor);
    }
    return out;
  }

  // The number of samples of every pixel; 0 where they differ.
  [[nodiscard]] double samples_per_pixel() const {
    const auto differs = [&](double weight) { return weight != weights_.front(); };
    return std::any_of(weights_.begin(), weights_.end(), differs) ? 0 : weights_.front();
  }

 private:
  static double weight(float samples) { return std::max(static_cast<double>(samples), kNoSamples); }

  void check_size(std::size_t pixels, const std::string& path) const {
    if (pixels != weights_.size()) {
      throw Error(ErrorKind::input, path, "has another size than the first of the pictures", "render them alike");
    }
  }
  static void refuse_layers(const std::string& path) {
    throw Error(ErrorKind::input, path, "has other layers than the first of the pictures",
                "render all with the same `aov`");
  }

  static void add_channel(Joined joined, const ImageGray& image, const std::vector<float>& samples,
                          std::vector<double>& sums) {
    const bool first = sums.empty();
    sums.resize(image.pixels.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const double value = static_cast<double>(image.pixels[i]);
      const double w = weight(samples[i]);
      switch (joined) {
        case Joined::mean:
          sums[i] += w * value;
          break;
        case Joined::variance:
          sums[i] += w * w * value;
          break;
        case Joined::sum:
          sums[i] += value;
          break;
        case Joined::first:
          sums[i] = first ? value : sums[i];
          break;
      }
    }
  }

  std::vector<double> weights_;
  std::map<std::string, std::vector<double>> channels_;
};

std::string text_of(const SeedSamples& seeds) {
  std::string text;
  for (const auto& [seed, samples] : seeds) {
    text += fmt::format("{}{}:{}", text.empty() ? "" : " ", seed, samples);
  }
  return text;
}

void describe_mean(const SeedSamples& seeds, double samples_per_pixel, const std::string& digest, Imf::Header& header) {
  header.erase("gazetrace:seed");
  header.erase("gazetrace:samples_per_pixel");
  add_text(header, kMeanOf, text_of(seeds));
  add_text(header, "settings_digest", digest);
  if (samples_per_pixel > 0) {
    add_text(header, "samples_per_pixel", fmt::format("{}", samples_per_pixel));
  }
}

bool is_lossy(Imf::Compression compression) {
  switch (compression) {
    case Imf::PXR24_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return true;
    default:
      return false;
  }
}

// Attributes of a part that are not the whole file's, as those of its Cryptomatte.
void copy_texts(const Imf::Header& from, ExrPicture& picture) {
  for (auto attribute = from.begin(); attribute != from.end(); ++attribute) {
    const std::string name = attribute.name();
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
    if (text != nullptr && name != "name" && name != "type") {
      picture.add_text(name, text->value());
    }
  }
}

}  // namespace

MeanStamp read_mean_stamp(const std::string& path) {
  MeanStamp stamp;
  try {
    const std::unique_ptr<ExrReader> file = open_exr(path, path);
    const Imf::Header& header = file->header(0);
    if (const auto* frame = header.findTypedAttribute<Imf::IntAttribute>("gazetrace:frame")) {
      stamp.frame = frame->value();
    }
    stamp.mean_digest = text_of(header, "mean_digest");
    stamp.seeds = seeds_of(header);
    stamp.is_mean = !text_of(header, kMeanOf).empty();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ErrorKind::input, path, std::string("cannot read the EXR: ") + e.what());
  }
  if (stamp.mean_digest.empty() || stamp.seeds.empty()) {
    throw Error(ErrorKind::input, path, "does not state the job or the seed of its samples",
                "render it by this version of gazetrace");
  }
  return stamp;
}

void check_mean(const MeanStamp& first, const std::string& first_path, const MeanStamp& other,
                const std::string& other_path) {
  if (first.mean_digest != other.mean_digest) {
    throw Error(ErrorKind::input, other_path, "was rendered with other settings than " + first_path,
                "take means of renders that differ in `seed` alone");
  }
  if (first.frame != other.frame) {
    throw Error(ErrorKind::input, other_path,
                fmt::format("is frame {}, and {} is frame {}", other.frame, first_path, first.frame),
                "name the pictures by their frames");
  }
  for (const auto& [seed, samples] : other.seeds) {
    if (first.seeds.contains(seed)) {
      throw Error(ErrorKind::input, other_path,
                  fmt::format("was rendered with seed {}, as {} was: they are the same samples", seed, first_path),
                  "render it with another `seed`");
    }
  }
}

WrittenMean write_mean_exr(const std::vector<std::string>& inputs, const std::string& path) {
  Render first = read_render(inputs.front());
  Sums sums;
  sums.add(first, inputs.front());
  SeedSamples seeds = first.seeds;
  for (std::size_t i = 1; i < inputs.size(); ++i) {
    const Render next = read_render(inputs[i]);
    sums.add(next, inputs[i]);
    seeds.insert(next.seeds.begin(), next.seeds.end());
  }
  Imf::Header header = first.parts.front().header;
  WrittenMean written;
  written.settings_digest = digest_settings({{"mean", text_of(header, "mean_digest")}, {"of", text_of(seeds)}});
  describe_mean(seeds, sums.samples_per_pixel(), written.settings_digest, header);
  header.compression() = is_lossy(header.compression()) ? Imf::ZIP_COMPRESSION : header.compression();
  ExrSettings settings;
  settings.parts = first.parts.size() > 1 ? ExrParts::multi : ExrParts::single;
  const ImageGray& like = first.samples;
  ExrPicture picture(like.width_px, like.height_px, settings, 1);
  picture.header() = header;
  for (const ExrLayers& part : first.parts) {
    picture.begin_layer(part.header.hasName() ? part.header.name() : "beauty");
    if (&part != &first.parts.front()) {
      copy_texts(part.header, picture);
    }
    for (const auto& [name, image] : part.channels) {
      picture.add_own(name, sums.value(name, like));
    }
  }
  const auto* frame = header.findTypedAttribute<Imf::IntAttribute>("gazetrace:frame");
  written.file = picture.write(path, frame == nullptr ? 0 : frame->value());
  return written;
}

}  // namespace gazetrace
