// SPDX-License-Identifier: Apache-2.0
// What the header of a frame's file says of its gaze, written and read again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/atomic_file.hpp"
#include "core/image_io.hpp"
#include "gazetrace/compare.hpp"
#include "support/temporary_folder.hpp"

namespace gazetrace::frame_facts_test {
namespace {

using testing::HasSubstr;
using testing::Not;

class FrameFactsOf : public testing::Test {
 protected:
  FrameFacts written(const GazeAtTime& gaze) {
    FrameHeader header;
    header.gaze_true = gaze;
    write_display_image(path_, picture(), header, {});
    return read_frame_facts(path_);
  }
  // A file of a version that stated place and direction of every gaze.
  FrameFacts of_earlier_version(const std::string& where) {
    EncodeOptions options;
    options.note = "gazetrace:settings_digest=ab frame=1 t_video_ns=5 exposure_ev=0 state=measured " + where +
                   " t_log_ns=5 rows=2,2 age_ns=0 validity=valid event=fixation no_gaze=0";
    const std::vector<std::uint8_t> bytes = encode_image(path_, 1, 1, 8, picture().bytes, options);
    write_bytes_atomically(path_, std::as_bytes(std::span(bytes)));
    return read_frame_facts(path_);
  }
  static DisplayImage picture() { return {1, 1, 8, {1, 2, 3}}; }

  TemporaryFolder folder_;
  std::string path_ = folder_ / "a.png";
};

TEST_F(FrameFactsOf, GazeOnAScreenIsAPlaceWithoutDirection) {
  GazeAtTime gaze;
  gaze.state = GazeState::measured;
  gaze.u = 0.25;
  gaze.v = 0.75;
  const FrameFacts facts = written(gaze);
  EXPECT_THAT(read_image_note(path_), HasSubstr("state=measured u=0.25 v=0.75 t_log_ns"));
  EXPECT_THAT(read_image_note(path_), Not(HasSubstr("direction")));
  EXPECT_FALSE(facts.gaze_is_direction);
  ASSERT_TRUE(facts.gaze_true);
  EXPECT_EQ(facts.gaze_true->kind, GazeKind::screen);
  EXPECT_EQ(facts.gaze_true->u, 0.25);
  EXPECT_EQ(facts.gaze_true->v, 0.75);
}

// Straight ahead is a direction like any other.
TEST_F(FrameFactsOf, GazeDirectionsHaveNoPlace) {
  GazeAtTime gaze;
  gaze.state = GazeState::measured;
  gaze.kind = GazeKind::direction;
  for (const Vec3d& direction : {Vec3d{0, 0, -1}, Vec3d{0.6, 0, -0.8}}) {
    gaze.direction = direction;
    const FrameFacts facts = written(gaze);
    EXPECT_THAT(read_image_note(path_), Not(HasSubstr(" u=")));
    EXPECT_TRUE(facts.gaze_is_direction);
    ASSERT_TRUE(facts.gaze_true);
    EXPECT_EQ(facts.gaze_true->kind, GazeKind::direction);
    EXPECT_EQ(facts.gaze_true->state, GazeState::measured);
  }
}

TEST_F(FrameFactsOf, FilesOfEarlierVersionsAreRead) {
  const FrameFacts place = of_earlier_version("u=0.25 v=0.75 direction=0,0,-1");
  ASSERT_TRUE(place.gaze_true);
  EXPECT_FALSE(place.gaze_is_direction);
  EXPECT_EQ(place.gaze_true->u, 0.25);
  const FrameFacts direction = of_earlier_version("u=0.5 v=0.5 direction=0.6,0,-0.8");
  ASSERT_TRUE(direction.gaze_true);
  EXPECT_TRUE(direction.gaze_is_direction);
  EXPECT_FALSE(of_earlier_version("u=0.5").gaze_true);
}

}  // namespace
}  // namespace gazetrace::frame_facts_test
