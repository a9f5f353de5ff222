// SPDX-License-Identifier: Apache-2.0
#include "temporal/sequences.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

namespace gazetrace::temporal {
namespace {

using benchmark::SeenFlicker;

void print_row(const std::string& name, const FramePlan& plan, const Luminances& frames, const Reference& reference,
               double temporal_ms) {
  const std::size_t count = frames.size();
  const std::size_t pixels = frames[0].size();
  double relative = 0;
  double floor = 0;
  double bias = 0;
  std::vector<double> local(pixels, 0);
  for (std::size_t f = 0; f < count; ++f) {
    for (std::size_t i = 0; i < pixels; ++i) {
      const auto ref = static_cast<double>(reference.mean[f][i]);
      const double off = static_cast<double>(frames[f][i]) - ref;
      const double halves = 0.5 * static_cast<double>(reference.a[f][i] - reference.b[f][i]);
      const double scale = ref * ref + 0.01 * reference.level * reference.level;
      relative += off * off / scale;
      floor += halves * halves / scale;
      bias += off;
      local[i] += off / static_cast<double>(count);
    }
  }
  const auto n = static_cast<double>(count * pixels);
  double local_square = 0;
  for (const double off : local) {
    local_square += off * off / static_cast<double>(pixels);
  }
  const auto of = [](const Luminances& from) {
    return [&from](std::size_t f, std::size_t i) { return static_cast<double>(from[f][i]); };
  };
  const double own = benchmark::variance_above_1_hz(of(frames), count, pixels);
  const double noise = benchmark::variance_above_1_hz(
      [&](std::size_t f, std::size_t i) { return 0.5 * static_cast<double>(reference.a[f][i] - reference.b[f][i]); },
      count, pixels);
  const double wanted = benchmark::variance_above_1_hz(of(reference.mean), count, pixels) - noise;
  const double excess = own - wanted;
  const SeenFlicker seen = benchmark::seen_flicker(plan, reference.mean, frames, reference.level);
  fmt::print("| {} | {:.4f} | {:+.2f} % | {:.2f} % | {}{:.2f} % | {:.2f} | {:.2f} | {:.2f} |\n", name,
             (relative - floor) / n, 100 * bias / n / reference.level, 100 * std::sqrt(local_square) / reference.level,
             excess < 0 ? "-" : "", 100 * std::sqrt(std::fabs(excess)) / reference.level, seen.all, seen.periphery,
             temporal_ms / static_cast<double>(count));
  std::fflush(stdout);
}

void print_floor(const FramePlan& plan, const Reference& reference) {
  double floor = 0;
  for (std::size_t f = 0; f < reference.a.size(); ++f) {
    for (std::size_t i = 0; i < reference.a[f].size(); ++i) {
      const double halves = 0.5 * static_cast<double>(reference.a[f][i] - reference.b[f][i]);
      const auto ref = static_cast<double>(reference.mean[f][i]);
      floor += halves * halves / (ref * ref + 0.01 * reference.level * reference.level);
    }
  }
  const SeenFlicker seen = benchmark::seen_flicker(plan, reference.a, reference.b, reference.level);
  fmt::print("The reference's own relmse: {:.5f}; flicker seen of one half against the other: {:.2f} ({:.2f}).\n\n",
             floor / static_cast<double>(reference.a.size() * reference.a[0].size()), seen.all, seen.periphery);
}

void compare_variants(PathTracer& tracer, const Bench& bench, const FramePlan& plan, const Reference& reference,
                      const std::string& filter) {
  fmt::print(
      "\nFilter {}\n\n| accumulation | relmse | bias | local | flicker | seen | seen beyond {} deg | ms a frame |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n",
      filter, benchmark::kPeriphery_deg);
  std::vector<Variant> variants = variants_of(filter);
  for (Variant& variant : two_sided_variants()) {
    variants.push_back(std::move(variant));
  }
  for (const Variant& variant : variants) {
    double temporal_ms = 0;
    const Luminances frames = render(tracer, plan, bench.settings_of(variant.accumulate, filter), &temporal_ms);
    print_row(variant.name, plan, frames, reference, temporal_ms);
  }
}

}  // namespace

void compare_sequences(PathTracer& tracer, const Bench& bench, const Options& options) {
  for (const bool glides : {true, false}) {
    const FramePlan plan = bench.plan(glides, 1, options.frames);
    const Reference reference = make_reference(tracer, bench, plan, !glides);
    fmt::print("\n{}, {} frames of {}x{}, references of {} spp\n",
               glides ? "The camera glides" : "The camera stands still", options.frames, bench.width_px(),
               options.height_px, bench.reference_spp(!glides));
    print_floor(plan, reference);
    for (const std::string& filter : options.filters) {
      compare_variants(tracer, bench, plan, reference, filter);
    }
  }
}

}  // namespace gazetrace::temporal
