// SPDX-License-Identifier: Apache-2.0
// The first measurements of a recording in a perception lab: the quality of the data, and the eye movements, as numbers
// and as tables.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/error.hpp"
#include "gazetrace/gaze_events.hpp"
#include "gazetrace/gaze_log.hpp"
#include "gazetrace/gaze_process.hpp"
#include "gazetrace/gaze_vergence.hpp"

namespace gazetrace {

// Quality of the data of one gaze under the names of Holmqvist, Nystrom & Mulvey, "Eye tracker data quality: what it is
// and how to measure it", ETRA 2012. NaN: not known.
struct GazeQuality {
  std::string of;  // "gaze", "left eye", "right eye"
  std::size_t samples = 0, usable = 0;
  // Of the blocks of the recording, or from the first sample to the last; pauses between blocks do not count.
  double duration_s = 0;
  double sampling_rate_hz = 0;   // as stated by the log, else by the median step
  double effective_rate_hz = 0;  // usable samples over the duration
  double data_loss = 0;          // share of the samples expected at that rate that are missing or not usable
  double accuracy_deg = 0;       // mean error of the validations in the log
  double accuracy_max_deg = 0;   // their largest one
  std::size_t validations = 0;
  // Medians over fixations: root mean square of the distances from sample to sample, and standard deviation.
  double precision_rms_s2s = 0, precision_sd = 0;
  std::string precision_unit;  // "deg", else "px" or "of the picture"
};
// `eye`: one eye of a log of both, or the gaze of the log.
GazeQuality measure_quality(const GazeLog& log, std::optional<Eye> eye = std::nullopt);

// peak velocity (deg/s) = factor * amplitude^exponent, fitted by least squares to the logarithms of all saccades of 0.5
// to 30 degrees. correlation: of the logarithms. All NaN for fewer than five saccades.
struct MainSequence {
  std::size_t saccades = 0;
  double factor = 0, exponent = 0, correlation = 0;
};
MainSequence fit_main_sequence(const std::vector<EyeEvent>& events);

struct GazeMeasureSettings {
  std::string method = "auto";  // an event preset, "auto", or "log"
  std::optional<GazeDevice> device;
  double pupil_distance_mm = 0;  // for the vergence; 0: as VergenceSettings
  std::vector<GazeStep> steps;   // of processing: the events are those of the gaze after them, the quality is that of
                                 // the recording
  bool keep_ids = false;         // names of trials, which are texts of the recording
};

struct GazeTable {
  std::string name;  // of its file
  std::string text;
};

struct GazeMeasurements {
  std::vector<GazeQuality> quality;  // of the gaze and, for logs of both eyes, of each eye
  EyeEvents events;
  MainSequence main_sequence;
  VergenceOverTime vergence;
  std::vector<GazeTrial> trials;  // fewer than two: the recording is looked at as one
  // Tab-separated. events.tsv as of events_as_tsv(), and that of each eye of logs of both. samples.tsv: t_ns, and of
  // the gaze or of each eye the place, x to the right and y as the log's plane has it (upwards for angles, downwards
  // for places on a picture), and the pupil. vergence.tsv, for logs of both eyes: t_ns; horizontal_deg and
  // vertical_deg, the disparity of the places (left minus right, each seen from the middle between the eyes);
  // vergence_deg and distance_mm, the angle between the lines of sight and where they meet (gaze_vergence.hpp).
  std::vector<GazeTable> tables;
  std::string json;  // all numbers, and the facts about the tables that a drawing needs
  Warnings warnings;
};
// Throws the errors of detect_events.
GazeMeasurements measure_gaze(const GazeLog& log, const GazeMeasureSettings& settings);

}  // namespace gazetrace
