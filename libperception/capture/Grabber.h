#pragma once
#include <mrpt/core/Clock.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/capture/ChunkedLog.h"
#include "libperception/capture/LedgerSource.h"
#include "libperception/capture/Outlet.h"
#include "libperception/capture/drivers/Drivers.h"
#include "libperception/dds/ObservationTopic.h"
#include "libperception/dds/RosTopics.h"
#include "libperception/sensors/rawlog/ObservationStream.h"

namespace perception {

/// Text of the stamped comments that are written while no sensor sends anything. They let the time
/// of a stream go on. They are recorded as well, so that the record equals the stream.
inline constexpr const char* kClockText = "clock: no sensor has anything to say";

/// Where a capture goes; at least one.
struct GrabberOutputs {
  std::string folder;                  ///< of a ChunkedLog; empty: not recorded
  std::string stream;                  ///< pipe or file of an ObservationStream; empty: none
  std::optional<NetworkName> network;  ///< for other processes and computers, by DDS
};

/// What one sensor of a capture gave.
struct SensorLedger {
  std::uint64_t written = 0;  ///< observations
  std::uint64_t late = 0;     ///< of these, stamped before the sensor's one before
  /// Observations that were not recorded since the disk was too slow ([global] queue_mb), and which
  /// ones.
  std::uint64_t left_out = 0;
  std::vector<std::int64_t> left_out_stamps;  ///< [ns] since 1970
};

/// Records and streams the sensors of an INI of MRPT's rawlog-grabber (Drivers). Nothing of the
/// tail of a record is lost. A stream whose reader is slow leaves out observations ([global]
/// stream_limit); one whose reader is gone ends the capture.
class Grabber {
 public:
  /// Creates and starts the drivers. Throws ConfigError, Error, OutputError.
  Grabber(const std::string& ini, const GrabberOutputs& outputs);

  /// Runs until `done` says so, then ends the drivers and closes the log. `tick` is called about
  /// once a second. Throws OutputError (kIoError) when the disk is full: closed chunks are whole.
  void run(const std::function<bool()>& done, const std::function<void()>& tick);

  const std::map<std::string, SensorLedger>& sensors() const { return ledgers_; }
  std::uint64_t bytes() const { return bytes_; }    ///< of the log
  std::uint64_t chunks() const { return chunks_; }  ///< of the log
  /// Packets of all drivers that count them: faults for the user, one a line.
  std::vector<std::string> warnings() const;
  /// What the drivers say beside, one a line.
  std::vector<std::string> notes() const;

 private:
  void startStream(const std::string& path, std::size_t limit);
  void startPublishing(const NetworkName& network);
  void startRecord(const std::string& folder, const ChunkLimits& limits, std::uint64_t queue_bytes);
  void pass(std::vector<Drivers::Arrival> arrivals);
  void count(const Drivers::Arrival& arrival);
  void passTime();
  void put(const Drivers::Arrival& arrival);
  void noteLedgers();
  const LedgerSource* ledgerOf(std::size_t i) const;

  struct Newest {
    mrpt::Clock::time_point stamp;
    std::chrono::steady_clock::time_point at;  ///< when it came
  };

  Drivers drivers_;
  std::map<std::string, SensorLedger> ledgers_;
  std::map<std::string, mrpt::Clock::time_point> last_;
  std::optional<Newest> newest_;
  std::chrono::steady_clock::time_point last_passed_;
  std::optional<ChunkedLog> log_;
  std::optional<StreamWriter> writer_;
  std::unique_ptr<ObservationPublisher> publisher_;
  std::unique_ptr<RosTopics> ros_;
  std::atomic<std::uint64_t> unpublished_{0};
  std::atomic<std::uint64_t> bytes_{0}, chunks_{0};
  std::atomic<bool> reader_gone_{false};
  // Their threads end before what they write to.
  std::unique_ptr<Outlet> record_, stream_, network_;
};

}  // namespace perception
