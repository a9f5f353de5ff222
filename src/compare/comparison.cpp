// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "compare/eccentricity_bands.hpp"
#include "gazetrace/compare.hpp"
#include "gazetrace/error.hpp"

namespace gazetrace {
namespace {

constexpr const char* kFovVideoVdp = "fovvideovdp";

// What is averaged over frames, and the printed number of such a mean.
double printed(const std::string& metric, double mean) {
  return metric == kFovVideoVdp ? fovvideovdp_jod(mean) : metric_value(metric, mean);
}
double printed_local(const std::string& metric, double mean) {
  constexpr double kNoDifference = 10;
  return metric == kFovVideoVdp ? kNoDifference - mean : metric_value(metric, mean);
}

Scores scores_of(const std::string& metric, double mean, const BandSums& sums) {
  Scores scores;
  scores.metric = metric;
  scores.value = printed(metric, mean);
  if (sums.weight > 0) {
    scores.weighted = printed_local(metric, sums.weighted_sum / sums.weight);
  }
  for (std::size_t b = 0; b < sums.bands.size(); ++b) {
    if (sums.bands[b].pixels > 0) {
      scores.bands[b] = printed_local(metric, sums.bands[b].sum / sums.bands[b].pixels);
    }
  }
  return scores;
}

// Frames of one class of gaze, for one metric.
struct Series {
  double sum = 0;
  BandSums bands;
  std::vector<double> values;
  std::vector<std::int32_t> frames;
};

bool is_worse(const MetricInfo& info, double a, double b) {
  return info.better == MetricDirection::lower ? a > b : a < b;
}

}  // namespace

std::vector<MetricInfo> comparison_metrics() {
  std::vector<MetricInfo> all = metrics();
  all.push_back({kFovVideoVdp, MetricInput::code, MetricDirection::higher,
                 "FovVideoVDP: visible differences at this gaze, over time, JOD; blind to uniform differences"});
  return all;
}

struct Comparison::Impl {
  ComparisonSettings settings;
  std::vector<MetricInfo> infos;
  std::optional<FovVideoVdp> fovvideovdp;
  std::map<std::string, std::vector<Series>> classes;  // by name; "all" holds every frame

  Impl(const ComparisonSettings& given, int width_px, int height_px) : settings(given) {
    const std::vector<MetricInfo> known = comparison_metrics();
    for (const std::string& name : settings.metrics) {
      const auto info = std::find_if(known.begin(), known.end(), [&](const auto& i) { return i.name == name; });
      if (info == known.end()) {
        std::vector<std::string> names;
        for (const MetricInfo& i : known) {
          names.push_back(i.name);
        }
        throw Error(ErrorKind::usage, "--metrics", unknown_name_message("metric", name, names));
      }
      infos.push_back(*info);
      if (name == kFovVideoVdp) {
        start_fovvideovdp(width_px, height_px);
      }
    }
  }

  void start_fovvideovdp(int width_px, int height_px) {
    if (!settings.view) {
      throw Error(ErrorKind::usage, kFovVideoVdp, "needs the screen's size and distance",
                  "give --screen NAME, or --screen-px, --screen-cm and --screen-distance-cm, or leave the metric out");
    }
    // The metric takes a picture to fill its display: a display of the picture's own pixels and size. Distance 1 m.
    const PlanarView& view = *settings.view;
    FovVideoVdpSettings metric;
    metric.geometry = {width_px, height_px, view.step_x * width_px, view.step_y * height_px, 1};
    metric.frames_per_second = settings.frames_per_second;
    metric.original_border = settings.original_border;
    metric.threads = settings.metric.threads;
    fovvideovdp.emplace(metric, width_px, height_px);
  }

  MetricMap measure_one(const MetricInfo& info, const FramePair& pair) {
    if (info.name != kFovVideoVdp) {
      return measure(info.name, pair.reference, pair.test, settings.metric);
    }
    // Frames without gaze keep the window in time going; they are scored with the gaze in the middle.
    const int threads = settings.metric.threads;
    FovVideoVdpFrame frame =
        fovvideovdp->add(display_luminance(pair.reference.code, settings.photometry, threads),
                         display_luminance(pair.test.code, settings.photometry, threads), pair.gaze_px, true);
    return {std::move(frame.map), 0, frame.q};
  }

  FrameScores add(const FramePair& pair) {
    const int threads = settings.metric.threads;
    std::optional<EccentricityBands> bands;
    if (settings.view && pair.gaze_px) {
      bands = eccentricity_bands(*settings.view, *pair.gaze_px, threads);
    }
    FrameScores frame{pair.frame, pair.gaze_class, {}, {}, {}};
    for (std::size_t m = 0; m < infos.size(); ++m) {
      const MetricInfo& info = infos[m];
      MetricMap map = measure_one(info, pair);
      BandSums sums;
      if (bands && !map.values.empty()) {
        sums = sum_by_band(*bands, map.values, map.margin_px, threads);
      }
      frame.scores.push_back(scores_of(info.name, map.mean, sums));
      frame.statistics.push_back(map.values.empty() ? MapStatistics{} : map_statistics(map.values, map.margin_px));
      for (const std::string& name : {std::string("all"), pair.gaze_class}) {
        std::vector<Series>& series = classes[name];
        series.resize(infos.size());
        series[m].sum += map.mean;
        series[m].bands.add(sums);
        series[m].values.push_back(frame.scores.back().value);
        series[m].frames.push_back(pair.frame);
      }
      if (settings.want_maps) {
        frame.maps.push_back(std::move(map.values));
      }
    }
    return frame;
  }

  [[nodiscard]] SequenceScores summary_of(const std::string& name, const std::vector<Series>& series) const {
    SequenceScores result;
    result.gaze_class = name;
    result.frames = series.front().values.size();
    for (std::size_t m = 0; m < infos.size(); ++m) {
      const Series& s = series[m];
      result.scores.push_back(scores_of(infos[m].name, s.sum / static_cast<double>(s.values.size()), s.bands));
      std::vector<double> sorted = s.values;
      std::sort(sorted.begin(), sorted.end());
      const auto at = [&](double share) {
        return sorted[std::min(sorted.size() - 1,
                               static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
      };
      result.quantiles.push_back({at(0.05), at(0.5), at(0.95)});
      std::size_t worst = 0;
      for (std::size_t i = 1; i < s.values.size(); ++i) {
        worst = is_worse(infos[m], s.values[i], s.values[worst]) ? i : worst;
      }
      result.worst_frame.push_back(s.frames[worst]);
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
  std::vector<SequenceScores> result;
  for (const auto& [name, series] : impl_->classes) {
    if (!series.empty()) {
      result.push_back(impl_->summary_of(name, series));
    }
  }
  // All frames first.
  std::stable_partition(result.begin(), result.end(), [](const auto& s) { return s.gaze_class == "all"; });
  return result;
}

}  // namespace gazetrace
