// SPDX-License-Identifier: Apache-2.0
// Fixations, saccades and blinks in a gaze log, by published methods with their published defaults.
//
// Everything is measured in the geometry of the recording, as angles between directions from the eye, computed by
// atan2. For logs of a head-mounted display these are directions in the head, or in the world where the head's pose is
// known. For a screen they are directions to the display that was looked at while recording.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_log.hpp"

namespace gazetrace {

// The movement of an eye at a time. Only ivdt finds pursuit, and only ek finds microsaccades; the parts of a fixation
// before and after a microsaccade are events of their own. unclassified: the eye was seen, but its movement is none of
// the others (fixations too short to be kept, implausible speeds).
enum class EyeMovement : std::uint8_t { fixation, saccade, pursuit, blink, lost, unclassified, microsaccade };
std::string_view to_string(EyeMovement movement);

// Directions in the head are those of the log; world turns them by the head's pose at the time.
enum class GazeSpace : std::uint8_t { head, world };
std::string_view to_string(GazeSpace space);

// One direction for each sample of a log, of unit length; NaN in all parts where the sample is not usable.
struct GazeDirections {
  std::vector<std::int64_t> t_ns;
  std::vector<Vec3d> direction;
};
// Throws Error(input) for a screen log whose geometry gives no angles (it needs size and distance, or pixels per
// degree), for gaze on a scene camera's picture, and for GazeSpace::world without a head pose.
GazeDirections gaze_directions(const GazeLog& log, GazeSpace space = GazeSpace::head);
bool knows_angles(const GazeLog& log);
// Degrees per second at each sample: the angle between the directions at the ends of a window around it, divided by the
// time between them. The window reaches half of `window_ns` to either side, and at least to the next sample; at the end
// of a run it is one-sided. NaN for a sample without a neighbour. Source: Olsen 2012, "velocity calculator". Takes
// linear time.
std::vector<double> angular_speed_deg_s(const GazeDirections& gaze, std::int64_t window_ns);

// Thresholds of all methods. The comment at each threshold names the methods that use it.
struct EventSettings {
  std::string method = "ivt";  // the algorithm: ivt, idt, adaptive, ivdt or ek
  GazeSpace space = GazeSpace::head;
  // ivt: a sample slower than this belongs to a fixation. Olsen 2012.
  double velocity_deg_s = 30;                    // and ivdt
  std::int64_t velocity_window_ns = 20'000'000;  // ivt, ivdt: its window; adaptive: the length of its smoothing
  // ivt: lost samples in a gap up to this length are bridged for the classification, unless a blink is in it. 0: never.
  std::int64_t max_gap_ns = 75'000'000;
  // ivt: fixations that are no farther apart than both of these become one. 0 ns: never.
  std::int64_t merge_gap_ns = 75'000'000;
  double merge_angle_deg = 0.5;
  // All methods: shorter fixations are unclassified. n samples last n steps of the clock, as in Tobii Studio's exports;
  // the window of idt is measured from its first to its last sample.
  std::int64_t min_fixation_ns = 60'000'000;
  // idt, ivdt: the most that extent of azimuth plus extent of elevation may be. Salvucci & Goldberg 2000, eq. for D.
  double dispersion_deg = 1.0;
  // ivdt: gaze that stays within dispersion_deg for this long is a fixation, else a pursuit. Pursuit slower than their
  // quotient cannot be told from fixation.
  std::int64_t dispersion_window_ns = 110'000'000;
  // adaptive (Nystrom & Holmqvist 2010): where the peak threshold starts, the speed and acceleration that no eye
  // exceeds, and the shortest saccade.
  double start_velocity_deg_s = 100;
  double max_velocity_deg_s = 1000;
  double max_acceleration_deg_s2 = 100'000;
  std::int64_t min_saccade_ns = 10'000'000;  // and ek
  // ek (Engbert & Kliegl 2003): the thresholds in multiples of the velocities' own spread (their lambda), and the
  // extent below which a saccade counts as a microsaccade.
  double noise_factor = 6;
  double max_microsaccade_deg = 1;
  // All methods: a loss of this length that the log does not explain is taken for a blink (pymovements, after Nystrom
  // et al. 2024). Both 0: only the log's own blinks count.
  std::int64_t min_blink_ns = 50'000'000, max_blink_ns = 500'000'000;
};

// A method with constants for one kind of device.
struct EventPreset {
  std::string name, description;
  GazeDevice device = GazeDevice::desktop;
  EventSettings settings;
};
const std::vector<EventPreset>& event_presets();
const EventPreset& event_preset(std::string_view name);  // throws Error(usage) with the known names
// "ivt" for gaze on a screen, "ivt-hmd" for directions with a head pose, "ivt-attention" for those without.
// `device` is the recording device as the user states it; empty if not stated.
const EventPreset& default_event_preset(const GazeLog& log, std::optional<GazeDevice> device = std::nullopt);
// Directions from a head count as head-mounted and gaze on a screen as desktop, unless the log's reader knows better
// (as for GazeBase).
GazeDevice recorded_device(const GazeLog& log);

struct EyeEvent {
  EyeMovement movement = EyeMovement::unclassified;
  std::int64_t begin_ns = 0, end_ns = 0;  // of its first and last sample
  std::size_t first = 0, last = 0;        // their indices
  // Mean direction of a fixation, NaN for other movements; for gaze on a screen also as fractions of the display.
  Vec3d direction{};
  double u = 0, v = 0;
  // For a saccade: the angle between where it begins and where it lands, the highest and the mean of the speeds at its
  // samples (angular_speed_deg_s over EventSettings::velocity_window_ns), and the direction of its course (degrees, 0
  // to the right, 90 up). For a fixation: the peak speed, and dispersion_deg, the root mean square of the angle to its
  // mean direction. NaN where a value does not apply.
  double amplitude_deg = 0, peak_velocity_deg_s = 0, mean_velocity_deg_s = 0, angle_deg = 0, dispersion_deg = 0;
  // Of an event that the log itself states, the tracker's values: begin and end may lie between samples.
  struct Stated {
    std::int64_t begin_ns = 0, end_ns = 0;
    std::optional<std::int64_t> duration_ns;
    std::optional<double> amplitude_deg, peak_velocity_deg_s;
  };
  std::optional<Stated> stated = std::nullopt;
};

struct EyeEvents {
  std::string preset;  // its name; empty where settings were given instead
  EventSettings settings;
  std::vector<EyeMovement> labels;  // one for each sample
  std::vector<std::size_t> cuts;    // samples at which an event begins though the one before is of its kind; increasing
  std::vector<EyeEvent> events;     // runs of equal labels, in the order of time
  // The thresholds that adaptive arrived at; NaN for other methods.
  double peak_threshold_deg_s = 0, onset_threshold_deg_s = 0;
};

// Takes linear time. Throws the errors of gaze_directions, and Error(usage) for an unknown method or constants that are
// out of range.
EyeEvents detect_events(const GazeLog& log, const EventSettings& settings);
// Throws Error(input) where the preset is for the other kind of device. `device` is the device of the recording
// as the user states it; where it is empty, `recorded_device` decides.
EyeEvents detect_events(const GazeLog& log, const EventPreset& preset, std::optional<GazeDevice> device = std::nullopt);
// The log of one eye alone, out of a log of both. Error(input) where the log has not both eyes.
GazeLog one_eye(const GazeLog& log, Eye eye);
// Those of the left eye, of which only the saccades and microsaccades stay that overlap one of the right eye (the
// binocular condition of Engbert & Kliegl 2003); ek's other findings are noise of one eye and join a fixation.
EyeEvents binocular_events(const GazeLog& log, const EventPreset& preset,
                           std::optional<GazeDevice> device = std::nullopt);
// The events that the log itself states for the eye it has been read for (EyeLink's EFIX and ESACC, Tobii's columns,
// labels set by hand), in the same form, so that both can be compared. Without such events every sample is
// unclassified.
EyeEvents events_of_log(const GazeLog& log);

// Tab-separated values with one event in each row: movement, onset_ns, offset_ns, duration_ms, first_row, last_row,
// amplitude_deg, ... n samples last n steps of the clock. For events that the log states, these columns have the
// tracker's values (n/a where it has none), and our own measures are in columns named measured_... and after the
// velocity filter and its window, such as two_point_20ms_peak_velocity_deg_s.
std::string events_as_tsv(const EyeEvents& events, const GazeLog& log);
std::string events_as_json(const EyeEvents& events, const GazeLog& log);

}  // namespace gazetrace
