// SPDX-License-Identifier: Apache-2.0
// What pilots tell of a frame's noise: how large it would be at other rates, what the eye would see of it, and where
// samples take most of it away.
#pragma once

#include <cstddef>
#include <optional>

#include "gazetrace/visible_error.hpp"
#include "pipeline/quality/pilot.hpp"

namespace gazetrace {

// The mean over 5 x 5 pixels, where a single value that is more than half of the sum counts as at most kMostOfOthers
// times the mean of the others. So one firefly raises its surroundings by less than they hold already, and a place with
// several keeps them. By a plain mean, rates would follow chance, and the picture would flicker with them. What is
// negative counts as 0. What is not finite is not known and is left out; 0 where nothing else is near.
inline constexpr double kMostOfOthers = 16;
ImageGray pooled(const ImageGray& values, int threads = 0);

class VisibleNoise {
 public:
  // Keeps references, which must outlive it.
  VisibleNoise(const FrameRequest& request, const FrameSettings& settings);

  // The noise at other rates is that of the latest pilot, as if its squared error fell with 1 / n. Its spectrum is that
  // of the difference of the two latest: a filter correlates the noise of neighbouring pixels, those of a pilot as
  // those of the frame. After a single pilot it is taken to be white.
  void learn(Pilot pilot);
  [[nodiscard]] const Pilot& pilot() const { return *pilot_; }

  // Relative rates. The sum of relative squared errors is least, for a given number of samples, with
  // n ~ e / sqrt(L^2 + epsilon), where e^2 is the squared error times n (Neyman's allocation). e^2 is pooled over
  // neighbours; see pooled().
  [[nodiscard]] ImageGray wanted_for_relmse() const;
  // With gaze, the same times the root of the eye's weight of a relative error. The best rates of the model itself
  // (visible_allocation()) and the whole weight were tried and are no better than uniform frames: the model takes noise
  // to be normally distributed, and fireflies in places that it calls dull are seen. JOD of a still at 8 samples a
  // pixel, 320 x 180 on the display "paper", gaze in the middle, San Miguel / courtyard, filter guided:
  //   uniform 6.71 / 7.42    no weight 6.90 / 7.56    root 6.89 / 7.56    whole 6.64 / 7.42
  [[nodiscard]] ImageGray wanted_by_eye() const;

  [[nodiscard]] double relmse_at(const ImageGray& rates) const;

 private:
  // L^2 + epsilon, by which squared errors become relative. L is the pooled luminance: a pixel's own is as large as its
  // fireflies are, and would hide them.
  [[nodiscard]] double unit_at(std::size_t pixel) const;
  // The relative squared error of one sample. Light near the end of float's range has no finite square: of such a pixel
  // nothing is known, and the value is NaN.
  [[nodiscard]] double relative_error_of_one(std::size_t pixel) const;
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
