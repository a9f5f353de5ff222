// SPDX-License-Identifier: Apache-2.0
// Pictures into a video, through the ffmpeg program, with marks of where the viewer looked.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/color.hpp"
#include "gazetrace/display.hpp"

namespace gazetrace {

// What the file says its code values mean, in ffmpeg's names (ITU-T H.273).
struct VideoColor {
  std::string name;       // "srgb", "rec709", "display-p3", "linear"
  std::string primaries;  // bt709, smpte432
  std::string transfer;   // iec61966-2-1, bt709, linear
};
const std::vector<VideoColor>& video_colors();
VideoColor video_color_by_name(const std::string& name);  // Error(usage) with the known names
// Of ColorPipeline::description(), such as "built-in: display sRGB, view ACES"; empty: sRGB. Error(usage) for displays
// of which this is not known, and for high dynamic range, which 8 bits do not hold.
VideoColor video_color_of_view(const std::string& description);

enum class VideoCodec : std::uint8_t {
  h264,  // 8 bits, 4:2:0, plays everywhere
  hevc,  // the same in smaller files
  ffv1,  // without loss: RGB as it is; .mkv only
};

struct VideoSettings {
  VideoCodec codec = VideoCodec::h264;
  int crf = 18;  // 0 (no loss but that of 4:2:0) to 51; h264 and hevc
  FrameRate fps;
  VideoColor color;
  std::string comment;             // for the file's metadata
  std::string program = "ffmpeg";  // a name on the path, or a path
  int threads = 0;
};
// Error(usage) for suffixes that cannot hold the codec, and values out of range.
void check_video_settings(const std::string& path, const VideoSettings& settings);

// Takes frames in order; the file appears under its name when finish() has returned. Sizes that 4:2:0 cannot hold grow
// by a repeated row or column.
class VideoWriter {
 public:
  // Error(input) where the program is not found.
  VideoWriter(const std::string& path, int width_px, int height_px, const VideoSettings& settings);
  ~VideoWriter();  // without finish(): stops the program and removes what it wrote
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  // Of 8 bits and the size given. Error(runtime) with what the program said.
  void add(const DisplayImage& frame);
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Two pictures of one height beside each other; Error(input) for others.
DisplayImage side_by_side(const DisplayImage& left, const DisplayImage& right);

using Rgb8Color = std::array<std::uint8_t, 3>;
inline constexpr Rgb8Color kGazeColor{255, 210, 63};

// A dot with a dark and a light rim at a continuous pixel position; parts outside the picture are cut off.
void draw_gaze_dot(DisplayImage& image, const Vec2d& gaze_px, double radius_px);
// Where the eccentricity from the gaze is `eccentricity_deg`, as the view shows it.
void draw_eccentricity_ring(DisplayImage& image, const PlanarView& view, const Vec2d& gaze_px, double eccentricity_deg,
                            double width_px);
// A mark to look at: bull's eye with cross hair, outer diameter 0.6 deg and inner 0.2 deg, which keeps eyes stillest of
// seven (Thaler, Schuetz, Goodale and Gegenfurtner, "What is the best fixation target?", Vision Research 76, 2013).
void draw_fixation_mark(DisplayImage& image, const Vec2d& gaze_px, double pixels_per_degree);

}  // namespace gazetrace
