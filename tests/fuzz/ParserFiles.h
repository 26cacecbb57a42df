// Bytes as files, for readers of files.
#pragma once
#include <sys/mman.h>
#include <sys/types.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>

namespace perception {

/// A file in memory, by its path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : file_(::memfd_create("fuzz", 0)) {
    if (file_ < 0 ||
        ::write(file_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      std::abort();
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

/// Calls a reader of files with the path of the bytes.
template <class Reader>
std::function<void(std::string_view)> ofFile(Reader reader) {
  return [reader](std::string_view bytes) { reader(MemoryFile(bytes).path()); };
}

/// A folder of this process for readers that choose by the names of files; gone at its end.
const std::string& scratch();
/// Writes a file there; its path.
std::string written(const std::string& name, std::string_view bytes);

// Parsers of recordings of ROS.
void readBag(const std::string& path);
/// Of a small recording in sqlite with changes: of three bytes, two are the place of the third.
void readDatabase(std::string_view bytes);
/// The first byte chooses the type, the second the encoding.
void readMessage(std::string_view bytes);
/// By the fields of their definition. The first byte chooses the type, the second the encoding;
/// then the definition up to a line "--", then the message.
void readMessageByFields(std::string_view bytes);

}  // namespace perception
