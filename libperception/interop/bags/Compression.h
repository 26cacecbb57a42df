#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace perception {

/// The bytes of a block of a recording; `method`: "" or "none", bz2, lz4 (a frame), zstd. Throws
/// std::runtime_error unless they are exactly `size` bytes; at most kMostInflated.
std::string inflated(std::string_view method, std::string_view bytes, std::uint64_t size);
/// [bytes] 256 MB; usual blocks have up to 10.
inline constexpr std::uint64_t kMostInflated = std::uint64_t{1} << 28;

/// The content of one zstd frame that tells its size, at most kMostInflated. Throws
/// std::runtime_error.
std::string inflatedZstd(std::string_view frame);

}  // namespace perception
