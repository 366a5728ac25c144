#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>

#include "support/temporary_folder.hpp"

namespace flight_corridor::fuzz {

/// Ends the run with the law that is broken.
[[noreturn]] inline void fail(const std::string& law) {
  std::fprintf(stderr, "BROKEN LAW: %s\n", law.c_str());
  std::abort();
}

/// Of this process; in TMPDIR, which scripts/fuzz sets to memory.
inline const test_support::TemporaryFolder& scratchFolder() {
  static const test_support::TemporaryFolder folder;
  return folder;
}

/// Writes a file anew.  @return its path.
inline std::string scratchFile(const std::string& name, const std::string& content) {
  const std::string path = scratchFolder().path(name);
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << content;
  if (!file.flush()) std::exit(2);  // no room: no finding
  return path;
}

}  // namespace flight_corridor::fuzz
