#pragma once
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>

namespace perception {

/// Bytes of a recording in sequence: a file, or a block in memory. Little endian.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// The next bytes, valid until the next take(). Throws std::runtime_error with the position, the
  /// size and `what` was expected, if fewer are left.
  std::string_view take(std::uint64_t size, const char* what);
  void skip(std::uint64_t size, const char* what);
  template <class Number>
  Number number(const char* what) {
    Number value;
    std::memcpy(&value, take(sizeof(Number), what).data(), sizeof(Number));
    return value;
  }
  /// u32 length and that many bytes.
  std::string text(const char* what) {
    return std::string(take(number<std::uint32_t>(what), what));
  }
  std::uint64_t position() const { return position_; }
  std::uint64_t left() const { return size_ - position_; }
  std::uint64_t size() const { return size_; }

 protected:
  virtual std::string_view bytesAt(std::uint64_t position, std::uint64_t size) = 0;
  void check(std::uint64_t size, const char* what) const;
  std::uint64_t position_ = 0, size_ = 0;
};

/// Throws DataError: missing (kNoInput), empty, no regular file.
std::unique_ptr<ByteSource> fileSource(const std::string& path);
std::unique_ptr<ByteSource> memorySource(std::string bytes);

}  // namespace perception
