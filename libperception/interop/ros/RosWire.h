#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "libperception/core/Time.h"

namespace perception::ros {

// The two encodings of ROS messages. A message lists its members once, in members(), or where the
// encodings differ in fields(wire, message) of RosMessages.h; reader and writer of both encodings
// take them from there. Little endian.

/// ROS 1: packed.
struct Ros1Format {
  static constexpr bool kAligned = false;      ///< a number begins at a multiple of its size
  static constexpr bool kHead = false;         ///< four bytes before the message
  static constexpr bool kStringZero = false;   ///< strings count and hold a final 0
  static constexpr bool kHeaderNumber = true;  ///< std_msgs/Header begins with a number
};

/// ROS 2: CDR, version 1 (XCDR1) of the OMG's DDS-XTypes 1.3, 7.4.
struct CdrFormat {
  static constexpr bool kAligned = true;
  static constexpr bool kHead = true;
  static constexpr bool kStringZero = true;
  static constexpr bool kHeaderNumber = false;
};

/// uint8[N]: bytes without a count. They stay where they are: valid as long as the message.
template <std::size_t N>
struct FixedBytes {
  std::string_view bytes;
};

template <class Wire, class Message>
auto fields(Wire& w, Message& m) -> decltype(m.members(), void()) {
  std::apply([&](auto&... member) { (w(member), ...); }, m.members());
}

/// Reads a message; throws std::runtime_error with the byte of the message and what was expected.
template <class Format>
class WireReader {
 public:
  static constexpr bool kReads = true;
  using Wire = Format;

  explicit WireReader(std::string_view bytes) : bytes_(bytes) {
    if constexpr (Format::kHead) {
      // Representation CDR_LE; of the big-endian one no recording is known.
      if (bytes.size() < 4 || bytes[0] != 0 || bytes[1] != 1)
        fail("expected the head 00 01 00 00 of little-endian CDR");
      base_ = position_ = 4;
    }
  }

  template <class Number>
  std::enable_if_t<std::is_arithmetic_v<Number>> operator()(Number& value) {
    align(sizeof(Number));
    std::memcpy(&value, take(sizeof(Number), "a number").data(), sizeof(Number));
  }
  void operator()(std::string& text) {
    std::uint32_t size = 0;
    (*this)(size);
    text = take(size, "a text");
    if (Format::kStringZero && !text.empty() && text.back() == '\0') text.pop_back();
  }
  void operator()(Stamp& stamp) {
    std::int32_t seconds = 0;
    std::uint32_t nanoseconds = 0;
    (*this)(seconds);
    (*this)(nanoseconds);
    if (nanoseconds >= 1'000'000'000) fail("a stamp with a second or more of nanoseconds");
    // ROS 1 counts without sign: to the year 2106.
    const std::int64_t whole =
        Format::kHeaderNumber ? static_cast<std::uint32_t>(seconds) : seconds;
    stamp.ns = whole * 1'000'000'000 + nanoseconds;
  }
  /// Bytes stay where they are: valid as long as the message.
  void operator()(std::string_view& bytes) {
    std::uint32_t size = 0;
    (*this)(size);
    bytes = take(size, "bytes");
  }
  template <std::size_t N>
  void operator()(FixedBytes<N>& fixed) {
    fixed.bytes = take(N, "bytes");
  }
  template <class Number, std::size_t N>
  std::enable_if_t<std::is_arithmetic_v<Number>> operator()(std::array<Number, N>& values) {
    for (Number& value : values) (*this)(value);
  }
  template <class Element>
  void operator()(std::vector<Element>& list) {
    const std::size_t elements = count();
    list.clear();
    for (std::size_t i = 0; i < elements; ++i) (*this)(list.emplace_back());
  }
  template <class Message>
  std::enable_if_t<std::is_class_v<Message>> operator()(Message& message) {
    fields(*this, message);
  }

  // For messages whose members are known by their definition alone.
  std::size_t left() const { return bytes_.size() - std::min(position_, bytes_.size()); }
  std::string_view bytes(std::size_t count) { return take(count, "bytes"); }
  std::string_view text() {
    std::string_view text;
    (*this)(text);
    if (Format::kStringZero && !text.empty() && text.back() == '\0') text.remove_suffix(1);
    return text;
  }
  /// Of a list's elements. Memory grows as they arrive; each has a byte or more.
  std::size_t count() {
    std::uint32_t count = 0;
    (*this)(count);
    if (count > bytes_.size()) fail("a list of " + std::to_string(count) + " elements");
    return count;
  }

 private:
  void align(std::size_t size) {
    if (Format::kAligned) position_ += (size - (position_ - base_) % size) % size;
  }
  std::string_view take(std::size_t size, const char* what) {
    if (position_ > bytes_.size() || size > bytes_.size() - position_)
      fail(std::string("expected ") + what + " of " + std::to_string(size) + " bytes");
    const std::string_view part = bytes_.substr(position_, size);
    position_ += size;
    return part;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("byte " + std::to_string(position_) + " of " +
                             std::to_string(bytes_.size()) + " of the message: " + what);
  }

  std::string_view bytes_;
  std::size_t position_ = 0, base_ = 0;
};

/// Writes a message into bytes().
template <class Format>
class WireWriter {
 public:
  static constexpr bool kReads = false;
  using Wire = Format;

