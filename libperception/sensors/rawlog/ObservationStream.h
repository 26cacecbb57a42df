#pragma once
#include <mrpt/obs/CObservation.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace perception {

/// Observations on their way between two processes of one machine: each as a head of 24 bytes
/// ("PObs", number of observations left out so far, bytes, arrival in nanoseconds of the monotonic
/// clock) and what MRPT makes of it.
struct StreamEntry {
  std::shared_ptr<mrpt::obs::CObservation> observation;
  std::chrono::steady_clock::time_point arrival;  ///< from its sensor
  std::uint32_t dropped = 0;                      ///< left out so far, of all sensors
};

/// The writing end: a pipe or a file.
class StreamWriter {
 public:
  /// Throws OutputError (kCannotCreate).
  explicit StreamWriter(const std::string& path);
  ~StreamWriter();
  StreamWriter(const StreamWriter&) = delete;
  StreamWriter& operator=(const StreamWriter&) = delete;

  /// Waits until it is written; false when the reader is gone.
  bool write(const StreamEntry& entry);

 private:
  int file_ = -1;
  std::vector<std::uint8_t> bytes_;
};

/// The reading end.
class StreamReader {
 public:
  enum class Result { kEntry, kNothing, kEnd };

  /// Takes over the file descriptor.
  explicit StreamReader(int file) : file_(file) {}
  ~StreamReader();
  StreamReader(const StreamReader&) = delete;
  StreamReader& operator=(const StreamReader&) = delete;

  /// Waits up to `milliseconds` for the next entry to begin. Throws std::runtime_error for what is
  /// no stream of observations, and one that ends within an entry.
  Result read(StreamEntry& entry, int milliseconds);
  std::uint64_t bytesRead() const { return bytes_read_; }

 private:
  bool fill(void* to, std::size_t bytes);

  int file_;
  std::uint64_t bytes_read_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace perception
