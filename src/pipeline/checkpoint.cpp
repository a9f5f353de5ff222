// SPDX-License-Identifier: Apache-2.0
// The history in a sealed file.
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <system_error>

#include "gazetrace/checkpoint.hpp"
#include "gazetrace/error.hpp"
#include "pipeline/sealed_file.hpp"

namespace gazetrace {
namespace {

constexpr SealedKind kCheckpoint{"gazetrace history 2", "checkpoint", "give the file that `checkpoint` wrote",
                                 "render from the beginning, or with `preroll`",
                                 "render with the same options, or with `preroll`"};

template <class History, class Visit>
void each_field(History& history, bool& has_camera, bool& has_ev, auto& camera, auto& ev, const Visit& visit) {
  visit(history.radiance_sum);
  visit(history.count_sum);
  visit(history.variance_weight_sum);
  visit(history.surfaces.depth_m);
  visit(history.surfaces.normal);
  visit(history.surfaces.object);
  visit(history.surfaces.footprint_px);
  visit(history.surfaces.residual);
  visit(history.t_video_ns);
  visit(history.frames);
  visit(history.passed);
  visit(has_camera);
  visit(camera.pose);
  visit(camera.projection.kind);
  visit(camera.projection.yfov_rad);
  visit(camera.projection.ymag_m);
  visit(camera.projection.near_m);
  visit(camera.projection.far_m);
  visit(camera.lens);
  visit(camera.shutter_poses);
  visit(has_ev);
  visit(ev);
  visit(history.smoothed_ev_t_ns);
}

// A seal tells damage; a file that another program wrote must not lead out of the arrays either.
bool fits_together(const TemporalHistory& history, const Camera& camera) {
  const auto as_sums = [&](const auto& image) {
    return image.width_px == history.radiance_sum.width_px && image.height_px == history.radiance_sum.height_px;
  };
  const HistorySurfaces& surfaces = history.surfaces;
  const bool any_surfaces = !surfaces.object.empty();
  const auto with_surfaces = [&](const auto& image) { return any_surfaces ? as_sums(image) : image.empty(); };
  return as_sums(history.count_sum) && as_sums(history.variance_weight_sum) && with_surfaces(surfaces.object) &&
         with_surfaces(surfaces.depth_m) && with_surfaces(surfaces.normal) && with_surfaces(surfaces.footprint_px) &&
         with_surfaces(surfaces.residual) && history.frames >= 0 &&
         history.frames < std::numeric_limits<std::int32_t>::max() &&
         camera.projection.kind <= ProjectionKind::orthographic;
}

}  // namespace

void save_checkpoint(const std::string& path, const TemporalHistory& history, const std::string& settings_digest) {
  SealedWriter writer(kCheckpoint, settings_digest);
  bool has_camera = history.camera.has_value();
  bool has_ev = history.smoothed_ev.has_value();
  const Camera camera = history.camera.value_or(Camera{});
  const double ev = history.smoothed_ev.value_or(0);
  each_field(history, has_camera, has_ev, camera, ev, [&](const auto& field) { writer(field); });
  writer.save(path);
}

void check_checkpoint_target(const std::string& path, const std::string& settings_digest, bool goes_on) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) {
    return;
  }
  const std::string digest = read_sealed_digest(kCheckpoint, path);
  if (digest == settings_digest) {
    return;
  }
  // Damage may have changed the digest itself, and what a fault has left of a checkpoint is no reason to stop.
  if (!digest.empty() && is_sealed(path)) {
    throw Error(ErrorKind::input, path, "is a checkpoint that was made under other settings",
                "give another name, or `overwrite` to replace it");
  }
  if (!goes_on) {
    throw Error(ErrorKind::input, path, "is no whole checkpoint, and would be replaced by one",
                "give another name, or `overwrite` to replace it");
  }
}

TemporalHistory load_checkpoint(const std::string& path, const std::string& settings_digest) {
  SealedReader reader(kCheckpoint, path, settings_digest);
  TemporalHistory history;
  bool has_camera = false;
  bool has_ev = false;
  Camera camera;
  double ev = 0;
  each_field(history, has_camera, has_ev, camera, ev, [&](auto& field) { reader(field); });
  reader.finish();
  if (!fits_together(history, camera)) {
    reader.fail();
  }
  if (has_camera) {
    history.camera = camera;
  }
  if (has_ev) {
    history.smoothed_ev = ev;
  }
  return history;
}

}  // namespace gazetrace
