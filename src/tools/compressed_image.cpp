#include "tools/compressed_image.hpp"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

namespace flight_corridor::tools {
namespace {

namespace encodings = sensor_msgs::image_encodings;

/// OpenCV fills what is missing of a JPEG with what it has: so it must be there to its end marker. USB cameras pad with
/// zeros behind it. (Of a PNG it takes none without its end.)
bool isCutOff(const std::vector<std::uint8_t>& data) {
  const bool is_jpeg = data.size() > 2 && data[0] == 0xFF && data[1] == 0xD8;
  if (!is_jpeg) return false;
  const auto last = std::find_if(data.rbegin(), data.rend(), [](std::uint8_t byte) { return byte != 0; });
  return *last != 0xD9 || *(last + 1) != 0xFF;
}

cv::Mat decode(const std::vector<std::uint8_t>& data) try {
  if (data.empty() || isCutOff(data)) return {};
  return cv::imdecode(data, cv::IMREAD_UNCHANGED);
} catch (const cv::Exception&) {  // e.g. a header with an absurd size
  return {};
}

/// The encoding before the image was compressed, where the message names one: "mono8; jpeg compressed ".
std::string announcedEncoding(const std::string& format, int type) try {
  const std::string announced = format.substr(0, format.find(';'));
  return cv_bridge::getCvType(announced) == type ? announced : "";
} catch (const cv_bridge::Exception&) {
  return "";  // "jpeg"
}

/// @return "" when no encoding holds such an image.
std::string encodingOf(const cv::Mat& image, const std::string& format) {
  const bool is_wide = image.depth() == CV_16U;
  if (!is_wide && image.depth() != CV_8U) return "";
  // image_transport compresses colour as BGR; whoever compresses RGB says so, and it comes out in that order.
  const bool is_rgb = format.find("compressed rgb") != std::string::npos;
  switch (image.channels()) {
    case 1: {
      const std::string announced = announcedEncoding(format, image.type());
      if (!announced.empty()) return announced;
      return is_wide ? encodings::MONO16 : encodings::MONO8;
    }
    case 3:
      return is_wide ? (is_rgb ? encodings::RGB16 : encodings::BGR16) : (is_rgb ? encodings::RGB8 : encodings::BGR8);
    case 4:
      return is_wide ? (is_rgb ? encodings::RGBA16 : encodings::BGRA16)
                     : (is_rgb ? encodings::RGBA8 : encodings::BGRA8);
    default:
      return "";
  }
}

}  // namespace

sensor_msgs::ImagePtr decompress(const sensor_msgs::CompressedImage& message) {
  const cv::Mat image = decode(message.data);
  const std::string encoding = image.empty() ? "" : encodingOf(image, message.format);
  if (encoding.empty()) return cv_bridge::CvImage(message.header, encodings::MONO8, cv::Mat()).toImageMsg();
  return cv_bridge::CvImage(message.header, encoding, image).toImageMsg();
}

}  // namespace flight_corridor::tools
