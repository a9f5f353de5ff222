// SPDX-License-Identifier: Apache-2.0
// What every reader does after its rows are in: what the user said wins over what the log says, raw places become
// fractions or directions, and it is written down what was concluded from what.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazelog/table.hpp"

namespace gazetrace {

void add_fact(GazeLog& log, std::string what, std::string value, Evidence evidence, std::string detail = {});

// The unit of stamps: what --gaze-time-unit says, else `stated`.
TimeScale choose_time_unit(GazeLog& log, const GazeReadOptions& options, std::string_view column, int stated,
                           Evidence evidence, const std::string& place);

// The column of stamps, and of positions, of a table format: what the user named, else the format's own.
std::size_t time_column(const DelimitedTable& table, const GazeReadOptions& options, std::size_t own,
                        const std::string& place);

// How a format writes places.
struct PlaceSpace {
  PositionUnit unit = PositionUnit::px;
  PositionOrigin origin = PositionOrigin::top_left;
  Evidence evidence = Evidence::format;
  std::string columns;                                     // for the record
  bool validity_is_final = false;                          // off-screen is said by the log itself
  std::optional<Evidence> origin_evidence = std::nullopt;  // where it is not that of the unit
};

// Raw u, v of the samples to fractions of the display or, for a scene camera, of its picture, whose size is
// `log.recording_geometry` or `options.display`. Marks what lies beside it. Degrees become directions where
// `options.frame` is head.
void finish_places(GazeLog& log, const GazeReadOptions& options, const PlaceSpace& space, const std::string& place);

// Raw directions and origins in `own` axes to unit vectors in gazetrace's. --gaze-axes wins.
void finish_directions(GazeLog& log, const GazeReadOptions& options, GazeAxes own, Evidence evidence,
                       const std::string& place);
Vec3d from_axes(const Vec3d& v, GazeAxes axes);
std::string_view to_string(GazeAxes axes);

// A head's pose as written; `rotation` in degrees about x, y, z, applied in Unity's order z, x, y.
Quatd quaternion_from_unity_euler_deg(const Vec3d& rotation);
HeadPose head_pose_from_axes(std::int64_t t_ns, const Vec3d& position_m, const Quatd& orientation, GazeAxes axes);
// Keeps poses with increasing times and of unit length.
void finish_head(GazeLog& log);

// Gathers the correlations of a GazeWitness; rows where any of the four is not finite are left out.
class WitnessTally {
 public:
  void add(double x, double y, double witness_x, double witness_y);
  // Adds the witness to the log where there were enough rows. Call it before finish_places or finish_directions.
  // `eye`: whose gaze it tells of, where not of all rows'.
  void finish(GazeLog& log, std::string what, std::optional<Eye> eye = std::nullopt) const;

 private:
  std::size_t count_ = 0;
  std::array<double, 4> mean_{};                    // x, y, witness x, witness y
  std::array<std::array<double, 4>, 4> product_{};  // sums of products of differences from the means
};

// Throws for gaze on a scene camera's picture unless it was asked for; `way_out` says what else there is.
void refuse_scene_camera(const GazeFile& file, const GazeReadOptions& options, std::string_view way_out);

// Runs of one label over the rows become events: "Fixation 12".
class LabelRuns {
 public:
  void add(GazeEventType type, Eye eye, std::string_view key, std::int64_t t_ns, std::int64_t row);
  void end();  // a row without a label
  void finish(GazeLog& log);

 private:
  std::vector<GazeEvent> events_;
  std::string key_;
  bool open_ = false;
};

GazeSample missing_sample(std::int64_t t_ns, std::int64_t row, Eye eye, GazeKind kind);

}  // namespace gazetrace
