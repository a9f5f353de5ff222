// SPDX-License-Identifier: Apache-2.0
#include "trace/guides/guide_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/parallel.hpp"
#include "trace/guides/crossed_pixels.hpp"
#include "trace/samples/sampler.hpp"

namespace gazetrace {
namespace {

constexpr int kRowsPerTask = 32;
constexpr float kSamePlanePixels = 0.5F;  // how far off a surface's plane, relative to the size of a pixel there

struct EdgeFrame {
  const GuideFrame& guide;
  const Image<RoughNormal>& smooth;
  const Guides& guides;
  float pixel_m;              // the size of a pixel at 1 m (perspective), or at any depth
  std::vector<Vec2f> inside;  // the position of each ray in its pixel
};

// What is known of a ray's hit before its material is read.
struct EdgeHit {
  std::uint32_t object = 0, material = 0;  // as in Guides: 0 for a miss
  RoughNormal smooth;
  Vec3f plane_normal, position_m;  // the position is relative to the camera
  float tolerance_m = 0;
};

bool sees_the_same(const EdgeFrame& frame, int x, int y, const EdgeHit& hit) {
  const Guides& guides = frame.guides;
  const std::size_t i = guides.kind.index(x, y);
  if (guides.object.pixels[i] != hit.object || guides.material.pixels[i] != hit.material) {
    return false;
  }
  if (hit.object == 0) {
    return true;
  }
  if (facing(frame.smooth.pixels[i], hit.smooth) < kEdgeNormal) {
    return false;
  }
  const Vec2f through = from_center(frame.guide, x, y, {0.5F, 0.5F});
  const Vec3f place = guides.camera.place(through.x, through.y, guides.depth_m.pixels[i]);
  return std::fabs(dot(hit.plane_normal, place - hit.position_m)) < hit.tolerance_m;
}

struct PixelStep {
  int x, y;
};

constexpr std::uint32_t kNobody = 0xffffffffU;

// The pixel, the ray's own or one next to it, whose centre sees the surface that the ray hits; pixels nearer to the ray
// are tried first.
std::uint32_t seen_by(const EdgeFrame& frame, std::uint32_t pixel, const Vec2f& inside, const EdgeHit& hit) {
  const int w = frame.guides.kind.width_px;
  const int h = frame.guides.kind.height_px;
  const int x = static_cast<int>(pixel % static_cast<std::uint32_t>(w));
  const int y = static_cast<int>(pixel / static_cast<std::uint32_t>(w));
  const int to_x = inside.x < 0.5F ? -1 : 1;
  const int to_y = inside.y < 0.5F ? -1 : 1;
  const bool across_first = std::fabs(inside.x - 0.5F) > std::fabs(inside.y - 0.5F);
  const std::array<PixelStep, 8> order{{
      {0, 0},
      across_first ? PixelStep{to_x, 0} : PixelStep{0, to_y},
      across_first ? PixelStep{0, to_y} : PixelStep{to_x, 0},
      {to_x, to_y},
      across_first ? PixelStep{0, -to_y} : PixelStep{-to_x, 0},
      across_first ? PixelStep{to_x, -to_y} : PixelStep{-to_x, to_y},
      across_first ? PixelStep{-to_x, 0} : PixelStep{0, -to_y},
      across_first ? PixelStep{-to_x, to_y} : PixelStep{to_x, -to_y},
  }};
  for (const PixelStep& step : order) {
    const int px = x + step.x;
    const int py = y + step.y;
    if (px >= 0 && py >= 0 && px < w && py < h && sees_the_same(frame, px, py, hit)) {
      return static_cast<std::uint32_t>(frame.guides.kind.index(px, py));
    }
  }
  return kNobody;
}

// What was found in some rows of the frame.
struct EdgeRows {
  std::vector<EdgeRay> rays;
  std::vector<EdgeSurface> surfaces;
};

// A batch of rays: rays[first] and all after it were added to the workspace.
struct EdgeBatch {
  std::size_t first;
  EdgeRows& rows;
};

void trace_batch(const EdgeFrame& frame, const EdgeBatch& batch, GuideWorkspace& work) {
  const GuideFrame& guide = frame.guide;
  const std::size_t count = std::exchange(work.count, 0);
  intersect_rays(guide, count, work);
  EdgeRay* const rays = batch.rows.rays.data() + batch.first;
  ChunkHits& chunk = work.chunk;
  const Vec3f origin = guide.camera.origin();
  const auto per_pixel = static_cast<std::size_t>(guide.settings.edge_rays);
  for (std::size_t begin = 0; begin < count; begin += kChunk) {
    std::size_t hit_count = 0;
    for (std::size_t k = begin; k < std::min(begin + kChunk, count); ++k) {
      if (is_hit(work.hits, k)) {
        locate_hit(guide.scene, work.hits, k, chunk, hit_count++);
      } else {
        rays[k].seen_by =
            work.hits.geometry[k] == kNoId ? seen_by(frame, rays[k].pixel, frame.inside[k % per_pixel], {}) : kNobody;
      }
    }
    if (hit_count == 0) {
      continue;
    }
    place_first_hits(guide, hit_count, work);
    for (std::size_t i = 0; i < hit_count; ++i) {
      const std::size_t k = chunk.path[i];
      const ShadingMaterial& material = guide.scene.materials[chunk.material[i]];
      if (material.emissive || material.unlit) {
        rays[k].seen_by = kNobody;  // emission may differ strongly from pixel to pixel
        continue;
      }
      EdgeHit hit;
      hit.object = 1 + scene_instance_of(guide.scene, work.hits, k, chunk, i);
      hit.material = 1 + chunk.material[i];
      hit.smooth = smooth_normal(chunk, i);
      hit.plane_normal = chunk.geometric.get(i);
      hit.position_m = chunk.position.get(i) - origin;
      hit.tolerance_m = kSamePlanePixels * frame.pixel_m * (frame.guides.camera.perspective ? chunk.t[i] : 1.0F);
      rays[k].seen_by = seen_by(frame, rays[k].pixel, frame.inside[k % per_pixel], hit);
    }
  }
  // Hits that no pixel nearby sees are shaded.
  std::size_t hit_count = 0;
  const auto shade = [&] {
    if (hit_count > 0) {
      place_first_hits(guide, hit_count, work);
      shade_first_hits(guide, hit_count, work);
    }
    hit_count = 0;
  };
  for (std::size_t k = 0; k < count; ++k) {
    if (rays[k].seen_by == kNobody) {
      if (is_hit(work.hits, k)) {
        locate_hit(guide.scene, work.hits, k, chunk, hit_count++);
      } else {
        work.found[k] = first_miss(guide, work, k);
      }
      if (hit_count == kChunk) {
        shade();
      }
    }
  }
  shade();
}

// Keeps the rays of a finished batch, except those of pixels all of whose rays see what the centre sees.
void keep(const EdgeFrame& frame, const EdgeBatch& batch, const GuideWorkspace& work) {
  EdgeRows& rows = batch.rows;
  const auto per_pixel = static_cast<std::size_t>(frame.guide.settings.edge_rays);
  std::size_t end = batch.first;
  for (std::size_t first = batch.first; first < rows.rays.size(); first += per_pixel) {
    const std::uint32_t pixel = rows.rays[first].pixel;
    const auto own = [&](const EdgeRay& ray) { return ray.seen_by == pixel; };
    if (std::all_of(rows.rays.begin() + static_cast<std::ptrdiff_t>(first),
                    rows.rays.begin() + static_cast<std::ptrdiff_t>(first + per_pixel), own)) {
      continue;
    }
    const int w = frame.guides.kind.width_px;
    for (std::size_t r = 0; r < per_pixel; ++r) {
      EdgeRay ray = rows.rays[first + r];
      if (ray.seen_by == kNobody) {
        const FirstHit& hit = work.found[first + r - batch.first];
        const Vec2f through =
            from_center(frame.guide, static_cast<int>(pixel) % w, static_cast<int>(pixel) / w, frame.inside[r]);
        ray.own_surface = true;
        ray.seen_by = static_cast<std::uint32_t>(rows.surfaces.size());
        rows.surfaces.push_back({through.x, through.y, hit.albedo, hit.normal, hit.emission, hit.depth_m, hit.kind});
      }
      rows.rays[end++] = ray;
    }
  }
  rows.rays.resize(end);
}

EdgeRows trace_rows(const EdgeFrame& frame, int y0, int y1, GuideWorkspace& work) {
  EdgeRows out;
  const auto per_pixel = static_cast<std::uint32_t>(frame.guide.settings.edge_rays);
  const auto flush = [&] {
    const EdgeBatch batch{out.rays.size() - work.count, out};
    trace_batch(frame, batch, work);
    keep(frame, batch, work);
  };
  CrossedPixels pixels(frame.guides, frame.smooth, y0);
  for (int y = y0; y < y1; ++y) {
    const std::vector<std::uint8_t>& crossed = pixels.next_row();
    for (int x = 0; x < frame.guide.width_px; ++x) {
      if (crossed[static_cast<std::size_t>(x)] == 0) {
        continue;
      }
      if (work.count + per_pixel > kBatchSize) {
        flush();
      }
      for (std::uint32_t r = 0; r < per_pixel; ++r) {
        out.rays.push_back({static_cast<std::uint32_t>(frame.guides.kind.index(x, y))});
        add_ray(frame.guide, from_center(frame.guide, x, y, frame.inside[r]), x, y,
                static_cast<std::uint32_t>(frame.guide.settings.spp) + r, work.count, work);
      }
    }
  }
  flush();
  return out;
}

// The positions of the rays, the same in every pixel: a (0, m, 2)-net of one fixed scramble, so that coverage along an
// edge changes in even steps.
std::vector<Vec2f> points_in_pixel(int rays) {
  std::vector<Vec2f> points;
  for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(rays); ++r) {
    points.push_back(sample_2d(SampleKey{kGuideKey}, r, dimension_of(PathDimension::pixel)));
  }
  return points;
}

}  // namespace

