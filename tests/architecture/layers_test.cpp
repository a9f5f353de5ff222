// SPDX-License-Identifier: Apache-2.0
// The layer table of src/README.md, held against every #include: an include goes only down, each dependency is met in
// one place, and public headers name no dependency at all.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path source_folder = GAZETRACE_SOURCE_DIR;

// The layers from the bottom up. A module may include modules of the layers below it, and itself.
const std::vector<std::vector<std::string>> layers = {
    {"core"},
    {"display", "camera", "material", "gazelog", "gaze"},
    {"scene", "plan", "foveation", "measure"},
    {"trace"},
    {"reconstruct", "temporal", "color", "output", "metrics", "visible"},
    {"pipeline", "compare", "results"},
    {"job"},
    {"sweep", "aoi", "video", "farm"},
    {"cli"},
};
const std::map<std::string, int> layer_of = [] {
  std::map<std::string, int> layer;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    for (const std::string& module : layers[i]) {
      layer[module] = static_cast<int>(i);
    }
  }
  return layer;
}();

// Within a layer, the order of the data: what may be seen sideways.
const std::set<std::pair<std::string, std::string>> sideways = {
    {"gazelog", "display"},       // logs carry the geometry of their recording
    {"gaze", "gazelog"},          // what is done with gaze begins with a log
    {"gaze", "display"},          // gaze on a display is an angle
    {"camera", "display"},        // a camera's image plane is a view
    {"temporal", "reconstruct"},  // accumulates frames
    {"output", "color"},          // writes display images
    {"output", "reconstruct"},    // writes frames
    {"visible", "metrics"},       // predicts what a metric will measure
    {"visible", "color"},         // through the view that the picture is shown with
    {"farm", "sweep"},            // the rows of a sweep are divided among tasks
};

// The public headers of each module.
const std::map<std::string, std::vector<std::string>> public_headers = {
    {"core", {"math", "image", "error", "version"}},
    {"display", {"display", "headsets"}},
    {"camera", {"camera", "motion"}},
    {"material", {"material"}},
    {"gazelog", {"gaze_conventions", "gaze_log", "gaze_raw", "gaze_raw_rows", "gaze_read", "gaze_write"}},
    {"gaze",
     {"gaze", "gaze_event_check", "gaze_event_durations", "gaze_events", "gaze_inspect", "gaze_privacy", "gaze_process",
      "gaze_synth", "gaze_trials", "gaze_vergence"}},
    {"measure", {"gaze_measure"}},
    {"scene", {"scene", "scene_contents", "sky", "deformation"}},
    {"plan", {"plan"}},
    {"foveation", {"density", "foveation"}},
    {"trace", {"trace", "coverage", "guides", "light_groups"}},
    {"reconstruct", {"reconstruct"}},
    {"temporal", {"temporal"}},
    {"color", {"color"}},
    {"output", {"aovs", "cryptomatte", "frame_layers", "output"}},
    {"metrics", {"metrics", "fovvideovdp", "flicker"}},
    {"visible", {"visible_error", "model_gain"}},
    {"pipeline", {"build_info", "frame_renderer", "input_digest", "merge_means", "output_lock", "pipeline"}},
    {"compare", {"compare"}},
    {"results", {"results"}},
    {"job",
     {"compare_inputs", "compare_job", "former_options", "job", "job_schema", "job_settings", "metric_options",
      "option_schema", "option_values", "recorded_run", "resolve", "run_job"}},
    {"aoi", {"gaze_objects", "gaze_aois", "gaze_outlines"}},
    {"sweep", {"sweep", "sweep_plan"}},
    {"video", {"video"}},
    {"farm", {"farm"}},
};
const std::map<std::string, std::string> module_of_header = [] {
  std::map<std::string, std::string> module_of;
  for (const auto& [module, headers] : public_headers) {
    for (const std::string& header : headers) {
      module_of[header] = module;
    }
  }
  return module_of;
}();

// Which files may meet which dependency.
const std::vector<std::pair<std::string, std::string>> dependencies = {
    {R"(embree[34]/)", R"(src/trace/rays/embree(_\w+)?\.(hpp|cpp))"},
    {R"(tiny_gltf\.h)", R"(src/scene/gltf/document\.cpp)"},
    {R"(meshoptimizer\.h)", R"(src/scene/gltf/meshopt\.cpp)"},
    {R"(draco/)", R"(src/scene/gltf/draco\.cpp)"},
    {R"(OpenImageDenoise|oidn\.h)", R"(no file: it is opened at run time)"},
    {R"(OpenImageIO/)", R"(src/core/open_image_io\.cpp)"},
    {R"(OpenColorIO/)", R"(src/color/ocio\.cpp)"},
    {R"((OpenEXR/|Imf|Imath|Iex))", R"(src/(output/exr(_\w+)?|core/exr_reader)\.(hpp|cpp))"},
    {R"(tbb/|oneapi/)", R"(src/core/parallel\.cpp)"},
    {R"(CLI/)", R"(src/cli/.*)"},
    {R"(toml\+\+/|toml\.hpp)", R"(src/job/toml_tree\.cpp)"},
    {R"(nlohmann/)", R"(src/(.*\.cpp|scene/gltf/walker\.hpp|results/json_node\.hpp|gazelog/bids_parts\.hpp))"},
    {R"(pugixml)", R"(src/gazelog/formats/xdf\.cpp)"},
    {R"(fmt/)", R"(src/.*\.cpp)"},
    {"regex$", R"(src/gaze/privacy\.cpp)"},
    {R"(zlib\.h)", R"(src/(gazelog/gzip|core/png_file)\.cpp)"},
};

