// SPDX-License-Identifier: Apache-2.0
// Files: names of a sequence, pictures that appear only when complete, timing and the run record.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/reconstruct.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// "beauty.####.exr", "beauty.%04d.exr", "beauty.<frame>.exr" -> a file name. Error(usage) for a pattern without a
// place for the number when `require_number`, or with two; %% is a percent sign. Only the file name is looked at:
// folders keep their # and %.
std::string frame_file_name(const std::string& pattern, std::int32_t frame, bool require_number = false);
bool has_frame_number(const std::string& pattern);

enum class ExrPixels { half, float32 };

struct ExrSettings {
  std::string pattern;  // empty: no EXR
  ExrPixels pixels = ExrPixels::half;
  // none, rle, zips, zip, piz; lossy: pxr24, b44, b44a, dwaa, dwab. On noisy half-float frames piz takes about half the
  // time of zip at its fastest level and gives smaller files.
  std::string compression = "piz";
  int zip_level = 1;              // of zip and zips: 1 fast .. 9 small; lossless at every level
  std::vector<std::string> aovs;  // of aov_names()
};
const std::vector<std::string>& aov_names();  // albedo normal depth samples variance eccentricity

struct DisplaySettings {
  std::string pattern;  // .png .jpg .tif .dpx; empty: no display image
  int bits = 8;         // 16 for png, tif; dpx is written with 10
  int quality = 95;     // jpg
};
// The bits to ask ColorPipeline::apply for, by the suffix. Error(usage) for an unknown suffix, or bits it cannot hold.
int display_image_bits(const DisplaySettings& settings);
// Error(usage) where the format cannot hold a picture of this size.
void check_display_image_size(const DisplaySettings& settings, int width_px, int height_px);

struct OutputSettings {
  ExrSettings exr;
  DisplaySettings display;
  std::string map_pattern;    // EXR of the sampling map: region, samples per pixel, eccentricity
  std::string run_directory;  // timing.csv and run.json
  bool overwrite = false;
  bool resume = false;
};

// Error(usage) for whatever can be known to fail before the first ray: names, suffixes, compression, AOVs, bits.
void check_output_settings(const OutputSettings& settings, bool several_frames);

// What the header of a frame says. Free of times of day, so that a resumed run writes the same bytes.
struct FrameHeader {
  std::int32_t frame = 0;
  std::int64_t t_video_ns = 0;
  FrameRate fps;
  Camera camera;
  std::int64_t shutter_open_ns = 0, shutter_close_ns = 0;  // video time; equal: an instant
  GazeAtTime gaze_render, gaze_true;
  std::vector<std::string> gaze_processing;  // FramePlan::gaze_processing
  double exposure_ev = 0;
  double enhance_contrast = 0;  // above 0: the picture is no estimate of radiance any more
  std::uint64_t seed = 0;
  std::string settings_digest;  // hex
  std::string software;         // "gazetrace 0.1.0"
};

// Scene-linear EXR through OpenEXR. The file appears under its name only when complete. Returns the number of values
// clamped to half's range. Without `eccentricity_deg` (a frame without gaze) that AOV is NaN.
std::uint64_t write_frame_exr(const std::string& path, const Frame& frame, const ImageGray* eccentricity_deg,
                              const FrameHeader& header, const ExrSettings& settings, int threads = 0);
void write_sampling_map_exr(const std::string& path, const SamplingMap& map, const ImageGray* eccentricity_deg);
// PNG, JPEG, TIFF, DPX by suffix, through OpenImageIO; complete or absent.
void write_display_image(const std::string& path, const DisplayImage& image, const FrameHeader& header,
                         const DisplaySettings& settings);
ImageRgb read_exr_rgb(const std::string& path);
// The digest stored in an EXR or display image of ours; empty: not ours, unreadable or incomplete.
std::string read_settings_digest(const std::string& path);
// One digest for everything that reaches into pixels: (name, value) pairs in a fixed order.
std::string digest_settings(const std::vector<std::pair<std::string, std::string>>& settings);
// The same for frames that depend on those before them: of all else (`settings_digest`), of the frames there are, and
// of where the history comes from: a number of frames rendered before, or the content of a checkpoint.
std::string digest_of_sequence(const std::string& settings_digest, const std::string& frames, std::int32_t preroll,
                               const std::string& checkpoint);

constexpr std::size_t kTimingRegions = 11;

