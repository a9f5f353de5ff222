// SPDX-License-Identifier: Apache-2.0
// Frames around a frame have seen its surfaces, too. Their samples join its own before the filter, which then finds
// less noise to take away.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/motion.hpp"
#include "gazetrace/trace.hpp"
#include "temporal/light_changes.hpp"
#include "temporal/site_adder.hpp"

namespace gazetrace {

// What a frame has sampled, and from where.
struct WindowSamples {
  std::int32_t frame = 1;
  std::int32_t scrambling = 1;  // AccumulateSettings::scrambling()
  const Camera* camera = nullptr;
  const SamplingMap* map = nullptr;
  const SparseFrame* sparse = nullptr;                // with surfaces
  const std::vector<std::uint8_t>* glossy = nullptr;  // glossy_sites()
};

// Of each site, 1 where it saw a glossy surface.
std::vector<std::uint8_t> glossy_sites(const SparseFrame& sparse);

struct JoinedSamples {
  SamplingMap map;  // that of the frame, with the samples of all; its tiles and regions count the frame's own
  SparseFrame sparse;
};

// Joins the samples of a window's frames at the sites of one of them. A site goes as a whole to the one site that holds
// the place that its middle pixel saw, as that is in the frame: so each of its samples counts once, and the noise of
// neighbouring sites stays independent, which denoisers rely on. It joins where that site shows the same place, within
// kSamePlace of its distance; where it is not seen more coarsely than at kMostCoarse times the frame's own footprint;
// and, if the surface is glossy, where it is seen from within kSameGlossyView, or if it mirrors, kSameMirroredView.
//
// A site at the outline of something that moves joins only where such an outline is: what it saw of the body would stay
// behind as a ghost where the background that its middle saw is.
//
// Where light may differ, of each block of pixels only the frames around the frame itself join whose light does not
// differ from its own by more than their noise (light_changes.hpp): of glossy surfaces that are seen from elsewhere,
// and of all surfaces with `light_changes`.
//
// What nothing joins keeps its bits. Where camera and scene are at rest and the sites the same, the sums are those of
// all frames, with the same bits for each of them. What SparseFrame states of two halves of a site's samples is stated
// of the frames with odd and with even scramblings, where there are both.
class WindowJoin {
 public:
  // `places`: what the frame's pixels see, in its own view. Keeps references to what `own` names.
  WindowJoin(const WindowSamples& own, const HitPlaces& places, bool light_changes, int threads);
  WindowJoin(const WindowJoin&) = delete;
  WindowJoin& operator=(const WindowJoin&) = delete;

  // Another frame of the same size. `places`: what its pixels see, in the frame's view; `back`: what the frame's pixels
  // see, in its view, or null where nothing in the scene moves.
  void add(const WindowSamples& other, const HitPlaces& places, const HitPlaces* back);

  // Without stats.
  [[nodiscard]] JoinedSamples joined() const;

  static constexpr float kSamePlace = 0.05F;
  static constexpr float kMostCoarse = 1.5F;
  static constexpr float kSameGlossyView = 0.9962F;     // cosine of 5 degrees
  static constexpr float kSameMirroredView = 0.99999F;  // cosine of a quarter of a degree

 private:
  // Of a pixel of the frame: its site, and what it sees.
  struct Seen {
    Vec3f position_m;  // as HitPlace
    std::uint32_t object = 0, site = 0;
    std::uint16_t block_px = 1;  // of its site's region
    bool mirrors = false;
  };
  struct Added {
    WindowSamples samples;
    std::vector<std::uint32_t> target;       // the frame's site that each site joins, or kNoSite
    Vec3f camera_m;                          // from one camera to the other
    std::vector<Vec3f> moved_m;              // the same of each site, with its motion in the scene; empty: none moves
    std::vector<std::uint32_t> first, last;  // of each tile's targets
  };
  // For the two kinds of surfaces, diffuse and glossy, the frames in whose light each block is; empty: all of them.
  struct SameLight {
    std::array<std::vector<FrameRange>, 2> ranges;
    std::vector<std::uint32_t> block;  // of each site
  };
  struct Part;

  [[nodiscard]] bool joins(const WindowSamples& other, const Vec3f& to_own, const HitPlace& place, const Seen& seen,
                           std::size_t site) const;
  [[nodiscard]] Part part_of(std::size_t part, std::size_t own, const SameLight& light) const;
  [[nodiscard]] SameLight find_same_light(std::size_t own) const;

  WindowSamples own_;
  bool light_changes_, views_differ_ = false;
  int threads_;
  std::vector<Seen> seen_;
  std::vector<Added> added_;  // in ascending order of frames, with the frame itself
};

}  // namespace gazetrace
