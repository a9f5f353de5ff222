// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/eccentricity_bands.hpp"
#include "compare/score_series.hpp"
#include "compare/sequence_metric.hpp"
#include "core/named.hpp"
#include "gazetrace/compare.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"

namespace gazetrace {
namespace {

constexpr PrintedNumbers kPrinted{comparison_value, comparison_local_value};

// The frames of one gaze class, or all frames.
struct FrameGroup {
  std::size_t frames = 0;
  std::vector<ScoreSeries> series;  // one per metric
};

MetricInfo known_metric(const std::string& name) {
  return find_named(comparison_metrics(), name, "metric", "`metrics`");
}

}  // namespace

std::string metric_unit(const std::string& metric) {
  return metric == "psnr" ? "dB" : metric == "fovvideovdp" ? kFovVideoVdpUnit : "";
}

std::vector<MetricInfo> comparison_metrics() {
  std::vector<MetricInfo> all = metrics();
  for (MetricInfo& info : sequence_metrics()) {
    all.push_back(std::move(info));
  }
  return all;
}

struct Comparison::Impl {
  ComparisonSettings settings;
  std::vector<MetricInfo> infos;
  std::vector<std::unique_ptr<SequenceMetric>> over_time;  // one per metric; null for metrics of single frames
  bool sees_luminance = false;
  FrameGroup all;
  std::array<FrameGroup, kGazeClasses.size()> classes;

  Impl(const ComparisonSettings& given, int width_px, int height_px) : settings(given) {
    check_comparison(settings);
    for (const std::string& name : settings.metrics) {
      infos.push_back(known_metric(name));
      if (infos.back().needs_gaze && !settings.view) {
        throw Error(
            ErrorKind::usage, name, "needs the screen's size and distance",
            "give `screen` NAME, or `screen-px`, `screen-cm` and `screen-distance-cm`, or leave the metric out");
      }
      over_time.push_back(is_sequence_metric(name) ? make_sequence_metric(name, settings, width_px, height_px)
                                                   : nullptr);
      sees_luminance = sees_luminance || over_time.back();
    }
    all.series.resize(infos.size());
    for (FrameGroup& group : classes) {
      group.series.resize(infos.size());
    }
  }

  FrameScores add(const FramePair& pair) {
    const int threads = settings.metric.threads;
    const bool is_blind = pair.gaze_class == GazeClass::blink || pair.gaze_class == GazeClass::no_gaze;
    const std::optional<Vec2d> gaze_px = is_blind ? std::nullopt : pair.gaze_px;
    std::optional<EccentricityBands> bands;
    if (settings.view && gaze_px) {
      bands = eccentricity_bands(*settings.view, *gaze_px, settings.regions, threads);
    }
    ImageGray reference_cd_m2;
    ImageGray test_cd_m2;
    if (sees_luminance) {
      reference_cd_m2 = display_luminance(pair.reference.code, settings.photometry, threads);
      test_cd_m2 = display_luminance(pair.test.code, settings.photometry, threads);
    }
    FrameGroup& group = classes[static_cast<std::size_t>(pair.gaze_class)];
    ++all.frames;
    ++group.frames;
    FrameScores frame{pair.frame, pair.gaze_class, {}, {}, {}};
    for (std::size_t m = 0; m < infos.size(); ++m) {
      const std::string& name = infos[m].name;
      std::optional<MetricMap> map = over_time[m] ? over_time[m]->add({reference_cd_m2, test_cd_m2, gaze_px})
                                                  : measure(name, pair.reference, pair.test, settings.metric);
      if (!map) {
        frame.scores.emplace_back().metric = name;
        frame.statistics.emplace_back();
        if (settings.want_maps) {
          frame.maps.emplace_back();
        }
        continue;
      }
      BandSums sums;
      if (bands && !map->values.empty()) {
        sums = sum_by_band(*bands, map->values, map->margin_px, threads);
      }
      frame.scores.push_back(scores_of(name, kPrinted, map->mean, sums));
      if (std::isnan(*frame.scores.back().value)) {
        throw Error(ErrorKind::input, name, fmt::format("its score of frame {} is not a number", pair.frame),
                    "check the pictures of that frame and the display's light");
      }
      frame.statistics.push_back(map->values.empty() ? MapStatistics{} : map_statistics(map->values, map->margin_px));
      for (ScoreSeries* series : {&all.series[m], &group.series[m]}) {
        series->sum += map->mean;
        series->bands.add(sums);
        series->values.push_back(*frame.scores.back().value);
        series->frames.push_back(pair.frame);
      }
      if (settings.want_maps) {
        frame.maps.push_back(std::move(map->values));
      }
    }
    return frame;
  }

  [[nodiscard]] SequenceScores summary_of(std::string_view name, const FrameGroup& group) const {
    SequenceScores result;
    result.gaze_class = name;
    result.frames = group.frames;
    for (std::size_t m = 0; m < infos.size(); ++m) {
      summarise(infos[m], kPrinted, group.series[m], result);
    }
    return result;
  }
};

Comparison::Comparison(const ComparisonSettings& settings, int width_px, int height_px)
    : impl_(std::make_unique<Impl>(settings, width_px, height_px)) {}
Comparison::~Comparison() = default;

FrameScores Comparison::add(const FramePair& pair) {
  return impl_->add(pair);
}

std::vector<SequenceScores> Comparison::summary() const {
  std::vector<SequenceScores> result{impl_->summary_of("all", impl_->all)};
  for (const GazeClass gaze_class : kGazeClasses) {
    const FrameGroup& group = impl_->classes[static_cast<std::size_t>(gaze_class)];
    if (group.frames > 0) {
      result.push_back(impl_->summary_of(to_string(gaze_class), group));
    }
  }
  return result;
}

}  // namespace gazetrace