std::vector<fs::path> sources(const std::vector<std::string>& folders) {
  std::vector<fs::path> found;
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::recursive_directory_iterator(source_folder / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".hpp" || extension == ".cpp" || extension == ".def" || extension == ".inl") {
        found.push_back(entry.path());
      }
    }
  }
  return found;
}

struct Include {
  std::string file;  // relative to the repository
  int line = 0;
  std::string target;
  bool quoted = false;
};

std::vector<Include> includes_of(const fs::path& path) {
  static const std::regex include_line(R"re(^\s*#\s*include\s*([<"])([^>"]+)[>"])re");
  std::vector<Include> found;
  std::ifstream in(path);
  std::string text;
  for (int line = 1; std::getline(in, text); ++line) {
    std::smatch match;
    if (std::regex_search(text, match, include_line)) {
      found.push_back({fs::relative(path, source_folder).string(), line, match[2], match[1] == "\""});
    }
  }
  return found;
}

// "core", "cli", ... of a file of ours; empty for others.
std::string module_of_file(const std::string& relative) {
  static const std::regex public_path(R"(include/gazetrace/([a-z_]+)\.hpp)");
  static const std::regex private_path(R"(src/([a-z]+)/.*)");
  std::smatch match;
  if (std::regex_match(relative, match, public_path)) {
    const auto found = module_of_header.find(match[1]);
    return found == module_of_header.end() ? "" : found->second;
  }
  return std::regex_match(relative, match, private_path) ? match[1].str() : "";
}

std::string module_of_target(const Include& include) {
  if (include.target.rfind("gazetrace/", 0) == 0) {
    return module_of_file("include/" + include.target);
  }
  const auto slash = include.target.find('/');
  const std::string first = include.target.substr(0, slash);
  return include.quoted && slash != std::string::npos && layer_of.count(first) != 0 ? first : "";
}

TEST(Architecture, IncludesGoOnlyDown) {
  for (const fs::path& path : sources({"include", "src"})) {
    const std::string from = module_of_file(fs::relative(path, source_folder).string());
    if (path.filename() == "version.hpp.in") {
      continue;
    }
    ASSERT_TRUE(layer_of.count(from) != 0) << path << " belongs to no module of the layer table";
    for (const Include& include : includes_of(path)) {
      const std::string to = module_of_target(include);
      if (to.empty() || to == from) {
        continue;
      }
      const bool down = layer_of.at(to) < layer_of.at(from);
      EXPECT_TRUE(down || sideways.count({from, to}) != 0)
          << include.file << ":" << include.line << ": " << from << " may not include " << to << " (" << include.target
          << ")";
    }
  }
}

TEST(Architecture, EveryDependencyIsMetInItsPlace) {
  for (const fs::path& path : sources({"include", "src"})) {
    for (const Include& include : includes_of(path)) {
      for (const auto& [pattern, place] : dependencies) {
        if (std::regex_search(include.target, std::regex("^" + pattern))) {
          EXPECT_TRUE(std::regex_match(include.file, std::regex(place)))
              << include.file << ":" << include.line << ": " << include.target << " belongs into " << place;
        }
      }
    }
  }
}

TEST(Architecture, PublicHeadersNeedOnlyTheStandardLibrary) {
  for (const fs::path& path : sources({"include"})) {
    for (const Include& include : includes_of(path)) {
      const bool ours = include.target.rfind("gazetrace/", 0) == 0;
      const bool standard = !include.quoted && include.target.find('/') == std::string::npos &&
                            include.target.find('.') == std::string::npos;
      EXPECT_TRUE(ours || standard) << include.file << ":" << include.line << ": " << include.target;
    }
  }
}

TEST(Architecture, TheProgramUsesPublicHeadersOnly) {
  for (const fs::path& path : sources({"src"})) {
    if (module_of_file(fs::relative(path, source_folder).string()) != "cli") {
      continue;
    }
    for (const Include& include : includes_of(path)) {
      const std::string to = module_of_target(include);
      EXPECT_TRUE(to.empty() || to == "cli" || include.target.rfind("gazetrace/", 0) == 0)
          << include.file << ":" << include.line << ": " << include.target;
    }
  }
}

// They are compiled together, several as one file.
TEST(Architecture, EveryTestHasANamespaceOfItsOwn) {
  for (const fs::path& path : sources({"tests/unit", "tests/stats", "tests/render", "tests/reference"})) {
    if (path.stem().string().ends_with("_test")) {
      std::ifstream in(path);
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      const std::string wanted = "namespace gazetrace::" + path.stem().string() + " {";
      EXPECT_NE(text.find(wanted), std::string::npos) << path << ": say `" << wanted << "`";
    }
  }
}

TEST(Architecture, EveryFileNamesItsLicence) {
  for (const fs::path& path : sources({"include", "src", "tests", "examples"})) {
    std::ifstream in(path);
    std::string first;
    std::getline(in, first);
    EXPECT_NE(first.find("SPDX-License-Identifier: Apache-2.0"), std::string::npos) << path;
  }
}

}  // namespace
