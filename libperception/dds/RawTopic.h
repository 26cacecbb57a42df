#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/core/Time.h"
#include "libperception/dds/Network.h"

namespace perception {

/// What the writers of a topic offer, or a reader asks for.
struct TopicQuality {
  bool reliable = true;  ///< what is lost is sent again
  bool latched = false;  ///< who comes late gets what was sent before (ROS: transient local)

  bool operator==(const TopicQuality& o) const {
    return reliable == o.reliable && latched == o.latched;
  }
};

struct ReceiveCounts;

/// Messages as bytes, CDR with its head of four, of topics whose types are known by name alone.
/// Names are those on the wire: "rt/points", "sensor_msgs::msg::dds_::PointCloud2_".
class RawReader {
 public:
  struct Message {
    std::string bytes;
    Stamp received;  ///< by this computer's clock
  };
  /// What came and was not given, since the reader was made.
  struct Ledger {
    std::uint64_t received = 0;
    std::uint64_t lost = 0;      ///< by the numbers that their writers give
    std::uint64_t overrun = 0;   ///< newer ones came before they were taken
    std::uint64_t too_long = 0;  ///< longer than kLongest
  };
  static constexpr std::size_t kLongest = 256'000'000;  ///< [bytes] of a message

  /// `depth`: messages that may wait. Throws Error (kUnavailable).
  RawReader(std::shared_ptr<Network> network, const std::string& topic, const std::string& type,
            TopicQuality quality, int depth);
  ~RawReader();
  RawReader(const RawReader&) = delete;
  RawReader& operator=(const RawReader&) = delete;

  /// What came since the last call, in the order of arrival.
  std::vector<Message> take();
  Ledger ledger() const;
  const TopicQuality& quality() const { return quality_; }
  /// The entity of Cyclone DDS, for a waitset.
  int entity() const { return reader_; }

 private:
  std::shared_ptr<Network> network_;
  TopicQuality quality_;
  std::shared_ptr<ReceiveCounts> counts_;
  int topic_ = 0, reader_ = 0;
  std::uint64_t taken_ = 0;
};

/// Sends such messages: reliable, the last 50 kept for who is slow, or the last one for who comes
/// late.
class RawWriter {
 public:
  /// Throws Error (kUnavailable).
  RawWriter(std::shared_ptr<Network> network, const std::string& topic, const std::string& type,
            TopicQuality quality = {});
  ~RawWriter();
  RawWriter(const RawWriter&) = delete;
  RawWriter& operator=(const RawWriter&) = delete;

  /// False where a reader that wants all could not follow for 10 ms: it misses the message.
  bool write(std::string_view cdr);
  bool hasReaders() const;

 private:
  std::shared_ptr<Network> network_;
  const void* type_ = nullptr;  ///< of Cyclone DDS
  int topic_ = 0, writer_ = 0;
};

}  // namespace perception
