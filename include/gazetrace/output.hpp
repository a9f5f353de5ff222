// SPDX-License-Identifier: Apache-2.0
// Output files: names of a sequence, pictures that appear only when complete, timing and the run record.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/frame_layers.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/reconstruct.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// The file name for a frame, from a pattern such as "beauty.####.exr", "beauty.%04d.exr" or "beauty.<frame>.exr"; %% is
// a percent sign. Folders keep their # and %, except that %04d and <frame> stand for the number there, too, where the
// file's name has it: "out/%04d/%04d.exr". Error(usage) for a file's name with two places for the number, and for one
// with none where `require_number`.
std::string frame_file_name(const std::string& pattern, std::int32_t frame, bool require_number = false);
bool has_frame_number(const std::string& pattern);
// The folder in which the files of all frames lie: that of the pattern, or of its folders the one above the first that
// has the frame's number in its name; "." where there is none.
std::string folder_of_frames(const std::string& pattern);
// The frames for which a file of this pattern exists, ascending; {0} for the name of a single picture that exists.
// Error(input) where there is none.
std::vector<std::int32_t> find_frames(const std::string& pattern);

enum class ExrPixels { half, float32 };
// Colour space of an EXR: linear, with Rec.709's primaries or those of ACES, which are stated in its header.
enum class ExrSpace { rec709, acescg, aces2065_1 };
// Whether all channels are in one part of the file, or each layer is a part of its own, named after it, the picture
// first as "beauty". Readers that want one layer of many then read that alone.
enum class ExrParts { single, multi };

struct ExrSettings {
  std::string pattern;  // empty: no EXR
  ExrPixels pixels = ExrPixels::half;
  ExrSpace space = ExrSpace::rec709;
  // Lossless: none, rle, zips, zip, piz. Lossy: pxr24, b44, b44a, dwaa, dwab. Of half floats zip takes 2 to 15 % less
  // room than piz, is read in three quarters of its time, and takes as long to write.
  std::string compression = "zip";
  int zip_level = 1;              // of zip and zips: 1 (fast) .. 9 (small); lossless at every level
  std::vector<std::string> aovs;  // some of aov_names()
  bool alpha = false;             // FrameLayers::alpha as the picture's A; display pictures have it as well, straight
  // With `multi` and a lossy compression, layers of numbers (all but light, albedo and normals) are compressed by zip.
  ExrParts parts = ExrParts::single;
  std::optional<double> sky_depth_m;  // the depth of pixels that see nothing; empty: infinite
  int crypto_ranks = 6;               // CoverageSettings::ranks of Cryptomatte layers: an even number, 2..16
  int crypto_rays = 64;               // CoverageSettings::rays, 1..1024
};
const std::vector<std::string>& aov_names();  // those of aov_infos()

struct DisplaySettings {
  std::string pattern;  // .png .jpg .tif .dpx; empty: no display image
  int bits = 8;         // 8, or 16 for png and tif; dpx is always written with 10
  int quality = 95;     // jpg
};
// The number of bits to ask ColorPipeline::apply for. Error(usage) for an unknown suffix, and for bits that the format
// does not have.
int display_image_bits(const DisplaySettings& settings);
bool holds_alpha(const DisplaySettings& settings);
// Error(usage) where the format cannot hold a picture of this size.
void check_display_image_size(const DisplaySettings& settings, int width_px, int height_px);

struct OutputSettings {
  ExrSettings exr;
  DisplaySettings display;
  std::string map_pattern;  // EXR of the sampling map: region, samples per pixel, eccentricity; empty: none
  // The run's own files begin with this: "out/frame" stands for out/frame.timing.csv and out/frame.run.json, see
  // run_name_of(). Empty: none are written.
  std::string run_name;
  bool overwrite = false;
  bool resume = false;
  bool trust_files = false;  // `resume` believes the headers of finished files, and does not compare their content
};

// Error(usage) for everything that is known to fail before the first ray: patterns, suffixes, compression, AOVs, bits.
void check_output_settings(const OutputSettings& settings, bool several_frames);

