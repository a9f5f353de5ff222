// SPDX-License-Identifier: Apache-2.0
// The model of the header, band by band. Names of terms are those of the header.
#include "gazetrace/visible_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/fast_math.hpp"
#include "core/parallel.hpp"
#include "core/statistics.hpp"
#include "gazetrace/error.hpp"
#include "metrics/band_sensitivity.hpp"
#include "metrics/pyramid.hpp"
#include "visible/channel_gain.hpp"
#include "visible/displayed_error.hpp"
#include "visible/gaze_angles.hpp"
#include "visible/masked_moment.hpp"
#include "visible/pyramid_rows.hpp"
#include "visible/variance_pyramid.hpp"

namespace gazetrace {
namespace {

constexpr float kMostContrast = 1000;

// A band of the frame's pyramid, and the level of the given picture's pyramid at which it is computed.
struct Band {
  BandGeometry geometry;
  std::size_t level = 0;
  bool has_contrast = true;  // the picture is fine enough to hold this band's contrast
  // Of white noise, for its variance at each place relative to the spectrum's gain: it is larger at borders, where the
  // pyramid mirrors pixels, and differs between even and odd ones. Empty where there is no contrast.
  NoiseSums along_x, along_y;
  float white_gain = 1;

  [[nodiscard]] float relative_noise(std::size_t x, std::size_t y) const {
    return along_x.kk.empty() ? 1.0F : std::max(noise_variance(along_x, along_y, x, y), 0.0F) / white_gain;
  }
};

// a_bc of both channels at the band's resolution, and v_b.
struct BandMoments {
  ImageGray sustained, transient, variance;
};

// What the picture shows at the resolution of a band.
struct BandPicture {
  ImageGray background;  // L_b, cd/m2
  ImageGray contrast;    // before gain and sensitivity; empty: not known, taken as 0
};

// A component's variances at one level, and what the band and the channels make of them.
struct BandError {
  const ImageGray* variance = nullptr;
  float spectrum_gain = 0;
  float picture_gain = 0;  // of what the given picture holds of it
  std::array<float, 2> channel_gain{};
};

BandPicture band_picture(const Band& band, const ImageGray& fine, const ImageGray& coarse, int threads) {
  BandPicture picture;
  picture.background = fine;
  if (band.has_contrast) {
    picture.contrast = ImageGray(fine.width_px, fine.height_px);
  }
  parallel_for(static_cast<std::size_t>(fine.height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const auto width = static_cast<std::size_t>(fine.width_px);
    float* background = &picture.background(0, y);
    std::vector<float> blurred(width);
    if (band.has_contrast) {
      std::vector<float> scratch;
      doubled_row(coarse, y, fine.width_px, scratch, blurred.data());
      std::copy(blurred.begin(), blurred.end(), background);
    }
    for (std::size_t x = 0; x < width; ++x) {
      background[x] = std::max(background[x], kLeastBackground);
    }
    if (band.has_contrast) {
      float* contrast = &picture.contrast(0, y);
      for (std::size_t x = 0; x < width; ++x) {
        contrast[x] = std::min((fine(static_cast<int>(x), y) - blurred[x]) / background[x], kMostContrast);
      }
    }
  });
  return picture;
}

// Takes from the contrast what its own error explains: times the root of (P - 1.5 N) / P, where P is the mean squared
// contrast and N that of the error, both over 5 x 5 pixels. These hold about eight independent values, so that the mean
// square of noise alone is above 1.5 times its expectation once in six: what is left of it would mask.
void take_off_error(ImageGray& contrast, const ImageGray& noise, int threads) {
  constexpr int kReach = 2;
  constexpr float kMargin = 1.5F;
  ImageGray cleaned = contrast;
  parallel_for(static_cast<std::size_t>(contrast.height_px), threads, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const auto width = static_cast<std::size_t>(contrast.width_px);
    std::vector<float> power(width);
    std::vector<float> explained(width);
    for (int j = std::max(y - kReach, 0); j <= std::min(y + kReach, contrast.height_px - 1); ++j) {
      const float* c = &contrast.pixels[contrast.index(0, j)];
      const float* n = &noise.pixels[noise.index(0, j)];
      for (std::size_t x = 0; x < width; ++x) {
        power[x] += c[x] * c[x];
        explained[x] += kMargin * n[x];
      }
    }
    for (int x = 0; x < contrast.width_px; ++x) {
      float p = 0;
      float e = 0;
      for (int i = std::max(x - kReach, 0); i <= std::min(x + kReach, contrast.width_px - 1); ++i) {
        p += power[static_cast<std::size_t>(i)];
        e += explained[static_cast<std::size_t>(i)];
      }
      cleaned(x, y) *= p > e ? std::sqrt((p - e) / p) : 0.0F;
    }
  });
  contrast = std::move(cleaned);
}

ImageGray contrast_noise(const Band& band, const std::vector<BandError>& errors, const ImageGray& background,
                         int threads) {
  ImageGray noise(background.width_px, background.height_px);
  parallel_for(static_cast<std::size_t>(noise.height_px), threads, [&](std::size_t row) {
    for (std::size_t x = 0; x < static_cast<std::size_t>(noise.width_px); ++x) {
      const std::size_t i = row * static_cast<std::size_t>(noise.width_px) + x;
      float variance = 0;
      for (const BandError& error : errors) {
        variance += error.picture_gain * error.variance->pixels[i];
      }
      noise.pixels[i] = band.relative_noise(x, row) * variance / (background.pixels[i] * background.pixels[i]);
    }
  });
  return noise;
}

}  // namespace

