// SPDX-License-Identifier: Apache-2.0
// The explicit list of a tile's samples, made from the map a batch at a time: no ray is generated to be thrown away.
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

// Walks the sites [first, first + count) of a map in order, each with those of its samples 0, 1, 2, ... that are in
// `range`: neighbouring entries are neighbours in the picture, so that packets of 16 are coherent.
class SampleList {
 public:
  SampleList(const SamplingMap& map, std::uint32_t first_site, std::uint32_t site_count, std::uint64_t seed,
             std::int32_t frame, const SampleRange& range = kAllSamples)
      : map_(&map),
        site_(first_site),
        end_(first_site + site_count),
        range_(range),
        sample_(range.begin),
        seed_(seed),
        frame_(frame) {}

  // Fills up to kBatchSize samples and returns how many; 0 at the end.
  int next(const PixelFilterSampler& filter, SampleBatch& out);

 private:
  const SamplingMap* map_;
  std::uint32_t site_, end_;
  SampleRange range_;
  std::uint32_t sample_;
  std::uint64_t seed_;
  std::int32_t frame_;
  std::vector<PixelIndex> pixels_;
};

}  // namespace gazetrace
