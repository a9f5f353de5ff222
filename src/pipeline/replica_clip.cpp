// SPDX-License-Identifier: Apache-2.0
#include "pipeline/replica_clip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/hash.hpp"
#include "core/parallel.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "pipeline/trace_counts.hpp"

namespace gazetrace {
namespace {

constexpr std::uint64_t kSeedTag = 0x5245504c494341ULL;  // "REPLICA"
constexpr double kBaseRate = 8, kLeastBaseSpp = 32;      // of the base: over the pilot's rate, and at least

FrameSettings pilot_settings(const FrameSettings& settings, double spp, std::uint64_t seed) {
  FrameSettings pilot = settings;
  pilot.foveation.target = {};
  pilot.foveation.budget_samples.reset();
  pilot.foveation.budget_spp = spp;
  pilot.trace.seed = seed;
  pilot.trace.guides = false;
  pilot.trace.only_pixel.reset();
  return pilot;
}

void for_each_pixel_of(const ImageRgb& image, int threads, const std::function<void(std::size_t)>& visit) {
  const auto width = static_cast<std::size_t>(image.width_px);
  parallel_for(static_cast<std::size_t>(image.height_px), threads, [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      visit(i);
    }
  });
}

// The mean of many samples is nearer to a normal distribution than that of a few: less of it is far out, where it is
// seen best. So where an error is asked for as of `times` as many samples, the replicas of as many neighbouring frames
// are mixed, by the rows of an orthonormal matrix (those of the discrete cosine transform): this keeps their variance,
// and keeps them uncorrelated from frame to frame.
struct Mixture {
  std::size_t first = 0;  // of the run's frames
  std::vector<float> weights;
};

Mixture mixture_of(std::size_t frame, std::size_t frames, double times) {
  const auto most = static_cast<std::size_t>(std::clamp(times, 1.0, static_cast<double>(frames)));
  const std::size_t groups = (frames + most - 1) / most;
  const std::size_t group = frame * groups / frames;
  const auto begin_of = [&](std::size_t g) { return (g * frames + groups - 1) / groups; };
  Mixture mixture{begin_of(group), {}};
  const std::size_t size = begin_of(group + 1) - mixture.first;
  const std::size_t row = frame - mixture.first;
  const auto length = static_cast<double>(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double wave = std::cos(kPi * (static_cast<double>(i) + 0.5) * static_cast<double>(row) / length);
    mixture.weights.push_back(static_cast<float>(std::sqrt((row == 0 ? 1 : 2) / length) * wave));
  }
  return mixture;
}

Vec3f positive(const Vec3f& light) {
  return {std::max(light.x, 0.0F), std::max(light.y, 0.0F), std::max(light.z, 0.0F)};
}

}  // namespace

ReplicaClip::ReplicaClip(PathTracer& tracer, const JudgedFrames& judged, const FrameSettings& settings,
                         const ColorPipeline& color, double spp, std::uint64_t round)
    : judged_(judged), settings_(settings), color_(color) {
  const std::uint64_t seed = hash_combine(hash_combine(settings.trace.seed, kSeedTag), round);
  const auto render = [&](const FrameSettings& by, const FrameRequest& request) {
    TemporalHistory none;
    RenderedFrame rendered = FrameRenderer(tracer, by).render(request, none);
    add_traces(rendered.samples, stats_);
    add_traces(rendered.first_look, stats_);
    return std::move(rendered.frame.radiance);
  };
  FrameSettings base = pilot_settings(settings, std::max(kBaseRate * spp, kLeastBaseSpp), hash_combine(seed, 2));
  base.foveation.falloff = "uniform";
  base.foveation.retinal_velocity = false;
  base.foveation.contrast_strength = 0;
  base.reconstruction = {"guided", {}};
  base_ = render(base, judged.runs.front().front());
  TemporalHistory none;
  exposure_ev_ = choose_exposure_ev(base_, 0, settings.exposure, none);
  reference_ = shown(base_);
  const std::array<FrameSettings, 2> pair{pilot_settings(settings, spp, hash_combine(seed, 0)),
                                          pilot_settings(settings, spp, hash_combine(seed, 1))};
  for (const std::vector<FrameRequest>& run : judged.runs) {
    std::vector<Judged>& frames = runs_.emplace_back();
    for (const FrameRequest& request : run) {
      Judged& frame = frames.emplace_back();
      frame.replica = render(pair[0], request);
      const ImageRgb other = render(pair[1], request);
      for_each_pixel_of(frame.replica, settings.threads, [&](std::size_t i) {
        frame.replica.pixels[i] = std::sqrt(0.5F) * (frame.replica.pixels[i] - other.pixels[i]);
      });
      if (request.gaze_direction_true && !request.gaze_true.no_gaze) {
        frame.gaze_px = request.view.pixel(*request.gaze_direction_true);
      }
    }
  }
}

