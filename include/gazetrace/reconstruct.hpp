// SPDX-License-Identifier: Apache-2.0
// From the sums of every site to a dense frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/foveation.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/image.hpp"
#include "gazetrace/trace.hpp"

namespace gazetrace {

// Every pixel has a finite value. The AOV images (albedo, normal, depth) are empty unless the SparseFrame holds guides.
struct Frame {
  ImageRgb radiance;       // linear Rec.709
  ImageGray sample_count;  // effective samples behind a pixel: site samples / site pixels, those of other frames that
                           // join it included
  ImageGray variance;      // of the pixel's mean luminance, from the spread of its samples, or of those around one
  // Estimate of the squared error of the pixel's luminance: its variance, and the square of the filter's change
  // beside noise. Empty for filters that make no estimate of it (all but those that need halves). Accumulation leaves
  // it as it was for the samples that went through the filter.
  ImageGray squared_error;
  ImageRgb albedo, normal;  // first hit, means over all samples; normal in world space, zero where nothing was hit
  ImageGray depth_m;        // mean over the hits; +Inf where the pixel's site hit nothing
};

// Inputs of a filter besides the sums of every site. Each filter states it in its own file.
struct ReconstructionNeeds {
  // The first hits of every pixel, traced with these settings (but see Reconstruction::guide_settings); empty: none.
  std::optional<GuideSettings> guides = std::nullopt;
  // Sums per surface (SparseFrame::surfaces). Only samples can be sorted by surface: an accumulated frame and the sums
  // of a part of the samples do not hold them.
  bool surfaces = false;
  bool halves = false;      // SparseFrame::half_difference, and samples that are traced in halves
  bool first_half = false;  // SparseFrame::first_half
};

struct FilterInfo {
  std::string name;  // as users write it, for example "guided"
  std::string description;
  ReconstructionNeeds needs;
};
std::vector<FilterInfo> reconstruction_filters();

struct ReconstructionSettings {
  // One of reconstruction_filters(). There is no default that suits every job: choose_filter() names one for the job at
  // hand.
  std::string filter;
};

struct FilterDefinition;  // defined by a file of src/reconstruct/filters/

// A filter with its settings. It states its inputs, so that nobody else has to know the filters.
class Reconstruction {
 public:
  // Error(usage) for a name that is not in reconstruction_filters().
  explicit Reconstruction(const ReconstructionSettings& settings);

  [[nodiscard]] const FilterInfo& filter() const { return filter_; }
  [[nodiscard]] const ReconstructionNeeds& needs() const { return filter_.needs; }

  // The settings under which the tracer collects the filter's inputs: sums per surface of the sites that it changes.
  // `map`: where the samples go, if that is known. The halves are then independent (TraceSettings) only for a filter
  // that reads them.
  [[nodiscard]] TraceSettings trace_settings(TraceSettings settings, const SamplingMap* map = nullptr) const;
  // The settings of the guides that the filter needs, for samples that are traced with `trace`: their materials are
  // those of the samples. Empty: the filter needs no guides. `joins`: the frames of a window join. Their
  // samples have seen most features many times, so one ray a pixel is enough.
  [[nodiscard]] std::optional<GuideSettings> guide_settings(const TraceSettings& trace, bool joins = false) const;

  // A site without samples takes its value from its neighbours. `guides`: of the map's size, nullptr unless the filter
  // needs them. Error(runtime) for inputs that do not belong together.
  [[nodiscard]] Frame frame(const SparseFrame& sparse, const SamplingMap& map, const Guides* guides = nullptr,
                            int threads = 0) const;

 private:
  const FilterDefinition* definition_;
  FilterInfo filter_;
};

// The library that the filter "oidn" calls, Open Image Denoise 2.
struct DenoiserLibrary {
  std::string path;             // empty: none was found that can be used
  std::string version;          // "2.5.1"
  std::string instruction_set;  // of its loops: "avx512", "avx2", "sse4.1" or "neon"
  std::string problem;          // without a path: why the first file that was found cannot be used
};
// Looks for it when it is first called: the environment variable GAZETRACE_OIDN_LIBRARY names its file or folder, or
// is empty, and there is none; else the system's, one beside the program or in its build folder, that of Python's
// `pyoidn`, Blender's. Error(usage) where the variable names an unusable file.
const DenoiserLibrary& denoiser_library();
// Library, quality, weights and instruction set, for the records of runs; empty where there is none.
std::string denoiser_description();

// The properties of a job that choose its filter. The defaults are those of a foveated job that asks for nothing else.
struct FilterFacts {
  bool foveated = true;       // a gaze steers where the samples go, by another sampling than a uniform one
  bool single_pixel = false;  // TraceSettings::only_pixel
  bool has_denoiser = false;  // denoiser_library() has found one
};
struct FilterChoice {
  std::string name;
  std::string reason;  // the end of a sentence that begins "... because"
};
// "oidn" where its library is there, "guided" where it is not. "linear" wherever "guided" would not work (it needs all
// samples).
FilterChoice choose_filter(const FilterFacts& facts);

}  // namespace gazetrace
