// SPDX-License-Identifier: Apache-2.0
// Makes the list of a tile's samples from the map, a batch at a time, so that no ray is generated only to be discarded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "gazetrace/foveation.hpp"
#include "gazetrace/sample_sums.hpp"
#include "trace/kernel/path_batch.hpp"
#include "trace/samples/pixel_filter.hpp"

namespace gazetrace {

inline constexpr SampleRange kAllSamples{0, std::numeric_limits<std::uint32_t>::max()};

// Goes through the sites [first, first + count) of a map in order, and through those of each site's samples 0, 1, 2,
// ... that are in `range`. Neighbouring entries are neighbours in the picture, so that packets of 16 rays are coherent.
class SampleList {
 public:
  SampleList(const SamplingMap& map, std::uint32_t first_site, std::uint32_t site_count, std::uint64_t seed,
             std::int32_t frame, const SampleRange& range = kAllSamples, bool halves = false)
      : map_(&map),
        site_(first_site),
        end_(first_site + site_count),
        range_(range),
        sample_(range.begin),
        seed_(seed),
        frame_(frame),
        halves_(halves) {}

  // Fills in up to kBatchSize samples and returns their number, which is 0 at the end.
  int next(const PixelFilterSampler& filter, SampleBatch& out);

 private:
  const SamplingMap* map_;
  std::uint32_t site_, end_;
  SampleRange range_;
  std::uint32_t sample_;
  std::uint64_t seed_;
  std::int32_t frame_;
  bool halves_;  // as TraceSettings::halves
  std::vector<PixelIndex> pixels_;
};

}  // namespace gazetrace
