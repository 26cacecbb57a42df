#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libperception/core/Time.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {

/// Writes an MCAP file (https://mcap.dev/spec): messages in uncompressed chunks with their
/// indexes, and a summary with copies of schemas and channels, statistics, chunk indexes and
/// checksums. The file has its name after close().
class McapWriter {
 public:
  struct Schema {
    std::string name;      ///< "foxglove.PointCloud"
    std::string encoding;  ///< "jsonschema"
    std::string text;
  };

  /// Throws OutputError. `profile`: "" for none.
  explicit McapWriter(const std::string& path, const std::string& profile = "");

  /// Adds a channel whose messages are encoded as `encoding` ("json", "cdr"); returns its number.
  std::uint16_t addChannel(const std::string& topic, const std::string& encoding,
                           const Schema& schema,
                           const std::map<std::string, std::string>& metadata = {});
  /// Stamps may come in any order; they are not before 1970. Throws OutputError (kIoError).
  void write(std::uint16_t channel, Stamp stamp, std::string_view message);
  /// Throws OutputError (kIoError).
  void close();
  std::uint64_t messages() const { return messages_; }

 private:
  struct Span {
    std::uint64_t begin = 0, end = 0;  ///< [ns]
    void add(std::uint64_t t, bool first);
  };
  void put(std::string_view bytes);
  void finishChunk();
  std::string statistics() const;

  OutputFile file_;
  std::uint64_t position_ = 0;      ///< [bytes] written
  std::uint32_t crc_ = 0;           ///< of all bytes written
  std::string schemas_, channels_;  ///< records for the summary
  std::map<std::string, std::uint16_t> schema_ids_;
  std::string chunk_;
  Span chunk_span_, span_;
  /// Of the open chunk: time and offset of every message, by channel.
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;
  std::string chunk_indexes_;
  std::uint32_t chunks_ = 0, sequence_ = 0;
  std::uint64_t messages_ = 0;
  std::vector<std::uint64_t> counts_;  ///< messages of each channel
};

}  // namespace perception
