// SPDX-License-Identifier: Apache-2.0
// All settings of a run, as typed values. resolve.hpp turns them into loaded and checked inputs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/camera.hpp"
#include "gazetrace/gaze_trials.hpp"
#include "gazetrace/option_values.hpp"
#include "gazetrace/pipeline.hpp"
#include "gazetrace/scene.hpp"

namespace gazetrace {

// The viewer's screen, and where the eye is in front of it.
struct ScreenSettings {
  std::string name;
  std::optional<Vec2d> size_px, size_cm;
  std::optional<double> distance_cm;
  std::optional<Vec2d> eye_cm;
  std::optional<double> pixels_per_degree;
};

// Where the samples go, and the options of samplings that are not chosen.
struct SamplingSettings : FoveationSettings {
  SamplingSettings() { sampling = DensitySampling(); }
  RegionSampling unused_regions;
  DensitySampling unused_density;
};

struct GazeFileSettings {
  std::string path;
  GazeReadOptions read;
  std::string columns_file;  // a column map; `read` overrides it
  std::optional<double> min_confidence;
  TrialRules trial_rules;
  std::string trial;  // the one that is taken, by number or name; empty: the whole recording
};

// The settings of one run, in the order of the options, which job_schema.hpp describes.
struct JobSettings {  // NOLINT(clang-analyzer-optin.performance.Padding)
  std::string preset;

  // Scene and light
  std::string scene;
  std::string animation;
  std::string environment = "auto";
  double environment_rotation_deg = 0;
  double environment_ev = 0;
  ByteCount max_memory;  // 0: most_memory_bytes()
  bool allow_outside = false;
  bool allow_missing = false;
  bool strict = false;
  bool cull_back_faces = false;
  bool confine = false;  // as for load_job()

  // Scene camera
  std::string camera;
  std::string camera_path;
  bool camera_from_gaze = false;
  CameraReadOptions camera_read;
  std::optional<FrameRate> camera_fps;  // empty: that of the video
  CameraPlacement camera_placement;     // `camera_up` sets z_up
  WorldUp camera_up = WorldUp::y;
  CameraExtrapolation camera_extrapolation = CameraExtrapolation::error;
  std::optional<Vec3d> eye, target;
  Vec3d up{0, 1, 0};
  std::optional<double> yfov_deg;

  // Lens and shutter
  Aperture aperture;
  std::optional<double> focus_distance_m;
  double sensor_height_mm = 24;
  Shutter shutter;

  // Gaze and screen
  GazeFileSettings gaze;
  std::optional<Vec2d> gaze_at;
  GazeInterpolation gaze_mode = GazeInterpolation::hold;
  NoGazePolicy gaze_missing = NoGazePolicy::hold;
  std::uint64_t gaze_max_missing_frames = 3600;  // in a row; 0: any number
  DurationNs gaze_max_age{500'000'000};
  DurationNs gaze_max_gap{75'000'000};
  DurationNs gaze_offset;
  double gaze_scale = 1.0;
  std::optional<DurationNs> gaze_start;
  DurationNs gaze_latency;
  bool keep_ids = false;
  std::vector<std::string> gaze_process;  // texts for parse_gaze_step()
  std::vector<std::string> gaze_anchors;  // LOG=VIDEO
  ScreenSettings screen;
  std::string recording_screen;  // a name or a file
  std::optional<GazeTransfer> gaze_transfer;
  std::optional<FrameRect> frame_rect;

  // Frames
  SizePx size{1280, 720};
  FrameRate fps;
  std::optional<FrameList> frames;
  std::int32_t first_frame = 1;
  std::optional<FrameCrop> crop;
  DurationNs start;
  std::optional<Chunk> chunk;

  // How it is rendered
  SamplingSettings foveation;
  TraceSettings trace;
  std::string filter = "auto";  // filter_of() says which filter that is
  AccumulateSettings accumulate{
      .mode = AccumulateMode::automatic};  // how many frames are read follows from the times below
  DurationNs accumulate_past{250'000'000}, accumulate_future{250'000'000};
  std::optional<PixelIndex> only_pixel;
  int threads = 0;

  // Exposure, colour, files
  ExposureSettings exposure{.mode = ExposureMode::log_average};  // one for the sequence, see settle_exposure()
  ColorSettings color;
  std::vector<std::string> outputs;
  ExrSettings exr;
  DisplaySettings picture;
  std::string map_pattern;
  bool overwrite = false;
  bool resume = false;
  bool trust_files = false;
  DurationNs grace{25'000'000'000};  // for the frame in hand, once a run is asked to stop
  std::optional<DurationNs> max_time;

  // Messages of the program
  std::string progress = "auto";
  bool quiet = false;
};

}  // namespace gazetrace