struct TimingRow {
  std::int32_t frame = 0;
  double plan_ms = 0, trace_ms = 0, guides_ms = 0, reconstruct_ms = 0, temporal_ms = 0, exposure_ms = 0, color_ms = 0,
         write_ms = 0, total_ms = 0;
  double trace_cpu_ms = 0;
  std::uint64_t pixels = 0, samples = 0;
  std::uint64_t rays_primary = 0, rays_bounce = 0, rays_shadow = 0;
  std::uint64_t rejected_rays = 0, non_finite_samples = 0;
  // In the order of timing_regions().
  std::array<std::uint64_t, kTimingRegions> region_pixels{}, region_samples{};
  std::array<double, kTimingRegions> region_cpu_ms{};
  double exposure_ev = 0;
  std::string gaze_state;             // of the gaze that steers
  std::string gaze_event;             // fixation, saccade, blink, ...; "none": not known
  std::string gaze_age_ms;            // "unknown" where a log repeats values once a frame; empty without a row
  std::string gaze_effective_age_ms;  // in the middle of the frame's display, latency included; empty where not known
  int no_gaze = 0;                    // 1: the log has none at this time, the policy decided
  double peak_memory_mib = 0;
};

std::vector<std::string> timing_columns();
// Names of the regions that have columns: those of "regions", "uniform" for frames without regions, and the block sizes
// of density models.
const std::vector<std::string>& timing_regions();
std::string timing_row_text(const TimingRow& row);                // one line, without its end
std::string timing_csv_text(const std::vector<TimingRow>& rows);  // header and rows
// Error(input) with file:line. A last line without its end is what a killed run leaves behind: it is passed over.
std::vector<TimingRow> read_timing_csv(const std::string& path);

// Where frames depend on those before them: what a run found, for parts that are to be joined.
struct RecordedHistory {
  std::string settings_digest;  // as the run's, but for its frames and history; empty: no frame depends on another
  std::string frames;           // list of those whose history its first written frame found; empty: of none
  std::string checkpoint;       // the file that it came from; empty: none

  friend bool operator==(const RecordedHistory&, const RecordedHistory&) = default;
};

// Enough to repeat the run. Serialised as JSON.
struct RunRecord {
  std::string version, build, instruction_set, ray_library;
  std::vector<std::string> command_line;
  std::string config_toml;  // every option with its effective value
  std::string settings_digest;
  std::vector<std::string> part_digests;  // of a whole: its parts', which its pictures carry, where they differ
  RecordedHistory history;
  std::map<std::string, std::string> input_digests;  // path -> content hash
  std::string frames;                                // frame list text
  bool is_part = false;                              // a part of a longer sequence
  std::string samples;                               // "0:1024": a part of the samples; empty: all of them
  std::map<std::string, std::string> facts;          // load_s, bvh_mib, peak_memory_mib, view, working_space, ...
  Warnings warnings;
  std::vector<BadSample> bad_samples;
};
std::string run_record_json(const RunRecord& record);
RunRecord read_run_record(const std::string& path);  // Error(input)

// timing.csv / run.json, or timing.1-100.csv / run.1-100.json for a part of a sequence.
std::string timing_file_name(const std::string& directory, const std::string& frames, bool is_part);
std::string run_record_file_name(const std::string& directory, const std::string& frames, bool is_part);

// How a part of the samples is called in the names of its files, after the frames: "1-3.samples-0-1024".
std::string part_of_samples_name(const std::string& frames, const SampleRange& samples);
// samples.0001.0-1024.sums
std::string samples_file_name(const std::string& directory, std::int32_t frame, const SampleRange& samples);

// What a run over a part left in a directory.
struct RunPart {
  std::string timing_path;
  RunRecord record;
  std::map<std::int32_t, TimingRow> rows;
};
// All of them, by name. Error(input) where there are none, records are missing, or settings or inputs differ.
std::vector<RunPart> read_run_parts(const std::string& directory);
// Parts of the samples, for merge_samples() of pipeline.hpp. Error(input) where some are and some are not.
bool are_parts_of_samples(const std::vector<RunPart>& parts);

// Joins the parts found in a directory into timing.csv and run.json. Error(input) where parts disagree in settings
// digest or overlap, or frames are missing (unless allowed). Where frames depend on those before them, each part must
// have found the history of all before it, as from the checkpoint of another; of the last few alone, as after
// --preroll, is warned of.
struct MergeResult {
  std::vector<std::string> parts;
  std::string frames;
  Warnings warnings;
};
// The record of the whole; what parts say differently is kept apart, or warned of.
RunRecord join_records(const std::vector<RunPart>& parts, const std::string& frames, Warnings& warnings);
MergeResult merge_runs(const std::string& directory, bool allow_missing, bool overwrite);

// Writes text to a temporary neighbour and renames it.
void write_text_atomically(const std::string& path, const std::string& text);

}  // namespace gazetrace