struct VisibleErrorModel::Impl {
  VisibleErrorSettings settings;
  FovVideoVdpGeometry geometry;
  int width_px, height_px;  // of the pictures
  std::vector<double> frequencies_cpd;
  std::vector<Band> bands;

  explicit Impl(const VisibleErrorSettings& given)
      : settings(given),
        geometry(fovvideovdp_geometry(given.view)),
        width_px((given.view.width_px + given.cell_px - 1) / given.cell_px),
        height_px((given.view.height_px + given.cell_px - 1) / given.cell_px),
        frequencies_cpd(
            fovvideovdp_bands_cpd(geometry.pixels_per_degree(), given.view.width_px, given.view.height_px)) {
    channel_gains(settings.frames_per_second, 0, {});  // throws for a frame rate that cannot be
    const auto cell_levels = static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(settings.cell_px)));
    int w = width_px;
    int h = height_px;
    const std::vector<LevelRows> columns = pyramid_rows(given.view.height_px, frequencies_cpd.size());
    // The metric treats the right border as if the width had the height's parity.
    std::vector<bool> odd_rule;
    for (const LevelRows& level : columns) {
      odd_rule.push_back(level.level.size() % 2 == 1);
    }
    const std::vector<LevelRows> rows = pyramid_rows(given.view.width_px, frequencies_cpd.size(), odd_rule);
    const ErrorSpectrum white = white_error();
    for (std::size_t b = 0; b < frequencies_cpd.size(); ++b) {
      Band band;
      band.has_contrast = b >= cell_levels;
      band.level = band.has_contrast ? b - cell_levels : 0;
      band.geometry = band_geometry(geometry, true, frequencies_cpd[b], w, h, settings.threads);
      if (band.has_contrast) {
        band.along_x = noise_sums(rows[b]);
        band.along_y = noise_sums(columns[b]);
        band.white_gain = static_cast<float>(white.gain[b]);
      }
      bands.push_back(std::move(band));
      if (b >= cell_levels) {
        w = (w + 1) / 2;
        h = (h + 1) / 2;
      }
    }
  }

  void check_sizes(const VisiblePicture& picture, const std::vector<ErrorComponent>& errors) const {
    const auto check = [&](const ImageGray& image) {
      if (image.width_px != width_px || image.height_px != height_px) {
        throw Error(
            ErrorKind::usage, "visible error",
            fmt::format("a picture has {}x{} pixels, not {}x{}", image.width_px, image.height_px, width_px, height_px));
      }
    };
    check(picture.luminance);
    for (const ErrorComponent& error : errors) {
      check(error.squared_error);
    }
  }

  [[nodiscard]] std::optional<Vec2f> gaze_deg(const VisiblePicture& picture) const {
    if (!picture.gaze_direction) {
      return std::nullopt;
    }
    return metric_gaze_deg(settings.view, geometry, *picture.gaze_direction);
  }

  [[nodiscard]] BandMoments moments_of(std::size_t b, const BandPicture& picture, const std::vector<BandError>& errors,
                                       float standing_transient, const std::optional<Vec2f>& gaze) const {
    const int width = picture.background.width_px;
    const int height = picture.background.height_px;
    const float gain = band_contrast_gain(b);
    const bool has_transient = settings.frames_per_second > 0;
    const MaskedMoments& sustained = MaskedMoments::sustained();
    const MaskedMoments& transient = MaskedMoments::transient();
    BandMoments moments;
    moments.sustained = ImageGray(width, height);
    moments.variance = moments.sustained;
    moments.transient = has_transient ? moments.sustained : ImageGray{};
    parallel_for(static_cast<std::size_t>(height), settings.threads, [&](std::size_t row) {
      const int y = static_cast<int>(row);
      const std::size_t from = picture.background.index(0, y);
      const std::vector<float> background(&picture.background.pixels[from], &picture.background.pixels[from] + width);
      std::vector<float> sensitivity_sustained;
      std::vector<float> sensitivity_transient;
      band_sensitivity(bands[b].geometry, gaze, y, background, sensitivity_sustained, sensitivity_transient);
      for (std::size_t x = 0; x < background.size(); ++x) {
        const std::size_t i = from + x;
        float variance_sustained = 0;
        float variance_transient = 0;
        const float place = bands[b].relative_noise(x, row);
        for (const BandError& error : errors) {
          const float variance = place * error.variance->pixels[i];
          moments.variance.pixels[i] += error.variance->pixels[i];
          variance_sustained += error.spectrum_gain * error.channel_gain[0] * variance;
          variance_transient += error.spectrum_gain * error.channel_gain[1] * variance;
        }
        const float contrast = picture.contrast.empty() ? 0.0F : picture.contrast.pixels[i];
        const float s = gain * sensitivity_sustained[x];
        moments.sustained.pixels[i] = sustained(s * contrast, s * std::sqrt(variance_sustained) / background[x]);
        if (has_transient) {
          const float t = gain * sensitivity_transient[x];
          moments.transient.pixels[i] =
              transient(t * standing_transient * contrast, t * std::sqrt(variance_transient) / background[x]);
        }
      }
    });
    return moments;
  }

  [[nodiscard]] std::vector<BandMoments> all_moments(const VisiblePicture& picture,
                                                     const std::vector<ErrorComponent>& errors,
                                                     const DisplayedError& shown) const {
    const int threads = settings.threads;
    const std::optional<Vec2f> gaze = gaze_deg(picture);
    std::vector<ChannelGains> channels;
    for (const ErrorComponent& error : errors) {
      channels.push_back(channel_gains(settings.frames_per_second, error.correlation, picture.frames_before));
    }
    const auto standing = static_cast<float>(channel_gains(settings.frames_per_second, 1, {}).standing[1]);
    std::vector<BandMoments> all;
    ImageGray luminance = shown.luminance;
    std::vector<ImageGray> variances = shown.variance;
    for (std::size_t b = 0; b < bands.size(); ++b) {
      const ImageGray coarse = bands[b].has_contrast ? halved(luminance, true, threads) : ImageGray{};
      BandPicture seen = band_picture(bands[b], luminance, coarse, threads);
      std::vector<BandError> band_errors;
      for (std::size_t k = 0; k < errors.size(); ++k) {
        band_errors.push_back(
            {&variances[k],
             static_cast<float>(errors[k].spectrum.gain[b]),
             static_cast<float>(errors[k].spectrum.gain[bands[b].level]),
             {static_cast<float>(channels[k].variance[0]), static_cast<float>(channels[k].variance[1])}});
      }
      if (picture.holds_the_error && !seen.contrast.empty()) {
        take_off_error(seen.contrast, contrast_noise(bands[b], band_errors, seen.background, threads), threads);
      }
      all.push_back(moments_of(b, seen, band_errors, standing, gaze));
      if (bands[b].has_contrast) {
        luminance = coarse;
        for (ImageGray& variance : variances) {
          variance = halved_variance(variance, threads);
        }
      }
    }
    return all;
  }

  // Q of the bands and of the frame.
  [[nodiscard]] VisibleFrame pooled(const std::vector<BandMoments>& moments) const {
    VisibleFrame frame;
    for (const BandMoments& band : moments) {
      frame.sustained.push_back(std::pow(mean_of(band.sustained), 1 / kPoolSpace));
      if (!band.transient.empty()) {
        frame.transient.push_back(std::pow(mean_of(band.transient), 1 / kPoolSpace));
      }
    }
    frame.q = pooled_over_bands(frame.sustained, frame.transient);
    return frame;
  }

  // The moments times r dQ / dA, summed over channels: Q is a homogeneous function of the means A, of degree 1 / r, so
  // that the sum over all bands of the means of these is Q itself.
  [[nodiscard]] std::vector<ImageGray> shares(const std::vector<BandMoments>& moments,
                                              const VisibleFrame& frame) const {
    const double sustained = std::accumulate(frame.sustained.begin(), frame.sustained.end(), 0.0);
    const double transient = kTransientWeight * std::accumulate(frame.transient.begin(), frame.transient.end(), 0.0);
    const auto of_channel = [&](double channel) {
      return channel > 0 ? std::pow(frame.q / channel, 1 - kPoolChannels) : 0.0;
    };
    const auto of_band = [](double band_q) { return band_q > 0 ? std::pow(band_q, 1 - kPoolSpace) : 0.0; };
    std::vector<ImageGray> all;
    for (std::size_t b = 0; b < moments.size(); ++b) {
      ImageGray share = moments[b].sustained;
      const auto s = static_cast<float>(of_channel(sustained) * of_band(frame.sustained[b]));
      const bool has_transient = !moments[b].transient.empty();
      const auto t = has_transient
                         ? static_cast<float>(kTransientWeight * of_channel(transient) * of_band(frame.transient[b]))
                         : 0.0F;
      for (std::size_t i = 0; i < share.pixels.size(); ++i) {
        share.pixels[i] = s * share.pixels[i] + (has_transient ? t * moments[b].transient.pixels[i] : 0.0F);
      }
      all.push_back(std::move(share));
    }
    return all;
  }

  // Brings maps of all bands to the picture's resolution and adds them up.
  [[nodiscard]] ImageGray collapsed(std::vector<ImageGray> maps) const {
    ImageGray sum = std::move(maps.back());
    for (std::size_t b = maps.size() - 1; b-- > 0;) {
      if (bands[b].level != bands[b + 1].level) {
        sum = doubled(sum, maps[b].width_px, maps[b].height_px, settings.threads);
      }
      std::transform(sum.pixels.begin(), sum.pixels.end(), maps[b].pixels.begin(), sum.pixels.begin(), std::plus<>());
    }
    return sum;
  }
};

