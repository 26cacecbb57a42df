#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// Cuts a stream of Ibeo's (TCP, or a recorded file) into messages, each with its header.
class IbeoStream {
 public:
  /// The messages that these bytes complete. Bytes that belong to no message are skipped up to the
  /// beginning of the next one, and counted.
  std::vector<std::string> add(std::string_view bytes);
  std::uint64_t skipped() const { return skipped_; }  ///< [bytes] that belong to no message

 private:
  std::string rest_;
  std::uint64_t skipped_ = 0;
};

/// Types of messages that hold a scan.
enum class IbeoType : std::uint16_t { kLuxScan = 0x2202, kEcuScan2204 = 0x2204, kEcuScan = 0x2205 };

/// Header of 24 bytes and body.
std::string ibeoMessage(IbeoType type, std::int64_t stamp_ns, std::uint32_t previous_size,
                        std::string_view body);

/// Seconds since 1900 in the upper half, their 2^-32 in the lower, from and to [ns] since 1970.
std::uint64_t ntpOf(std::int64_t stamp_ns);
std::int64_t stampOfNtp(std::uint64_t ntp);

/// Elevations of the four layers, lowest first [deg]; LUX and ALASCA XT.
inline constexpr double kIbeoLayers[4] = {-1.2, -.4, .4, 1.2};

}  // namespace perception
