#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/interop/ros/RosWire.h"

namespace perception::ros {

struct MessagePart;

/// A member of a message, as its definition says.
struct MessageField {
  enum class Kind : std::uint8_t {
    kBool,
    kI8,
    kU8,
    kI16,
    kU16,
    kI32,
    kU32,
    kI64,
    kU64,
    kF32,
    kF64,
    kText,
    kTime,
    kPart
  };
  enum class List : std::uint8_t { kOne, kFixed, kSequence };
  std::string name;
  Kind kind = Kind::kF64;
  List list = List::kOne;
  std::size_t count = 1;              ///< of a fixed list
  const MessagePart* part = nullptr;  ///< of kPart
  bool isNumber() const { return kind < Kind::kText && list == List::kOne; }
};

/// A message, or a message inside another one.
struct MessagePart {
  std::string name;  ///< "std_msgs/Header"; empty: the message itself
  std::vector<MessageField> fields;
  /// Null: there is none.
  const MessageField* find(std::string_view name) const;
};

/// A message's definition: ROS's text of it (.msg) with that of its parts, as it travels with
/// recordings. Parts that the text lacks are those of RosSchemas.h.
class Definition {
 public:
  /// Throws std::runtime_error: a line that is no member, a type that nothing defines.
  explicit Definition(const std::string& text);
  Definition(const Definition&) = delete;
  Definition& operator=(const Definition&) = delete;
  const MessagePart& message() const { return *message_; }

 private:
  const MessagePart* partOf(const std::string& type, const std::string& package, int depth);
  void addFields(const std::string& text, const std::string& package, int depth, MessagePart& to);
  MessageField fieldOf(const std::string& type, const std::string& name, const std::string& package,
                       int depth);

  std::map<std::string, std::string> texts_;  ///< of the parts that travel, by name
  std::map<std::string, std::unique_ptr<MessagePart>> parts_;
  std::unique_ptr<MessagePart> message_;
};

/// A member's value. Texts and bytes stay in the message: valid as long as it.
struct RosValue {
  const MessagePart* part = nullptr;  ///< of a message; else null
  std::vector<RosValue> items;        ///< a message's members, or a list's elements
  std::vector<double> numbers;        ///< one, or those of a list
  std::string_view bytes;             ///< a text, or a list of bytes

  /// A member, "pose.position.x" of the members' members; null: there is none.
  const RosValue* find(std::string_view path) const;
  /// NaN: there is none.
  double number(std::string_view path) const;
  /// Empty: there is none. A number as its digits.
  std::string text(std::string_view path) const;
};

/// Decodes a message by its definition. Throws std::runtime_error: it ends before its members do,
/// or holds more than they.
RosValue decoded(std::string_view bytes, Encoding encoding, const Definition& definition);

}  // namespace perception::ros