// A file as it was written: proof that it is still the same later.
struct WrittenFile {
  std::int32_t frame = 0;
  std::uint64_t bytes = 0;
  std::string digest;  // of the content, hex

  friend bool operator==(const WrittenFile&, const WrittenFile&) = default;
};
// Files of a run by their names, relative to the folder of its record, or absolute where they lie elsewhere.
using WrittenFiles = std::map<std::string, WrittenFile>;

// The clean gaze of the log as numbers, for programs that read headers and tables.
struct GazeNumbers {
  // Fractions of the screen, origin top left; of logs that hold directions, fractions of the frame. NaN without gaze.
  double u = std::numeric_limits<double>::quiet_NaN(), v = std::numeric_limits<double>::quiet_NaN();
  int valid = 0;  // 1: the log has gaze at this time; 0: it has none, and u and v are a substitute, or NaN
};
GazeNumbers gaze_numbers(const FrameRequest& request);

// The header of a frame's file. It contains no time of day, so that a resumed run writes the same bytes.
struct FrameHeader {
  std::int32_t frame = 0;
  std::int64_t t_video_ns = 0;
  FrameRate fps;
  Camera camera;
  FrameWindow window;
  std::int64_t shutter_open_ns = 0, shutter_close_ns = 0;  // video time; equal: an instant
  GazeAtTime gaze_render, gaze_true;
  GazeNumbers gaze;
  std::vector<std::string> gaze_processing;  // FramePlan::gaze_processing
  double exposure_ev = 0;
  std::uint64_t seed = 0;
  std::string settings_digest;   // hex
  std::string mean_digest;       // PipelineSettings::mean_digest; empty: no mean is to be taken of this picture
  double samples_per_pixel = 0;  // where every pixel has as many; 0: they differ
  std::string software;          // "gazetrace 0.1.0"
};

struct WrittenExr {
  std::uint64_t clamped_values = 0;  // values that were clamped to half's range
  WrittenFile file;
};
// Writes a scene-linear EXR with OpenEXR. Error(usage) where an AOV was asked for that the frame does not have. The
// file appears under its name only when it is complete. Without `eccentricity_deg` (a frame without gaze) that AOV is
// NaN.
WrittenExr write_frame_exr(const std::string& path, const Frame& frame, const ImageGray* eccentricity_deg,
                           const FrameHeader& header, const ExrSettings& settings, int threads = 0,
                           const FrameLayers& layers = {});
WrittenFile write_sampling_map_exr(const std::string& path, const SamplingMap& map, const ImageGray* eccentricity_deg,
                                   const FrameWindow& window = {});
// One channel, Y, in 32-bit floats: for other renderers, and for DensitySampling::picture_files.
WrittenFile write_density_exr(const std::string& path, const ImageGray& density, std::int32_t frame,
                              const FrameWindow& window = {});
// Writes a PNG, JPEG, TIFF or DPX, by the suffix, with OpenImageIO; the file is complete or absent. With `alpha`, which
// PNG and TIFF hold, the colours of the image are straight: not multiplied by it.
WrittenFile write_display_image(const std::string& path, const DisplayImage& image, const FrameHeader& header,
                                const DisplaySettings& settings, const ImageGray* alpha = nullptr);
ImageRgb read_exr_rgb(const std::string& path);
// Data of its run in the header of an EXR or display image of gazetrace. The digest is empty where there is
// none, and for files that are unreadable or incomplete.
struct FrameStamp {
  std::string settings_digest;
  std::optional<std::int32_t> frame;  // empty: not stated
  std::optional<double> exposure_ev;
};
FrameStamp read_frame_stamp(const std::string& path);
std::string read_settings_digest(const std::string& path);
// One digest, in hex, of everything that can change pixels, given as (name, value) pairs in a fixed order.
std::string digest_settings(const std::vector<std::pair<std::string, std::string>>& settings);

