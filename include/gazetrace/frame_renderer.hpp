// SPDX-License-Identifier: Apache-2.0
// One frame, from the request to the picture: every stage in its order, and nothing on disk. render_sequence()
// (pipeline.hpp) makes sequences of files with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/frame_layers.hpp"
#include "gazetrace/plan.hpp"
#include "gazetrace/reconstruct.hpp"
#include "gazetrace/temporal.hpp"
#include "gazetrace/trace.hpp"
#include "gazetrace/visible_error.hpp"

namespace gazetrace {

// As MapContext::density and ::full_rate_spp.
struct FrameRates {
  ImageGray spp;
  double full_rate_spp = 0;
};

struct FrameSettings {
  FoveationSettings foveation;
  TraceSettings trace;                    // the filter's needs are added to it: `surfaces`, `halves`
  ReconstructionSettings reconstruction;  // its filter must be named; choose_filter() helps
  AccumulateSettings accumulate;
  ExposureSettings exposure;
  // The viewing conditions that a pilot needs: with the frame's view, the look of its noise.
  double frames_per_second = 0;  // of the clip that the frame belongs to; 0: a still
  // Where it is given: the rates of a frame, in place of the file and of the pilot of its sampling.
  std::function<FrameRates(const FrameRequest& request)> rates_of;
  // Where it is given, and TraceSettings::guiding is set: the guiding field of a frame, in place of
  // PosedScene::train_guiding(). So a part of a frame is guided as the whole frame is.
  std::function<std::shared_ptr<const GuidingField>(const FrameRequest& request)> light_of;
  // How the viewer's display shows luminance at an exposure in stops; empty: linear_display_curve().
  std::function<DisplayCurve(double exposure_ev)> display_curve;
  LayerSettings layers;
  int threads = 0;  // 0: all
};

// Wall time of the stages, ms.
struct StageTimes {
  double plan_ms = 0;         // the sampling map
  double guiding_ms = 0;      // PosedScene::train_guiding()
  double pilot_ms = 0;        // everything that decides the rates of AdaptiveSampling
  double trace_ms = 0;        // samples, and putting the scene into its pose
  double guides_ms = 0;       // first hits for the filter
  double reconstruct_ms = 0;  // the filter
  double temporal_ms = 0;     // joining frames of a window, and where surfaces are in them
  double exposure_ms = 0;
  double layers_ms = 0;  // FrameLayers
};

struct Prediction {
  std::optional<double> relmse;  // as QualityTarget::relmse, of the frame, by the pilot of AdaptiveSampling
  // As QualityTarget::jod, of the sequence, by the choice of its rate (render_sequence()). Empty from FrameRenderer.
  std::optional<double> jod;
};

// The samples of a frame and where they went.
struct TracedFrame {
  SamplingMap map;
  SparseFrame sparse;
  // Of the samples that told where the frame's own belong, and were discarded. The paths of TraceSettings::guiding
  // are counted here, too, but are no samples.
  TraceStats pilot;
  Prediction prediction;
  StageTimes times;  // plan_ms, guiding_ms, pilot_ms and trace_ms
};

struct RenderedFrame {
  Frame frame;             // linear
  double exposure_ev = 0;  // stops; the radiance is not multiplied by it
  FrameLayers layers;      // those of FrameSettings::layers
  SamplingMap map;
  TraceStats samples, pilot;  // as SparseFrame::stats and TracedFrame::pilot
  // Of frames that were traced only because this one reads them (AccumulateMode::window), their pilots among them.
  // Their time is part of `times`. Empty from FrameRenderer.
  TraceStats others;
  Prediction prediction;
  StageTimes times;
};

// The guiding field trained for a frame. Frames with the same camera and scene reuse it, since training is
// deterministic. It belongs to one renderer: others have other settings, and would train another field.
struct TrainedField {
  std::optional<FrameRequest> request;  // that it was trained for; empty: none
  std::shared_ptr<const GuidingField> field;
};

// A frame of a window: its samples, and the surfaces that its pixels see.
struct WindowFrame {
  FrameRequest request;
  TracedFrame traced;
  PixelHits hits;
  std::vector<std::uint8_t> glossy;  // of each site: 1 where it saw a glossy surface
};

class FrameRenderer {
 public:
  // Error(usage) for a filter that is not there. Keeps a reference to `tracer`, which must outlive it; several
  // renderers may share one.
  FrameRenderer(PathTracer& tracer, FrameSettings settings);

