// SPDX-License-Identifier: Apache-2.0
// Output files: names of a sequence, pictures that appear only when complete, timing and the run record.
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

// The file name for a frame, from a pattern such as "beauty.####.exr", "beauty.%04d.exr" or "beauty.<frame>.exr"; %% is
// a percent sign. Only the last part of the path is looked at, so folders keep their # and %. Error(usage) for a
// pattern with two places for the number, or with none where `require_number`.
std::string frame_file_name(const std::string& pattern, std::int32_t frame, bool require_number = false);
bool has_frame_number(const std::string& pattern);
// The frames for which a file of this pattern exists, ascending; {0} for the name of a single picture that exists.
// Error(input) where there is none.
std::vector<std::int32_t> find_frames(const std::string& pattern);

enum class ExrPixels { half, float32 };

struct ExrSettings {
  std::string pattern;  // empty: no EXR
  ExrPixels pixels = ExrPixels::half;
  // Lossless: none, rle, zips, zip, piz. Lossy: pxr24, b44, b44a, dwaa, dwab. On noisy half-float frames piz takes
  // about half the time of zip at its fastest level and makes smaller files.
  std::string compression = "piz";
  int zip_level = 1;              // of zip and zips: 1 (fast) .. 9 (small); lossless at every level
  std::vector<std::string> aovs;  // some of aov_names()
};
const std::vector<std::string>& aov_names();  // albedo normal depth samples variance eccentricity

struct DisplaySettings {
  std::string pattern;  // .png .jpg .tif .dpx; empty: no display image
  int bits = 8;         // 8, or 16 for png and tif; dpx is always written with 10
  int quality = 95;     // jpg
};
// The number of bits to ask ColorPipeline::apply for. Error(usage) for an unknown suffix, and for bits that the format
// does not have.
int display_image_bits(const DisplaySettings& settings);
// Error(usage) where the format cannot hold a picture of this size.
void check_display_image_size(const DisplaySettings& settings, int width_px, int height_px);

struct OutputSettings {
  ExrSettings exr;
  DisplaySettings display;
  std::string map_pattern;    // EXR of the sampling map: region, samples per pixel, eccentricity; empty: none
  std::string run_directory;  // where timing.csv and run.json are written; empty: nowhere
  bool overwrite = false;
  bool resume = false;
};

// Error(usage) for everything that is known to fail before the first ray: patterns, suffixes, compression, AOVs, bits.
void check_output_settings(const OutputSettings& settings, bool several_frames);

// What the header of a frame's file states. It contains no time of day, so that a resumed run writes the same bytes.
struct FrameHeader {
  std::int32_t frame = 0;
  std::int64_t t_video_ns = 0;
  FrameRate fps;
  Camera camera;
  std::int64_t shutter_open_ns = 0, shutter_close_ns = 0;  // video time; equal: an instant
  GazeAtTime gaze_render, gaze_true;
  std::vector<std::string> gaze_processing;  // FramePlan::gaze_processing
  double exposure_ev = 0;
  double enhance_contrast = 0;  // above 0: contrast was enhanced, and the picture no longer estimates radiance
  std::uint64_t seed = 0;
  std::string settings_digest;  // hex
  std::string software;         // "gazetrace 0.1.0"
};

// Writes a scene-linear EXR with OpenEXR; the file appears under its name only when it is complete. Returns the number
// of values that were clamped to half's range. Without `eccentricity_deg` (a frame without gaze) that AOV is NaN.
std::uint64_t write_frame_exr(const std::string& path, const Frame& frame, const ImageGray* eccentricity_deg,
                              const FrameHeader& header, const ExrSettings& settings, int threads = 0);
void write_sampling_map_exr(const std::string& path, const SamplingMap& map, const ImageGray* eccentricity_deg);
// Writes a PNG, JPEG, TIFF or DPX, by the suffix, with OpenImageIO; the file is complete or absent.
void write_display_image(const std::string& path, const DisplayImage& image, const FrameHeader& header,
                         const DisplaySettings& settings);
ImageRgb read_exr_rgb(const std::string& path);
// The settings digest in the header of an EXR or display image of gazetrace; empty where there is none, and for files
// that are unreadable or incomplete.
std::string read_settings_digest(const std::string& path);
// One digest, in hex, of everything that can change pixels, given as (name, value) pairs in a fixed order.
std::string digest_settings(const std::vector<std::pair<std::string, std::string>>& settings);
// The same for frames that depend on those before them. It also covers the list of frames, and where the history comes
// from: a number of frames that are rendered before, or the content of a checkpoint. `settings_digest` covers the rest.
std::string digest_of_sequence(const std::string& settings_digest, const std::string& frames, std::int32_t preroll,
                               const std::string& checkpoint);

constexpr std::size_t kTimingRegions = 11;

