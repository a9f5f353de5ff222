// SPDX-License-Identifier: Apache-2.0
// What pilots tell of a frame's noise: how large it would be at other rates, what the eye would see of it, and where
// samples take most of it away.
#pragma once

#include <cstddef>
#include <optional>

#include "gazetrace/visible_error.hpp"
#include "pipeline/pilot.hpp"

namespace gazetrace {

class VisibleNoise {
 public:
  // Keeps references, which must outlive it.
  VisibleNoise(const FrameRequest& request, const FrameSettings& settings);

  // The noise at other rates is that of the latest pilot, as if its squared error fell with 1 / n. Its spectrum is that
  // of the difference of the two latest: a filter correlates the noise of neighbouring pixels, those of a pilot as
  // those of the frame. After a single pilot it is taken to be white.
  void learn(Pilot pilot);
  [[nodiscard]] const Pilot& pilot() const { return *pilot_; }

  // Relative rates that leave the least of what is pooled. Relative squared error is least, for a given number of
  // samples, with n ~ e / sqrt(L^2 + epsilon), where e^2 is the squared error times n (Neyman's allocation); for
  // visible error see visible_allocation(). e^2 is pooled over neighbours; see pooled().
  [[nodiscard]] ImageGray wanted_for_relmse() const;
  [[nodiscard]] ImageGray wanted_by_eye() const;  // where is_seen(); otherwise as for relmse

  [[nodiscard]] double relmse_at(const ImageGray& rates) const;
  // Whether the frame is large enough for the model of what the eye sees.
  [[nodiscard]] bool is_seen() const { return model_.has_value(); }
  [[nodiscard]] double q_at(const ImageGray& rates) const;  // VisibleFrame::q
  // JOD of a clip of such frames, and back.
  static double jod_of(double q);
  static double q_of(double jod);

 private:
  // L^2 + epsilon, by which squared errors become relative. L is the pooled luminance: a pixel's own is as large as its
  // fireflies are, and would hide them.
  [[nodiscard]] double unit_at(std::size_t pixel) const;
  [[nodiscard]] ImageGray relative_squared_error() const;  // of one sample, pooled
  [[nodiscard]] ErrorComponent error_at(const ImageGray& rates) const;
  [[nodiscard]] VisiblePicture picture() const;

  const FrameRequest& request_;
  const FrameSettings& settings_;
  std::optional<VisibleErrorModel> model_;
  std::optional<Pilot> pilot_;
  ImageGray level_;
  DisplayCurve display_;
  ErrorSpectrum spectrum_ = white_error();
};

}  // namespace gazetrace
