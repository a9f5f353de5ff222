// SPDX-License-Identifier: Apache-2.0
// What the readers share. A reader fills rows as they stand in the file, and declares what the file says about its
// numbers. What the numbers mean is concluded and interpreted elsewhere (conclude.cpp, interpret.cpp).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazelog/table.hpp"

namespace gazetrace {

// The raw gaze of a file, without rows yet.
RawGaze raw_of(const GazeFile& file, std::string clock, std::string pupil_unit = {});

// Adds a fact that the file states, in words for people.
void add_note(RawGaze& raw, std::string what, std::string value, Evidence evidence, std::string detail = {});

// Adds the size of the display, where the file states one, to what is known of it; `detail` says where it stands.
void state_display_px(RawGaze& raw, double width, double height, Evidence evidence, std::string detail);

// The picture of Pupil Labs' scene camera is 1088 x 1080 for Invisible, 1600 x 1200 for Neon; many files do not say.
void guess_picture_size(RawGaze& raw);

// The first stamps of a table as they are written, for guesses. `is_checked`: throws Error(input) for a first one that
// is no number, saying what it is.
std::vector<double> first_stamps(const GazeFile& file, const DelimitedTable& table, std::size_t column,
                                 bool is_checked = false);

// Declares the column and the unit of the stamps: the unit that the user gave or, without one, `stated`.
TimeScale declare_time(RawGaze& raw, const GazeReadOptions& options, std::string_view column, int stated,
                       Evidence evidence, const std::string& place);

// The confidence from which on a sample is used: the one that the user gave or, without one, the format's own.
double least_confidence(const GazeReadOptions& options, double own);

// How a format writes positions. Unit and origin may be automatic where the file does not state them.
struct PlaceSpace {
  PositionUnit unit = PositionUnit::px;
  PositionOrigin origin = PositionOrigin::top_left;
  Evidence evidence = Evidence::format;
  std::string columns;                                     // in words
  bool validity_is_final = false;                          // the log itself says which samples are off-screen
  std::optional<Evidence> origin_evidence = std::nullopt;  // where it differs from that of the unit
};
// `place`: file:line where the log says so, for messages.
void declare_places(RawGaze& raw, const PlaceSpace& space, const std::string& place);
// Declares vectors in `axes`, which also hold for the origins of the eyes.
void declare_directions(RawGaze& raw, Concluded<std::string> columns, GazeAxes axes, Evidence evidence,
                        const std::string& place);

// A head's pose as written; `rotation` in degrees about x, y, z, applied in Unity's order z, x, y.
Quatd quaternion_from_unity_euler_deg(const Vec3d& rotation);
HeadPose head_pose_from_axes(std::int64_t t_ns, const Vec3d& position_m, const Quatd& orientation, GazeAxes axes);

// Adds a text that the log has at one moment, such as a message of the experiment.
void add_message(RawGaze& raw, std::int64_t t_ns, std::string text, std::int64_t row);

// Gathers the correlations of a GazeWitness; rows where any of the four is not finite are left out.
class WitnessTally {
 public:
  void add(double x, double y, double witness_x, double witness_y);
  // Adds the witness where there were enough rows. `eye` is the eye whose gaze it describes, where it does not describe
  // that of all rows.
  void finish(RawGaze& raw, std::string what, std::optional<Eye> eye = std::nullopt) const;

 private:
  std::size_t count_ = 0;
  std::array<double, 4> mean_{};                    // x, y, witness x, witness y
  std::array<std::array<double, 4>, 4> product_{};  // sums of products of differences from the means
};

// Makes events of the runs of rows with one label, such as "Fixation 12".
class LabelRuns {
 public:
  // `text` is that of the event, where the label has words that are to be kept.
  void add(GazeEventType type, Eye eye, std::string_view key, std::int64_t t_ns, std::int64_t row,
           std::string_view text = {});
  // The same by the tracker's word for it; any other word than Fixation, Saccade or Blink ends the run.
  void add_named(std::string_view word, Eye eye, std::string_view key, std::int64_t t_ns, std::int64_t row);
  void end();  // ends the run, for a row without a label
  void finish(RawGaze& raw);

 private:
  std::vector<GazeEvent> events_;
  std::string key_;
  bool open_ = false;
};

// Labels a row of Pupil Cloud by its `blink id` or, where it has none, its `fixation id`. During a blink the gaze that
// the row states means nothing.
void label_by_ids(TableRows& rows, const OptionalColumn& blink, const OptionalColumn& fixation, RawSample& sample,
                  LabelRuns& runs);

// A row with a position on a display, of a format that has no confidence. A pupil that is not above 0 is missing. Where
// a coordinate is missing, the other one is taken for missing as well, and the eye is lost.
RawSample position_row(std::int64_t t_ns, std::int64_t row, Eye eye, const Vec2d& at, double pupil);
// A row whose position is not known.
RawSample missing_row(std::int64_t t_ns, std::int64_t row, Eye eye);

}  // namespace gazetrace
