#pragma once
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "libperception/core/system/PartialFile.h"

namespace perception {

/// Receives text piece by piece.
using TextSink = std::function<void(std::string_view)>;

/// Text that waits in a file beside an output until it has its place there. The file is removed
/// with this.
class SpoolFile {
 public:
  /// Beside `output`, or in the system's temporary folder if that is a device or a pipe; `name` is
  /// that of this one among those of the output. Throws OutputError (kCannotCreate).
  SpoolFile(const std::string& output, const std::string& name);

  /// Throws OutputError (kIoError).
  void write(std::string_view text);
  /// Everything that was written. Throws OutputError (kIoError).
  void copyTo(const TextSink& sink);

 private:
  PartialFile place_;
  std::unique_ptr<std::FILE, FileCloser> file_;
};

}  // namespace perception
