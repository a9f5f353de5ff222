// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gazetrace/plan.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

std::string position_text(const GazeAtTime& gaze) {
  if (gaze.state == GazeState::none) {
    return "-";
  }
  return gaze.kind == GazeKind::screen
             ? fmt::format("{:.4f} {:.4f}", gaze.u, gaze.v)
             : fmt::format("{:.4f} {:.4f} {:.4f}", gaze.direction.x, gaze.direction.y, gaze.direction.z);
}

std::string rows_text(const GazeAtTime& gaze) {
  if (gaze.row_before != 0 && gaze.row_after != 0) {
    return fmt::format("{}-{}", gaze.row_before, gaze.row_after);
  }
  const std::int64_t row = std::max(gaze.row_before, gaze.row_after);
  return row != 0 ? fmt::format("{}", row) : "-";
}

bool has_rows(const GazeAtTime& gaze) {
  return gaze.row_before != 0 || gaze.row_after != 0;
}

bool same_gaze(const FrameRequest& request) {
  const GazeAtTime& a = request.gaze_render;
  const GazeAtTime& b = request.gaze_true;
  return a.t_log_ns == b.t_log_ns && a.state == b.state && a.u == b.u && a.v == b.v && a.direction == b.direction;
}

std::string age_text(const GazeAtTime& gaze) {
  return !has_rows(gaze)     ? "-"
         : gaze.age_is_known ? fmt::format("{:.3f}", static_cast<double>(gaze.age_ns) * 1e-6)
                             : "unknown";
}

// The lines below the table: what was done to the gaze that steers, and how old it is when it is seen.
std::string notes_text(const FramePlan& plan) {
  std::string text;
  for (const std::string& line : plan.gaze_processing) {
    text += fmt::format("gaze_render: {}\n", line);
  }
  if (plan.ages && plan.gaze_latency_ns > 0) {
    text += fmt::format("effective age at mid-display: {}\n", gaze_ages_text(*plan.ages));
  }
  return text;
}

Json ages_json(const GazeAges& a) {
  return Json{{"frames", a.frames}, {"unknown", a.unknown},     {"without", a.without},
              {"min_ns", a.min_ns}, {"median_ns", a.median_ns}, {"mean_ns", a.mean_ns},
              {"p95_ns", a.p95_ns}, {"max_ns", a.max_ns},       {"half_frame_ns", a.half_frame_ns}};
}

// A number that JSON can hold: NaN and infinities become null.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json vector_json(const Vec3d& v) {
  return Json::array({number(v.x), number(v.y), number(v.z)});
}

Json gaze_json(const GazeAtTime& gaze, const std::optional<Vec3d>& direction) {
  Json json{{"state", std::string(to_string(gaze.state))}};
  if (gaze.kind == GazeKind::screen && gaze.state != GazeState::none) {
    json["u"] = number(gaze.u);
    json["v"] = number(gaze.v);
  }
  json["direction"] = direction ? vector_json(*direction) : Json(nullptr);
  json["t_log_ns"] = gaze.t_log_ns;
  json["row_before"] = gaze.row_before != 0 ? Json(gaze.row_before) : Json(nullptr);
  json["row_after"] = gaze.row_after != 0 ? Json(gaze.row_after) : Json(nullptr);
  json["age_ns"] = has_rows(gaze) && gaze.age_is_known ? Json(gaze.age_ns) : Json(nullptr);
  json["validity"] = has_rows(gaze) ? Json(to_string(gaze.validity)) : Json(nullptr);
  json["event"] = gaze.movement ? Json(to_string(*gaze.movement)) : Json(nullptr);
  json["no_gaze"] = gaze.no_gaze;
  json["reason"] = gaze.reason;
  return json;
}

Json camera_json(const Camera& camera) {
  const Quatd& q = camera.pose.orientation;
  Json json{{"position_m", vector_json(camera.pose.position_m)},
            {"orientation_xyzw", Json::array({q.x, q.y, q.z, q.w})}};
  if (camera.projection.kind == ProjectionKind::perspective) {
    json["yfov_deg"] = camera.projection.yfov_rad * kDegPerRad;
  } else {
    json["ymag_m"] = camera.projection.ymag_m;
  }
  if (const Vec2d& middle = camera.projection.middle_m; middle != Vec2d{}) {
    json["middle_m"] = Json::array({middle.x, middle.y});
  }
  return json;
}

using Row = std::vector<std::string>;

Row row_of(const FrameRequest& request, bool with_true) {
  const Vec3d& p = request.camera.pose.position_m;
  const GazeAtTime& gaze = request.gaze_render;
  Row row{fmt::format("{}", request.frame), fmt::format("{:.6f}", static_cast<double>(request.t_video_ns) * 1e-9),
          fmt::format("{:.3f} {:.3f} {:.3f}", p.x, p.y, p.z), position_text(gaze)};
  if (with_true) {
    row.push_back(position_text(request.gaze_true));
  }
  row.emplace_back(to_string(gaze.state));
  row.push_back(rows_text(gaze));
  row.push_back(age_text(gaze));
  row.emplace_back(has_rows(gaze) ? to_string(gaze.validity) : "-");
  row.emplace_back(gaze.movement ? to_string(*gaze.movement) : "-");
  row.push_back(gaze.reason);
  return row;
}

