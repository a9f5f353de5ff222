// SPDX-License-Identifier: Apache-2.0
// The picture that stands for the truth: independent scramblings, rendered once and kept.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

struct CertifiedReference {
  std::string directory;              // with the sweep's folder before it
  std::map<std::int32_t, double> ev;  // exposure by frame: tests are shown under it, too
  double spp = 0;                     // of all scramblings together
  [[nodiscard]] std::string half_path(int half, std::int32_t frame) const;
  [[nodiscard]] std::string mean_path(std::int32_t frame) const;
};

std::string reference_folder(const SweepReference& reference);  // within the sweep's folder

// Renders what is missing: each scrambling by itself, frame by frame, then the means of the two halves and of all.
CertifiedReference ensure_reference(PathTracer& tracer, const SweepReference& reference, const ColorPipeline& color,
                                    const std::string& sweep_directory, const SweepObserver& observer);

// The halves against each other, see SweepFloor. Kept as well, by what it depends on.
ScoreTable ensure_floor(const CertifiedReference& reference, const ColorPipeline& color,
                        const ComparisonSettings& settings, const std::vector<SweepFrame>& frames,
                        const std::string& digest);

MetricPicture metric_picture(ImageRgb light, const ColorPipeline& color, double ev, int threads);

}  // namespace gazetrace
