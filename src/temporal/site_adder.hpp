// SPDX-License-Identifier: Apache-2.0
// Adds up the sums of sites of several frames that join a frame's sites.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gazetrace/foveation.hpp"
#include "gazetrace/light_groups.hpp"
#include "gazetrace/trace.hpp"
#include "trace/rays/camera_rays.hpp"
#include "trace/samples/surface_sums.hpp"

namespace gazetrace {

// A site of one of the frames, and which of a batch's sites it joins.
struct Joining {
  std::uint32_t site = 0, to = 0;
};

// One of the frames, and what of it joins a batch.
struct JoiningFrame {
  std::int32_t scrambling = 1;
  const SamplingMap* map = nullptr;
  const SparseFrame* sparse = nullptr;
  Vec3f camera_m;                  // from the frame's camera to the one of this frame
  std::span<const Vec3f> moved_m;  // of each of its sites, in place of `camera_m`; empty: nothing moves
  std::span<const Joining> joining;
};

// Goes through a batch of sites frame by frame, so that each frame is read in the order in which it lies in memory.
class SiteAdder {
 public:
  static constexpr std::size_t kBatchSites = 512;

  // `map` and `out` have an entry for each of the frame's sites; `out` has its guides already.
  SiteAdder(const CameraRays& rays, SamplingMap& map, SparseFrame& out);

  // Of `count` sites from `first` on. The frames are in the order in which they are added up; each site is joined by
  // itself at least. Appends the sites' surfaces to `surfaces`.
  void add(std::size_t first, std::size_t count, std::span<const JoiningFrame> frames,
           std::vector<SurfaceSums>& surfaces);

 private:
  struct Sums {
    Vec3d light, light_of_first_half;
    double square = 0, expected = 0;
    std::array<double, 2> bright{};
    std::array<std::uint32_t, 2> count{};
    std::uint32_t planned = 0, sites = 0;
    const SparseFrame* last = nullptr;  // of the last site that joins, and that site
    std::uint32_t last_site = 0;

    // Whether halves are those of the frames with odd and with even scramblings; else those within each frame.
    [[nodiscard]] bool by_frames() const { return count[0] > 0 && count[1] > 0; }
  };
  struct GuideDoubles {
    Vec3d albedo, normal;
    std::uint32_t hits = 0;
  };
  struct FirstHitDoubles {
    Vec3d shone;
    double square_shift = 0;
    std::array<double, 2> bright{};
    std::uint32_t blended = 0;
  };
  // SparseFrame::half_difference and the like from the halves within each frame, whose errors add up.
  struct WithinFrames {
    double light = 0, shone = 0, samples = 0;
    Vec3d first_half;
    std::uint32_t first_half_samples = 0;
  };

  void start(std::size_t count, std::span<const JoiningFrame> frames);
  void add_sums(const JoiningFrame& frame);
  void add_surfaces(const JoiningFrame& frame);
  void add_guides(const JoiningFrame& frame);
  void add_light_groups(const JoiningFrame& frame);
  void add_first_hits(const JoiningFrame& frame);
  void add_within_frames(const JoiningFrame& frame);
  void finish(std::size_t site, std::size_t at, std::vector<SurfaceSums>& surfaces);

  SamplingMap& map_;
  SparseFrame& out_;
  std::vector<Sums> sums_;
  std::vector<SurfaceSorter> sorters_;
  std::vector<GuideDoubles> guides_;
  std::vector<std::array<Vec3d, kLightGroups>> light_groups_;
  std::vector<FirstHitDoubles> first_hits_;
  std::vector<WithinFrames> within_;
};

}  // namespace gazetrace
