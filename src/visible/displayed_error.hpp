// SPDX-License-Identifier: Apache-2.0
// A picture and its errors as a display shows them.
#pragma once

#include <vector>

#include "gazetrace/visible_error.hpp"

namespace gazetrace {

struct DisplayedError {
  ImageGray luminance;              // cd/m2
  std::vector<ImageGray> variance;  // of each component, (cd/m2)^2
  ImageGray slope;                  // cd/m2 per unit of the scene's luminance, for errors of this size
};

// `least_contrast`: every pixel has at least this error, relative to the display's luminance and of the first
// component's kind, so that sensitivities can be told where there is no error. 0: none is added.
DisplayedError displayed_error(const VisiblePicture& picture, const std::vector<ErrorComponent>& errors,
                               float least_contrast, int threads);

}  // namespace gazetrace
