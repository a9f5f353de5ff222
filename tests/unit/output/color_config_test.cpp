// SPDX-License-Identifier: Apache-2.0
// Which config, which view, and how linear Rec.709 finds its way in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "gazetrace/color.hpp"
#include "gazetrace/output.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::color_config_test {
namespace {

// Two displays; "plain" shows scene-linear values of the reference space, "half" half of them. The look doubles red.
std::string config_text(const std::string& roles) {
  return R"(ocio_profile_version: 2
roles:
  default: raw
)" + roles +
         R"(file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  monitor:
    - !<View> {name: plain, colorspace: ap0}
    - !<View> {name: half, colorspace: dimmed}
    - !<View> {name: looked, colorspace: ap0, looks: red}
  projector:
    - !<View> {name: raw, colorspace: raw}
active_displays: []
active_views: []
looks:
  - !<Look>
    name: red
    process_space: ap0
    transform: !<MatrixTransform> {matrix: [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}
  - !<Look>
    name: none
    process_space: ap0
colorspaces:
  - !<ColorSpace> {name: ap0}
  - !<ColorSpace> {name: raw, isdata: true}
  - !<ColorSpace>
    name: dimmed
    from_scene_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
)";
}

class ColorConfig : public testing::Test {
 protected:
  // A user's own $OCIO must not reach the tests.
  void SetUp() override { unsetenv("OCIO"); }
  void TearDown() override { unsetenv("OCIO"); }

  std::string write(const std::string& text) {
    const std::string path = folder_ / "config.ocio";
    write_text_atomically(path, text);
    return path;
  }
  static std::vector<int> show(const ColorSettings& settings) {
    const DisplayImage image = ColorPipeline(settings).apply(ImageRgb(1, 1, {1, 0, 0}), 0, 8, 1);
    return {image.bytes.begin(), image.bytes.end()};
  }
  static void expect_error(const ColorSettings& settings, ErrorKind kind, const std::vector<std::string>& parts) {
    try {
      const ColorPipeline pipeline(settings);
      FAIL() << parts.front();
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), kind);
      for (const std::string& part : parts) {
        EXPECT_THAT(e.what(), testing::HasSubstr(part));
      }
    }
  }

  TemporaryFolder folder_;
};

const std::string kInterchange = "  aces_interchange: ap0\n";

TEST_F(ColorConfig, BuiltInViews) {
  const ColorPipeline pipeline{ColorSettings{}};
  std::vector<std::string> names;
  for (const ViewInfo& info : pipeline.views()) {
    EXPECT_EQ(info.display, "sRGB");
    EXPECT_EQ(info.is_default, info.view == "ACES SDR");
    names.push_back(info.view);
  }
  EXPECT_THAT(names, testing::ElementsAre("ACES SDR", "sRGB", "Reinhard", "Raw"));
  EXPECT_EQ(pipeline.description(), "built-in: display sRGB, view ACES SDR");
}

TEST_F(ColorConfig, EntersThroughTheInterchangeRole) {
  ColorSettings settings;
  settings.config = write(config_text(kInterchange));
  // Rec.709 red in ACES2065-1 is the first column of the matrix: 0.4396, 0.0898, 0.0175.
  EXPECT_THAT(show(settings), testing::ElementsAre(112, 23, 4));
  settings.view = "half";
  EXPECT_THAT(show(settings), testing::ElementsAre(56, 11, 2));
}

TEST_F(ColorConfig, EntersThroughANamedInput) {
  ColorSettings settings;
  settings.config = write(config_text(""));
  expect_error(settings, ErrorKind::input, {settings.config, "no role aces_interchange", "`ocio-input`"});
  settings.input = "ap0";
  EXPECT_THAT(show(settings), testing::ElementsAre(255, 0, 0));
  settings.input = "ap1";
  expect_error(settings, ErrorKind::usage, {"unknown input color space 'ap1'", "did you mean 'ap0'"});
}

// Of the working space, by whatever way it would enter the config.
TEST_F(ColorConfig, AViewOfDataShowsThePicturesOwnNumbers) {
  ColorSettings settings;
  settings.display = "projector";
  for (const std::string& roles : {kInterchange, std::string()}) {
    settings.config = write(config_text(roles));
    const DisplayImage image = ColorPipeline(settings).apply(ImageRgb(1, 1, {0.8F, 0.2F, 0.4F}), 0, 8, 1);
    EXPECT_THAT(image.bytes, testing::ElementsAre(204, 51, 102));
  }
  settings.input = "ap0";
  EXPECT_THAT(show(settings), testing::ElementsAre(255, 0, 0));
  settings.look = "red";
  expect_error(settings, ErrorKind::usage, {"'raw'", "no look"});
}

