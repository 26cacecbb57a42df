#pragma once
#include <cstdint>
#include <string_view>

namespace perception {

/// CRC-16/CCITT-FALSE over header and elements of an SRR520's list.
std::uint16_t srr520Checksum(std::string_view bytes);

}  // namespace perception
