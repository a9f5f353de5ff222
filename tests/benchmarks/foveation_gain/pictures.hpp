// SPDX-License-Identifier: Apache-2.0
// Pictures of the rivals, and how they score.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compare/eccentricity_bands.hpp"
#include "foveation_gain/rows.hpp"
#include "gazetrace/color.hpp"
#include "gazetrace/guides.hpp"
#include "gazetrace/reconstruct.hpp"
#include "gazetrace/temporal.hpp"
#include "gazetrace/trace.hpp"
#include "world.hpp"

namespace gazetrace::gain {

struct Gaze {
  std::string name;
  Vec2d at;  // fractions of the frame
};

// Samples of one map, once traced; each filter makes a picture of them.
struct Shot {
  SamplingMap map;
  SparseFrame sparse;
};
// A still is one shot; a clip is several of other samples, in which nothing moves.
struct Traced {
  std::vector<Shot> frames;
  double plan_ms = 0, trace_ms = 0;  // a frame, by the mean
  [[nodiscard]] double spp() const;  // the same
};
// The still, or the last frame of a clip.
struct Picture {
  ImageRgb light;
  double guides_ms = 0, reconstruct_ms = 0, temporal_ms = 0;  // a frame, by the mean
};

// Traces and filters. The frame fills the paper's display.
class Renderer {
 public:
  // Pictures are the last ones of clips of so many frames; of more than one, their mean.
  Renderer(PathTracer& tracer, const Camera& camera, const benchmark::FrameSize& size, int clip_frames);

  // `surfaces`: for filters that need guides. Empty gaze: for maps that need none.
  [[nodiscard]] Traced trace(const FoveationSettings& settings, const std::optional<Gaze>& gaze, int seed,
                             bool surfaces) const;
  // First hits are the same for every map and frame: they are traced once, and their time is that of the first time,
  // in every frame; so is that of where surfaces were seen before.
  Picture filtered(const Traced& traced, const std::string& filter);
  void forget_first_hits() { guides_.reset(); }
  [[nodiscard]] const PlanarView& view() const { return view_; }

 private:
  PathTracer& tracer_;
  Camera camera_;
  PlanarView view_;
  int clip_frames_ = 1;
  std::optional<Guides> guides_;
  double guides_ms_ = 0;
};

// A model of all_models() scaled to an average count. Cut-off frequencies are relative to the fovea: measured against
// what so few pixels can show, most models would be flat.
FoveationSettings model_settings(const std::string& model, double spp);
FoveationSettings uniform_settings(double spp);
FoveationSettings blocks_settings(double spp);  // uniform, in blocks as models have them at that density
FoveationSettings paper_settings();             // regions with their own counts

// Bilinear between pixel centres; beyond the outer ones the outer ones.
ImageRgb enlarged(const ImageRgb& image, int width_px, int height_px);

// What does not depend on the gaze: made once a picture.
struct ScoreMaps {
  ImageGray relmse, flip;  // empty: not asked for
  ImageGray luminance_cd_m2;
};

// Errors against the mean of several pictures of other seeds. relMSE is of linear light at the exposure, FLIP of the
// sRGB view at the display's pixels per degree, FovVideoVDP of the same view on a display of 200 cd/m2.
class Judge {
 public:
  Judge(const std::vector<std::string>& reference_files, const PlanarView& view, std::optional<double> ev,
        const std::vector<Gaze>& gazes, const std::vector<std::string>& metrics);

  [[nodiscard]] ScoreMaps maps_of(const ImageRgb& light) const;
  // Columns of the share and of each metric at a gaze. JOD of a band is 10 less the mean of its local differences.
  void score(const ScoreMaps& maps, std::size_t gaze, Row& row) { score(maps, reference_luminance_, gaze, row); }
  // At each gaze, "halves": the first half of the files against the second; and "own", what the reference's noise adds
  // to relative errors: the error of one half against their mean. That is half of the halves' difference, which has
  // the variance of the mean.
  [[nodiscard]] std::vector<Row> floor();

  [[nodiscard]] double ev() const { return ev_; }
  [[nodiscard]] double pixels_per_degree() const;
  [[nodiscard]] double mean_ratio(const ImageRgb& light) const;  // of the frame's light, to the reference

 private:
  void score(const ScoreMaps& maps, const ImageGray& reference_cd_m2, std::size_t gaze, Row& row);
  [[nodiscard]] bool wants(Metric metric) const;
  [[nodiscard]] ScoreMaps maps_of(const MetricPicture& reference, const ImageRgb& light) const;
  [[nodiscard]] MetricPicture shown(ImageRgb light) const;

  std::vector<std::string> metrics_;
  PlanarView view_;
  ColorPipeline color_;
  double ev_ = 0;
  ImageRgb halves_[2];
  MetricPicture reference_;
  ImageGray reference_luminance_;
  std::vector<Gaze> gazes_;
  std::vector<EccentricityBands> bands_;
  FovVideoVdp vdp_;
};

}  // namespace gazetrace::gain