struct TimingRow {
  std::int32_t frame = 0;
  double plan_ms = 0, pilot_ms = 0, trace_ms = 0, guides_ms = 0, reconstruct_ms = 0, temporal_ms = 0, exposure_ms = 0,
         color_ms = 0, write_ms = 0, total_ms = 0;
  double trace_cpu_ms = 0;
  std::uint64_t pixels = 0, samples = 0, pilot_samples = 0;  // those of the pilot are among the samples
  std::uint64_t rays_primary = 0, rays_bounce = 0, rays_shadow = 0;
  std::uint64_t rejected_rays = 0, non_finite_samples = 0;
  // One entry per region, in the order of timing_regions().
  std::array<std::uint64_t, kTimingRegions> region_pixels{}, region_samples{};
  std::array<double, kTimingRegions> region_cpu_ms{};
  double exposure_ev = 0;
  std::string predicted_relmse, predicted_jod;  // by the pilot; empty where it did not
  std::string gaze_state;                       // of the gaze that steers the frame
  std::string gaze_event;                       // fixation, saccade, blink, ...; "none": not known
  std::string gaze_age_ms;            // "unknown" where a log repeats values once per frame; empty without a row
  std::string gaze_effective_age_ms;  // GazeAges: in the middle of the frame's display; empty where not known
  int no_gaze = 0;                    // 1: the log has no gaze at this time, and the policy for that decided
  double peak_memory_mib = 0;
};

std::vector<std::string> timing_columns();
// Names of the regions that have columns: those of the fall-off "regions", "uniform" for frames without regions, and
// the block sizes of density models.
const std::vector<std::string>& timing_regions();
std::string timing_row_text(const TimingRow& row);                // one line, without the line break
std::string timing_csv_text(const std::vector<TimingRow>& rows);  // header and rows
// Error(input) with file:line. A last line without its line break is what a killed run leaves behind; it is skipped.
std::vector<TimingRow> read_timing_csv(const std::string& path);

// For runs whose frames depend on those before them: what merging needs to know about the history that a part had.
struct RecordedHistory {
  std::string settings_digest;  // the run's digest without its frames and history; empty: no frame depends on another
  std::string frames;           // list of the frames whose history its first written frame had; empty: none
  std::string checkpoint;       // the file that the history came from; empty: none

  friend bool operator==(const RecordedHistory&, const RecordedHistory&) = default;
};

// Everything that is needed to repeat a run; stored as JSON.
struct RunRecord {
  std::string version, build, instruction_set, ray_library;
  std::vector<std::string> command_line;
  std::string config_toml;  // every option with its effective value
  std::string settings_digest;
  std::vector<std::string> part_digests;  // of a merged run: the digests in its parts' pictures, where they differ
  RecordedHistory history;
  std::map<std::string, std::string> input_digests;  // path -> content hash
  std::string frames;                                // a frame list, see format_frame_list()
  bool is_part = false;                              // a part of a longer sequence
  std::string samples;                               // "0:1024": a part of the samples; empty: all of them
  std::map<std::string, std::string> facts;          // load_s, bvh_mib, peak_memory_mib, view, working_space, ...
  Warnings warnings;
  std::vector<BadSample> bad_samples;
};
std::string run_record_json(const RunRecord& record);
RunRecord read_run_record(const std::string& path);  // Error(input)

// timing.csv and run.json, or timing.1-100.csv and run.1-100.json for a part of a sequence.
std::string timing_file_name(const std::string& directory, const std::string& frames, bool is_part);
std::string run_record_file_name(const std::string& directory, const std::string& frames, bool is_part);

// The name of a part of the samples in the names of its files, beginning with the frames: "1-3.samples-0-1024".
std::string part_of_samples_name(const std::string& frames, const SampleRange& samples);
// The file of a frame's sums over a part of the samples: samples.0001.0-1024.sums
std::string samples_file_name(const std::string& directory, std::int32_t frame, const SampleRange& samples);

// What the run over one part left in a directory.
struct RunPart {
  std::string timing_path;
  RunRecord record;
  std::map<std::int32_t, TimingRow> rows;
};
// All parts in a directory, ordered by name. Error(input) where there are none, where records are missing, and where
// settings or inputs differ.
std::vector<RunPart> read_run_parts(const std::string& directory);
// Whether these are parts of the samples, for merge_samples() of pipeline.hpp, rather than parts of the frames.
// Error(input) where both occur.
bool are_parts_of_samples(const std::vector<RunPart>& parts);

struct MergeResult {
  std::vector<std::string> parts;
  std::string frames;
  Warnings warnings;
};
// The record of the whole run. Where the parts differ, the record lists what each says, or a warning is added.
RunRecord join_records(const std::vector<RunPart>& parts, const std::string& frames, Warnings& warnings);
// Joins the parts found in a directory into timing.csv and run.json. Error(input) where the settings digests of parts
// differ, where parts overlap, and where frames are missing (unless allowed); Error(usage) where the files exist and
// may not be overwritten. Where frames depend on those before them, each part must have had the history of all frames
// before it, for instance from another part's checkpoint; a history of only the last few frames (`preroll`) gives a
// warning.
MergeResult merge_runs(const std::string& directory, bool allow_missing, bool overwrite);

// Writes the text to a temporary file beside `path`, and renames that.
void write_text_atomically(const std::string& path, const std::string& text);

}  // namespace gazetrace
