// SPDX-License-Identifier: Apache-2.0
#include "temporal/bench.hpp"

#include <string>
#include <utility>

#include "gazetrace/error.hpp"

namespace gazetrace::temporal {

std::vector<Variant> make_variants() {
  std::vector<Variant> variants{{"off", {}, false}};
  const auto add = [&](std::string name, double frames, double clip, double blend, AccumulateOrder order) {
    AccumulateSettings settings;
    settings.mode = AccumulateMode::reproject;
    settings.frames = frames;
    settings.clip_sigmas = clip;
    settings.blend = blend;
    settings.order = order;
    variants.push_back({std::move(name), settings, false});
  };
  const AccumulateSettings standard;
  constexpr auto kLater = AccumulateOrder::after;
  add("reproject (the defaults)", standard.frames, standard.clip_sigmas, 0, standard.order);
  add("before the filter", standard.frames, standard.clip_sigmas, 0, AccumulateOrder::before);
  add("after the filter", standard.frames, standard.clip_sigmas, 0, kLater);
  variants[2].orders = variants[3].orders = true;
  add("memory 8", 8, standard.clip_sigmas, 0, kLater);
  add("memory 32", 32, standard.clip_sigmas, 0, kLater);
  add("clip 0", standard.frames, 0, 0, kLater);
  add("clip 2", standard.frames, 2, 0, kLater);
  add("clip 5", standard.frames, 5, 0, kLater);
  add("blend 0.1", standard.frames, standard.clip_sigmas, 0.1, kLater);
  return variants;
}

std::vector<Variant> two_sided_variants() {
  std::vector<Variant> variants;
  for (const std::int32_t window : {2, 4, 8}) {
    AccumulateSettings settings;
    settings.mode = AccumulateMode::two_sided;
    settings.window = window;
    variants.push_back({"two-sided, window " + std::to_string(window), settings, false});
  }
  return variants;
}

std::vector<Variant> variants_of(const std::string& filter) {
  std::vector<Variant> variants = make_variants();
  const bool surfaces = Reconstruction({filter}).needs().surfaces;
  std::erase_if(variants, [&](const Variant& variant) { return variant.orders && surfaces; });
  return variants;
}

std::vector<float> luminance_of(const Frame& frame) {
  std::vector<float> luminance;
  luminance.reserve(frame.radiance.pixels.size());
  for (const Vec3f& c : frame.radiance.pixels) {
    luminance.push_back(0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z);
  }
  return luminance;
}

Luminances render(PathTracer& tracer, const FramePlan& plan, const PipelineSettings& settings, double* temporal_ms) {
  const ColorPipeline color(ColorSettings{});
  Luminances frames;
  PipelineObserver observer;
  observer.frame_ready = [&](const FrameRequest&, const Frame& frame, double) {
    frames.push_back(luminance_of(frame));
  };
  observer.frame_done = [&](const TimingRow& row, bool) {
    if (temporal_ms != nullptr) {
      *temporal_ms += row.temporal_ms;
    }
  };
  Warnings warnings;
  (void)render_sequence(tracer, plan, color, settings, observer, starting_history(plan, settings, warnings));
  return frames;
}

Reference make_reference(PathTracer& tracer, const Bench& bench, const FramePlan& plan, bool still) {
  const FramePlan& all = plan;
  FramePlan one = plan;
  one.frames.resize(1);
  Reference reference;
  const auto half = [&](std::uint64_t seed) {
    Luminances frames = render(tracer, still ? one : all, bench.reference_settings(seed, still));
    frames.resize(all.frames.size(), frames.front());
    return frames;
  };
  reference.a = half(1001);
  reference.b = half(2002);
  reference.mean = reference.a;
  double sum = 0;
  for (std::size_t f = 0; f < reference.a.size(); ++f) {
    for (std::size_t i = 0; i < reference.a[f].size(); ++i) {
      reference.mean[f][i] = 0.5F * (reference.a[f][i] + reference.b[f][i]);
      sum += static_cast<double>(reference.mean[f][i]);
    }
  }
  reference.level = sum / static_cast<double>(reference.a.size() * reference.a[0].size());
  if (!(reference.level > 0)) {
    throw Error(ErrorKind::input, "--start", "the reference is black", "begin where light reaches, not in a wall");
  }
  return reference;
}

}  // namespace gazetrace::temporal
