// SPDX-License-Identifier: Apache-2.0
// Fills the template of the page: texts and tables as HTML, diagrams and pictures as data for its script.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/svg.hpp"
#include "gazetrace/output.hpp"
#include "report/fill.hpp"
#include "report/page_files.hpp"
#include "report/pictures.hpp"
#include "report/tables.hpp"
#include "report/words.hpp"

namespace gazetrace {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr double kBytesOfMib = 1024.0 * 1024.0;

Json number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json();
}

std::string set_id(const SceneGaze& both) {
  return both.scene + "/" + both.gaze;
}

// What the viewer offers of a scene and gaze: the reference and every run that has pictures.
struct ViewerRun {
  std::string label;
  const ResultRow* row = nullptr;                // nullptr: the reference
  std::map<std::int32_t, std::string> pictures;  // frame -> path
  std::map<std::int32_t, std::string> maps;      // of FLIP
};
struct ViewerSet {
  SceneGaze both;
  std::vector<const ResultFrame*> frames;  // in the order of time, of the run that has the most frames
  std::vector<ViewerRun> runs;
};

ViewerSet viewer_set(const Results& data, const SceneGaze& both, const std::map<std::string, std::string>& names) {
  ViewerSet set{both, {}, {}};
  const ResultRow* longest = nullptr;
  for (const ResultRow& row : data.rows) {
    const bool has_pictures =
        std::any_of(row.frames.begin(), row.frames.end(), [](const ResultFrame& frame) { return !frame.png.empty(); });
    if (!(SceneGaze{row.scene, row.gaze} == both) || !has_pictures) {
      continue;
    }
    ViewerRun run{names.at(row.id), &row, {}, {}};
    for (const ResultFrame& frame : row.frames) {
      if (!frame.png.empty()) {
        run.pictures[frame.index] = (fs::path(data.directory) / frame.png).string();
      }
      if (!frame.png.empty() && !frame.flip_png.empty()) {
        run.maps[frame.index] = (fs::path(data.directory) / frame.flip_png).string();
      }
    }
    set.runs.push_back(std::move(run));
    if (longest == nullptr || row.frames.size() > longest->frames.size() ||
        (row.frames.size() == longest->frames.size() && row.role == RowRole::test && longest->role != RowRole::test)) {
      longest = &row;
    }
  }
  if (longest == nullptr) {
    return set;
  }
  for (const ResultFrame& frame : longest->frames) {
    set.frames.push_back(&frame);
  }
  const std::vector<const ResultReference*> scenes = find_references(data, both);
  std::vector<ViewerRun> references;
  for (const ResultReference* const scene : scenes) {
    if (scene->png.empty()) {
      continue;
    }
    ViewerRun reference{reference_text(*scene, scenes.size()), nullptr, {}, {}};
    const std::string pattern = (fs::path(data.directory) / scene->png).string();
    for (const ResultFrame* const frame : set.frames) {
      const std::string path = has_frame_number(pattern) ? frame_file_name(pattern, frame->index) : pattern;
      if (fs::is_regular_file(path)) {
        reference.pictures[frame->index] = path;
      }
    }
    if (!reference.pictures.empty()) {
      references.push_back(std::move(reference));
    }
  }
  set.runs.insert(set.runs.begin(), std::make_move_iterator(references.begin()),
                  std::make_move_iterator(references.end()));
  return set;
}

std::vector<std::vector<std::string>> paths_of_frames(const std::vector<ViewerSet>& sets) {
  std::vector<std::vector<std::string>> paths;
  for (const ViewerSet& set : sets) {
    for (const ResultFrame* const frame : set.frames) {
      std::vector<std::string> of_frame;
      for (const ViewerRun& run : set.runs) {
        for (const auto* const kind : {&run.pictures, &run.maps}) {
          if (const auto found = kind->find(frame->index); found != kind->end()) {
            of_frame.push_back(found->second);
          }
        }
      }
      paths.push_back(std::move(of_frame));
    }
  }
  return paths;
}

const ResultFrame* find_frame(const ResultRow* row, std::int32_t index) {
  if (row == nullptr) {
    return nullptr;
  }
  const auto found = std::find_if(row->frames.begin(), row->frames.end(),
                                  [&](const ResultFrame& frame) { return frame.index == index; });
  return found == row->frames.end() ? nullptr : &*found;
}

// Gaze and rings become fractions of the frame's width and height, because pictures may be reduced.
Json frame_json(const ResultFrame& frame, const EmbeddedPicture* picture) {
  Json json{{"index", frame.index},
            {"t_s", number(frame.t_s)},
            {"event", frame.event},
            {"gaze", Json()},
            {"rings", Json::array()}};
  if (frame.gaze_px && picture != nullptr) {
    json["gaze"] = {frame.gaze_px->x / picture->width_px, frame.gaze_px->y / picture->height_px};
    for (const double ring_px : frame.rings_px) {
      json["rings"].push_back(ring_px / picture->width_px);
    }
  }
  return json;
}

class PictureList {
 public:
  PictureList(const EmbeddedPictures& embedded, Json& list) : embedded_(embedded), list_(list) {}
  using Paths = std::map<std::int32_t, std::string>;
  [[nodiscard]] const EmbeddedPicture* find(const Paths& paths, std::int32_t frame) const {
    const auto path = paths.find(frame);
    if (path == paths.end()) {
      return nullptr;
    }
    const auto found = embedded_.of_path.find(path->second);
    return found == embedded_.of_path.end() ? nullptr : &found->second;
  }
  Json index(const Paths& paths, std::int32_t frame) {
    const EmbeddedPicture* const picture = find(paths, frame);
    if (picture == nullptr) {
      return {};
    }
    const auto [found, is_new] = indices_.emplace(picture, list_.size());
    if (is_new) {
      list_.push_back(picture->data_uri);
    }
    return found->second;
  }

