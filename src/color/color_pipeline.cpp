// SPDX-License-Identifier: Apache-2.0
// Applies exposure and clamping, and runs the viewing transform on several threads.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <mutex>

#include "color/baked_view.hpp"
#include "color/ocio.hpp"
#include "core/parallel.hpp"
#include "gazetrace/color.hpp"

namespace gazetrace {
namespace {

// Pixels that are handled at once; few enough that a band's floats stay in the L2 cache.
constexpr std::size_t kBandPixels = 8192;
constexpr float kMaxScene = 1e6F;

// radiance * scale, clamped to 0..kMaxScene, as interleaved RGB; NaN becomes 0. Returns how many pixels were clamped.
std::uint64_t expose(const Vec3f* radiance, std::size_t count, float scale, float* rgb) {
  const auto limit = [](float value) {
    const float low = value > 0 ? value : 0.0F;
    return low < kMaxScene ? low : kMaxScene;
  };
  std::uint64_t clamped = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f value = radiance[i] * scale;
    const Vec3f limited{limit(value.x), limit(value.y), limit(value.z)};
    clamped += value == limited ? 0U : 1U;
    rgb[3 * i] = limited.x;
    rgb[3 * i + 1] = limited.y;
    rgb[3 * i + 2] = limited.z;
  }
  return clamped;
}

}  // namespace

struct ColorPipeline::Impl {
  explicit Impl(const ColorSettings& settings) : view(settings) {}

  // OpenColorIO's own arithmetic takes about 240 ms of CPU per megapixel for ACES; a table, for the pixels where it is
  // within half a code value of that, 20 to 70 ms. Depends only on settings and frame size, so that a frame is the same
  // wherever in a sequence it is rendered.
  [[nodiscard]] bool wants_table(std::size_t pixels, int bits) const {
    constexpr std::size_t kMinPixels = 250'000;  // below, baking takes longer than it saves in most jobs
    return bits == 8 && view.is_builtin_aces() && pixels >= kMinPixels;
  }
  const BakedView& table(int threads) {
    std::call_once(baked_once, [&] { baked = std::make_unique<BakedView>(view, threads); });
    return *baked;
  }

  OcioView view;
  std::once_flag baked_once;
  std::unique_ptr<BakedView> baked;
};

ColorPipeline::ColorPipeline(const ColorSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
ColorPipeline::~ColorPipeline() = default;
ColorPipeline::ColorPipeline(ColorPipeline&&) noexcept = default;
ColorPipeline& ColorPipeline::operator=(ColorPipeline&&) noexcept = default;

DisplayImage ColorPipeline::apply(const ImageRgb& radiance, double ev, int bits, int threads,
                                  std::uint64_t* clamped_pixels) const {
  if (bits != 8 && bits != 16) {
    throw Error(ErrorKind::usage, "", "a display image has 8 or 16 bits a channel, not " + std::to_string(bits));
  }
  DisplayImage image;
  image.width_px = radiance.width_px;
  image.height_px = radiance.height_px;
  image.bits = bits;
  const std::size_t bytes_per_pixel = static_cast<std::size_t>(bits) / 8 * 3;
  const std::size_t pixels = radiance.pixels.size();
  image.bytes.resize(pixels * bytes_per_pixel);

  const BakedView* table = impl_->wants_table(pixels, bits) ? &impl_->table(threads) : nullptr;
  const auto scale = static_cast<float>(std::exp2(ev));
  std::atomic<std::uint64_t> clamped{0};
  parallel_for((pixels + kBandPixels - 1) / kBandPixels, threads, [&](std::size_t band) {
    const std::size_t first = band * kBandPixels;
    const std::size_t count = std::min(kBandPixels, pixels - first);
    std::vector<float> rgb(3 * count);
    clamped += expose(&radiance.pixels[first], count, scale, rgb.data());
    std::uint8_t* out = &image.bytes[first * bytes_per_pixel];
    if (table != nullptr) {
      table->apply_8(rgb.data(), count, out);
    } else if (bits == 8) {
      impl_->view.apply_8(rgb.data(), count, out);
    } else {
      std::vector<std::uint16_t> wide(3 * count);
      impl_->view.apply_16(rgb.data(), count, wide.data());
      std::copy_n(reinterpret_cast<const std::uint8_t*>(wide.data()), 2 * wide.size(), out);
    }
  });
  if (clamped_pixels != nullptr) {
    *clamped_pixels = clamped;
  }
  return image;
}

void ColorPipeline::prepare(int width_px, int height_px, int bits, int threads) const {
  if (impl_->wants_table(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), bits)) {
    impl_->table(threads);
  }
}

const std::vector<ViewInfo>& ColorPipeline::views() const {
  return impl_->view.views();
}
const Warnings& ColorPipeline::warnings() const {
  return impl_->view.warnings();
}
std::string ColorPipeline::description() const {
  return impl_->view.description();
}

}  // namespace gazetrace
