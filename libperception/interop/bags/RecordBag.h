#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "libperception/interop/bags/ByteSource.h"
#include "libperception/interop/bags/ReadingBag.h"

namespace perception {

/// A recording in records, some of which are (compressed) chunks of records. A damaged chunk is
/// left out; a damaged or missing end keeps what is whole.
class RecordBag : public ReadingBag {
 public:
  std::uint64_t bytesRead() const override { return file_->position(); }
  std::uint64_t fileBytes() const override { return file_->size(); }

 protected:
  RecordBag(std::string path, std::unique_ptr<ByteSource> file)
      : ReadingBag(std::move(path)), file_(std::move(file)) {}

  enum class Record { kOther, kMessage, kChunk, kEnd };
  /// Reads one record; sets `message` or chunk_. Throws std::runtime_error.
  virtual Record read(ByteSource& source, BagMessage& message) = 0;
  /// What is wrong with a file that ends here; empty: nothing.
  virtual std::string faultOfEnd(bool ended) const = 0;

  BagTopic& topic(std::uint32_t id) { return topics_[id]; }
  /// Throws std::runtime_error if no record of it came before.
  const BagTopic* knownTopic(std::uint32_t id) const;

  /// A chunk that was read, not inflated yet.
  struct Chunk {
    std::string compression, bytes;
    std::uint64_t size = 0;  ///< inflated
    std::uint32_t crc = 0;   ///< of the inflated bytes; 0: not known
  } chunk_;

 private:
  bool nextStored(BagMessage& message) override;
  void open();
  void finish(bool ended);

  std::unique_ptr<ByteSource> file_, block_;
  std::uint64_t block_offset_ = 0;
  std::map<std::uint32_t, BagTopic> topics_;
  bool done_ = false;
};

/// MCAP, https://mcap.dev/spec. `file`: behind its magic.
std::unique_ptr<ReadingBag> mcapBag(const std::string& path, std::unique_ptr<ByteSource> file);
/// ROS 1, http://wiki.ros.org/Bags/Format/2.0. `file`: behind its magic.
std::unique_ptr<ReadingBag> ros1Bag(const std::string& path, std::unique_ptr<ByteSource> file);

}  // namespace perception
