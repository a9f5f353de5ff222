// SPDX-License-Identifier: Apache-2.0
// Instances that move from frame to frame, and while the shutter is open.
#include <algorithm>

#include "trace/scene/instance_transform.hpp"
#include "trace/scene/render_scene.hpp"

namespace gazetrace {
namespace {

// A motion need not be even while the shutter is open, so it is sampled at this many steps, and linear in between. A
// body that makes half a turn meanwhile shrinks by 0.5 % in the middle of a step.
constexpr int kSteps = 16;

// The transforms at all steps; a single one where the instance stands still, and none where the ray library cannot take
// one of them.
std::vector<Affine> way_of(const Scene& scene, const Instance& instance, const Vec3d& origin_m,
                           const std::optional<ShutterTimes>& at) {
  if (!at) {
    const Affine place = counted_from(origin_m, instance.to_world);
    return can_be_instanced(place) ? std::vector<Affine>{place} : std::vector<Affine>{};
  }
  const Motion& motion = scene.motions[static_cast<std::size_t>(instance.motion)];
  const ShutterTimes& times = *at;
  std::vector<Affine> way;
  const int steps = times.close_ns > times.open_ns ? kSteps : 0;
  for (int i = 0; i <= steps; ++i) {
    const std::int64_t t_ns = times.open_ns + (times.close_ns - times.open_ns) * i / std::max(steps, 1);
    way.push_back(counted_from(origin_m, motion.to_world_at(t_ns)));
    if (!can_be_instanced(way.back())) {
      return {};
    }
  }
  if (std::all_of(way.begin(), way.end(), [&](const Affine& place) { return place == way.front(); })) {
    way.resize(1);
  }
  return way;
}

}  // namespace

void RenderScene::move_to(const Scene& scene, const std::optional<ShutterTimes>& times) {
  if (moving_.empty() && deforming_.empty()) {
    return;
  }
  deform_meshes(scene, times);
  ways.clear();
  for (const MovingInstance& moving : moving_) {
    const Instance& source = scene.instances[moving.scene_instance];
    const std::vector<Affine> places = way_of(scene, source, origin_m, times);
    InstanceWay way;
    std::transform(places.begin(), places.end(), std::back_inserter(way), ray_transform);
    rays->place_instance(first_instance_id + moving.instance, way);
    if (places.empty()) {
      continue;
    }
    ShadingInstance& instance = instances[moving.instance];
    ShadingInstance middle = shading_instance(places[places.size() / 2]);
    middle.first_geometry = instance.first_geometry;
    middle.scene_instance = instance.scene_instance;
    middle.shape_way = instance.shape_way;
    if (way.size() > 1) {
      middle.way = static_cast<std::uint32_t>(ways.size());
      ways.push_back(std::move(way));
    }
    instance = middle;
  }
  const bool any_shape = std::any_of(instances.begin(), instances.end(),
                                     [](const ShadingInstance& instance) { return instance.shape_way != kNoId; });
  blurs = !ways.empty() || any_shape;
  rays->commit(blurs);
}

ShadingInstance RenderScene::instance_at(std::uint32_t index, float time) const {
  ShadingInstance instance = instances[index];
  if (instance.way == kNoId) {
    return instance;
  }
  const InstanceWay& way = ways[instance.way];
  const float at = time * static_cast<float>(way.size() - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(at), way.size() - 2);
  const float s = at - static_cast<float>(first);
  const auto column = [&](std::size_t c) {
    const RayTransform& a = way[first];
    const RayTransform& b = way[first + 1];
    return Vec3f{(1.0F - s) * a[3 * c] + s * b[3 * c], (1.0F - s) * a[3 * c + 1] + s * b[3 * c + 1],
                 (1.0F - s) * a[3 * c + 2] + s * b[3 * c + 2]};
  };
  instance.axes = {column(0), column(1), column(2)};
  instance.translation = column(3);
  const Affine now{to_double(instance.axes[0]), to_double(instance.axes[1]), to_double(instance.axes[2]), {}};
  const std::array<Vec3d, 3> normals = cofactors(now);
  double largest = 0;
  for (const Vec3d& n : normals) {
    largest = std::max({largest, std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)});
  }
  // Only the signs of these axes matter, not their length: see corner_normal.
  const double scale = (determinant(now) < 0 ? -1.0 : 1.0) / largest;
  for (std::size_t k = 0; k < 3; ++k) {
    instance.normal_axes[k] = to_float(normals[k] * scale);
  }
  instance.flip = scale < 0 ? -1.0F : 1.0F;
  return instance;
}

}  // namespace gazetrace
