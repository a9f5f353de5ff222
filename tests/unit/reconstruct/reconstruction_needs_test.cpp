// SPDX-License-Identifier: Apache-2.0
// What filters state of themselves, what the tracer is told of it, and which filter suits a job.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gazetrace/display.hpp"
#include "gazetrace/error.hpp"
#include "gazetrace/foveation.hpp"
#include "gazetrace/reconstruct.hpp"

namespace gazetrace::reconstruction_needs_test {
namespace {

TEST(ReconstructionNeeds, OnlyGuidedFiltersNeedMoreThanSums) {
  for (const FilterInfo& info : reconstruction_filters()) {
    SCOPED_TRACE(info.name);
    const bool guided = info.name == "guided" || info.name == "oidn";
    EXPECT_EQ(info.needs.guides.has_value(), guided);
    EXPECT_EQ(info.needs.surfaces, guided);
    EXPECT_EQ(info.needs.halves, guided);
    EXPECT_EQ(Reconstruction({info.name}).filter().name, info.name);
  }
}

TEST(ReconstructionNeeds, TheTracerIsToldThem) {
  TraceSettings trace;
  trace.seed = 7;
  trace.guides = true;  // of AOVs, which no filter takes away
  const TraceSettings guided = Reconstruction({"guided"}).trace_settings(trace);
  EXPECT_TRUE(guided.surfaces);
  EXPECT_TRUE(guided.halves);
  EXPECT_TRUE(guided.guides);
  EXPECT_EQ(guided.seed, 7U);
  trace.surfaces = true;  // left over from another filter
  EXPECT_FALSE(Reconstruction({"linear"}).trace_settings(trace).surfaces);
}

// The network's halves are read from 16 samples a pixel on; guided always reads them.
TEST(ReconstructionNeeds, SamplesAreSplitForThoseWhoReadTheHalves) {
  FoveationSettings settings;
  settings.sampling = UniformSampling{};
  for (const int spp : {15, 16}) {
    settings.spp = spp;
    const SamplingMap map = make_sampling_map(settings, view_of_perspective(1.0, 64, 36), {});
    EXPECT_EQ(Reconstruction({"oidn"}).trace_settings({}, &map).independent_halves, spp == 16);
    EXPECT_TRUE(Reconstruction({"guided"}).trace_settings({}, &map).independent_halves);
  }
  EXPECT_TRUE(Reconstruction({"oidn"}).trace_settings({}).independent_halves);
}

// One ray stands for a pixel, so that its cone is as wide as that; materials are those of the samples.
TEST(ReconstructionNeeds, GuidesFollowTheSamples) {
  TraceSettings trace;
  trace.diffuse = DiffuseModel::lambert;
  EXPECT_FALSE(Reconstruction({"none"}).guide_settings(trace).has_value());
  const Reconstruction guided({"guided"});
  const GuideSettings settings = guided.guide_settings(trace).value();
  EXPECT_EQ(settings.pixel_cone, 1);
  EXPECT_EQ(settings.diffuse, DiffuseModel::lambert);
  EXPECT_EQ(settings.edge_rays, guided.needs().guides.value().edge_rays);
}

TEST(ReconstructionNeeds, AFilterMustBeNamed) {
  try {
    const Reconstruction none{ReconstructionSettings{}};
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::usage);
    EXPECT_THAT(e.what(), testing::HasSubstr("no reconstruction filter is named"));
  }
}

TEST(ChooseFilter, TheNetworkWhereItsLibraryIs) {
  EXPECT_EQ(choose_filter({.has_denoiser = true}).name, "oidn");
  EXPECT_EQ(choose_filter({.foveated = false, .has_denoiser = true}).name, "oidn");
  EXPECT_EQ(choose_filter({.single_pixel = true, .has_denoiser = true}).name, "guided");
  EXPECT_THAT(choose_filter({}).reason, testing::HasSubstr("Open Image Denoise was not found"));
}

TEST(ChooseFilter, GuidedWhereAllSamplesAreThere) {
  EXPECT_EQ(choose_filter({}).name, "guided");
  EXPECT_EQ(choose_filter({.foveated = false}).name, "guided");
  const FilterChoice choice = choose_filter({.foveated = false, .single_pixel = true});
  EXPECT_EQ(choice.name, "linear");
  EXPECT_NE(choice.reason, choose_filter({}).reason);
  // What is chosen goes with what it was chosen for.
  EXPECT_FALSE(Reconstruction({choice.name}).filter().needs.surfaces);
}

}  // namespace
}  // namespace gazetrace::reconstruction_needs_test