  WireWriter() {
    if (Format::kHead) bytes_.assign("\0\1\0\0", 4);
    base_ = bytes_.size();
  }
  std::string bytes() && { return std::move(bytes_); }

  template <class Number>
  std::enable_if_t<std::is_arithmetic_v<Number>> operator()(const Number& value) {
    if (Format::kAligned)
      bytes_.append((sizeof(Number) - (bytes_.size() - base_) % sizeof(Number)) % sizeof(Number),
                    '\0');
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Number));
  }
  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint32_t>(text.size() + (Format::kStringZero ? 1 : 0)));
    bytes_ += text;
    if (Format::kStringZero) bytes_ += '\0';
  }
  void operator()(const Stamp& stamp) {
    (*this)(static_cast<std::uint32_t>(stamp.ns / 1'000'000'000));
    (*this)(static_cast<std::uint32_t>(stamp.ns % 1'000'000'000));
  }
  void operator()(const std::string_view& bytes) {
    (*this)(static_cast<std::uint32_t>(bytes.size()));
    bytes_ += bytes;
  }
  template <std::size_t N>
  void operator()(const FixedBytes<N>& fixed) {
    bytes_ += fixed.bytes.substr(0, N);
    bytes_.append(N - std::min(N, fixed.bytes.size()), '\0');
  }
  template <class Number, std::size_t N>
  std::enable_if_t<std::is_arithmetic_v<Number>> operator()(const std::array<Number, N>& values) {
    for (const Number& value : values) (*this)(value);
  }
  template <class Element>
  void operator()(const std::vector<Element>& list) {
    (*this)(static_cast<std::uint32_t>(list.size()));
    for (const Element& element : list) (*this)(element);
  }
  template <class Message>
  std::enable_if_t<std::is_class_v<Message>> operator()(const Message& message) {
    fields(*this, const_cast<Message&>(message));  // a writer changes nothing
  }

 private:
  std::string bytes_;
  std::size_t base_ = 0;
};

enum class Encoding : std::uint8_t { kRos1, kCdr };

/// Throws std::runtime_error, see WireReader.
template <class Message>
Message decoded(std::string_view bytes, Encoding encoding) {
  Message message;
  if (encoding == Encoding::kCdr) {
    WireReader<CdrFormat> reader(bytes);
    reader(message);
  } else {
    WireReader<Ros1Format> reader(bytes);
    reader(message);
  }
  return message;
}

template <class Message>
std::string encoded(const Message& message, Encoding encoding) {
  if (encoding == Encoding::kCdr) {
    WireWriter<CdrFormat> writer;
    writer(message);
    return std::move(writer).bytes();
  }
  WireWriter<Ros1Format> writer;
  writer(message);
  return std::move(writer).bytes();
}

}  // namespace perception::ros
