// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "gazelog/bids_parts.hpp"
#include "gazelog/bids_sidecars.hpp"
#include "gazelog/eyes.hpp"
#include "gazelog/stamps.hpp"

namespace gazetrace {
namespace {

using Json = BidsJson;

BidsRow row_of(const GazeSample& sample, GazeKind kind) {
  return {sample.t_ns, eye_gaze(sample, kind), {NAN, NAN, NAN}};
}

// The number itself or one of its neighbours.
template <class Fits>
double one_that_fits(double number, const Fits& fits) {
  for (const double x : {number, std::nextafter(number, -HUGE_VAL), std::nextafter(number, HUGE_VAL)}) {
    if (fits(x)) {
      return x;
    }
  }
  return number;
}

template <class Number>
void append(std::string& text, Number value) {
  if (std::isnan(value)) {
    text += "\tn/a";
  } else {
    fmt::format_to(std::back_inserter(text), "\t{}", value);
  }
}

class RecordingWriter {
 public:
  RecordingWriter(const GazeLog& log, const BidsRecording& recording, const BidsPixelScale& scale, bool is_exact)
      : log_(log), recording_(recording), width_px_(scale.width_px), height_px_(scale.height_px), is_exact_(is_exact) {
    for (const BidsRow& row : recording.rows) {
      has_pupil_ = has_pupil_ || !std::isnan(row.gaze.pupil);
      has_confidence_ = has_confidence_ || !std::isnan(row.gaze.confidence);
      has_origin_ = has_origin_ || !std::isnan(row.origin_mm.x);
    }
  }

  [[nodiscard]] std::string table() const {
    std::string text;
    for (const BidsRow& row : recording_.rows) {
      const Vec3d& at = row.gaze.at;
      fmt::format_to(std::back_inserter(text), "{}", row.t_ns);
      if (log_.kind == GazeKind::direction) {
        append(text, std::atan2(at.x, -at.z) * kDegPerRad);
        append(text, std::atan2(at.y, std::hypot(at.x, at.z)) * kDegPerRad);
      } else {
        append(text, inverse_of_division(at.x, width_px_));
        append(text, inverse_of_division(at.y, height_px_));
      }
      if (has_pupil_) {
        append(text, row.gaze.pupil);
      }
      fmt::format_to(std::back_inserter(text), "\t{}", to_string(row.gaze.validity));
      if (has_confidence_) {
        append(text, row.gaze.confidence);
      }
      if (!is_exact_) {
        append(text, at.x);
        append(text, at.y);
        if (log_.kind == GazeKind::direction) {
          append(text, at.z);
        }
      }
      if (has_origin_) {
        append(text, row.origin_mm.x);
        append(text, row.origin_mm.y);
        append(text, row.origin_mm.z);
      }
      text += '\n';
    }
    return text;
  }

  [[nodiscard]] Json sidecar() const {
    const bool is_direction = log_.kind == GazeKind::direction;
    const std::string unit = is_direction ? "deg" : width_px_ > 1 ? "pixel" : "1";
    Json json{{kBidsWriterKey, kBidsWriter},
              {"PhysioType", "eyetrack"},
              {"SamplingFrequency", rate_hz()},
              {"StartTime", 0},
              {"RecordedEye", to_string(recording_.eye)},
              {"SampleCoordinateSystem", is_direction ? "eye-in-head" : "gaze-on-screen"}};
    if (const ChosenEye chosen = chosen_eye(log_); chosen.eye) {
      json["ChosenEye"] = to_string(*chosen.eye);  // a key of gazetrace's own: the eye whose gaze stands for both
    }
    if (log_.device) {
      json["RecordedOn"] = to_string(*log_.device);  // a key of gazetrace's own: desktop or head-mounted
    }
    if (log_.sample_age_unknown) {
      json["SampleAge"] = "unknown";  // our own
    }
    add_calibration(json);
    for (const GazeCalibration& c :
         log_.calibrations) {  // a key of gazetrace's own: ns, degrees, null where not stated
      json["Calibrations"].push_back({{"Eye", to_string(c.eye)},
                                      {"Time", c.t_ns},
                                      {"MeanError", c.mean_error_deg},
                                      {"MaxError", c.max_error_deg}});
    }
    json["Columns"] = {"timestamp", "x_coordinate", "y_coordinate"};
    json["timestamp"] = {{"Units", "ns"}, {"Origin", log_.clock}};
    json["x_coordinate"] = {{"Units", unit}};
    json["y_coordinate"] = {{"Units", unit}};
    const auto add = [&](const char* name, const std::string& units, const char* description) {
      json["Columns"].push_back(name);
      json[name] = {{"Description", description}};
      if (!units.empty()) {
        json[name]["Units"] = units;
      }
    };
    if (is_direction) {
      json["x_coordinate"]["Description"] = "Azimuth to the right";
      json["y_coordinate"]["Description"] = "Elevation";
    }
    if (has_pupil_) {
      add_pupil(json);
    }
    add("validity", "", "ok, low_confidence, blink, lost, off_screen or interpolated");
    if (has_confidence_) {
      add("confidence", "", "0 to 1");
    }
    if (!is_exact_ && !is_direction) {
      add("display_x", "1", "Fraction of the display from its left edge; every digit of x_coordinate");
      add("display_y", "1", "Fraction of the display from its top edge; every digit of y_coordinate");
    }
    if (is_direction) {
      add("direction_x", "", "Unit vector, to the right");
      add("direction_y", "", "Unit vector, up");
      add("direction_z", "", "Unit vector, backward: forward is -1");
    }
    if (has_origin_) {
      add("origin_x", "mm", "The eye in the head, to the right");
      add("origin_y", "mm", "The eye in the head, up");
      add("origin_z", "mm", "The eye in the head, backward");
    }
    return json;
  }

