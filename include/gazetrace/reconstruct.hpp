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
  ImageGray sample_count;  // effective samples behind a pixel: site samples / site pixels, plus what accumulation adds
  ImageGray variance;      // of the pixel's mean luminance, from the spread of its samples, or of those around one
  // Estimate of the squared error of the pixel's luminance: its variance, and the square of what the filter changed
  // beside noise. Empty for filters that make no estimate of it (all but those that need halves). Accumulation leaves
  // it as it was for the samples that went through the filter.
  ImageGray squared_error;
  ImageRgb albedo, normal;  // first hit, means over all samples; normal in world space, zero where nothing was hit
  ImageGray depth_m;        // mean over the hits; +Inf where the pixel's site hit nothing
};

// What a filter must be given besides the sums of every site. Each filter states it in its own file.
struct ReconstructionNeeds {
  // The first hits of every pixel, traced with these settings (but see Reconstruction::guide_settings); empty: none.
  std::optional<GuideSettings> guides = std::nullopt;
  // Sums per surface (SparseFrame::surfaces). Only samples can be sorted by surface: an accumulated frame and the sums
  // of a part of the samples do not hold them.
  bool surfaces = false;
  bool halves = false;  // SparseFrame::half_difference, and samples that are traced in halves
};

struct FilterInfo {
  std::string name;  // as users write it, for example "push-pull"
  std::string description;
  ReconstructionNeeds needs;
  bool blurs_blocks = true;  // it takes contrast from the picture where blocks are coarse (see contrast_gain)
};
std::vector<FilterInfo> reconstruction_filters();

struct ReconstructionSettings {
  // One of reconstruction_filters(). There is no default that suits every job: choose_filter() names one for the job at
  // hand.
  std::string filter;
  std::optional<std::uint64_t> pass_through_samples;  // as in PassThrough; only filters that need surfaces heed it
};

struct FilterDefinition;  // what a file of src/reconstruct/filters/ defines

// A filter with its settings. It states what it needs, so that nobody else has to know the filters.
class Reconstruction {
 public:
  // Error(usage) for a name that is not in reconstruction_filters().
  explicit Reconstruction(const ReconstructionSettings& settings);

  [[nodiscard]] const FilterInfo& filter() const { return filter_; }
  [[nodiscard]] const ReconstructionNeeds& needs() const { return filter_.needs; }

  // The settings under which the tracer collects what the filter needs: sums per surface of the sites that it changes.
  [[nodiscard]] TraceSettings trace_settings(TraceSettings settings) const;
  // The settings of the guides that the filter needs, for samples that are traced with `trace`: their materials are
  // those of the samples, and a ray's cone is at least as wide as a sample's. Empty: the filter needs no guides.
  [[nodiscard]] std::optional<GuideSettings> guide_settings(const TraceSettings& trace) const;

  // A site without samples takes its value from its neighbours. The pixels of a site that PassThrough keeps have the
  // same bits under every filter. `guides`: of the map's size, nullptr unless the filter needs them. Error(runtime) for
  // inputs that do not belong together.
  [[nodiscard]] Frame frame(const SparseFrame& sparse, const SamplingMap& map, const Guides* guides = nullptr,
                            int threads = 0) const;

 private:
  const FilterDefinition* definition_;
  FilterInfo filter_;
  std::optional<std::uint64_t> pass_through_samples_;
};

// What decides which filter suits a job. The defaults are those of a foveated job that asks for nothing else.
struct FilterFacts {
  bool foveated = true;            // a gaze steers where the samples go, under another fall-off than "uniform"
  bool accumulates_sites = false;  // AccumulateMode::reproject under AccumulateOrder::before
  bool enhances_contrast = false;  // enhance_contrast() is applied
  bool means_frames = false;       // AccumulateMode::running
  bool single_pixel = false;       // TraceSettings::only_pixel
};
struct FilterChoice {
  std::string name;
  std::string reason;  // the end of a sentence that begins "... because"
};
// "guided", since it shows edges and texture at full resolution, takes noise away, and tends to the samples' own mean
// as they grow in number. "linear" wherever "guided" would not work (it needs all samples) or leaves nothing to
// enhance.
FilterChoice choose_filter(const FilterFacts& facts);

// Contrast preservation where samples are sparse: an enhancement, not an estimate of radiance.
//
// Blocks of n pixels take contrast from the picture: averaged over a block and interpolated between blocks, a wave of
// f cycles a pixel keeps sinc(f n)^3 of its amplitude, sinc(x) = sin(pi x) / (pi x). Patney et al., "Towards Foveated
// Rendering for Gaze-Tracked Virtual Reality" (ACM TOG 35(6), 2016) found that the eye's periphery misses this contrast
// more than detail, and raise what is left. Here the logarithm of luminance goes `gain` times farther from its mean
// under a Gaussian of standard deviation n pixels:
//   log Y' = log Y + gain (log Y - mean),   gain = strength (sinc(1/4)^-3 - 1) / (1 - exp(-pi^2 / 8))
// so that at strength 1 a wave of half the blocks' own limit, f = 1 / (4 n), is as strong as before. Colours keep their
// ratios. Waves longer than that come out up to 6 % too strong, and noise is raised with the picture.
double contrast_gain(double strength);

// Pixels of 1x1 blocks and black pixels keep their bits. The gain moves a pixel at most by a factor of 7.4 (e^2) for
// each unit of gain, so that single bright samples are not raised without bounds. `strength` is in 0..1; Error(usage)
// outside of it, and where the map is not of the picture's size.
ImageRgb enhance_contrast(ImageRgb radiance, const SamplingMap& map, double strength, int threads = 0);

}  // namespace gazetrace
