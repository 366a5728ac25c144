#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

namespace flight_corridor::tools {

/// The image in a CompressedImage, with its header: as it was compressed, nothing scaled or turned to grey. Its
/// encoding is the one that the format names ("bayer_rggb8; png compressed"), where what is decoded has it.
/// @return an empty image when the data is damaged, cut off, or holds no image of 8 or 16 bit.
sensor_msgs::ImagePtr decompress(const sensor_msgs::CompressedImage& message);

}  // namespace flight_corridor::tools