 private:
  // The standard asks whether it is an area or a diameter. EyeLink's areas and diameters have no unit.
  void add_pupil(Json& json) const {
    const std::string& unit = log_.pupil_unit;
    const bool is_bare = unit == "area" || unit == "diameter";
    json["Columns"].push_back("pupil_size");
    json["pupil_size"] = {{"Description", unit == "area" ? "The area of the pupil, as the tracker gives it"
                                          : unit.empty()
                                              ? "The pupil, as the tracker gives it; the log does not state whether "
                                                "it is an area or a diameter"
                                              : "The diameter of the pupil, as the tracker gives it"}};
    // Without units the official validator takes the column for one of texts.
    json["pupil_size"]["Units"] = is_bare || unit.empty() ? "arbitrary" : unit;
    if (is_bare) {
      json["pupil_size"]["Measure"] = unit;  // a key of gazetrace's own
    }
  }

  // By the standard's names, which have room for one: the last that was measured for this eye.
  void add_calibration(Json& json) const {
    const GazeCalibration* last = nullptr;
    int count = 0;
    for (const GazeCalibration& c : log_.calibrations) {
      if (c.eye == recording_.eye || c.eye == Eye::cyclopean) {
        last = &c;
        ++count;
      }
    }
    if (last == nullptr) {
      return;
    }
    json["CalibrationCount"] = count;
    if (!std::isnan(last->mean_error_deg)) {
      json["AverageCalibrationError"] = last->mean_error_deg;
    }
    if (!std::isnan(last->max_error_deg)) {
      json["MaximalCalibrationError"] = last->max_error_deg;
    }
  }

  [[nodiscard]] double rate_hz() const {
    // The rate comes from the mean step, because the steps of a frame log have two or three lengths, and the median
    // would be one of these.
    const double measured_hz = measure_timing(log_).mean_rate_hz;
    return log_.nominal_rate_hz > 0 ? log_.nominal_rate_hz : measured_hz > 0 ? measured_hz : 1;
  }

  const GazeLog& log_;
  const BidsRecording& recording_;
  double width_px_, height_px_;
  bool is_exact_;
  bool has_pupil_ = false, has_confidence_ = false, has_origin_ = false;
};

}  // namespace

double inverse_of_division(double value, double scale) {
  return one_that_fits(value * scale, [&](double x) { return x / scale == value; });
}

double inverse_of_product(double value, double scale) {
  return one_that_fits(value / scale, [&](double x) { return x * scale == value; });
}

std::vector<BidsRecording> bids_recordings(const GazeLog& log) {
  constexpr Vec3f kUnknown{NAN, NAN, NAN};
  const bool has_own_rows = !chosen_eye(log).is_alone;
  std::vector<BidsRecording> all{{Eye::left, {}}, {Eye::right, {}}, {Eye::cyclopean, {}}};
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    const GazeSample& sample = log.samples[i];
    const EyeOrigins origins = log.origins.empty() ? EyeOrigins{kUnknown, kUnknown} : log.origins[i];
    if (log.eyes.empty()) {
      BidsRow row = row_of(sample, log.kind);
      row.origin_mm = sample.eye == Eye::right ? origins.right_mm : origins.left_mm;
      all[static_cast<std::size_t>(sample.eye)].rows.push_back(row);
      continue;
    }
    all[0].rows.push_back({sample.t_ns, log.eyes[i].left, origins.left_mm});
    all[1].rows.push_back({sample.t_ns, log.eyes[i].right, origins.right_mm});
    if (has_own_rows) {
      all[2].rows.push_back(row_of(sample, log.kind));
    }
  }
  std::erase_if(all, [](const BidsRecording& r) { return r.rows.empty(); });
  return all;
}

BidsPixelScale bids_pixel_scale(const GazeLog& log) {
  const bool sized =
      log.recording_geometry && log.recording_geometry->width_px > 0 && log.recording_geometry->height_px > 0;
  return sized && log.kind == GazeKind::screen ? BidsPixelScale{static_cast<double>(log.recording_geometry->width_px),
                                                                static_cast<double>(log.recording_geometry->height_px)}
                                               : BidsPixelScale{};
}

bool are_pixels_exact(const std::vector<BidsRecording>& recordings, GazeKind kind, const BidsPixelScale& scale) {
  const auto survives = [](double value, double by) {
    return std::isnan(value) || inverse_of_division(value, by) / by == value;
  };
  for (const BidsRecording& recording : recordings) {
    for (const BidsRow& row : recording.rows) {
      if (!survives(row.gaze.at.x, scale.width_px) || !survives(row.gaze.at.y, scale.height_px)) {
        return false;
      }
    }
  }
  return kind == GazeKind::screen;
}

BidsSamples bids_samples(const GazeLog& log, const BidsRecording& recording, const BidsPixelScale& scale,
                         bool is_exact) {
  const RecordingWriter writer(log, recording, scale, is_exact);
  return {writer.table(), writer.sidecar()};
}

}  // namespace gazetrace
