#include "libperception/interop/bags/RecordBag.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cstring>
#include <stdexcept>

#include "libperception/core/Error.h"
#include "libperception/interop/bags/Compression.h"
#include "libperception/interop/bags/McapFormat.h"

namespace perception {
namespace {

using ros::Encoding;

/// MCAP, https://mcap.dev/spec.
class McapBag final : public RecordBag {
 public:
  McapBag(const std::string& path, std::unique_ptr<ByteSource> file)
      : RecordBag(path, std::move(file)) {}

 private:
  Record read(ByteSource& source, BagMessage& message) override;
  std::string faultOfEnd(bool ended) const override {
    return ended ? "" : "the recording was not closed or is cut: there is no end of data";
  }
  void readChannel(ByteSource& content);

  struct Schema {
    std::string name, text;
  };
  std::map<std::uint16_t, Schema> schemas_;
};

RecordBag::Record McapBag::read(ByteSource& source, BagMessage& message) {
  const auto op = source.number<std::uint8_t>("a record");
  const auto size = source.number<std::uint64_t>("the length of a record");
  if (op == mcap::kDataEnd) return Record::kEnd;
  if (op == mcap::kMessage) {
    constexpr std::uint64_t kHead = 2 + 4 + 8 + 8;
    if (size < kHead) throw std::runtime_error(fmt::format("a message of {} bytes", size));
    message.topic = knownTopic(source.number<std::uint16_t>("a message"));
    source.skip(4, "a message");
    message.stamp.ns = static_cast<std::int64_t>(source.number<std::uint64_t>("a message"));
    source.skip(8, "a message");
    message.bytes = source.take(size - kHead, "a message");
    return Record::kMessage;
  }
  if (op == mcap::kChunk) {
    const auto content = memorySource(std::string(source.take(size, "a chunk")));
    content->skip(16, "a chunk");
    chunk_.size = content->number<std::uint64_t>("a chunk");
    chunk_.crc = content->number<std::uint32_t>("a chunk");
    chunk_.compression = content->text("a chunk's compression");
    chunk_.bytes = content->take(content->number<std::uint64_t>("a chunk"), "a chunk's records");
    return Record::kChunk;
  }
  if (op == mcap::kSchema || op == mcap::kChannel) {
    const auto content = memorySource(std::string(source.take(size, "a schema or channel")));
    if (op == mcap::kChannel) {
      readChannel(*content);
    } else {
      const auto id = content->number<std::uint16_t>("a schema");
      Schema& schema = schemas_[id];
      schema.name = content->text("a schema's name");
      const std::string kind = content->text("a schema's encoding");
      const std::string text = content->text("a schema");
      schema.text = kind == "ros1msg" || kind == "ros2msg" ? text : "";
    }
    return Record::kOther;
  }
  source.skip(size, "a record");
  return Record::kOther;
}

void McapBag::readChannel(ByteSource& content) {
  const auto id = content.number<std::uint16_t>("a channel");
  const auto schema = content.number<std::uint16_t>("a channel");
  BagTopic& channel = topic(id);
  channel.name = content.text("a channel's topic");
  const std::string encoding = content.text("a channel's encoding");
  channel.type = shortType(schemas_[schema].name);
  channel.definition = schemas_[schema].text;
  channel.encoding = encoding == "cdr" ? Encoding::kCdr : Encoding::kRos1;
  channel.unknown_encoding = encoding == "cdr" || encoding == "ros1" ? "" : encoding;
}

/// ROS 1, http://wiki.ros.org/Bags/Format/2.0.
class Ros1Bag final : public RecordBag {
 public:
  Ros1Bag(const std::string& path, std::unique_ptr<ByteSource> file)
      : RecordBag(path, std::move(file)) {}

 private:
  using Fields = std::map<std::string, std::string>;
  enum Op : std::uint8_t { kMessage = 2, kBagHeader = 3, kChunk = 5, kConnection = 7 };

  static Fields fieldsOf(const std::string& header);
  template <class Number>
  static Number numberOf(const Fields& fields, const char* name);

  Record read(ByteSource& source, BagMessage& message) override;
  std::string faultOfEnd(bool) const override {
    return index_at_ == 0 ? "the recording was not closed: there is no index" : "";
  }

