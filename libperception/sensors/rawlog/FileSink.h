#pragma once
#include <cstddef>
#include <functional>

namespace perception {

/// Is given the bytes of a file, block by block from its beginning, as they are read.
using FileSink = std::function<void(const unsigned char* bytes, std::size_t count)>;

}  // namespace perception