VisibleErrorModel::VisibleErrorModel(const VisibleErrorSettings& settings) {
  constexpr int kLeastSide = 8;
  const PlanarView& view = settings.view;
  if (std::min(view.width_px, view.height_px) < kLeastSide) {
    throw Error(ErrorKind::usage, "visible error",
                fmt::format("{}x{} pixels are too few", view.width_px, view.height_px),
                "frames of at least 8x8 pixels are needed");
  }
  if (settings.cell_px < 1 || !std::has_single_bit(static_cast<unsigned>(settings.cell_px))) {
    throw Error(ErrorKind::usage, "visible error",
                fmt::format("cells of {} pixels: not a power of two", settings.cell_px));
  }
  impl_ = std::make_unique<Impl>(settings);
}
VisibleErrorModel::~VisibleErrorModel() = default;
VisibleErrorModel::VisibleErrorModel(VisibleErrorModel&&) noexcept = default;
VisibleErrorModel& VisibleErrorModel::operator=(VisibleErrorModel&&) noexcept = default;

int VisibleErrorModel::width_px() const {
  return impl_->width_px;
}
int VisibleErrorModel::height_px() const {
  return impl_->height_px;
}
const std::vector<double>& VisibleErrorModel::band_frequencies_cpd() const {
  return impl_->frequencies_cpd;
}

