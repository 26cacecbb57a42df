#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/serialization/CSerializable.h>

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "libperception/core/Time.h"
#include "libperception/sensors/rawlog/FileSink.h"
#include "libperception/sensors/rawlog/ObservationInput.h"

namespace mrpt::obs {
class CActionCollection;
}

namespace perception {

class CRawlogInput;

/// Streams the observations of a rawlog and reports why it ended: MRPT's own readers do not
/// distinguish a truncated, damaged or partly unknown log from a complete one. Both layouts are
/// read: observations alone, and sensory frames with actions (wheel odometry inside an action
/// becomes a CObservationOdometry with the label ODOMETRY). A sensor without a label has the name
/// of its class as label.
///
/// A bit error in gzip data is detected where decoding fails, at the latest by the checksum at the
/// end of the file: observations returned before that may be wrong, see end().
///
/// Not detectable: an uncompressed log truncated exactly between two entries, see verifiable().
/// Implausible sizes
/// inside MRPT's own classes may allocate gigabytes before they fail: a program that reads
/// untrusted logs sets a MemoryLimit, as runApp() does.
class RawlogReader final : public ObservationInput {
 public:
  enum class End {
    kNotYet,
    kClean,         ///< the file ends after a whole entry and its gzip checksums match
    kTorn,          ///< truncated: an interrupted copy or recording
    kUnknownClass,  ///< an entry of an unregistered class; entries have no length by which to skip
    kNewerVersion,  ///< an entry written by a newer version of its class
    kDamaged        ///< invalid bytes: bit errors, other data appended
  };

  /// Throws DataError: kNoInput when missing, kBadInput (with a description of the content) when it
  /// is no rawlog.
  explicit RawlogReader(const std::string& path, FileSink sink = {});
  ~RawlogReader() override;

  /// The next observation; null at the end. All whole entries before a fault are returned.
  std::shared_ptr<mrpt::obs::CObservation> next() override;

  End end() const { return end_; }
  bool isComplete() const override { return end_ == End::kClean; }
  std::string endName() const override;
  /// One line about the end: file, fault, byte offset, index of the entry, last stamp.
  const std::string& endMessage() const override { return end_message_; }
  /// Whether kClean proves that nothing is missing: one gzip container, with its length and
  /// checksum. An uncompressed log, or one of several containers, may be cut between two entries.
  bool verifiable() const override;

  std::uint64_t entries() const override { return entries_; }  ///< whole ones so far
  /// Number of entries that are no observations, by class.
  const std::map<std::string, std::uint64_t>& skipped() const { return skipped_; }
  std::optional<Stamp> lastStamp() const override { return last_stamp_; }
  std::uint64_t bytesRead() const override;  ///< compressed bytes, for a progress bar
  std::uint64_t fileBytes() const override;

 private:
  bool readEntry();
  void finishAtFault(const std::string& class_name, const std::string& fault);
  void take(const mrpt::serialization::CSerializable::Ptr& object);
  void give(mrpt::obs::CObservation::Ptr observation);
  void addActions(const mrpt::obs::CActionCollection& actions);
  void finish(End end, const std::string& what);

  std::string path_;
  std::unique_ptr<CRawlogInput> input_;
  std::deque<std::shared_ptr<mrpt::obs::CObservation>> ready_;
  std::map<std::string, std::uint64_t> skipped_;
  mrpt::poses::CPose2D odometry_;  ///< sum of the increments in actions
  std::uint64_t entries_ = 0;
  std::uint64_t entry_offset_ = 0;  ///< [bytes] where the current entry begins, after inflating
  std::optional<Stamp> last_stamp_;
  End end_ = End::kNotYet;
  std::string end_message_;
};

/// "clean", "torn", "unknown_class", "newer_version", "damaged".
const char* nameOf(RawlogReader::End end);

}  // namespace perception
