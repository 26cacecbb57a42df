#include "libperception/interop/bags/McapWriter.h"

#include <zlib.h>

#include <algorithm>

#include "libperception/interop/bags/McapFormat.h"

namespace perception {
namespace {

constexpr std::size_t kChunkBytes = 4 << 20;

// Unsigned numbers, little endian whatever the processor.
template <typename T>
std::string number(T value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
  return bytes;
}

std::string sized(std::string_view text) {
  return number(static_cast<std::uint32_t>(text.size())).append(text);
}

std::string record(mcap::Op op, std::string_view content) {
  std::string bytes(1, static_cast<char>(op));
  return bytes.append(number(static_cast<std::uint64_t>(content.size()))).append(content);
}

std::uint32_t crcOf(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace

void McapWriter::Span::add(std::uint64_t t, bool first) {
  begin = first ? t : std::min(begin, t);
  end = first ? t : std::max(end, t);
}

McapWriter::McapWriter(const std::string& path, const std::string& profile) : file_(path) {
  put(mcap::kMagic);
  put(record(mcap::kHeader, sized(profile) + sized("perception")));
}

void McapWriter::put(std::string_view bytes) {
  file_.write(bytes);
  crc_ = crcOf(bytes, crc_);
  position_ += bytes.size();
}

std::uint16_t McapWriter::addChannel(const std::string& topic, const std::string& encoding,
                                     const Schema& schema,
                                     const std::map<std::string, std::string>& metadata) {
  const auto [known, is_new] =
      schema_ids_.try_emplace(schema.name, static_cast<std::uint16_t>(schema_ids_.size() + 1));
  if (is_new) {
    const std::string bytes =
        record(mcap::kSchema, number(known->second) + sized(schema.name) + sized(schema.encoding) +
                                  sized(schema.text));
    schemas_ += bytes;
    chunk_ += bytes;
  }
  const auto id = static_cast<std::uint16_t>(counts_.size());
  std::string entries;
  for (const auto& [name, value] : metadata) entries += sized(name) + sized(value);
  const std::string bytes =
      record(mcap::kChannel,
             number(id) + number(known->second) + sized(topic) + sized(encoding) + sized(entries));
  channels_ += bytes;
  chunk_ += bytes;
  counts_.push_back(0);
  return id;
}

void McapWriter::write(std::uint16_t channel, Stamp stamp, std::string_view message) {
  const auto t = static_cast<std::uint64_t>(stamp.ns);
  chunk_span_.add(t, index_.empty());
  span_.add(t, messages_ == 0);
  index_[channel].emplace_back(t, chunk_.size());
  chunk_ += record(mcap::kMessage,
                   (number(channel) + number(sequence_++) + number(t) + number(t)).append(message));
  ++messages_;
  ++counts_.at(channel);
  if (chunk_.size() >= kChunkBytes) finishChunk();
}

void McapWriter::finishChunk() {
  if (chunk_.empty()) return;
  const std::uint64_t begin = position_, size = chunk_.size();
  const std::string span = number(chunk_span_.begin) + number(chunk_span_.end);
  put(record(
      mcap::kChunk,
      (span + number(size) + number(crcOf(chunk_)) + sized("") + number(size)).append(chunk_)));
  const std::uint64_t end = position_;
  std::string offsets;
  for (const auto& [channel, entries] : index_) {
    offsets += number(channel) + number(position_);
    std::string list;
    for (const auto& [t, offset] : entries) list += number(t) + number(offset);
    put(record(mcap::kMessageIndex, number(channel) + sized(list)));
  }
  chunk_indexes_ += record(mcap::kChunkIndex, span + number(begin) + number(end - begin) +
                                                  sized(offsets) + number(position_ - end) +
                                                  sized("") + number(size) + number(size));
  ++chunks_;
  chunk_.clear();
  index_.clear();
  chunk_span_ = {};
}

std::string McapWriter::statistics() const {
  std::string counts;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    counts += number(static_cast<std::uint16_t>(i)) + number(counts_[i]);
  }
  constexpr std::uint32_t kNoAttachments = 0, kNoMetadata = 0;
  return record(mcap::kStatistics,
                number(messages_) + number(static_cast<std::uint16_t>(schema_ids_.size())) +
                    number(static_cast<std::uint32_t>(counts_.size())) + number(kNoAttachments) +
                    number(kNoMetadata) + number(chunks_) + number(span_.begin) +
                    number(span_.end) + sized(counts));
}

void McapWriter::close() {
  finishChunk();
  put(record(mcap::kDataEnd, number(crc_)));
  const std::uint64_t start = position_;
  std::string summary = schemas_ + channels_ + statistics() + chunk_indexes_;
  const std::uint64_t footer_bytes = 20, no_offsets = 0;
  summary += static_cast<char>(mcap::kFooter);
  summary += number(footer_bytes) + number(start) + number(no_offsets);
  put(summary + number(crcOf(summary)));
  put(mcap::kMagic);
  file_.close();
}

}  // namespace perception
