// SPDX-License-Identifier: Apache-2.0
// Makes the list of a tile's samples from the map, a batch at a time, so that no ray is generated only to be discarded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gazetrace/foveation.hpp"
#include "trace/kernel/path_batch.hpp"
#include "trace/samples/pixel_filter.hpp"

namespace gazetrace {

// Goes through the sites [first, first + count) of a map in order, and through the samples of each. Neighbouring
// entries are neighbours in the picture, so that packets of 16 rays are coherent. Each site has a sequence of random
// numbers of its own.
class SampleList {
 public:
  SampleList(const SamplingMap& map, std::uint32_t first_site, std::uint32_t site_count, std::uint64_t seed,
             std::int32_t frame, bool halves = false, bool independent_halves = true)
      : map_(&map),
        site_(first_site),
        end_(first_site + site_count),
        seed_(seed),
        frame_(frame),
        halves_(halves),
        independent_halves_(independent_halves) {}

  // Fills in up to kBatchSize samples and returns their number, which is 0 at the end.
  int next(const PixelFilterSampler& filter, SampleBatch& out);

 private:
  [[nodiscard]] SiteSequence sequence_of_site(const Site& site, int first_x, int first_y) const;

  const SamplingMap* map_;
  std::uint32_t site_, end_;
  std::uint32_t sample_ = 0;
  std::uint64_t seed_;
  std::int32_t frame_;
  bool halves_, independent_halves_;  // as TraceSettings
  std::vector<PixelIndex> pixels_;
};

}  // namespace gazetrace
