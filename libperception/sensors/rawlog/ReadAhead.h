#pragma once
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "libperception/sensors/rawlog/ObservationInput.h"

namespace perception {

/// A recorded input that is read and inflated by a thread of its own, a few observations ahead. The
/// observations, the state after each of them and the end are those of the input itself.
class ReadAhead final : public ObservationInput {
 public:
  /// Without a thread to be had, it reads in next().
  explicit ReadAhead(std::unique_ptr<ObservationInput> input);
  ~ReadAhead() override;

  /// Throws what the input throws, after all observations that precede it.
  std::shared_ptr<mrpt::obs::CObservation> next() override;

  bool isComplete() const override { return at_.complete; }
  std::string endName() const override { return at_.end_name; }
  const std::string& endMessage() const override { return at_.end_message; }
  bool verifiable() const override { return at_.verifiable; }
  std::uint64_t entries() const override { return at_.entries; }
  std::optional<Stamp> lastStamp() const override { return at_.last_stamp; }
  std::uint64_t bytesRead() const override { return at_.bytes_read; }
  std::uint64_t fileBytes() const override { return file_bytes_; }

 private:
  static constexpr std::size_t kAhead = 8;  ///< observations; a scan of 200,000 returns has 4 MB

  /// What next() gave, and the input's state after it.
  struct Taken {
    std::shared_ptr<mrpt::obs::CObservation> observation;  ///< null: the end, or `fault`
    std::exception_ptr fault;
    bool complete = false, verifiable = false;
    std::string end_name, end_message;
    std::uint64_t entries = 0, bytes_read = 0;
    std::optional<Stamp> last_stamp;
  };

  Taken take();
  void readAll();

  const std::unique_ptr<ObservationInput> input_;
  const std::uint64_t file_bytes_;
  Taken at_;            ///< of the last next()
  bool ended_ = false;  ///< the last next() gave no observation
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Taken> ahead_;
  bool stop_ = false;
  std::thread reader_;
};

}  // namespace perception
