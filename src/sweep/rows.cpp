// SPDX-License-Identifier: Apache-2.0
#include "sweep/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gazetrace {
namespace {

RasterSize size_of(const FramePlan& plan) {
  return {plan.frames.front().width_px, plan.frames.front().height_px};
}

bool has_gaze(const FramePlan& plan) {
  return std::any_of(plan.frames.begin(), plan.frames.end(),
                     [](const FrameRequest& request) { return request.gaze_direction_render.has_value(); });
}

PlannedRow beside(const PlannedRow& test, RowRole role, const std::string& suffix, const std::string& label) {
  PlannedRow result = test;
  result.row.id = test.row.id + "-" + suffix;
  result.row.role = role;
  result.row.of = test.row.id;
  result.row.label = label;
  result.row.baselines.clear();
  result.row.published.clear();
  result.row.runs.clear();  // it has measurements of its own
  return result;
}

std::string digest_of(const std::string& base, const std::string& what) {
  return digest_settings({{"base", base}, {"what", what}});
}

// Makes a row uniform. It is rendered at full size unless its plan has another.
void make_uniform(const SweepPlan& plan, PlannedRow& row, double spp) {
  FoveationSettings& foveation = row.pipeline.foveation;
  foveation.sampling = UniformSampling{};
  foveation.target = {};
  foveation.spp = spp;
  row.row.is_foveated = false;
  row.row.resolution_scale = static_cast<double>(size_of(row.plan).width_px) / row.size.width_px;
  NamedValues& settings = row.row.settings;
  settings = plan.tests[row.test].uniform_settings;
  settings.emplace_back("sampling", "uniform");
  settings.emplace_back("spp", fmt::format("{:.6g}", spp));
  for (ResultFrame& frame : row.row.frames) {
    frame.rings_px.clear();
  }
  // A row of equal time is rendered apart from rows of other roles even where their rates are the same: its time must
  // be measured anew, and not be taken from the row by which its rate was found.
  const char* purpose = row.row.role == RowRole::equal_time ? "equal time, " : "";
  const RasterSize size = size_of(row.plan);
  row.digest =
      digest_of(row.uniform, fmt::format("{}uniform {} on {}x{}", purpose, spp, size.width_px, size.height_px));
}

const char* suffix_of(RowRole role) {
  switch (role) {
    case RowRole::uniform_reference_rate:
      return "uniform";
    case RowRole::equal_samples:
      return "samples";
    case RowRole::equal_time:
      return "time";
    case RowRole::low_resolution:
      return "lowres";
    default:
      return "rate";
  }
}

}  // namespace

bool is_foveated(const SweepTest& test) {
  const Sampling& sampling = test.pipeline.foveation.sampling;
  return has_gaze(test.plan) ? !is_uniform(sampling) : follows_picture(sampling);
}

PlannedRow test_row(const SweepPlan& plan, std::size_t test) {
  const SweepTest& from = plan.tests[test];
  PlannedRow result;
  MeasuredRow& row = result.row;
  row.id = from.id;
  row.scene = plan.scenes[from.scene].name;
  row.gaze = from.gaze;
  row.label = from.label;
  row.settings = from.settings;
  row.is_foveated = is_foveated(from);
  row.resolution_scale = from.resolution_scale;
  row.published = from.published;
  row.reference = from.reference;
  row.curve = digest_of(from.uniform_digest, "curve").substr(0, 8);
  row.frames = sweep_frames(from.plan, from.pipeline.foveation, plan.measure.leave_out_s);
  result.pipeline = from.pipeline;
  result.pipeline.output = {};
  result.plan = from.plan;
  result.size = size_of(from.plan);
  row.compared_pixels =
      static_cast<double>(result.size.width_px) * result.size.height_px * static_cast<double>(from.plan.frames.size());
  result.digest = from.digest;
  result.uniform = from.uniform_digest;
  result.test = test;
  if (from.resolution_scale != 1) {
    result.plan = resized(from.plan, scaled_size(result.size, from.resolution_scale));
    result.digest = digest_of(from.digest, fmt::format("scale {}", from.resolution_scale));
  }
  return result;
}