VisibleFrame VisibleErrorModel::predict(const VisiblePicture& picture, const std::vector<ErrorComponent>& errors,
                                        bool want_density) const {
  impl_->check_sizes(picture, errors);
  const DisplayedError shown = displayed_error(picture, errors, 0, impl_->settings.threads);
  const std::vector<BandMoments> moments = impl_->all_moments(picture, errors, shown);
  VisibleFrame frame = impl_->pooled(moments);
  if (want_density) {
    frame.density = impl_->collapsed(impl_->shares(moments, frame));
    // Interpolation between pixels of coarse bands keeps means up to what happens at the borders.
    const double mean = mean_of(frame.density);
    const auto scale = static_cast<float>(mean > 0 ? frame.q / mean : 0);
    for (float& value : frame.density.pixels) {
      value *= scale;
    }
  }
  return frame;
}

ImageGray VisibleErrorModel::weights(const VisiblePicture& picture, const std::vector<ErrorComponent>& errors) const {
  constexpr float kInvisible = 1e-4F;    // a contrast that changes no score
  constexpr float kAssumedError = 0.1F;  // relative
  constexpr float kLeastWeight = 1e-4F;  // of the mean
  impl_->check_sizes(picture, errors);
  std::vector<ErrorComponent> known = errors;
  VisiblePicture seen = picture;
  if (known.empty()) {
    seen.holds_the_error = false;
    known.push_back({picture.luminance});
    for (float& value : known.front().squared_error.pixels) {
      value *= kAssumedError * kAssumedError * value;
    }
  }
  const DisplayedError shown = displayed_error(seen, known, kInvisible, impl_->settings.threads);
  const std::vector<BandMoments> moments = impl_->all_moments(seen, known, shown);
  std::vector<ImageGray> maps = impl_->shares(moments, impl_->pooled(moments));
  constexpr auto kExponent = static_cast<float>(kVisiblePooling);
  for (std::size_t b = 0; b < maps.size(); ++b) {
    for (std::size_t i = 0; i < maps[b].pixels.size(); ++i) {
      maps[b].pixels[i] /= pow_fast(moments[b].variance.pixels[i], kExponent / 2);
    }
  }
  ImageGray weights = impl_->collapsed(std::move(maps));
  for (std::size_t i = 0; i < weights.pixels.size(); ++i) {
    weights.pixels[i] = pow_fast(weights.pixels[i], 1 / kExponent) * shown.slope.pixels[i];
  }
  const float least = kLeastWeight * static_cast<float>(mean_of(weights));
  for (float& value : weights.pixels) {
    value = std::max(value, least);
  }
  return weights;
}

double visible_jod(const std::vector<double>& q_of_frames) {
  const double sum = std::accumulate(q_of_frames.begin(), q_of_frames.end(), 0.0);
  return fovvideovdp_jod(sum / static_cast<double>(q_of_frames.size()));
}

}  // namespace gazetrace
