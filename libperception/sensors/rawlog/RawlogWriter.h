#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "libperception/core/system/PartialFile.h"

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
  /// Verifies the file and removes an earlier one of the name: what belongs to the log, its truth,
  /// is written now, so that no log has that of another. Throws OutputError (kIoError).
  void finish();
  /// finish(), and gives the file its name. Throws OutputError (kIoError).
  void close();

  std::uint64_t entries() const { return entries_; }
  std::uint64_t bytes() const;  ///< of the file so far
  std::uint64_t bytesInflated() const;

 private:
  std::string path_;
  PartialFile file_;
  std::unique_ptr<CRawlogOutput> output_;
  std::uint64_t entries_ = 0;
  bool finished_ = false;
};

}  // namespace perception
