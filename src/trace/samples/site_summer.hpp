// SPDX-License-Identifier: Apache-2.0
// Adds up the samples of sites.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gazetrace/light_groups.hpp"
#include "gazetrace/trace.hpp"
#include "trace/kernel/kernel.hpp"
#include "trace/samples/surface_sums.hpp"

namespace gazetrace {

// What the samples of a range of sites leave beside the sums of each site.
struct SummedRange {
  std::uint64_t non_finite = 0;       // samples
  std::vector<BadSample> bad;         // as keep_first() keeps them
  std::vector<SurfaceSums> surfaces;  // of all sites, in their order
};

// The sums of a site in double, of which its entries in the frame are rounded; members as in SparseFrame and GuideSums.
struct SiteLightSums {
  Vec3d radiance;
  double square_luminance = 0;
  std::uint32_t count = 0;
  Vec3d first_half;  // the radiance of HalfSum
};
struct SiteGuideSums {
  Vec3d albedo, normal;
  double depth_m = 0;
  std::uint32_t hits = 0;
};

// Sites are finished one at a time, since the samples of a site follow each other, possibly over several batches. A
// site belongs to one thread, which adds its samples in their order.
class SiteSummer {
 public:
  // For samples of sites from `first_site` on. Stores into the arrays of `out`, which must be as long as the map; of
  // first_surface, which join_surfaces() completes, the number of surfaces. Keeps a reference to `out`.
  SiteSummer(const FrameContext& context, std::int32_t frame, std::uint32_t first_site, SparseFrame& out);

  // The first `count` samples of a batch that the kernel has traced.
  void add(const Workspace& work, std::size_t count);
  // Stores the last site.
  SummedRange finish();

 private:
  struct SiteSum {
    SiteLightSums light;
    SiteGuideSums guides;
    std::array<Vec3d, kLightGroups> groups{};
  };

  void finish_site();
  void report(const SampleBatch& samples, std::size_t slot, const char* what);

  std::int32_t frame_;
  bool surfaces_;  // as TraceSettings
  SparseFrame& out_;
  std::uint32_t site_;
  SiteSum sum_;
  HalfSums halves_;
  SurfaceSorter sorter_;
  FirstHitSummer first_hits_;
  SummedRange range_;
};

}  // namespace gazetrace
