// SPDX-License-Identifier: Apache-2.0
// Outlines of a scene's objects in every frame, for tools that know areas of interest but not scenes: the visible part
// of each object, with holes and behind others, exact to the pixel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/gaze_objects.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/job.hpp"
#include "gazetrace/plan.hpp"

namespace gazetrace {

// A corner of a pixel: pixel (x, y) has the corners (x, y) to (x + 1, y + 1), from the frame's upper left one.
struct PixelCorner {
  std::int32_t x = 0, y = 0;
  friend bool operator==(const PixelCorner&, const PixelCorner&) = default;
};

// Pixels of one object that hang together by their sides. Every ring follows sides of pixels, turns at each of its
// corners, meets no corner twice and is closed from the last to the first. The first is the border around the pixels,
// clockwise as a viewer sees it; the others are around holes, the other way.
struct OutlinePolygon {
  std::vector<std::vector<PixelCorner>> rings;
};

// Polygons of each number in an image but 0, by the number. A pixel lies in a polygon of its own number alone.
std::vector<std::vector<OutlinePolygon>> outlines_of(const Image<std::uint32_t>& numbers);

struct FrameOutlines {
  std::int32_t frame = 1;
  std::int64_t t_video_ns = 0;
  std::optional<std::int64_t> t_log_ns;  // on the clock of the gaze log; empty without one
  // Of objects that are seen: index into SceneOutlines::objects, how many pixels they have, and where.
  struct Seen {
    std::size_t object = 0;
    std::int64_t pixels = 0;
    std::vector<OutlinePolygon> polygons;
  };
  std::vector<Seen> seen;
};

struct SceneOutlines {
  int width_px = 0, height_px = 0;  // of the frames
  FrameRate fps;
  std::optional<DisplayGeometry> display;  // where they are watched, and
  FrameRect frame_rect;                    // where they lie on it
  std::vector<SceneObject> objects;        // the first is the environment, which has no outline
  std::vector<FrameOutlines> frames;
};

// The object that the middle of each pixel sees first, by a pinhole in the middle of the frame's time, for all frames
// of a job. It needs a scene and a camera, and no gaze. Throws Error as resolve() does.
struct OutlinesOfJob {
  SceneOutlines outlines;
  Warnings warnings;
};
OutlinesOfJob outlines_of_job(const Job& job);

// docs/gaze.md describes it.
std::string outlines_as_json(const SceneOutlines& outlines);

}  // namespace gazetrace
