#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// What is needed of a sensor's metadata file (either of its two layouts).
struct OusterMetadata {
  std::vector<double> altitudes, azimuths;  ///< [deg], one a row
  double origin_to_beam = 0;                ///< [m]
  std::size_t columns_per_frame = 1024, columns_per_packet = 16;
  std::string profile = "LEGACY";  ///< of the lidar's packets
};

/// Throws DataError: no JSON, a field is missing or does not fit, an unknown profile.
OusterMetadata parseOusterMetadata(const std::string& text, const std::string& name);
OusterMetadata readOusterMetadata(const std::string& path);

/// One pixel of a column, as sent.
struct OusterPixel {
  std::uint32_t range[2] = {0, 0};  ///< [mm]; the second of profiles with two returns
  std::uint8_t reflectivity[2] = {0, 0};
  std::uint16_t signal[2] = {0, 0};
  std::uint16_t near_infrared = 0;
};

struct OusterColumn {
  std::uint64_t stamp_ns = 0;
  std::uint16_t measurement = 0, frame = 0;  ///< column of the frame, number of the frame
  bool valid = false;
  std::vector<OusterPixel> pixels;
};

/// The columns of a packet. `warnings`: its checksum is wrong (0 means that none was sent).
/// Throws DataError if the size or a measurement number is not that of the metadata.
std::vector<OusterColumn> ousterColumns(std::string_view payload, const OusterMetadata& metadata,
                                        std::vector<std::string>& warnings);

}  // namespace perception
