// SPDX-License-Identifier: Apache-2.0
// The pictures that stand for the truth: the mean of independent scramblings, rendered once and kept.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "gazetrace/sweep.hpp"

namespace gazetrace {

struct CertifiedReference {
  std::string directory;              // its path begins with the sweep's folder
  std::map<std::int32_t, double> ev;  // exposure by frame, at which tests are shown, too
  double spp = 0;                     // of all scramblings together
  std::size_t pictures = 0;           // see reference_pictures()
  [[nodiscard]] std::string half_path(int half, std::int32_t frame) const;
  [[nodiscard]] std::string mean_path(std::int32_t frame) const;
};

std::string reference_folder(const SweepReference& reference);  // within the sweep's folder

// The frames of a reference that are rendered: all of them, or only the first where neither camera nor scene moves.
// Then that one picture stands for every frame of the clip.
std::vector<std::int32_t> reference_pictures(const SweepReference& reference, const Scene& scene);
// Whether reference_pictures() depends on the scene: where all frames have the same view.
bool scene_decides_pictures(const SweepReference& reference);
FramePlan only_frames(const FramePlan& plan,
                      const std::vector<std::int32_t>& frames);  // the part of the plan with these frames

// Renders what is missing: each scrambling by itself, frame by frame; then forms the means of the two halves and of
// all. `with_others`: other processes may be at the same reference in the same folder. Each then renders the pictures
// that no other is at, and waits for the rest.
CertifiedReference ensure_reference(PathTracer& tracer, const Scene& scene, const SweepReference& reference,
                                    const ColorPipeline& color, const std::string& sweep_directory, bool with_others,
                                    const SweepObserver& observer);
// What an earlier process has finished; empty where something is missing. Without `pictures`.
std::optional<CertifiedReference> finished_reference(const SweepReference& reference,
                                                     const std::string& sweep_directory);

// The score of the two halves against each other, see ResultReference. It is kept, too, under a digest of what it
// depends on.
ScoreTable ensure_floor(const CertifiedReference& reference, const ColorPipeline& color,
                        const ComparisonSettings& settings, const std::vector<ResultFrame>& frames,
                        const std::string& digest);

MetricPicture metric_picture(ImageRgb light, const ColorPipeline& color, double ev, int threads);

}  // namespace gazetrace