TEST_F(ColorConfig, LooksReplaceThoseOfTheView) {
  ColorSettings settings;
  settings.config = write(config_text(""));
  settings.input = "ap0";
  const auto half_red = [&] {
    const DisplayImage image = ColorPipeline(settings).apply(ImageRgb(1, 1, {0.25F, 0.25F, 0}), 0, 8, 1);
    return std::vector<int>{image.bytes.begin(), image.bytes.end()};
  };
  EXPECT_THAT(half_red(), testing::ElementsAre(64, 64, 0));
  settings.view = "looked";
  EXPECT_THAT(half_red(), testing::ElementsAre(128, 64, 0));
  settings.look = "none";
  EXPECT_THAT(half_red(), testing::ElementsAre(64, 64, 0));
  settings.view = "plain";
  settings.look = "+red";
  EXPECT_THAT(half_red(), testing::ElementsAre(128, 64, 0));
  settings.look = "rad";
  expect_error(settings, ErrorKind::usage, {"unknown look 'rad'", "did you mean 'red'"});
}

TEST_F(ColorConfig, EnvironmentVariableAndItsOverride) {
  const std::string path = write(config_text(kInterchange));
  setenv("OCIO", path.c_str(), 1);
  EXPECT_THAT(ColorPipeline(ColorSettings{}).description(), testing::StartsWith(path));
  setenv("OCIO", (folder_ / "missing.ocio").c_str(), 1);
  expect_error({}, ErrorKind::input, {"$OCIO", "missing.ocio", "no such"});
  ColorSettings settings;
  settings.config = path;
  EXPECT_THAT(ColorPipeline(settings).description(), testing::StartsWith(path));
}

TEST_F(ColorConfig, UnknownNamesGetTheKnownOnes) {
  ColorSettings settings;
  settings.view = "ACES SRD";
  expect_error(settings, ErrorKind::usage,
               {"unknown view 'ACES SRD'", "did you mean 'ACES SDR'", "ACES SDR, sRGB, Reinhard, Raw"});
  settings = {};
  settings.display = "P3";
  expect_error(settings, ErrorKind::usage, {"unknown display 'P3'", "Known: sRGB"});
  settings = {};
  settings.look = "warm";
  expect_error(settings, ErrorKind::usage, {"unknown look 'warm'", "none"});
}

TEST_F(ColorConfig, BrokenFiles) {
  ColorSettings settings;
  settings.config = folder_ / "missing.ocio";
  expect_error(settings, ErrorKind::input, {settings.config, "no such"});
  settings.config = write("this is no config");
  expect_error(settings, ErrorKind::input, {settings.config, "not a usable"});
  settings.config = folder_.path();
  expect_error(settings, ErrorKind::input, {settings.config});
}

// Blender 5's config is 2.4, and that of 5.2 is 2.5, whose names of views mean nothing to the built-in one.
TEST_F(ColorConfig, TooNewForThisLibrary) {
  ColorSettings settings;
  std::string text = config_text(kInterchange);
  settings.config = write(text.replace(text.find("version: 2"), 10, "version: 2.99"));
  settings.display = "monitor";
  settings.view = "plain";
  settings.look = "red";
  for (const bool is_needed : {true, false}) {
    settings.is_needed = is_needed;
    const ColorPipeline pipeline(settings);
    EXPECT_EQ(pipeline.description(), "built-in: display sRGB, view ACES SDR");
    EXPECT_THAT(pipeline.warnings(),
                testing::ElementsAre(testing::AllOf(
                    testing::StartsWith(settings.config), testing::HasSubstr("version 2.99"),
                    testing::ContainsRegex("OpenColorIO 2\\.[0-9]+\\.[0-9]+ reads those up to 2\\.[0-9]"),
                    testing::EndsWith(is_needed ? "pictures have the built-in view instead" : "no picture needs it"))));
    EXPECT_EQ(show(settings), show({}));
  }
  setenv("OCIO", settings.config.c_str(), 1);
  EXPECT_THAT(ColorPipeline(ColorSettings{}).warnings(), testing::ElementsAre(testing::StartsWith("$OCIO (")));
}

TEST_F(ColorConfig, BrokenButNotNeeded) {
  ColorSettings settings;
  settings.is_needed = false;
  settings.config = write("this is no config");
  EXPECT_THAT(
      ColorPipeline(settings).warnings(),
      testing::ElementsAre(testing::AllOf(testing::HasSubstr("not a usable"), testing::HasSubstr("no picture"))));
  settings.config = write(config_text(kInterchange));
  EXPECT_THAT(ColorPipeline(settings).warnings(), testing::IsEmpty());
}

}  // namespace
}  // namespace gazetrace::color_config_test
