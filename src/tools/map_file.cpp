#include "tools/map_file.hpp"

#include <CLI/Error.hpp>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace flight_corridor::tools {

void writeMap(const std::string& path, const octomap::OcTree& tree) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".ot" && extension != ".bt") {
    throw CLI::ValidationError(path + ": a map ends in .ot (log-odds) or .bt (free, occupied and unknown)");
  }
  std::ofstream file(path, std::ios::binary);
  const bool written = file && (extension == ".ot" ? tree.write(file) : tree.writeBinaryConst(file));
  if (!written || !file.flush()) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace flight_corridor::tools
