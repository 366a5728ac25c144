#pragma once

#include <rosbag/bag.h>

#include <stdexcept>
#include <string>

namespace flight_corridor::tools {

/// A bag that is there once it is finished: until then it is called PATH.unfinished (PATH.active is a recorder's), and
/// an existing file at PATH is kept. An unfinished bag leaves no file.
class NewBag {
 public:
  /// @throws std::runtime_error naming the file when it cannot be written, as the others.
  explicit NewBag(const std::string& path);
  ~NewBag();
  NewBag(const NewBag&) = delete;
  NewBag& operator=(const NewBag&) = delete;

  template <typename Message>
  void write(const std::string& topic, const ros::Time& recorded, const Message& message,
             const boost::shared_ptr<ros::M_string>& connection = nullptr) {
    attempt([&] { bag_.write(topic, recorded, message, connection); });
  }
  void finish();

 private:
  /// Names the file that rosbag's errors do not name.
  template <typename Work>
  void attempt(const Work& work) const try {
    work();
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(path_ + ": cannot be written: " + error.what());
  }

  std::string path_, unfinished_path_;
  rosbag::Bag bag_;
};

}  // namespace flight_corridor::tools