constexpr std::size_t kTimingRegions = 11;

struct TimingRow {
  std::int32_t frame = 0;
  double plan_ms = 0, guiding_ms = 0, pilot_ms = 0, trace_ms = 0, guides_ms = 0, reconstruct_ms = 0, temporal_ms = 0,
         exposure_ms = 0, layers_ms = 0, color_ms = 0, write_ms = 0, total_ms = 0;
  double trace_cpu_ms = 0;
  std::uint64_t pixels = 0, samples = 0, pilot_samples = 0;  // those of the pilot are among the samples
  std::uint64_t other_samples = 0;   // among the samples: of frames that were traced only since this one reads them
  std::uint64_t training_paths = 0;  // these are not; see TraceStats
  std::uint64_t rays_primary = 0, rays_bounce = 0, rays_shadow = 0;
  std::uint64_t rejected_rays = 0, non_finite_samples = 0;
  // One entry per region, in the order of timing_regions().
  std::array<std::uint64_t, kTimingRegions> region_pixels{}, region_samples{};
  std::array<double, kTimingRegions> region_cpu_ms{};
  double exposure_ev = 0;
  std::string predicted_relmse, predicted_jod;  // Prediction; empty: nothing was predicted
  std::string gaze_state;                       // of the gaze that steers the frame
  GazeNumbers gaze;                             // of the clean log
  std::string gaze_event;                       // fixation, saccade, blink, ...; "none": not known
  std::string gaze_age_ms;            // "unknown" where a log repeats values once per frame; empty without a row
  std::string gaze_effective_age_ms;  // GazeAges: in the middle of the frame's display; empty where not known
  int no_gaze = 0;                    // 1: the log has no gaze at this time, and the policy for that decided
  double peak_memory_mib = 0;
};

std::vector<std::string> timing_columns();
// Names of the regions that have columns: those of RegionSampling, "uniform" for frames without regions, and
// the block sizes of density models.
const std::vector<std::string>& timing_regions();
std::string timing_row_text(const TimingRow& row);                // one line, without the line break
std::string timing_csv_text(const std::vector<TimingRow>& rows);  // header and rows
// Error(input) with file:line. A last line without its line break comes from a killed run; it is skipped.
std::vector<TimingRow> read_timing_csv(const std::string& path);

// Everything that is needed to repeat a run; stored as JSON.
struct RunRecord {
  std::string version, build, instruction_set, ray_library;
  std::string denoiser;  // denoiser_description(), where the filter is oidn; else empty
  std::vector<std::string> command_line;
  std::string config_toml;  // every option with its effective value
  std::string settings_digest;
  std::vector<std::string> part_digests;             // of a mean: the digests in the pictures that it is made of
  std::map<std::string, std::string> input_digests;  // path -> content hash
  std::string frames;                                // a frame list, see format_frame_list()
  bool is_part = false;                              // a part of a longer sequence
  std::string chunk_file;                    // the ChunkFile that its frames come from, in its folder; empty: none
  std::map<std::string, std::string> facts;  // load_s, bvh_mib, peak_memory_mib, view, working_space, ...
  Warnings warnings;
  std::vector<BadSample> bad_samples;
  WrittenFiles files;  // pictures and maps, as they were written
};
std::string run_record_json(const RunRecord& record);
RunRecord read_run_record(const std::string& path);  // Error(input)
// Error(input) where two runs whose pictures are put together had different denoisers: other weights or loops make
// another picture, which would flicker from frame to frame.
void check_same_denoiser(const RunRecord& first, const std::string& first_path, const RunRecord& other,
                         const std::string& other_path);

// The prefix of the record files of a sequence: its folder and its name without number and suffix, so that
// out/frame.####.exr and out/frame.####.png, which one run writes, share "out/frame". A sequence that has no name
// beside its number, such as out/####.exr, gives "out/".
std::string run_name_of(const std::string& pattern);
std::string folder_of_run(const std::string& run_name);
// NAME.timing.csv and NAME.run.json, or NAME.timing.1-100.csv and NAME.run.1-100.json for a part of a sequence; without
// NAME timing.csv and so on, which were the names of every sequence before version 1.
std::string timing_file_name(const std::string& run_name, const std::string& frames, bool is_part);
std::string run_record_file_name(const std::string& run_name, const std::string& frames, bool is_part);

