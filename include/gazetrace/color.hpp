// SPDX-License-Identifier: Apache-2.0
// Exposure, and the viewing transform from linear Rec.709 radiance to display code values by OpenColorIO.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

enum class ExposureMode { fixed, log_average };

struct ExposureSettings {
  ExposureMode mode = ExposureMode::fixed;
  double ev = 0;      // stops; fixed: the exposure; log_average: added to the measured exposure
  double key = 0.18;  // log_average: the luminance that the log-average is brought to (Reinhard 2002, eq. 1-2)
};

// The exposure of a frame in stops. The log-average is taken over the means of blocks of at least 16 x 16 pixels, since
// over the pixels of a noisy frame it would be biased low.
double choose_exposure_ev(const ImageRgb& radiance, const ExposureSettings& settings);

struct ColorSettings {
  std::string config;     // OCIO config file; empty: that of $OCIO; neither: the built-in one
  std::string input;      // name of linear Rec.709 in a config without aces_interchange
  std::string display;    // empty: the config's default
  std::string view;       // empty: the display's default
  std::string look;       // empty: those of the view
  bool is_needed = true;  // false: no picture goes through the view, which the run record names all the same
};

struct ViewInfo {
  std::string display, view;
  bool is_default = false;
};

struct DisplayImage {
  int width_px = 0, height_px = 0;
  int bits = 8;                     // 8 or 16
  std::vector<std::uint8_t> bytes;  // interleaved RGB, row after row; 16 bits in the machine's byte order
};

class ColorPipeline {
 public:
  // Error(usage) for an unknown display, view or look (with the known ones), Error(input) for a config that cannot be
  // read or that offers no way in from linear Rec.709. The built-in view takes the place of a config for a newer
  // OpenColorIO, and of one that cannot be read and is not needed; warnings() says so.
  explicit ColorPipeline(const ColorSettings& settings);
  ~ColorPipeline();
  ColorPipeline(ColorPipeline&&) noexcept;
  ColorPipeline& operator=(ColorPipeline&&) noexcept;
  ColorPipeline(const ColorPipeline&) = delete;
  ColorPipeline& operator=(const ColorPipeline&) = delete;

  // Takes radiance * 2^ev through the view. Values are first clamped to 0..1e6 (OpenColorIO's ACES returns black above
  // about 1e20); `clamped_pixels`, where not null, receives the number of clamped pixels. `bits` is 8 or 16. May be
  // called from several threads at once.
  [[nodiscard]] DisplayImage apply(const ImageRgb& radiance, double ev, int bits, int threads = 0,
                                   std::uint64_t* clamped_pixels = nullptr) const;

  // Bakes the table now if apply() will need it for frames of this size (0.8 s of CPU, once), so that it is not part of
  // a frame's measured time. Changes no result.
  void prepare(int width_px, int height_px, int bits, int threads = 0) const;

  [[nodiscard]] const std::vector<ViewInfo>& views() const;
  [[nodiscard]] const Warnings& warnings() const;
  [[nodiscard]] std::string description() const;  // such as "built-in: display sRGB, view ..."

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gazetrace