void trace_edges(const GuideFrame& frame, const Image<RoughNormal>& smooth, Guides& guides, int threads) {
  const Vec3f& step = guides.camera.up_step;
  const EdgeFrame edge_frame{frame, smooth, guides, std::sqrt(dot(step, step)),
                             points_in_pixel(frame.settings.edge_rays)};
  std::vector<EdgeRows> tasks(static_cast<std::size_t>((frame.height_px + kRowsPerTask - 1) / kRowsPerTask));
  parallel_for(tasks.size(), threads, [&](std::size_t t) {
    const FlushDenormals flush;
    const auto work = std::make_unique<GuideWorkspace>();
    work->found.resize(kBatchSize);
    const int y0 = static_cast<int>(t) * kRowsPerTask;
    tasks[t] = trace_rows(edge_frame, y0, std::min(y0 + kRowsPerTask, frame.height_px), *work);
  });
  std::size_t ray_count = 0;
  for (const EdgeRows& rows : tasks) {
    ray_count += rows.rays.size();
  }
  guides.edge_rays.reserve(ray_count);
  for (const EdgeRows& rows : tasks) {
    const auto before = static_cast<std::uint32_t>(guides.edge_surfaces.size());
    for (EdgeRay ray : rows.rays) {
      ray.seen_by += ray.own_surface ? before : 0U;
      guides.edge_rays.push_back(ray);
    }
    guides.edge_surfaces.insert(guides.edge_surfaces.end(), rows.surfaces.begin(), rows.surfaces.end());
  }
}

}  // namespace gazetrace
