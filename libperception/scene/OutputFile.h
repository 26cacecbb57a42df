#pragma once
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

namespace perception {

/// A result file that is whole or an error: what cannot be created, written or closed throws
/// OutputError with path, reason and free space. A full disk shows at the latest in close().
class OutputFile {
 public:
  /// Creates or empties the file. Throws OutputError (kCannotCreate).
  explicit OutputFile(const std::string& path);

  /// Throws OutputError (kIoError).
  void write(std::string_view text);
  /// Hands everything to the disk and closes. Throws OutputError (kIoError).
  void close();
  const std::string& path() const { return path_; }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  [[noreturn]] void fail(int reason) const;
  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
};

/// Creates a folder and those above it; nothing for an empty path. Throws OutputError
/// (kCannotCreate).
void createFolder(const std::string& path);

/// Writes a whole file at once. Throws OutputError.
void writeFile(const std::string& path, std::string_view text);

}  // namespace perception
