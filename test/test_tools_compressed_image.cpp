#include <cv_bridge/cv_bridge.h>
#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "ros/conversions.hpp"
#include "support/rewrite_bag.hpp"
#include "tools/compressed_image.hpp"

namespace flight_corridor::tools {
namespace {

namespace encodings = sensor_msgs::image_encodings;
using test_support::compress;

/// An image of noise: no two pixels are equal by chance alone.
sensor_msgs::ImagePtr noise(int type, const std::string& encoding) {
  std_msgs::Header header;
  header.stamp = ros::Time(1603715273, 262142977);
  header.frame_id = "stereo_left_optical";
  cv::Mat image(24, 32, type);
  cv::RNG random(1);
  random.fill(image, cv::RNG::UNIFORM, 0, image.depth() == CV_16U ? 65536 : 256);
  return flight_corridor_ros::toImage(header, image, encoding);
}

/// A soft ramp, which JPEG keeps but for rounding.
sensor_msgs::ImagePtr ramp(int type, const std::string& encoding) {
  cv::Mat image(24, 32, type);
  for (int v = 0; v < image.rows; ++v) image.row(v).setTo(cv::Scalar::all(60 + 4 * v));
  return flight_corridor_ros::toImage({}, image, encoding);
}

TEST(CompressedImage, PngGivesTheImageAsItWas) {
  for (const auto& [type, encoding] :
       {std::pair(CV_8UC1, encodings::MONO8), std::pair(CV_8UC1, encodings::TYPE_8UC1),
        std::pair(CV_8UC1, encodings::BAYER_RGGB8), std::pair(CV_8UC3, encodings::BGR8),
        std::pair(CV_8UC4, encodings::BGRA8), std::pair(CV_16UC1, encodings::MONO16),
        std::pair(CV_16UC1, encodings::TYPE_16UC1), std::pair(CV_16UC3, encodings::BGR16)}) {
    const sensor_msgs::ImagePtr image = noise(type, encoding);
    EXPECT_EQ(*decompress(compress(image, ".png")), *image) << encoding;
  }
}

TEST(CompressedImage, JpegGivesTheImageButForRounding) {
  for (const auto& [type, encoding] : {std::pair(CV_8UC1, encodings::MONO8), std::pair(CV_8UC3, encodings::BGR8)}) {
    const sensor_msgs::ImagePtr image = ramp(type, encoding);
    const sensor_msgs::ImagePtr read = decompress(compress(image, ".jpg"));
    ASSERT_EQ(read->encoding, encoding);
    EXPECT_LE(cv::norm(cv_bridge::toCvShare(read)->image, cv_bridge::toCvShare(image)->image, cv::NORM_INF), 4.0);
  }
}

TEST(CompressedImage, EncodingIsThatOfTheDataWhereTheFormatTellsNone) {
  const sensor_msgs::ImagePtr grey = noise(CV_8UC1, encodings::MONO8), wide = noise(CV_16UC1, encodings::MONO16),
                              colour = noise(CV_8UC3, encodings::BGR8);
  for (const char* format :
       {"", "png", "jpeg", "bgra8; png compressed bgra8", "mono16;png", "purple7; png compressed"}) {
    auto compressed = compress(grey, ".png");
    compressed.format = format;
    EXPECT_EQ(decompress(compressed)->encoding, encodings::MONO8) << format;
    compressed = compress(colour, ".png");
    compressed.format = format;
    EXPECT_EQ(decompress(compressed)->encoding, encodings::BGR8) << format;
  }
  auto compressed = compress(wide, ".png");
  compressed.format = "mono8; png compressed";
  EXPECT_EQ(decompress(compressed)->encoding, encodings::MONO16);
}

TEST(CompressedImage, ColourComesInTheOrderInWhichItWasCompressed) {
  auto compressed = compress(noise(CV_8UC3, encodings::BGR8), ".png");
  compressed.format = "rgb8; png compressed bgr8";  // turned to BGR before, as image_transport does
  EXPECT_EQ(decompress(compressed)->encoding, encodings::BGR8);
  compressed.format = "rgb8; png compressed rgb8";
  EXPECT_EQ(decompress(compressed)->encoding, encodings::RGB8);
}

TEST(CompressedImage, DamagedOrForeignDataGivesAnEmptyImageWithItsHeader) {
  const sensor_msgs::ImagePtr image = noise(CV_8UC1, encodings::MONO8);
  sensor_msgs::CompressedImage empty = compress(image, ".png"), text = empty, flipped = empty, no_header = empty;
  empty.data.clear();
  text.data = {'h', 'e', 'l', 'l', 'o'};
  flipped.data[flipped.data.size() / 2] ^= 0x10;  // PNG has a checksum
  no_header.data[0] = 0;
  for (const sensor_msgs::CompressedImage& damaged : {empty, text, flipped, no_header}) {
    const sensor_msgs::ImagePtr read = decompress(damaged);
    EXPECT_EQ(read->header, image->header);
    EXPECT_EQ(read->width * read->height, 0u);
    EXPECT_TRUE(read->data.empty());
    EXPECT_TRUE(flight_corridor_ros::toGrey(read)->image.empty()) << "must be no error of its own";
  }
}

TEST(CompressedImage, NoneThatIsCutOffIsFilledUp) {
  for (const char* extension : {".png", ".jpg"}) {
    const auto whole = compress(noise(CV_8UC1, encodings::MONO8), extension);
    for (const double share : {0.01, 0.3, 0.6, 0.9, 0.99}) {
      auto cut = whole;
      cut.data.resize(static_cast<std::size_t>(share * static_cast<double>(whole.data.size())));
      EXPECT_TRUE(decompress(cut)->data.empty()) << extension << " " << share;
    }
  }
}

TEST(CompressedImage, ZerosBehindAJpegDoNoHarm) {
  auto padded = compress(ramp(CV_8UC1, encodings::MONO8), ".jpg");
  const sensor_msgs::ImagePtr image = decompress(padded);
  padded.data.resize(padded.data.size() + 100, 0);
  EXPECT_EQ(*decompress(padded), *image);
  EXPECT_FALSE(image->data.empty());
}

}  // namespace
}  // namespace flight_corridor::tools