  std::uint64_t index_at_ = 0;
};

Ros1Bag::Fields Ros1Bag::fieldsOf(const std::string& header) {
  Fields fields;
  const auto source = memorySource(header);
  while (source->left() > 0) {
    const std::string field = source->text("a field of a header");
    const auto equals = field.find('=');
    if (equals == std::string::npos) throw std::runtime_error("a header's field without '='");
    fields[field.substr(0, equals)] = field.substr(equals + 1);
  }
  return fields;
}

template <class Number>
Number Ros1Bag::numberOf(const Fields& fields, const char* name) {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() != sizeof(Number))
    throw std::runtime_error(
        fmt::format("a header without the field {} of {} bytes", name, sizeof(Number)));
  Number value;
  std::memcpy(&value, found->second.data(), sizeof(Number));
  return value;
}

RecordBag::Record Ros1Bag::read(ByteSource& source, BagMessage& message) {
  const Fields header = fieldsOf(source.text("the header of a record"));
  const auto op = numberOf<std::uint8_t>(header, "op");
  const auto size = source.number<std::uint32_t>("the length of a record");
  if (op == kMessage) {
    message.topic = knownTopic(numberOf<std::uint32_t>(header, "conn"));
    const auto time = numberOf<std::uint64_t>(header, "time");
    message.stamp.ns =
        static_cast<std::int64_t>((time & 0xffffffffU) * 1'000'000'000 + (time >> 32));
    message.bytes = source.take(size, "a message");
    return Record::kMessage;
  }
  if (op == kChunk) {
    chunk_.size = numberOf<std::uint32_t>(header, "size");
    chunk_.crc = 0;
    chunk_.compression = header.count("compression") != 0 ? header.at("compression") : "";
    chunk_.bytes = source.take(size, "a chunk");
    return Record::kChunk;
  }
  if (op == kBagHeader) {
    index_at_ = numberOf<std::uint64_t>(header, "index_pos");
    if (header.count("encryptor") != 0 && !header.at("encryptor").empty())
      throw std::runtime_error("the recording is encrypted by " + header.at("encryptor"));
  }
  if (op != kConnection) {
    source.skip(size, "a record");
    return Record::kOther;
  }
  BagTopic& connection = topic(numberOf<std::uint32_t>(header, "conn"));
  const Fields data = fieldsOf(std::string(source.take(size, "a connection")));
  if (data.count("type") == 0) throw std::runtime_error("a connection without the field type");
  connection.type = data.at("type");
  if (data.count("message_definition") != 0) connection.definition = data.at("message_definition");
  connection.name = header.count("topic") != 0 ? header.at("topic") : "";
  return Record::kOther;
}

}  // namespace

const BagTopic* RecordBag::knownTopic(std::uint32_t id) const {
  const auto found = topics_.find(id);
  if (found == topics_.end())
    throw std::runtime_error(fmt::format("a message of channel {}, which is not declared", id));
  return &found->second;
}

/// The chunk that was read becomes the block whose records are next.
void RecordBag::open() {
  std::string bytes = inflated(chunk_.compression, chunk_.bytes, chunk_.size);
  const auto crc = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
  if (chunk_.crc != 0 && chunk_.crc != crc) throw std::runtime_error("its checksum is wrong");
  block_ = memorySource(std::move(bytes));
}

void RecordBag::finish(bool ended) {
  done_ = true;
  if (const std::string fault = faultOfEnd(ended); !fault.empty())
    faults_.push_back(fmt::format("{}: {}", path_, fault));
}

bool RecordBag::nextStored(BagMessage& message) {
  while (!done_) {
    if (block_ && block_->left() == 0) block_.reset();
    if (!block_ && file_->left() == 0) {
      finish(false);
      break;
    }
    if (!block_) block_offset_ = file_->position();
    message.offset = block_offset_;
    try {
      const Record record = read(block_ ? *block_ : *file_, message);
      if (record == Record::kMessage) return true;
      if (record == Record::kEnd && !block_) finish(true);
      if (record != Record::kChunk) continue;
      if (block_) throw std::runtime_error("a chunk inside a chunk");
    } catch (const std::runtime_error& e) {
      if (dynamic_cast<const Error*>(&e) != nullptr) throw;
      faults_.push_back(block_ ? fmt::format("{}: chunk at byte {}, in it {}: its rest is left out",
                                             path_, block_offset_, e.what())
                               : fmt::format("{}: record at byte {}: {}: all behind it is left out",
                                             path_, block_offset_, e.what()));
      if (!block_) done_ = true;
      block_.reset();
      continue;
    }
    try {
      open();
    } catch (const std::runtime_error& e) {
      faults_.push_back(
          fmt::format("{}: chunk at byte {}: {}: left out", path_, block_offset_, e.what()));
    }
  }
  return false;
}

std::unique_ptr<ReadingBag> mcapBag(const std::string& path, std::unique_ptr<ByteSource> file) {
  return std::make_unique<McapBag>(path, std::move(file));
}

std::unique_ptr<ReadingBag> ros1Bag(const std::string& path, std::unique_ptr<ByteSource> file) {
  return std::make_unique<Ros1Bag>(path, std::move(file));
}

}  // namespace perception