 private:
  const EmbeddedPictures& embedded_;
  Json& list_;
  std::map<const EmbeddedPicture*, std::size_t> indices_;
};

Json run_json(const ViewerRun& run, const std::vector<const ResultFrame*>& frames, PictureList& pictures) {
  Json json{{"label", run.label},
            {"pictures", Json::array()},
            {"maps", Json::array()},
            {"times", Json::array()},
            {"scores", Json::array()}};
  for (const ResultFrame* const frame : frames) {
    const ResultFrame* const own = find_frame(run.row, frame->index);
    json["pictures"].push_back(pictures.index(run.pictures, frame->index));
    json["maps"].push_back(pictures.index(run.maps, frame->index));
    json["times"].push_back(own == nullptr ? Json() : number(own->time_s));
    Json scores = Json::object();
    if (own != nullptr) {
      for (const auto& [metric, value] : own->scores) {
        scores[metric] = number(value);
      }
    }
    json["scores"].push_back(std::move(scores));
  }
  return json;
}

Json set_json(const ViewerSet& set, PictureList& pictures) {
  Json json{{"id", set_id(set.both)},
            {"name", scene_gaze_text(set.both)},
            {"frames", Json::array()},
            {"runs", Json::array()}};
  std::vector<const ResultFrame*> shown;  // the frames of which at least one picture found room
  for (const ResultFrame* const frame : set.frames) {
    const EmbeddedPicture* any = nullptr;
    for (const ViewerRun& run : set.runs) {
      any = any != nullptr ? any : pictures.find(run.pictures, frame->index);
    }
    if (any != nullptr) {
      shown.push_back(frame);
      json["frames"].push_back(frame_json(*frame, any));
    }
  }
  if (!shown.empty()) {
    for (const ViewerRun& run : set.runs) {
      json["runs"].push_back(run_json(run, shown, pictures));
    }
  }
  return json;
}

std::string facts_line(const Results& data) {
  std::vector<std::string> facts;
  for (const NamedValues& list : {facts_of(data.build), facts_of(data.machine)}) {
    for (const auto& [name, value] : list) {
      facts.push_back(fmt::format("{} {}", name, value));
    }
  }
  if (!data.plan_file.empty()) {
    facts.push_back("plan " + data.plan_file);
  }
  return escaped(fmt::format("{}", fmt::join(facts, " · ")));
}

}  // namespace

ReportPage report_page(const Results& data, const ReportSettings& settings) {
  Json json{{"metrics", Json::array()},
            {"tests", Json::array()},
            {"plots", Json::array()},
            {"sets", Json::array()},
            {"pictures", Json::array()}};
  for (const ResultMetric& metric : data.metrics) {
    json["metrics"].push_back(metric.name);
  }
  const std::map<std::string, std::string> names = run_names(data);
  const ReportFindings findings = report_findings(data);
  for (const ResultRow* const test : test_rows(data)) {
    json["tests"].push_back(
        {{"id", test->id}, {"label", names.at(test->id)}, {"set", set_id({test->scene, test->gaze})}});
  }
  for (const ReportPlot& plot : report_plots(data)) {
    json["plots"].push_back({{"kind", plot.kind},
                             {"set", set_id({plot.scene, plot.gaze})},
                             {"row", plot.row},
                             {"metric", plot.metric},
                             {"svg", plot.svg}});
  }
  std::vector<ViewerSet> sets;
  for (const SceneGaze& both : scene_gazes(data)) {
    sets.push_back(viewer_set(data, both, names));
  }
  std::map<std::string, std::string> values{
      {"title", escaped(data.title)},
      {"style", std::string(report_page_style)},
      {"script", std::string(report_page_script)},
      {"facts", facts_line(data)},
      {"headline", escaped(findings.headline)},
      {"summary", findings_html(findings)},
      {"tables", tables_html(data)},
      {"methods", escaped(results_methods(data))},
      {"notes", data.notes.empty() ? "<p>None.</p>" : list_html(data.notes)},
  };
  const auto dumped = [&] { return script_safe(json.dump(-1, ' ', false, Json::error_handler_t::replace)); };
  double other_bytes = static_cast<double>(dumped().size() + report_page_html.size());
  for (const auto& [name, value] : values) {
    other_bytes += static_cast<double>(value.size());
  }
  // The gaze, times and scores of each frame take about this much; with them the page must stay below its limit.
  constexpr double kBytesOfFrame = 400;
  const std::vector<std::vector<std::string>> paths = paths_of_frames(sets);
  for (const std::vector<std::string>& of_frame : paths) {
    other_bytes += kBytesOfFrame * static_cast<double>(of_frame.size() + 1);
  }
  EmbeddedPictures embedded = embed_pictures(paths, settings.max_mib * kBytesOfMib - other_bytes, settings.threads);
  if (other_bytes > settings.max_mib * kBytesOfMib) {
    embedded.warnings.push_back(
        fmt::format("tables and diagrams alone take {:.2f} MiB, more than the limit of {:g} MiB",
                    other_bytes / kBytesOfMib, settings.max_mib));
  }
  PictureList pictures(embedded, json["pictures"]);
  for (const ViewerSet& set : sets) {
    Json one = set_json(set, pictures);
    json["sets"].push_back(std::move(one));
  }
  values["pictures"] = escaped(fmt::format("{} The page's limit is {:g} MiB.", embedded.statement, settings.max_mib));
  values["data"] = dumped();
  return {fill_template(report_page_html, values), std::move(embedded.warnings)};
}

}  // namespace gazetrace
