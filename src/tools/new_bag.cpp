#include "tools/new_bag.hpp"

#include <filesystem>
#include <system_error>

namespace flight_corridor::tools {

namespace fs = std::filesystem;

NewBag::NewBag(const std::string& path) : path_(path), unfinished_path_(path + ".unfinished") {
  if (fs::exists(path) && !fs::is_regular_file(path)) {
    throw std::runtime_error(path + ": cannot be written: is not a regular file");
  }
  attempt([&] { bag_.open(unfinished_path_, rosbag::bagmode::Write); });
}

NewBag::~NewBag() {
  if (!bag_.isOpen()) return;
  std::error_code nobody_to_tell;
  fs::resize_file(unfinished_path_, 0, nobody_to_tell);  // room on a full disk: ~Bag writes, and aborts where it cannot
  fs::remove(unfinished_path_, nobody_to_tell);
}

void NewBag::finish() {
  attempt([&] { bag_.close(); });
  fs::rename(unfinished_path_, path_);
}

}  // namespace flight_corridor::tools
