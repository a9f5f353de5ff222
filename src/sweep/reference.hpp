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
  std::size_t pictures = 0;           // see reference_pictures()
  [[nodiscard]] std::string half_path(int half, std::int32_t frame) const;
  [[nodiscard]] std::string mean_path(std::int32_t frame) const;
};

std::string reference_folder(const SweepReference& reference);  // within the sweep's folder

// The frames of a reference that are rendered: all, or the first for all of them where neither camera nor scene moves.
// A clip of a standing picture is then known as well as its one frame.
std::vector<std::int32_t> reference_pictures(const SweepReference& reference, const Scene& scene);
// Whether reference_pictures() depends on the scene: of frames that are seen alike and gather nothing over time.
bool scene_decides_pictures(const SweepReference& reference);
FramePlan only_frames(const FramePlan& plan, const std::vector<std::int32_t>& frames);  // the plan of these

// Renders what is missing: each scrambling by itself, frame by frame, then the means of the two halves and of all.
CertifiedReference ensure_reference(PathTracer& tracer, const Scene& scene, const SweepReference& reference,
                                    const ColorPipeline& color, const std::string& sweep_directory,
                                    const SweepObserver& observer);

// The halves against each other, see ResultFloor. Kept as well, by what it depends on.
ScoreTable ensure_floor(const CertifiedReference& reference, const ColorPipeline& color,
                        const ComparisonSettings& settings, const std::vector<ResultFrame>& frames,
                        const std::string& digest);

MetricPicture metric_picture(ImageRgb light, const ColorPipeline& color, double ev, int threads);

}  // namespace gazetrace