const std::string kIndent = "\n    ";

Json frame_json(const FrameRequest& request) {
  return Json{{"frame", request.frame},
              {"t_video_ns", request.t_video_ns},
              {"size_px", Json::array({request.width_px, request.height_px})},
              {"camera", camera_json(request.camera)},
              {"gaze_render", gaze_json(request.gaze_render, request.gaze_direction_render)},
              {"gaze_true", gaze_json(request.gaze_true, request.gaze_direction_true)},
              {"eye_in_saccade", request.eye_in_saccade},
              {"saccade_since_last_frame", request.saccade_since_last_frame},
              {"blink_since_last_frame", request.blink_since_last_frame}};
}

}  // namespace

std::string gaze_ages_text(const GazeAges& ages) {
  const auto ms = [](double ns) { return ns * 1e-6; };
  const std::string unknown =
      ages.unknown > 0 ? fmt::format("unknown for {} frames, as the log repeats values once a frame", ages.unknown)
                       : "";
  if (ages.frames == 0) {
    return unknown;
  }
  const bool are_alike = ms(ages.max_ns) - ms(ages.min_ns) < 0.1;
  const std::string figures =
      are_alike
          ? fmt::format("{:.1f} ms in all of {} frames", ms(ages.median_ns), ages.frames)
          : fmt::format("{:.1f} ms in the median, mean {:.1f}, {:.1f} to {:.1f}, 95 % up to {:.1f}, over {} frames",
                        ms(ages.median_ns), ms(ages.mean_ns), ms(ages.min_ns), ms(ages.max_ns), ms(ages.p95_ns),
                        ages.frames);
  return fmt::format("{}; {:.1f} ms less when a frame appears, as much more when it goes{}{}{}", figures,
                     ms(ages.half_frame_ns), unknown.empty() ? "" : "; ", unknown,
                     ages.without > 0 ? fmt::format("; {} frames without gaze are left out", ages.without) : "");
}

std::string plan_as_table(const FramePlan& plan) {
  const bool with_true = !std::all_of(plan.frames.begin(), plan.frames.end(), same_gaze);
  const bool directions = std::any_of(plan.frames.begin(), plan.frames.end(),
                                      [](const FrameRequest& r) { return r.gaze_render.kind == GazeKind::direction; });
  Row titles{"frame", "time s", "position m", directions ? "gaze x y z" : "gaze u v"};
  if (with_true) {
    titles.emplace_back("true gaze");
  }
  for (const std::string_view title : {"state", "rows", "age ms", "valid", "event", "reason"}) {
    titles.emplace_back(title);
  }
  // Made twice, since the rows of a long plan take as much memory as the plan.
  std::vector<std::size_t> widths(titles.size());
  const auto widen = [&](const Row& row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], row[i].size());
    }
  };
  std::string text;
  const auto add = [&](const Row& row) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      // Text is aligned to the left, numbers to the right.
      const bool is_text = titles[i] == "state" || titles[i] == "valid" || titles[i] == "event";
      text += is_text ? fmt::format("{:<{}}  ", row[i], widths[i]) : fmt::format("{:>{}}  ", row[i], widths[i]);
    }
    text += row.back() + "\n";
  };
  widen(titles);
  for (const FrameRequest& request : plan.frames) {
    widen(row_of(request, with_true));
  }
  add(titles);
  for (const FrameRequest& request : plan.frames) {
    add(row_of(request, with_true));
  }
  return text + notes_text(plan);
}

void write_plan_json(const FramePlan& plan, const std::function<void(const std::string& text)>& write) {
  const auto text_of = [](const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); };
  // Frame by frame, since a tree of all of them takes several times as much memory as the plan.
  write("{\n  \"frames\": [");
  for (const FrameRequest& request : plan.frames) {
    std::string text = text_of(frame_json(request));
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += kIndent.size()) {
      text.replace(at, 1, kIndent);
    }
    write((&request == &plan.frames.front() ? "" : ",") + (kIndent + text));
  }
  const Json json{{"gaze_processing", plan.gaze_processing},
                  {"effective_age", plan.ages ? ages_json(*plan.ages) : Json(nullptr)},
                  {"warnings", plan.warnings}};
  write((plan.frames.empty() ? "]," : "\n  ],") + text_of(json).substr(1) + "\n");
}

std::string plan_as_json(const FramePlan& plan) {
  std::string all;
  write_plan_json(plan, [&](const std::string& text) { all += text; });
  return all;
}

}  // namespace gazetrace
