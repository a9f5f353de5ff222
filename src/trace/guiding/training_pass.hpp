// SPDX-License-Identifier: Apache-2.0
// The training paths of a frame, which find where its light arrives from.
#pragma once

#include "trace/guiding/guiding_field.hpp"
#include "trace/kernel/kernel.hpp"

namespace gazetrace {

// Paths are spread over the frame evenly, one for every eight pixels but no more than these, each with a scrambling of
// its own, so that the field depends on the view and the seed, and neither on the samples that the frame gets nor
// on the part of them that is traced. How good the field is follows from their number, whatever its size: with 65,536
// of them the variance of Sponza's hall falls to 0.48, with a quarter to 0.60, with four times as many to 0.46.
inline constexpr double kPixelsPerTrainingPath = 8, kMostTrainingPaths = 65536;
// The first few show whether a scene has anything to find; the others follow what these have found.
inline constexpr double kGlimpsePaths = 4096;

TrainedGuiding train_guiding(const FrameContext& context, Kernel kernel, int width_px, int height_px, int threads);

}  // namespace gazetrace
