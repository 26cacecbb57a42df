#include "libperception/detectors/OnnxFile.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>

#include "libperception/core/Error.h"

namespace perception {
namespace {

/// One field of a protocol buffers message: a number, or bytes.
struct Field {
  std::uint64_t number = 0, value = 0;
  std::string_view bytes;
};

/// The fields of a message, in order; ends at the first that makes no sense.
class Message {
 public:
  explicit Message(std::string_view bytes) : rest_(bytes) {}
  bool damaged() const { return damaged_; }

  std::optional<Field> next() {
    if (rest_.empty()) return std::nullopt;
    Field field;
    const auto key = varint();
    if (!key) return bad();
    field.number = *key >> 3;
    switch (*key & 7) {
      case 0: {
        const auto value = varint();
        if (!value) return bad();
        field.value = *value;
        return field;
      }
      case 1:
        return take(8) ? std::optional(field) : bad();
      case 5:
        return take(4) ? std::optional(field) : bad();
      case 2: {
        const auto size = varint();
        if (!size || *size > rest_.size()) return bad();
        field.bytes = rest_.substr(0, *size);
        rest_.remove_prefix(*size);
        return field;
      }
      default:
        return bad();
    }
  }

 private:
  std::optional<Field> bad() {
    damaged_ = true;
    rest_ = {};
    return std::nullopt;
  }
  bool take(std::size_t count) {
    if (rest_.size() < count) return false;
    rest_.remove_prefix(count);
    return true;
  }
  std::optional<std::uint64_t> varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
      const auto byte = static_cast<unsigned char>(rest_.front());
      rest_.remove_prefix(1);
      value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
      if ((byte & 0x80) == 0) return value;
    }
    return std::nullopt;
  }
  std::string_view rest_;
  bool damaged_ = false;
};

// The bytes of the first field with that number; empty where there is none.
std::string_view inside(std::string_view bytes, std::uint64_t number) {
  Message message(bytes);
  while (const auto field = message.next()) {
    if (field->number == number) return field->bytes;
  }
  return {};
}

// ValueInfoProto: type (2), tensor_type (1), shape (2), dim (1): dim_value (1) or dim_param (2).
std::vector<std::int64_t> dimensions(std::string_view value_info) {
  std::vector<std::int64_t> out;
  Message shape(inside(inside(inside(value_info, 2), 1), 2));
  while (const auto dim = shape.next()) {
    if (dim->number != 1) continue;
    std::int64_t size = -1;
    Message parts(dim->bytes);
    while (const auto part = parts.next()) {
      if (part->number == 1) size = static_cast<std::int64_t>(part->value);
    }
    out.push_back(size > 0 ? size : -1);
  }
  return out;
}

}  // namespace

OnnxFile readOnnxFile(const std::string& path) {
  if (!std::filesystem::exists(path))
    throw DataError(fmt::format("{}: no such file (a network)", path), ExitCode::kNoInput);
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  OnnxFile out;
  std::string_view graph;
  Message model(bytes);  // ModelProto: graph (7), opset_import (8) with version (2)
  while (const auto field = model.next()) {
    if (field->number == 7) graph = field->bytes;
    if (field->number != 8) continue;
    Message opset(field->bytes);
    while (const auto part = opset.next()) {
      if (part->number == 2) out.opset = static_cast<std::int64_t>(part->value);
    }
  }
  if (model.damaged() || graph.empty())
    throw DataError(fmt::format("{}: not a whole ONNX file", path));
  // GraphProto: initializer (5) with name (8), input (11) with name (1). Old exports list their
  // weights among the inputs.
  std::set<std::string_view> weights;
  Message first(graph);
  while (const auto field = first.next()) {
    if (field->number == 5) weights.insert(inside(field->bytes, 8));
  }
  Message second(graph);
  while (const auto field = second.next()) {
    if (field->number != 11 || weights.count(inside(field->bytes, 1)) > 0) continue;
    out.input = dimensions(field->bytes);
    break;
  }
  if (second.damaged() || out.input.empty())
    throw DataError(fmt::format("{}: an ONNX file without an input", path));
  return out;
}

}  // namespace perception