PlannedRow uniform_row(const SweepPlan& plan, const PlannedRow& test, RowRole role, double spp) {
  const char* suffix = suffix_of(role);
  const std::string label = role == RowRole::equal_samples ? fmt::format("uniform, equal samples: {:.4g} spp", spp)
                            : role == RowRole::equal_time  ? fmt::format("uniform, equal time: {:.4g} spp", spp)
                                                           : fmt::format("uniform, {:g} spp", spp);
  const bool is_rate = role == RowRole::uniform_rate;
  PlannedRow result = beside(test, role, is_rate ? fmt::format("{}{:g}", suffix, spp) : suffix, label);
  if (is_rate) {
    result.row.of.clear();
  }
  result.plan = plan.tests[test.test].plan;
  make_uniform(plan, result, spp);
  return result;
}

std::vector<PlannedRow> baselines_known_before(const SweepPlan& plan, const PlannedRow& test,
                                               std::vector<std::string>& notes) {
  std::vector<PlannedRow> rows;
  const SweepBaselines& wanted = plan.measure.baselines;
  const SweepTest& from = plan.tests[test.test];
  if (!is_foveated(from)) {
    return rows;
  }
  if (wanted.reference_rate) {
    rows.push_back(uniform_row(plan, test, RowRole::uniform_reference_rate, wanted.reference_spp));
  }
  for (const double spp : wanted.uniform_rates) {
    if (!wanted.reference_rate || spp != wanted.reference_spp) {
      rows.push_back(uniform_row(plan, test, RowRole::uniform_rate, spp));
    }
  }
  for (const std::string& wrong :
       wanted.wrong_gaze&& has_gaze(test.plan) ? wrong_gazes() : std::vector<std::string>()) {
    if (const auto other = with_wrong_gaze(test.plan, wrong)) {
      PlannedRow row = beside(test, RowRole::wrong_gaze, wrong, test.row.label + ", gaze " + wrong);
      row.row.wrong = wrong;
      row.plan = *other;
      row.digest = digest_of(test.digest, "gaze " + wrong);
      rows.push_back(std::move(row));
    } else {
      notes.push_back(fmt::format("{}/{}: no control with gaze {}: within 2 degrees of the right one", test.row.scene,
                                  test.row.gaze, wrong));
    }
  }
  return rows;
}

std::vector<PlannedRow> baselines_of_samples(const SweepPlan& plan, const PlannedRow& test, double spp) {
  std::vector<PlannedRow> rows;
  const SweepBaselines& wanted = plan.measure.baselines;
  if (!is_foveated(plan.tests[test.test])) {
    return rows;
  }
  if (wanted.equal_samples) {
    rows.push_back(uniform_row(plan, test, RowRole::equal_samples, spp));
  }
  const double full = wanted.reference_spp;
  if (wanted.low_resolution && spp < full) {
    const RasterSize small = scaled_size(test.size, std::sqrt(spp / full));
    const double pixels = static_cast<double>(test.size.width_px) * test.size.height_px;
    const double small_spp = spp * pixels / (static_cast<double>(small.width_px) * small.height_px);
    PlannedRow row = uniform_row(plan, test, RowRole::low_resolution, small_spp);
    row.plan = resized(plan.tests[test.test].plan, small);
    make_uniform(plan, row, small_spp);
    row.row.label =
        fmt::format("uniform on {}x{} px, {:.4g} spp, upscaled", small.width_px, small.height_px, small_spp);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::optional<PlannedRow> cost_row(const SweepPlan& plan, const PlannedRow& test) {
  const std::uint32_t spp = plan.measure.efficiency_spp;
  PlannedRow row = test;
  FoveationSettings& foveation = row.pipeline.foveation;
  auto* const regions = std::get_if<RegionSampling>(&foveation.sampling);
  if (spp == 0 || regions == nullptr || !is_foveated(plan.tests[test.test])) {
    return std::nullopt;
  }
  row.row.id += "-cost";
  regions->samples = {spp, spp, spp};
  regions->blocks_px = {1, 1};
  foveation.spp.reset();
  row.digest = digest_of(test.digest, fmt::format("cost by region at {} spp", spp));
  return row;
}

double planned_spp(const PlannedRow& row) {
  const FoveationSettings& foveation = row.pipeline.foveation;
  double samples = 0;
  double pixels = 0;
  for (const FrameRequest& request : row.plan.frames) {
    const double size = static_cast<double>(request.width_px) * request.height_px;
    pixels += size;
    if (looks_first(foveation.sampling)) {  // with a target it is not known how many it takes
      samples += foveation.spp.value_or(kUsualSpp) * size;
      continue;
    }
    const SamplingMap map = planned_sampling_map(foveation, request, row.pipeline.trace.seed, row.pipeline.threads);
    samples += static_cast<double>(map.samples());
  }
  return samples / pixels;
}

}  // namespace gazetrace
