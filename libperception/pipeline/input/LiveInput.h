#pragma once
#include <memory>
#include <string>

#include "libperception/core/system/ChildProcess.h"
#include "libperception/sensors/rawlog/ObservationInput.h"
#include "libperception/sensors/rawlog/ObservationStream.h"

namespace perception {

/// Sensors at work as the input of a run: starts perception-grabber, which runs the drivers of a
/// capture INI in a process of its own, and reads its stream. Ends after the given time, or with
/// SIGINT or SIGTERM, which here are the end of the input and no fault.
class LiveInput final : public ObservationInput {
 public:
  struct Params {
    std::string ini;     ///< as of perception-grabber
    double seconds = 0;  ///< 0: until a signal
    std::string record;  ///< folder in which perception-grabber records as well; empty: none
  };

  /// Throws DataError (kNoInput) for the INI, Error (kUnavailable) without perception-grabber.
  explicit LiveInput(Params params);

  std::shared_ptr<mrpt::obs::CObservation> next() override;
  bool isComplete() const override { return end_message_.empty(); }
  std::string endName() const override { return isComplete() ? "clean" : "broken"; }
  const std::string& endMessage() const override { return end_message_; }
  bool verifiable() const override { return false; }
  std::uint64_t entries() const override { return entries_; }
  std::optional<Stamp> lastStamp() const override { return last_stamp_; }
  std::uint64_t bytesRead() const override { return reader_->bytesRead(); }
  std::uint64_t fileBytes() const override { return 0; }
  std::optional<std::chrono::steady_clock::time_point> arrival() const override;
  std::uint64_t dropped() const override { return entry_.dropped; }

 private:
  void finish(const std::string& fault);

  Params params_;
  std::unique_ptr<ChildProcess> grabber_;
  std::unique_ptr<StreamReader> reader_;
  StreamEntry entry_;
  std::uint64_t entries_ = 0;
  std::optional<Stamp> last_stamp_;
  std::string end_message_;
};

/// Whether an input is "ros2:INI", the topics of a running ROS 2 graph, and its INI, which may be
/// empty.
bool isOfRosGraph(const std::string& input);
std::string rosGraphIniOf(const std::string& input);
/// The capture INI of an input: what stands behind "live:", or the whole of "ros2:INI"; empty: it
/// is a file.
std::optional<std::string> liveIniOf(const std::string& input);

}  // namespace perception
