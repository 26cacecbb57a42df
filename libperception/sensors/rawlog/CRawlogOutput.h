#pragma once
#include <mrpt/serialization/CArchive.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "libperception/core/Error.h"

namespace perception {

/// Writes a rawlog as a gzip file. Every failed write throws OutputError at once (MRPT's
/// CFileGZOutputStream does not report a full disk on closing).
class CRawlogOutput final : public mrpt::serialization::CArchive {
 public:
  /// Creates or truncates the file. `gzip_level` 0 (stored) to 9; levels above 1 hardly reduce
  /// sensor data further.
  CRawlogOutput(const std::string& path, int gzip_level);
  ~CRawlogOutput() override;

  /// Writes the rest and the trailer, syncs to disk and closes. Throws OutputError.
  void finish();
  /// The error of a failed write: MRPT's serialization converts exceptions into its own type.
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
