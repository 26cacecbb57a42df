#include "libperception/interop/ros/RosDefinition.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "libperception/interop/ros/RosSchemas.h"

namespace perception::ros {
namespace {

using Kind = MessageField::Kind;
using List = MessageField::List;

constexpr int kDeepest = 16;                      // messages in messages
constexpr std::size_t kLongestFixed = 1U << 20U;  // elements
constexpr std::size_t kMostPadding = 4;           // [bytes] behind a message of CDR

constexpr std::array<std::pair<const char*, Kind>, 16> kKinds = {{{"bool", Kind::kBool},
                                                                  {"byte", Kind::kU8},
                                                                  {"char", Kind::kU8},
                                                                  {"int8", Kind::kI8},
                                                                  {"uint8", Kind::kU8},
                                                                  {"int16", Kind::kI16},
                                                                  {"uint16", Kind::kU16},
                                                                  {"int32", Kind::kI32},
                                                                  {"uint32", Kind::kU32},
                                                                  {"int64", Kind::kI64},
                                                                  {"uint64", Kind::kU64},
                                                                  {"float32", Kind::kF32},
                                                                  {"float64", Kind::kF64},
                                                                  {"string", Kind::kText},
                                                                  {"time", Kind::kTime},
                                                                  {"duration", Kind::kTime}}};

/// "geometry_msgs/Point" of "geometry_msgs/msg/Point".
std::string shortName(std::string type) {
  if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
  return type;
}

/// Reads values by their definition.
template <class Format>
class ValueReader {
 public:
  explicit ValueReader(std::string_view bytes) : wire_(bytes) {}

  void read(const MessagePart& part, RosValue& value) {
    value.part = &part;
    // In ROS 1 it begins with a number, which the texts of ROS 2 lack.
    if (Format::kHeaderNumber && part.name == "std_msgs/Header" && part.find("seq") == nullptr)
      number<std::uint32_t>();
    // CDR has a byte where there is nothing.
    if (Format::kAligned && part.fields.empty()) number<std::uint8_t>();
    value.items.reserve(part.fields.size());
    for (const MessageField& field : part.fields) read(field, value.items.emplace_back());
  }
  std::size_t left() const { return wire_.left(); }

 private:
  template <class Number>
  double number() {
    Number value{};
    wire_(value);
    return static_cast<double>(value);
  }
  double numberOf(Kind kind) {
    switch (kind) {
      case Kind::kBool:
      case Kind::kU8:
        return number<std::uint8_t>();
      case Kind::kI8:
        return number<std::int8_t>();
      case Kind::kI16:
        return number<std::int16_t>();
      case Kind::kU16:
        return number<std::uint16_t>();
      case Kind::kI32:
        return number<std::int32_t>();
      case Kind::kU32:
        return number<std::uint32_t>();
      case Kind::kI64:
        return number<std::int64_t>();
      case Kind::kU64:
        return number<std::uint64_t>();
      case Kind::kF32:
        return number<float>();
      default:
        return number<double>();
    }
  }
  void one(const MessageField& field, RosValue& value) {
    if (field.kind == Kind::kPart) {
      read(*field.part, value);
    } else if (field.kind == Kind::kText) {
      value.bytes = wire_.text();
    } else if (field.kind == Kind::kTime) {
      for (int i = 0; i < 2; ++i) value.numbers.push_back(number<std::uint32_t>());
    } else {
      value.numbers.push_back(numberOf(field.kind));
    }
  }
  void read(const MessageField& field, RosValue& value) {
    if (field.list == List::kOne) return one(field, value);
    const bool fixed = field.list == List::kFixed;
    const std::size_t count = fixed ? field.count : wire_.count();
    if (field.kind == Kind::kU8 || field.kind == Kind::kI8 || field.kind == Kind::kBool) {
      value.bytes = wire_.bytes(count);
      return;
    }
    const bool numbers = field.kind < Kind::kText;
    for (std::size_t i = 0; i < count; ++i) {
      if (numbers) {
        value.numbers.push_back(numberOf(field.kind));
      } else {
        one(field, value.items.emplace_back());
      }
    }
  }

