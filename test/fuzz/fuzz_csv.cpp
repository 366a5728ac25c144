// Tables of results and of truth: rows, or std::runtime_error; what was read can be written and read again.

#include <stdexcept>

#include "scratch.hpp"
#include "tools/csv.hpp"

namespace flight_corridor::tools {
namespace {

template <typename Row>
void readAgain(const std::string& path, std::vector<Row> (*read)(const std::string&),
               void (*write)(const std::string&, const std::vector<Row>&)) {
  std::vector<Row> rows;
  try {
    rows = read(path);
  } catch (const std::runtime_error&) {
    return;
  }
  const std::string copy = fuzz::scratchFolder().path("copy.csv");
  write(copy, rows);
  if (read(copy).size() != rows.size()) fuzz::fail("what is written is read again");
}

}  // namespace
}  // namespace flight_corridor::tools

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace flight_corridor;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::string path = fuzz::scratchFile("table.csv", text);
  tools::readAgain(path, tools::readResults, tools::writeResults);
  tools::readAgain(path, tools::readTruth, tools::writeTruth);
  try {
    if (tools::parseStamp(tools::formatStamp(tools::parseStamp(text))) != tools::parseStamp(text)) {
      fuzz::fail("a stamp is kept");
    }
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
