// SPDX-License-Identifier: Apache-2.0
// Makes a video of pictures with the ffmpeg program, and draws marks where the viewer looked.
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

// The meaning of the code values that the video file states, in ffmpeg's names (ITU-T H.273).
struct VideoColor {
  std::string name;       // "srgb", "rec709", "display-p3", "linear"
  std::string primaries;  // bt709, smpte432
  std::string transfer;   // iec61966-2-1, bt709, linear
};
const std::vector<VideoColor>& video_colors();
VideoColor video_color_by_name(const std::string& name);  // Error(usage) with the known names
// The colour for ColorPipeline::description(), such as "built-in: display sRGB, view ACES"; sRGB where that is empty.
// Error(usage) for displays whose colour is not known, and for high dynamic range, which 8 bits cannot hold.
VideoColor video_color_of_view(const std::string& description);

enum class VideoCodec : std::uint8_t {
  h264,  // 8 bits, 4:2:0, plays everywhere
  hevc,  // the same, in smaller files
  ffv1,  // lossless RGB; .mkv only
};

struct VideoSettings {
  VideoCodec codec = VideoCodec::h264;
  int crf = 18;  // quality of h264 and hevc, from 0 (no loss besides 4:2:0) to 51 (worst)
  FrameRate fps;
  VideoColor color;
  std::string comment;             // for the file's metadata
  std::string program = "ffmpeg";  // a name to look up on $PATH, or a path
  int threads = 0;                 // 0: as ffmpeg chooses
};
// Error(usage) for suffixes whose format cannot hold the codec, and for values out of range.
void check_video_settings(const std::string& path, const VideoSettings& settings);

// Takes frames in order; the file appears under its name when finish() has returned. Where 4:2:0 needs an even size,
// the last row or column is repeated.
class VideoWriter {
 public:
  // Error(input) where the program is not found.
  VideoWriter(const std::string& path, int width_px, int height_px, const VideoSettings& settings);
  ~VideoWriter();  // where finish() was not called, stops ffmpeg and removes its file
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  // Adds a frame of 8 bits and the writer's size. Error(runtime) with ffmpeg's message where that fails.
  void add(const DisplayImage& frame);
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Two pictures of 8 bits beside each other. Error(input) where their heights differ, and for other bits.
DisplayImage side_by_side(const DisplayImage& left, const DisplayImage& right);

using Rgb8Color = std::array<std::uint8_t, 3>;
inline constexpr Rgb8Color kGazeColor{255, 210, 63};

// Draws a ring with a dark rim about a continuous pixel position, which leaves its inside visible; parts outside
// the picture are cut off.
void draw_gaze_ring(DisplayImage& image, const Vec2d& gaze_px, double radius_px, double width_px);
// Draws the line where the eccentricity from the gaze is `eccentricity_deg`, as the view shows it.
void draw_eccentricity_ring(DisplayImage& image, const PlanarView& view, const Vec2d& gaze_px, double eccentricity_deg,
                            double width_px);
// Draws a fixation mark: a bull's eye of 0.6 deg outer and 0.2 deg inner diameter with a cross hair, the one of seven
// marks on which eyes keep stillest (Thaler, Schuetz, Goodale and Gegenfurtner, "What is the best fixation target?",
// Vision Research 76, 2013).
void draw_fixation_mark(DisplayImage& image, const Vec2d& gaze_px, double pixels_per_degree);
// Writes a line in capital letters on a darkened ground; `dot_px`: the size of one of a letter's 5 x 7 dots. Characters
// that are no letter of English, digit or one of .:-/%+()= stay empty.
void draw_label(DisplayImage& image, const Vec2d& top_left_px, std::string_view text, int dot_px);

// Appends two insets below a picture, of the place of the gaze and of one far from it, cut from `clean` (the picture
// without marks): each is half as wide as the picture and three times as large. Frames both places in the picture.
// Without a gaze the insets stay empty.
DisplayImage with_insets(const DisplayImage& picture, const DisplayImage& clean, const std::optional<Vec2d>& gaze_px);

}  // namespace gazetrace