  [[nodiscard]] const FrameSettings& settings() const { return settings_; }

  // map -> trace -> feature buffers, where the filter needs them -> reconstruct -> exposure.
  // A function of its arguments: a frame has the same bits alone and in a sequence. No other frame is read, with any
  // AccumulateSettings.
  [[nodiscard]] RenderedFrame render(const FrameRequest& request) const;
  // With `known`, which saves time and changes no picture. It begins empty, and is then that of this frame.
  [[nodiscard]] RenderedFrame render(const FrameRequest& request, TrainedField& known) const;

  // Whether nothing moves between two frames: they see the same, and differ by their samples alone.
  [[nodiscard]] bool at_rest(const FrameRequest& a, const FrameRequest& b) const;

  // The first two stages alone.
  [[nodiscard]] TracedFrame trace(const FrameRequest& request) const;
  [[nodiscard]] TracedFrame trace(const FrameRequest& request, TrainedField& known) const;
  // All stages after them: render() is finish(request, trace(request)).
  [[nodiscard]] RenderedFrame finish(const FrameRequest& request, TracedFrame traced) const;

  // The first stages of a frame that others read (AccumulateMode::window), and all stages after them for one of a
  // window's frames, which are in order: only its own samples and times are counted. Whether this frame has neighbours
  // on both sides is the caller's choice; JoinedFrames chooses them by AccumulateSettings.
  [[nodiscard]] WindowFrame window_frame(const FrameRequest& request, TrainedField& known) const;
  [[nodiscard]] RenderedFrame finish(const std::vector<const WindowFrame*>& window, std::size_t own) const;

 private:
  // All stages after the samples. The picture's samples are in `shown`; counts and times are those of `own`.
  [[nodiscard]] RenderedFrame finish_with(const FrameRequest& request, const SamplingMap& map, const SparseFrame& shown,
                                          TracedFrame own) const;
  // Whether the frame would train the field of `known`: its own, or that of a frame at rest with it.
  [[nodiscard]] bool is_trained(const TrainedField& known, const FrameRequest& request) const;
  // Adds the paths that it takes to `stats`.
  [[nodiscard]] std::shared_ptr<const GuidingField> guiding_field(const PosedScene& scene, const FrameRequest& request,
                                                                  TrainedField& known, TraceStats& stats) const;
  // Each group of light by a filter that is linear; none unless they are asked for.
  [[nodiscard]] std::vector<ImageRgb> filtered_light(const SparseFrame& sparse, const SamplingMap& map,
                                                     StageTimes& times) const;
  void add_layers(const FrameRequest& request, std::vector<ImageRgb> light, RenderedFrame& rendered) const;

  PathTracer* tracer_;
  FrameSettings settings_;
  Reconstruction reconstruction_;
  std::shared_ptr<const std::vector<MatteTable>> tables_;  // of FrameSettings::layers; nullptr: there are no mattes
};

// Inputs of the sampling map of a frame beside settings, view and gaze, pictures left out.
MapContext map_context(const FrameRequest& request, std::uint64_t seed, int threads = 0);

// The picture of picture_files_of() that a frame follows, checked by check_density_picture(); empty where there is
// none. Error(input).
ImageGray read_density_picture(const FoveationSettings& settings, std::int32_t frame);
// Every file that picture_files_of() may stand for, by name; Error(input) where there are none of that name.
std::vector<std::string> density_picture_files(const FoveationSettings& settings);

// The sampling map of a frame, for settings under which no pilot of the frame decides it (looks_first()).
SamplingMap planned_sampling_map(const FoveationSettings& settings, const FrameRequest& request, std::uint64_t seed,
                                 int threads = 0);

// Relative density of the samples of such a frame, 1 where the eye looks: a density model at each pixel's centre; of
// regions, the expected samples of a pixel. 1 everywhere without gaze.
ImageGray planned_density(const FoveationSettings& settings, const FrameRequest& request, std::uint64_t seed,
                          int threads = 0);

// Samples a pixel of such a frame on average, and where the eye looks; twice the same without gaze.
struct PlannedRates {
  double mean_spp = 0, most_spp = 0;
};
PlannedRates planned_rates(const FoveationSettings& settings, const FrameRequest& request, std::uint64_t seed,
                           int threads = 0);

}  // namespace gazetrace
