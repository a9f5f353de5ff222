// SPDX-License-Identifier: Apache-2.0
// What the past was off by, from frame to frame: whether it is noise or a bias that lasts.
#pragma once

#include "gazetrace/image.hpp"
#include "gazetrace/motion.hpp"
#include "gazetrace/temporal.hpp"

namespace gazetrace {

// How far the past was off from two frames running, at full rate: noise differs from one to the other, the blur of
// resampled texture does not.
struct Residuals {
  const ImageGray& now;
  const ImageGray& before;  // luminance of past - frame; 0: not known
  const ImageGray& noise;   // variance of the frame, as its samples tell; in truth well-spread samples have less

  // A squared bias b^2, beside a variance v of one sample, makes n samples worth n / (1 + n b^2 / v); less where the
  // bias is far above the noise. The pixel itself has no say: what is kept must not depend on whether it came out
  // bright. `count` and `past_count` are the samples of the frame and of the past at the pixel. All is kept of a past
  // beside a frame of one sample or less, which does not know its own noise.
  [[nodiscard]] double share_kept(const SurfaceMotion& motion, double count, double past_count, int x, int y) const;
};

}  // namespace gazetrace
