#pragma once
#include <string>

namespace perception {

/// A result folder whose files are whole or absent: they are written in a temporary folder inside
/// it and moved to their names by commit(), done.json last. An earlier result in the folder is
/// replaced then, file by file; without commit() nothing of it changes and nothing is left behind.
class OutputFolder {
 public:
  /// Creates the folder and the temporary one. Throws OutputError (kCannotCreate) with path and
  /// reason.
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where the files are to be written.
  const std::string& temporary() const { return temporary_; }
  std::string pathFor(const std::string& file) const { return temporary_ + "/" + file; }
  const std::string& path() const { return path_; }

  /// Moves every file to its place. Throws OutputError (kIoError).
  void commit();

 private:
  std::string path_, temporary_;
};

}  // namespace perception
