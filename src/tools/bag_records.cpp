#include "tools/bag_records.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <stdexcept>
#include <vector>

namespace flight_corridor::tools {
namespace {

using Position = std::uint64_t;

constexpr Position kFirstRecord = 13;    // behind "#ROSBAG V2.0\n"
constexpr std::size_t kIndexEntry = 12;  // seconds, nanoseconds, offset
constexpr char kMessage = 0x02, kIndex = 0x04, kChunk = 0x05, kConnection = 0x07;

[[noreturn]] void fail(const std::string& what, Position at) {
  throw std::runtime_error(what + " at byte " + std::to_string(at));
}

std::uint32_t number(const char* bytes) {
  std::uint32_t number;
  std::memcpy(&number, bytes, sizeof(number));
  return number;
}

/// Length of header, "length name=value" for each field, length of data, data.
struct Record {
  Position data = 0, end = 0;
  std::map<std::string, std::string> fields;

  char op() const {
    const auto op = fields.find("op");
    return op != fields.end() && op->second.size() == 1 ? op->second[0] : '\0';
  }
};

class BagRecords {
 public:
  explicit BagRecords(const std::string& path) : file_(path, std::ios::binary | std::ios::ate) {
    end_ = static_cast<Position>(file_.tellg());
  }

  void requireSound() {
    for (Position at = kFirstRecord; at < end_;) {
      const Record record = read(at, end_);
      if (record.op() == kChunk) readChunk(record);
      if (record.op() == kIndex) checkIndex(record);
      at = record.end;
    }
  }

 private:
  std::string bytes(Position at, Position count, Position limit) {
    if (at > limit || count > limit - at) fail("a record announces more bytes than there are,", at);
    std::string bytes(count, '\0');
    if (at != at_) file_.seekg(static_cast<std::streamoff>(at));  // seeking empties its buffer
    file_.read(bytes.data(), static_cast<std::streamsize>(count));
    at_ = at + count;
    return bytes;
  }

  Position length(Position at, Position limit) { return number(bytes(at, 4, limit).data()); }

  /// Of a record's header, or of a connection's data, at a position.
  static std::map<std::string, std::string> fieldsOf(const std::string& header, Position at) {
    std::map<std::string, std::string> fields;
    for (std::size_t field = 0; field < header.size();) {
      if (header.size() - field < 4) fail("a record's header is cut off", at);
      const std::size_t begin = field + 4, size = number(&header[field]);
      if (size > header.size() - begin) fail("a record's header is cut off", at);
      const std::string text = header.substr(begin, size);
      const std::size_t equals = std::min(text.find('='), text.size() - 1);
      if (size > 0) fields[text.substr(0, equals)] = text.substr(equals + 1);
      field = begin + size;
    }
    return fields;
  }

  /// @param limit where what holds the record ends.
  Record read(Position at, Position limit) {
    Record record;
    const Position header = at + 4, header_size = length(at, limit), data_size_at = header + header_size;
    record.fields = fieldsOf(bytes(header, header_size, limit), at);
    record.data = data_size_at + 4;
    const Position data_size = length(data_size_at, limit);
    if (data_size > limit - record.data) fail("a record announces more bytes than there are,", at);
    record.end = record.data + data_size;
    if (record.op() == kConnection) fieldsOf(bytes(record.data, data_size, limit), at);
    return record;
  }

  void readChunk(const Record& chunk) {
    leading_.clear();
    is_open_ = chunk.fields.count("compression") != 0 && chunk.fields.at("compression") == "none";
    std::size_t until_last_message = 0;
    for (Position at = chunk.data; is_open_ && at < chunk.end;) {
      const Record record = read(at, chunk.end);
      leading_.push_back(at - chunk.data);
      if (record.op() == kMessage) until_last_message = leading_.size();
      at = record.end;
    }
    leading_.resize(until_last_message);
  }

  /// Each entry leads to a record of the chunk before, from which rosbag looks for the next message.
  void checkIndex(const Record& index) {
    const std::string entries = bytes(index.data, index.end - index.data, end_);
    for (std::size_t entry = 0; is_open_ && entry + kIndexEntry <= entries.size(); entry += kIndexEntry) {
      if (!std::binary_search(leading_.begin(), leading_.end(), Position{number(&entries[entry + 8])})) {
        fail("the index leads to no message", index.data + entry);
      }
    }
  }

  std::ifstream file_;
  Position end_ = 0, at_ = ~Position{0};
  std::vector<Position> leading_;  // offsets of the last chunk's records that lead to a message, its own or the next
  bool is_open_ = false;           // whether it is not compressed
};

}  // namespace

void requireSoundRecords(const std::string& path) { BagRecords(path).requireSound(); }

}  // namespace flight_corridor::tools
