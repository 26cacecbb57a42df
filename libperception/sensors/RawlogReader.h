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

namespace mrpt::obs {
class CActionCollection;
}

namespace perception {

class CRawlogInput;

/// Reads a rawlog observation by observation, never as a whole, and says why it ended: MRPT's own
/// readers take a torn, damaged or half-unknown log for a complete one. Both layouts are read:
/// observations alone, and sensory frames with actions (wheel odometry inside an action becomes a
/// CObservationOdometry that is labeled ODOMETRY).
///
/// A bit error inside gzip data shows at once where the data stop to make sense, at the latest with
/// the check sum at the end of the file: observations given before that may be wrong, end() says
/// so.
///
/// Not detectable: a log without compression that was cut exactly between two entries. Hostile
/// sizes inside MRPT's own classes can take gigabytes before they fail: a program that reads
/// unknown logs sets a MemoryLimit, as runApp() does.
class RawlogReader {
 public:
  enum class End {
    kNotYet,
    kClean,         ///< the file ends after a whole entry, and its gzip check sums are right
    kTorn,          ///< cut off: a copy that stopped, a recorder that died
    kUnknownClass,  ///< an entry of a class that no library here registers; entries carry no length
                    ///< to skip by
    kNewerVersion,  ///< an entry that was written by a newer version of its class
    kDamaged        ///< bytes that make no sense: bit errors, something else appended
  };

  /// Throws DataError: kNoInput when missing, kBadInput (with what was found) when it is no rawlog.
  explicit RawlogReader(const std::string& path);
  ~RawlogReader();

  /// The next observation; null at the end. All whole entries before a fault are given.
  std::shared_ptr<mrpt::obs::CObservation> next();

  End end() const { return end_; }
  /// One line on the end: file, fault, byte offset, index of the entry, last stamp.
  const std::string& endMessage() const { return end_message_; }

  std::uint64_t entries() const { return entries_; }  ///< whole ones so far
  /// Entries that are no observation, by class.
  const std::map<std::string, std::uint64_t>& skipped() const { return skipped_; }
  std::optional<Stamp> lastStamp() const { return last_stamp_; }
  std::uint64_t bytesRead() const;  ///< of the file as it is (compressed), for a progress bar
  std::uint64_t fileBytes() const;

 private:
  bool readEntry();
  void finishAtFault(const std::string& class_name, const std::string& fault);
  void take(const mrpt::serialization::CSerializable::Ptr& object);
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