// As `compare` shows pictures: in 8 bits.
ImageGray ReplicaClip::shown(const ImageRgb& radiance) const {
  constexpr int kBits = 8;
  constexpr float kMostCode = 255;
  const DisplayImage image = color_.apply(radiance, exposure_ev_, kBits, settings_.threads);
  ImageRgb code(radiance.width_px, radiance.height_px);
  for_each_pixel_of(code, settings_.threads, [&](std::size_t i) {
    const std::uint8_t* bytes = &image.bytes[3 * i];
    code.pixels[i] = {static_cast<float>(bytes[0]) / kMostCode, static_cast<float>(bytes[1]) / kMostCode,
                      static_cast<float>(bytes[2]) / kMostCode};
  });
  return display_luminance(code, {}, settings_.threads);
}

double ReplicaClip::q_at(double share) const {
  const bool is_still = judged_.sequence_frames == 1;
  const PlanarView& view = judged_.runs.front().front().view;
  FovVideoVdpSettings metric_settings;
  metric_settings.geometry = fovvideovdp_geometry(view);
  metric_settings.frames_per_second = is_still ? 0 : settings_.frames_per_second;
  metric_settings.threads = settings_.threads;
  const auto scale = static_cast<float>(std::sqrt(share));
  // The first frames of the sequence stand for themselves, those that have all before them in view for all the others.
  double early = 0;
  double late = 0;
  double early_frames = 0;
  double late_frames = 0;
  for (const std::vector<Judged>& run : runs_) {
    FovVideoVdp metric(metric_settings, view.width_px, view.height_px);
    for (std::size_t i = 0; i < run.size(); ++i) {
      const Judged& frame = run[i];
      const Mixture mixture = mixture_of(i, run.size(), 1 / share);
      ImageRgb test = base_;
      for_each_pixel_of(test, settings_.threads, [&](std::size_t p) {
        Vec3f error;
        for (std::size_t k = 0; k < mixture.weights.size(); ++k) {
          error += mixture.weights[k] * run[mixture.first + k].replica.pixels[p];
        }
        test.pixels[p] = positive(test.pixels[p] + scale * error);
      });
      const ImageGray seen = shown(test);
      const bool is_late = i + 1 >= static_cast<std::size_t>(metric.taps());
      if (!frame.gaze_px || (!is_late && &run != &runs_.front())) {
        metric.prime(reference_, seen);
        continue;
      }
      (is_late ? late : early) += metric.add(reference_, seen, frame.gaze_px).q;
      (is_late ? late_frames : early_frames) += 1;
    }
  }
  if (!(early_frames + late_frames > 0)) {
    throw Error(ErrorKind::input, "`target-jod`", "none of the frames by which the sequence is judged has a gaze",
                "check `gaze-start` and `gaze-offset`");
  }
  if (!(late_frames > 0)) {
    return early / early_frames;
  }
  const double rest = std::max(0.0, judged_.sequence_frames - early_frames);
  return (early + rest * late / late_frames) / (early_frames + rest);
}

}  // namespace gazetrace
