// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "aoi/cells.hpp"
#include "gazetrace/gaze_objects.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLeastListed = 0.005;
constexpr const char* kNothing = "(environment)";

std::string without_tabs(std::string text) {
  for (char& c : text) {
    c = c == '\t' || c == '\n' || c == '\r' ? ' ' : c;
  }
  return text;
}

std::string node_of(const GazeObjects& objects, std::size_t object) {
  return object == 0 ? kNothing : without_tabs(objects.objects[object].node);
}

std::string node_and_material(const GazeObjects& objects, std::size_t object) {
  const std::string material = object == 0 ? "" : without_tabs(objects.objects[object].material);
  return node_of(objects, object) + (material.empty() ? "" : " (" + material + ")");
}

const char* name_of(Stimulus stimulus) {
  return stimulus == Stimulus::recorded ? "recorded" : "replayed";
}

std::string movement_of(const FrameObjects& frame) {
  return frame.movement ? std::string(to_string(*frame.movement)) : "n/a";
}

}  // namespace

std::string objects_as_tsv(const GazeObjects& objects) {
  std::string text =
      "frame\tt_video_ns\tt_log_ns\tgaze\tmovement\tstimulus\tnode\tmaterial\tshare\tdistance_m\tx_m\ty_m\tz_m\talso\t"
      "beside_share\tcone95_deg";
  for (int i = 1; i <= objects.settings.nearest; ++i) {
    fmt::format_to(std::back_inserter(text), "\tnear_{0}\tnear_{0}_deg", i);
  }
  text += '\n';
  const std::string cone = number_cell(gaze_cone_95_deg(objects.settings.uncertainty));
  for (const FrameObjects& frame : objects.frames) {
    fmt::format_to(std::back_inserter(text), "{}\t{}\t{}\t{}\t{}\t{}", frame.frame, frame.t_video_ns, frame.t_log_ns,
                   to_string(frame.state), movement_of(frame), name_of(objects.settings.stimulus));
    if (frame.shares.empty()) {
      text += "\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a\tn/a";
    } else {
      const ObjectShare& first = frame.shares.front();
      const std::string material = without_tabs(objects.objects[first.object].material);
      fmt::format_to(std::back_inserter(text), "\t{}\t{}\t{:.4f}\t{}\t{}\t{}\t{}\t", node_of(objects, first.object),
                     material.empty() ? "n/a" : material, first.share, number_cell(first.distance_m),
                     number_cell(first.position_m.x), number_cell(first.position_m.y), number_cell(first.position_m.z));
      std::string also;
      for (std::size_t i = 1; i < frame.shares.size(); ++i) {
        if (frame.shares[i].share >= kLeastListed) {
          also += fmt::format("{}{}={:.3f}", also.empty() ? "" : "; ",
                              node_and_material(objects, frame.shares[i].object), frame.shares[i].share);
        }
      }
      text += also.empty() ? "n/a" : also;
    }
    fmt::format_to(std::back_inserter(text), "\t{:.4f}\t{}", frame.beside_share, cone);
    for (int i = 0; i < objects.settings.nearest; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (at < frame.nearest.size()) {
        fmt::format_to(std::back_inserter(text), "\t{}\t{:.3f}", node_of(objects, frame.nearest[at].object),
                       frame.nearest[at].eccentricity_deg);
      } else {
        text += "\tn/a\tn/a";
      }
    }
    text += '\n';
  }
  return text;
}

std::string objects_as_json(const GazeObjects& objects) {
  const auto object_of = [&](std::size_t object) {
    return object == 0 ? Json{{"node", nullptr}, {"material", nullptr}}
                       : Json{{"node", objects.objects[object].node}, {"material", objects.objects[object].material}};
  };
  Json frames = Json::array();
  for (const FrameObjects& frame : objects.frames) {
    Json item{{"frame", frame.frame},
              {"t_video_ns", frame.t_video_ns},
              {"t_log_ns", frame.t_log_ns},
              {"gaze", to_string(frame.state)},
              {"movement", frame.movement ? Json(to_string(*frame.movement)) : Json(nullptr)},
              {"beside_share", frame.beside_share}};
    item["objects"] = Json::array();
    for (const ObjectShare& share : frame.shares) {
      Json one = object_of(share.object);
      one["share"] = share.share;
      one["distance_m"] = number_or_null<Json>(share.distance_m);
      one["position_m"] =
          Json::array({number_or_null<Json>(share.position_m.x), number_or_null<Json>(share.position_m.y),
                       number_or_null<Json>(share.position_m.z)});
      item["objects"].push_back(std::move(one));
    }
    item["nearest"] = Json::array();
    for (const NearObject& near : frame.nearest) {
      Json one = object_of(near.object);
      one["eccentricity_deg"] = near.eccentricity_deg;
      item["nearest"].push_back(std::move(one));
    }
    frames.push_back(std::move(item));
  }
  const GazeObjectsSettings& s = objects.settings;
  const Json json{{"stimulus", name_of(s.stimulus)},
                  {"accuracy_deg", s.uncertainty.accuracy_deg},
                  {"precision_deg", s.uncertainty.precision_deg},
                  {"cone95_deg", gaze_cone_95_deg(s.uncertainty)},
                  {"rays", s.rays},
                  {"grid_deg", objects.grid_deg},
                  {"frames", std::move(frames)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace gazetrace
