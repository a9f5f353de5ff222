// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "core/atomic_file.hpp"
#include "gazelog/eyes.hpp"
#include "gazetrace/gaze_read.hpp"
#include "gazetrace/gaze_write.hpp"

namespace gazetrace {
namespace {

// Lengths are written in mm where dividing by ten gives exactly the same number back, else in cm.
std::string geometry_line(std::string_view key, std::initializer_list<double> values_cm) {
  bool exact = true;
  for (const double value : values_cm) {
    exact = exact && value * 10.0 / 10.0 == value;
  }
  std::string line = fmt::format("# {}_{}", key, exact ? "mm" : "cm");
  for (const double value : values_cm) {
    line += fmt::format(" {}", exact ? value * 10.0 : value);
  }
  return line + "\n";
}

// Line ends would break the preamble.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

// A column's name must not become two words.
std::string one_heading(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == '"' || c == '[' || c == ']'; }, ' ');
  return one_line(std::move(text));
}

// " duration_ns=20000000 amplitude_deg=9 peak_deg_s=400", of which only what the tracker states.
std::string stated_values(const GazeEvent& event) {
  std::string text;
  if (event.stated_duration_ns) {
    text += fmt::format(" duration_ns={}", *event.stated_duration_ns);
  }
  if (event.stated_amplitude_deg) {
    text += fmt::format(" amplitude_deg={}", *event.stated_amplitude_deg);
  }
  if (event.stated_peak_velocity_deg_s) {
    text += fmt::format(" peak_deg_s={}", *event.stated_peak_velocity_deg_s);
  }
  return text;
}

std::string preamble(const GazeLog& log) {
  std::string text = "# gazetrace-gaze 1\n";
  text += log.kind == GazeKind::scene_camera ? "# kind scene-camera\n" : "";
  if (log.recording_geometry) {
    const DisplayGeometry& g = *log.recording_geometry;
    if (g.width_px > 0 && g.height_px > 0) {
      text += fmt::format("# display_px {} {}\n", g.width_px, g.height_px);
    }
    if (g.width_cm > 0 && g.height_cm > 0) {
      text += geometry_line("display", {g.width_cm, g.height_cm});
    }
    if (g.distance_cm > 0) {
      text += geometry_line("distance", {g.distance_cm});
    }
    if (g.eye_x_cm != 0 || g.eye_y_cm != 0) {
      text += fmt::format("# eye_cm {} {}\n", g.eye_x_cm, g.eye_y_cm);
    }
  }
  if (log.pixels_per_degree) {
    text += fmt::format("# pixels_per_degree {} {}\n", log.pixels_per_degree->x, log.pixels_per_degree->y);
  }
  if (!log.clock.empty()) {
    text += fmt::format("# clock {}\n", one_line(log.clock));
  }
  if (const ChosenEye chosen = chosen_eye(log); chosen.eye) {
    text += fmt::format("# eye {}\n", to_string(*chosen.eye));
  }
  if (log.nominal_rate_hz > 0) {
    text += fmt::format("# rate_hz {}\n", log.nominal_rate_hz);
  }
  if (log.device) {
    text += fmt::format("# device {}\n", to_string(*log.device));
  }
  text += log.sample_age_unknown ? "# sample_age unknown\n" : "";
  for (const GazeCalibration& c : log.calibrations) {
    text += fmt::format("# calibration {} {} {} {}\n", to_string(c.eye), c.t_ns, c.mean_error_deg, c.max_error_deg);
  }
  for (const GazeEvent& event : log.events) {
    text += fmt::format("# event {} {} {} {}{} {}\n", to_string(event.type), to_string(event.eye), event.begin_ns,
                        event.end_ns, stated_values(event), one_line(event.text));
  }
  return text;
}

std::string pose_text(const HeadPose& pose, char separator) {
  const Vec3d& p = pose.position_m;
  const Quatd& q = pose.orientation;
  return fmt::format("{1}{0}{2}{0}{3}{0}{4}{0}{5}{0}{6}{0}{7}", separator, p.x, p.y, p.z, q.x, q.y, q.z, q.w);
}

// The pose at each sample's time, or none. A log that repeats a sample may also have poses at other times.
struct PosesOfSamples {
  std::vector<const HeadPose*> of_sample;
  std::vector<const HeadPose*> others;
};

PosesOfSamples poses_of_samples(const GazeLog& log) {
  PosesOfSamples poses;
  poses.of_sample.resize(log.samples.size(), nullptr);
  std::size_t i = 0;
  for (const HeadPose& pose : log.head) {
    while (i < log.samples.size() && log.samples[i].t_ns < pose.t_ns) {
      ++i;
    }
    if (i < log.samples.size() && log.samples[i].t_ns == pose.t_ns) {
      poses.of_sample[i] = &pose;
    } else {
      poses.others.push_back(&pose);
    }
  }
  return poses;
}

