#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "libperception/core/Time.h"
#include "libperception/dds/Network.h"

struct ddsi_serdata;
struct ddsi_sertype;

namespace perception {

// Types that Cyclone DDS knows by their names alone, whose messages stay bytes: its interface for
// middleware such as ROS's.

/// Counts the messages of one topic that came. Written by threads of the middleware.
struct ReceiveCounts {
  using WriterId = std::array<unsigned char, 16>;

  void number(const WriterId& writer, std::int64_t number);

  std::atomic<std::uint64_t> received{0}, too_long{0}, lost{0};

 private:
  std::mutex mutex_;
  std::map<WriterId, std::int64_t> next_;  ///< number expected, by writer
};

/// Sets `type` to that of the new topic. Throws Error (kUnavailable).
int makeRawTopic(const Network& network, const std::string& name, const std::string& type_name,
                 std::shared_ptr<ReceiveCounts> counts, const ddsi_sertype*& type);

/// A message to be sent, its last word filled with zeros; null for one that is too long or has not
/// even the four bytes of a head.
ddsi_serdata* makeRawMessage(const ddsi_sertype* type, std::string_view cdr);
const std::string& bytesOf(const ddsi_serdata* message);
/// By this computer's clock.
Stamp receivedOf(const ddsi_serdata* message);

}  // namespace perception
