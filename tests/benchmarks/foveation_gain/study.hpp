// SPDX-License-Identifier: Apache-2.0
// Which arms there are, and their measurement.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "foveation_gain/pictures.hpp"
#include "foveation_gain/rows.hpp"
#include "world.hpp"

namespace gazetrace::gain {

// Of the budget. The one at equal samples is 1. Low ones, since filters may take longer for uniform frames than for
// foveated ones, whose time is then that of few samples.
inline constexpr std::array<double, 10> kUniformRates{0.25, 0.35, 0.5, 0.7, 0.85, 1, 1.2, 1.5, 2, 2.8};
std::string uniform_arm(double rate);  // "uniform 0.7"
inline constexpr const char* kLowResolution = "low resolution";
inline constexpr const char* kInBlocks = "in blocks";
inline constexpr const char* kPaper = "paper";
inline constexpr const char* kFovealRate = "foveal rate";
inline constexpr const char* kAnyGaze = "-";

struct StudySettings {
  std::string scene;  // "SCENE.gltf=SKY.hdr"
  std::optional<benchmark::Viewpoint> viewpoint;
  benchmark::FrameSize size{960, 540};
  std::vector<std::string> reference;
  double spp = 1;
  std::vector<std::string> models;  // empty: all
  std::vector<std::string> filters{"none", "linear", "guided"};
  std::vector<std::string> metrics{"relmse", "flip", "fovvideovdp"};
  std::vector<Gaze> gazes;
  int seeds = 1;
  std::optional<double> ev;
  std::string csv;
  int clip_frames = 1;  // from 2 on: means of clips
  int time_rounds = 0;  // not 0: measure times, and no errors
};

// Centre, 10 degrees right of it, edge and corner of the paper's display.
std::vector<Gaze> gaze_grid();
// "LOG.csv:COUNT:SEED": places of recorded fixations on the display, without repetition.
std::vector<Gaze> drawn_fixations(const std::string& text);

void run_study(const StudySettings& settings);

}  // namespace gazetrace::gain
