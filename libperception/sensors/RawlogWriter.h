#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "libperception/core/Supervision.h"

namespace mrpt::serialization {
class CSerializable;
}

namespace perception {

class CRawlogOutput;

/// Writes observations to a gzip rawlog under a temporary name; close() reads the file back,
/// verifies and renames it, so that a file of the final name is always complete.
class RawlogWriter {
 public:
  /// Throws OutputError (kCannotCreate).
  explicit RawlogWriter(const std::string& path, int gzip_level = 1);
  /// Without close() the file is removed.
  ~RawlogWriter();
  RawlogWriter(const RawlogWriter&) = delete;
  RawlogWriter& operator=(const RawlogWriter&) = delete;

  /// Throws OutputError (kIoError) when the disk is full or fails.
  void write(const mrpt::serialization::CSerializable& entry);
  /// Throws OutputError (kIoError) when the verification fails.
  void close();

  std::uint64_t entries() const { return entries_; }
  std::uint64_t bytes() const;  ///< of the file so far
  std::uint64_t bytesInflated() const;

 private:
  std::string path_, temporary_;
  TemporaryPath removed_if_killed_;
  std::unique_ptr<CRawlogOutput> output_;
  std::uint64_t entries_ = 0;
  bool closed_ = false;
};

}  // namespace perception
