#pragma once
#include <mrpt/serialization/CArchive.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "libperception/core/Error.h"

namespace perception {

/// The bytes of a rawlog on their way into a gzip file. Every failed write is an OutputError at
/// once (MRPT's CFileGZOutputStream closes a file on a full disk without a word).
class CRawlogOutput final : public mrpt::serialization::CArchive {
 public:
  /// Creates or empties the file. `gzip_level` 0 (stored) to 9; above 1 hardly gains on sensor
  /// data.
  CRawlogOutput(const std::string& path, int gzip_level);
  ~CRawlogOutput() override;

  /// Writes the rest and the trailer, forces it to the disk and closes. Throws OutputError.
  void finish();
  /// What the disk said, when a write failed: MRPT's serialization turns exceptions that pass it
  /// into its own type.
  const std::optional<OutputError>& failure() const { return failure_; }
  std::uint64_t bytesIn() const { return bytes_in_; }    ///< [bytes] before compression
  std::uint64_t bytesOut() const { return bytes_out_; }  ///< [bytes] written to the file
  std::string getArchiveDescription() const override { return path_; }

 protected:
  std::size_t read(void*, std::size_t) override;
  std::size_t write(const void* from, std::size_t count) override;

 private:
  struct Deflater;
  void deflateSome(const void* from, std::size_t count, int flush);
  void writeFile(const unsigned char* from, std::size_t count);
  [[noreturn]] void fail(const char* what);

  std::string path_;
  int file_ = -1;
  std::unique_ptr<Deflater> deflater_;
  std::optional<OutputError> failure_;
  std::uint64_t bytes_in_ = 0, bytes_out_ = 0;
};

}  // namespace perception
