// SPDX-License-Identifier: Apache-2.0
// What FovVideoVDP's temporal channels make of an error.
#pragma once

#include <array>
#include <optional>

namespace gazetrace {

// Of a channel's two filters, sustained first: the transient one is 0 for stills.
struct ChannelGains {
  // The variance of the channel over the variance of a frame, for errors whose correlation over n frames is
  // correlation^n: the sum over i, j of F_i F_j correlation^|i - j|.
  std::array<double, 2> variance{1, 0};
  // What stands still comes through times this: the absolute sum of the filter.
  std::array<double, 2> standing{1, 0};
};
// `frames_before`: see VisiblePicture; frames before the first one are taken to equal it. Error(usage) for frame rates
// that temporal_filters() refuses, and for a correlation outside 0..1.
ChannelGains channel_gains(double frames_per_second, double correlation, std::optional<int> frames_before);

}  // namespace gazetrace
