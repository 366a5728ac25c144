#include <gtest/gtest.h>

#include "flight_corridor/image_watch.hpp"
#include "support/calibrations.hpp"
#include "support/wall_scene.hpp"

namespace flight_corridor {
namespace {

using namespace test_support;

TEST(ImageWatch, FindsNothingWrongWithACamera) {
  ImageWatch watch;
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(watch.faults(wallFrame(kSmallGeometry, 3, 1.0 + 0.1 * i)), 0u) << "frame " << i;
}

TEST(ImageWatch, NoticesOneImageOnBothSides) {
  StereoFrame frame = wallFrame(kSmallGeometry, 3, 1.0);
  frame.right = frame.left.clone();
  EXPECT_EQ(ImageWatch().faults(frame), kBadImage);
  frame.right.at<std::uint8_t>(0, 0) ^= 1;
  EXPECT_EQ(ImageWatch().faults(frame), 0u);
}

TEST(ImageWatch, NoticesOneFrozenCamera) {
  ImageWatch watch;
  const StereoFrame first = wallFrame(kSmallGeometry, 3, 1.0);
  watch.faults(first);
  StereoFrame next = wallFrame(kSmallGeometry, 3, 1.1);
  next.right = first.right;
  EXPECT_EQ(watch.faults(next), kFrozenImage);
}

TEST(ImageWatch, NoticesADriverThatRepeatsItsBuffers) {
  for (const int count : {1, 2, 4, 8}) {
    ImageWatch watch;
    for (int i = 0; i < 2 * count; ++i) {
      StereoFrame frame = wallFrame(kSmallGeometry, 3, 1.0 + 0.1 * (i % count));
      frame.stamp_s = 1.0 + 0.1 * i;
      EXPECT_EQ(watch.faults(frame), i < count ? 0u : kFrozenImage) << "frame " << i << " of " << count << " buffers";
    }
  }
}

TEST(ImageWatch, APairThatIsGivenTwiceIsNotFrozen) {
  ImageWatch watch;
  const StereoFrame frame = wallFrame(kSmallGeometry, 3, 1.0);
  watch.faults(frame);
  EXPECT_EQ(watch.faults(frame), 0u);
}

}  // namespace
}  // namespace flight_corridor
