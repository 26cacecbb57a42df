#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "libperception/core/Time.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"

namespace perception {

/// Limits of a capture's files.
struct ChunkLimits {
  double seconds = 60;                   ///< a chunk is closed after as long
  std::uint64_t bytes = 1000000000;      ///< and at this size of its file
  std::uint64_t free_bytes = 200000000;  ///< the capture ends when the disk has less
  int gzip_level = 1;                    ///< 0: not compressed, for more than a disk of 60 MB/s
};

/// A capture as a sequence of rawlogs, DIR/capture_0001.rawlog ...: each is closed, read back,
/// synced and renamed before the next, so that files of that name are whole whatever happens. Each
/// is listed in DIR/capture.jsonl.
class ChunkedLog {
 public:
  /// Creates the folder. Throws OutputError (kCannotCreate), also where it holds a capture.
  ChunkedLog(const std::string& folder, const ChunkLimits& limits);
  /// Throws OutputError (kIoError) when the disk is full; chunks closed before are whole.
  void write(const mrpt::obs::CObservation& observation);
  /// Closes the chunk where it is due. Throws OutputError (kIoError), with the chunk closed, when
  /// less space is left than the limit.
  void tend();
  /// Closes the last chunk.
  void close();
  /// Appends a line of JSON to capture.jsonl and syncs it.
  void note(const std::string& json);

  std::uint64_t chunks() const { return chunks_; }
  std::uint64_t bytes() const { return closed_bytes_ + (chunk_ ? chunk_->bytes() : 0); }

 private:
  std::string folder_;
  ChunkLimits limits_;
  std::unique_ptr<RawlogWriter> chunk_;
  std::string name_;  ///< of the open chunk
  double opened_ = 0;
  std::optional<Stamp> first_, last_;
  std::uint64_t chunks_ = 0, closed_bytes_ = 0;
};

}  // namespace perception
