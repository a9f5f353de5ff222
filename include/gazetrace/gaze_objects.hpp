// SPDX-License-Identifier: Apache-2.0
// Which objects of a scene gaze fell on. A tracker is off by about half a degree, so an object is never looked at for
// certain: every object has a share of the directions that the eye may have had.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/gaze_events.hpp"
#include "gazetrace/job.hpp"
#include "gazetrace/math.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/resolve.hpp"
#include "gazetrace/scene.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// Whether the viewer saw this scene on this path while the log was recorded, or looked at something else. A log does
// not tell; who asks must.
enum class Stimulus : std::uint8_t { replayed, recorded };

// How far gaze is off: the tracker's systematic error (accuracy) and its scatter (precision).
struct GazeUncertainty {
  double accuracy_deg = 0, precision_deg = 0;
};
// The log's own measures: the mean error of its validations, and the root mean square of the scatter within
// fixations. NaN where the log does not say.
GazeUncertainty uncertainty_of(const GazeLog& log);
// `stated` and, where that is NaN, the log's.
GazeUncertainty known_uncertainty(const GazeUncertainty& stated, const GazeLog& log);

// Directions around a gaze, equally likely each. The gaze is off by a normal distribution around it: the tracker's
// accuracy is its mean distance, sd = accuracy sqrt(2 / pi) in each axis (the mean of a Rayleigh distribution), and the
// precision p, a root mean square distance, adds p / sqrt(2) in each axis. Radii are the quantiles (i + 1/2) / count of
// that distribution and turn by the golden angle from one to the next (Vogel, "A better way to construct the sunflower
// head", 1979), so that they are stratified in both, and the same for the same gaze.
std::vector<Vec3d> gaze_cone(const Vec3d& direction, const GazeUncertainty& uncertainty, int count);
// The angle from the gaze within which 95 % of them lie: sqrt(-2 ln 0.05) standard deviations.
double gaze_cone_95_deg(const GazeUncertainty& uncertainty);

// A heat map on the surfaces of the scene, as one frame sees them: the hits of the cones of *all* frames stay in the
// world where they fell, and of these the frame shows those that nothing hides from it. Each hit spreads over the
// surface around it, on the same body, as a normal distribution whose standard deviation is seen under `sigma_deg` from
// where the eye was; values are seconds of gaze per square metre of surface. A body that moves keeps the hits where
// they fell in the world.
struct SceneHeatSettings {
  std::optional<std::int32_t> frame;  // empty: the middle one of those that are planned
  double sigma_deg = 0.5;             // above 0, at most 10
};
struct SceneHeat {
  std::int32_t frame = 1;
  int width_px = 0, height_px = 0;  // 480 wide for any frame
  std::vector<double> values;       // row by row from the upper left corner, in seconds per square metre
  std::vector<std::uint8_t> greys;  // of the surfaces, light where they are seen at a right angle
  double seconds = 0;               // of gaze on the surfaces of the scene, seen or hidden
  double highest = 0;               // of the values
};

struct GazeObjectsSettings {
  GazeUncertainty uncertainty;
  int rays = 256;  // in the cone of each frame, 16..65536
  int nearest = 3;
  // Of the grid over the frame by which the nearest objects are found; 0: none are sought.
  int grid_rays = 100'000;
  Stimulus stimulus = Stimulus::replayed;
  bool keep_hits = false;  // FrameObjects::hits
};

// A named object: a node of the glTF, as far as it has one material. Instances of one node are one object, and so
// are nodes of one name.
struct SceneObject {
  std::string node, material;  // both empty: nothing was hit, the environment
};

struct ObjectShare {
  std::size_t object = 0;  // an index into GazeObjects::objects
  double share = 0;        // of the cone, 0..1
  // Of its ray that is nearest to the gaze: distance from the camera, +Inf for the environment, and place in the world.
  double distance_m = 0;
  Vec3d position_m;
};
struct NearObject {
  std::size_t object = 0;
  double eccentricity_deg = 0;  // of the ray on it that is nearest to the gaze
};

struct FrameObjects {
  std::int32_t frame = 1;
  std::int64_t t_video_ns = 0, t_log_ns = 0;
  GazeState state = GazeState::none;  // measured or held; other frames have no gaze and no shares
  std::optional<EyeMovement> movement;
  std::vector<ObjectShare> shares;  // the largest first
  double beside_share = 0;          // of the cone that falls beside the picture
  std::vector<NearObject> nearest;  // of all nodes in the picture, the nearest first
  std::vector<RayHit> hits;         // of the cone's rays; empty unless they are kept
};

struct GazeObjects {
  GazeObjectsSettings settings;
  std::vector<SceneObject> objects;
  std::vector<FrameObjects> frames;
  double grid_deg = 0;  // the step of the grid in the middle of the picture: eccentricities are right to half of it
};

// First hits around the true gaze (not the steering one) of every frame of the plan, by a pinhole in the middle of the
// frame's time. Throws Error(usage) for settings out of range.
GazeObjects gaze_objects(PathTracer& tracer, const Scene& scene, const FramePlan& plan,
                         const GazeObjectsSettings& settings);

// The same for the frames of a job, whose scene is loaded for it. Where settings.uncertainty is NaN, the log's is
// taken; Error(input) where that tells none.
struct GazeOnScene {
  ResolvedJob resolved;
  GazeObjects objects;
  std::optional<SceneHeat> heat;  // where a heat map was asked for
};
GazeOnScene look_at_scene(const Job& job, GazeObjectsSettings settings,
                          const std::optional<SceneHeatSettings>& heat = std::nullopt);

// `objects` with their hits, and the frame of the plan upon which they are drawn. Throws Error(usage) for a frame that
// is not in the plan and for settings out of range.
SceneHeat scene_heat(PathTracer& tracer, const FramePlan& plan, double frame_s, const GazeObjects& objects,
                     const SceneHeatSettings& settings);
// As a picture, a PNG file's bytes: colors from dark to light over `picture`, a .png or .jpg of that frame, or over its
// surfaces in grey where that is empty. Error(input) for a picture that cannot be read.
std::vector<std::uint8_t> scene_heat_png(const SceneHeat& heat, const std::string& picture);
// A row of values for each row of the picture, separated by commas.
std::string scene_heat_csv(const SceneHeat& heat);

// One row for each frame: frame, t_video_ns, t_log_ns, gaze, movement, stimulus, node, material, share, distance_m,
// x_m, y_m, z_m, also (other objects with at least 0.5 % as "node (material)=share"), beside_share, cone95_deg, near_1,
// near_1_deg, ...
std::string objects_as_tsv(const GazeObjects& objects);
std::string objects_as_json(const GazeObjects& objects);

}  // namespace gazetrace