  WireReader<Format> wire_;
};

template <class Format>
RosValue valueIn(std::string_view bytes, const Definition& definition) {
  ValueReader<Format> reader(bytes);
  RosValue value;
  reader.read(definition.message(), value);
  if (reader.left() >= (Format::kAligned ? kMostPadding : 1))
    throw std::runtime_error(
        fmt::format("{} of {} bytes are left behind the members of its definition", reader.left(),
                    bytes.size()));
  return value;
}

}  // namespace

const MessageField* MessagePart::find(std::string_view wanted) const {
  for (const MessageField& field : fields) {
    if (field.name == wanted) return &field;
  }
  return nullptr;
}

Definition::Definition(const std::string& text) : message_(std::make_unique<MessagePart>()) {
  std::istringstream lines(text);
  std::string top;
  std::string* to = &top;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    constexpr std::string_view kPart = "MSG: ";
    if (line.compare(0, 3, "===") == 0) continue;
    if (line.compare(0, kPart.size(), kPart) == 0) {
      to = &texts_[shortName(line.substr(kPart.size()))];
      continue;
    }
    *to += line + "\n";
  }
  addFields(top, "", 0, *message_);
}

const MessagePart* Definition::partOf(const std::string& type, const std::string& package,
                                      int depth) {
  std::string name = shortName(type);
  if (name == "Header") name = "std_msgs/Header";
  if (name.find('/') == std::string::npos) {
    // Of the same package; the message's own is not said, then of any.
    for (const auto& row : texts_) {
      const auto slash = row.first.find('/');
      if (slash != std::string::npos && row.first.substr(slash + 1) == name &&
          (package.empty() || row.first.substr(0, slash) == package))
        name = row.first;
    }
  }
  if (const auto known = parts_.find(name); known != parts_.end()) return known->second.get();
  const auto travelled = texts_.find(name);
  const std::string text = travelled != texts_.end() ? travelled->second : membersOfType(name);
  if (text.empty() && travelled == texts_.end())
    throw std::runtime_error(fmt::format("its definition lacks that of {}", name));
  if (depth >= kDeepest)
    throw std::runtime_error("its definition has messages in messages too deep");
  auto part = std::make_unique<MessagePart>();
  part->name = name;
  addFields(text, name.substr(0, name.find('/')), depth + 1, *part);
  return (parts_[name] = std::move(part)).get();
}

MessageField Definition::fieldOf(const std::string& type, const std::string& name,
                                 const std::string& package, int depth) {
  MessageField field;
  field.name = name;
  const std::size_t bracket = type.find('[');
  if (bracket != std::string::npos) {
    const std::string inside = type.substr(bracket + 1, type.find(']', bracket) - bracket - 1);
    const bool fixed = !inside.empty() && std::isdigit(static_cast<unsigned char>(inside[0])) != 0;
    field.list = fixed ? List::kFixed : List::kSequence;
    field.count = fixed && inside.size() < 8 ? std::stoul(inside) : 0;
    if (fixed && (field.count == 0 || field.count > kLongestFixed))
      throw std::runtime_error(fmt::format("its definition has a list {} {}", type, name));
  }
  // "string<=10" is a string.
  const std::string base = type.substr(0, std::min(bracket, type.find('<')));
  for (const auto& [word, kind] : kKinds) {
    if (base == word) {
      field.kind = kind;
      return field;
    }
  }
  field.kind = Kind::kPart;
  field.part = partOf(base, package, depth);
  return field;
}

void Definition::addFields(const std::string& text, const std::string& package, int depth,
                           MessagePart& to) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string type, name, next;
    if (!(words >> type)) continue;
    if (!(words >> name))
      throw std::runtime_error(
          fmt::format("its definition has the line '{}'", line.substr(0, 100)));
    const bool constant = name.find('=') != std::string::npos || (words >> next && next[0] == '=');
    if (constant) continue;
    // Paths are made of names.
    if (!std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; }))
      throw std::runtime_error(
          fmt::format("its definition has a member '{}'", name.substr(0, 100)));
    to.fields.push_back(fieldOf(type, name, package, depth));
  }
}

const RosValue* RosValue::find(std::string_view path) const {
  const RosValue* at = this;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    if (at->part == nullptr) return nullptr;
    const MessageField* const field = at->part->find(path.substr(0, dot));
    if (field == nullptr) return nullptr;
    at = &at->items[static_cast<std::size_t>(field - at->part->fields.data())];
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return at;
}

double RosValue::number(std::string_view path) const {
  const RosValue* const value = find(path);
  return value == nullptr || value->numbers.empty() ? std::numeric_limits<double>::quiet_NaN()
                                                    : value->numbers.front();
}

std::string RosValue::text(std::string_view path) const {
  const RosValue* const value = find(path);
  if (value == nullptr) return "";
  return value->numbers.empty() ? std::string(value->bytes)
                                : fmt::format("{}", value->numbers.front());
}

RosValue decoded(std::string_view bytes, Encoding encoding, const Definition& definition) {
  return encoding == Encoding::kCdr ? valueIn<CdrFormat>(bytes, definition)
                                    : valueIn<Ros1Format>(bytes, definition);
}

}  // namespace perception::ros
