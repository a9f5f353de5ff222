// SPDX-License-Identifier: Apache-2.0
// The parts of an inspection's picture, and what they are drawn from and with.
#pragma once

#include <string>
#include <vector>

#include "core/svg.hpp"
#include "gazetrace/gaze_inspect.hpp"

namespace gazetrace {

class PictureSvg {
 public:
  void add(const std::string& element) { text_ += element + '\n'; }
  void raw(const std::string& text) { text_ += text; }
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  std::string text_;
};

// What is drawn: two coordinates over seconds.
struct GazeTrack {
  std::vector<double> s, x, y;  // NaN where not usable
  double x_low = 0, x_high = 1, y_top = 0, y_bottom = 1;
  double frame_width = 1, frame_height = 1;  // of the display, in the unit; 0: there is none
  std::string x_label, y_label;
};

GazeTrack make_track(const GazeLog& log, const GazeInspection& inspection);

// x and y over time. Steps of more than `gap_s` interrupt the lines and are marked as gaps.
void draw_traces(PictureSvg& svg, const GazeTrack& track, const Axis& time, const Axis& x, const Axis& y, double gap_s);
// A strip for each kind of event that the log has, from `top` down. Returns where the last one ends.
double draw_events(PictureSvg& svg, const GazeLog& log, const Axis& time, double top);

void draw_scanpath(PictureSvg& svg, const GazeLog& log, const GazeTrack& track, const Axis& x, const Axis& y,
                   double gap_s, const GazePictureOptions& options);

}  // namespace gazetrace