// How the frames of a sequence were divided among the tasks of an array job. The first task that comes writes it down
// beside the outputs, and it is never replaced: so all tasks have the same borders, and a chunk that never began is
// known to be missing.
struct ChunkFile {
  std::string digest;               // of the inputs of the borders
  std::string frames;               // all of them, a frame list
  std::vector<std::string> chunks;  // the frames of each; an empty text: none
  std::vector<double> samples;      // that the plan expects of each; 0: not known
};
std::string chunk_file_text(const ChunkFile& file);
ChunkFile read_chunk_file(const std::string& path);  // Error(input)

// The files of a run over one part in a directory.
struct RunPart {
  std::string run_name;  // of the sequence that it is a part of
  std::string timing_path, record_path;
  RunRecord record;
  std::map<std::int32_t, TimingRow> rows;
};
// All parts of a sequence, ordered by name: `where` is their folder or, where that has parts of several sequences, the
// pattern of the pictures, out/frame.####.exr. Error(input) where there are none, where records are missing, and where
// sequences, settings or inputs differ. The files of a part that was killed are those in its journal.
std::vector<RunPart> read_run_parts(const std::string& where);

// The files of a run that is going on or was killed: beside its record, which takes them over at the end, a line for
// each as it was written.
std::string file_journal_name(const std::string& record_path);
WrittenFiles read_file_journal(const std::string& path);  // empty where there is none; skips damaged lines

// A file that differs from the record of its run.
struct BadFile {
  std::string path;
  std::int32_t frame = 0;
  std::string problem;  // "is missing", "holds frame 30", "has 1000 bytes in place of 48213", ...
};
// Compares files with a record, on several threads; in the order of frames. `directory`: that of the record.
std::vector<BadFile> find_bad_files(const std::string& directory, const WrittenFiles& files,
                                    const std::string& settings_digest, int threads = 0);
// The same of all parts. A frame with a row in its part's timing of which the record lists no file is bad as well.
std::vector<BadFile> find_bad_files(const std::vector<RunPart>& parts, int threads = 0);
// Error(input) that counts bad files, and names the first of them and their frames; nothing where there are none.
void refuse_bad_files(const std::string& directory, const std::vector<BadFile>& bad);

struct MergeOptions {
  bool allow_missing = false;  // join the others; frames whose files are bad count as missing
  bool overwrite = false;
  bool trust_files = false;  // do not look at the files that the parts' records list
  int threads = 0;           // for looking at them
};
struct MergeResult {
  std::vector<std::string> parts;
  std::string frames;
  Warnings warnings;
};
// Joins the parts of a sequence, see read_run_parts(), into its timing and record. Error(input) where the settings
// digests of parts differ, where parts overlap, where files are not those that the parts wrote, and where frames are
// missing (unless allowed); Error(usage) where timing or record exist and may not be overwritten. Error(runtime) where
// a run or another merge is writing timing or record.
MergeResult merge_runs(const std::string& where, const MergeOptions& options = {});

// Whether a command may write these files, decided before its work for every output of every command: no output is a
// device, pipe, socket or folder, none is one of the `inputs` (files, or patterns of frames) under any name, no
// two are one file, and unless it may be replaced none is there; else Error(usage or input), which then advises
// `remedy`. Makes their folders. Empty names are of outputs that nobody asked for.
void check_outputs(std::vector<std::string> outputs, const std::vector<std::string>& inputs, bool may_replace,
                   const std::string& remedy = "give `overwrite` or another name");
// Writes the text to a temporary file beside `path`, and renames that.
void write_text_atomically(const std::string& path, const std::string& text);

}  // namespace gazetrace