// The shortest text that reads back as the same bits; empty for unknown values.
template <class Number>
void append_number(std::string& text, Number value) {
  text += ',';
  if (!std::isnan(value)) {
    fmt::format_to(std::back_inserter(text), "{}", value);
  }
}

// Writes the eyes of a sample as separate rows, which reading joins again.
GazeSample eye_row(const GazeSample& sample, const EyeGaze& gaze, Eye eye, GazeKind kind) {
  GazeSample row = sample;
  row.eye = eye;
  take_eye(row, gaze, kind);
  return row;
}

class RowWriter {
 public:
  explicit RowWriter(const GazeLog& log) : log_(log) {
    const auto look = [&](float confidence, float pupil) {
      has_confidence_ = has_confidence_ || !std::isnan(confidence);
      has_pupil_ = has_pupil_ || !std::isnan(pupil);
    };
    for (const GazeSample& sample : log.samples) {
      look(sample.confidence, sample.pupil);
    }
    for (const BothEyes& eyes : log.eyes) {
      look(eyes.left.confidence, eyes.left.pupil);
      look(eyes.right.confidence, eyes.right.pupil);
    }
  }

  [[nodiscard]] std::string header() const {
    std::string text = log_.kind == GazeKind::direction ? "t[ns],dx,dy,dz,valid,eye" : "t[ns],u[1],v[1],valid,eye";
    text += has_confidence_ ? ",confidence" : "";
    text += has_pupil_ ? log_.pupil_unit.empty() ? ",pupil" : ",pupil[" + one_heading(log_.pupil_unit) + "]" : "";
    text += log_.origins.empty() ? "" : ",ox[mm],oy[mm],oz[mm]";
    text += log_.head.empty() ? "" : ",hx[m],hy[m],hz[m],hqx,hqy,hqz,hqw";
    return text + "\n";
  }

  void write(const GazeSample& sample, const Vec3f* origin, const HeadPose* pose, std::string& text) const {
    fmt::format_to(std::back_inserter(text), "{}", sample.t_ns);
    if (log_.kind == GazeKind::direction) {
      append_number(text, sample.direction.x);
      append_number(text, sample.direction.y);
      append_number(text, sample.direction.z);
    } else {
      append_number(text, sample.u);
      append_number(text, sample.v);
    }
    fmt::format_to(std::back_inserter(text), ",{},{}", to_string(sample.validity), to_string(sample.eye));
    if (has_confidence_) {
      append_number(text, sample.confidence);
    }
    if (has_pupil_) {
      append_number(text, sample.pupil);
    }
    if (!log_.origins.empty()) {
      constexpr Vec3f kUnknown{NAN, NAN, NAN};
      const Vec3f& at = origin == nullptr ? kUnknown : *origin;
      append_number(text, at.x);
      append_number(text, at.y);
      append_number(text, at.z);
    }
    if (!log_.head.empty()) {
      text += pose == nullptr ? ",,,,,,," : "," + pose_text(*pose, ',');
    }
    text += '\n';
  }

 private:
  const GazeLog& log_;
  bool has_confidence_ = false;
  bool has_pupil_ = false;
};

}  // namespace

void write_gaze_csv(const GazeLog& log, const std::string& path) {
  const RowWriter rows(log);
  const PosesOfSamples poses = poses_of_samples(log);
  std::string text = preamble(log);
  for (const HeadPose* const pose : poses.others) {
    text += fmt::format("# head {} {}\n", pose->t_ns, pose_text(*pose, ' '));
  }
  text += rows.header();
  const bool has_own_rows = !chosen_eye(log).is_alone;
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    GazeSample sample = log.samples[i];
    const auto origin_of = [&](Eye eye) {
      return log.origins.empty() ? nullptr : eye == Eye::right ? &log.origins[i].right_mm : &log.origins[i].left_mm;
    };
    const HeadPose* const pose = poses.of_sample[i];  // once for each time
    if (log.eyes.empty()) {
      rows.write(sample, origin_of(sample.eye), pose, text);
      continue;
    }
    if (has_own_rows) {
      sample.eye = Eye::cyclopean;
      rows.write(sample, nullptr, pose, text);
    }
    rows.write(eye_row(sample, log.eyes[i].left, Eye::left, log.kind), origin_of(Eye::left),
               has_own_rows ? nullptr : pose, text);
    rows.write(eye_row(sample, log.eyes[i].right, Eye::right, log.kind), origin_of(Eye::right), nullptr, text);
  }
  write_bytes_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace gazetrace
