#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libperception/scene/files/RunRecord.h"

namespace perception {

/// 64 hexadecimal digits. Throws DataError for a file that cannot be read.
std::string sha256OfFile(const std::string& path);
std::string sha256OfText(const std::string& text);

class Sha256;

/// sha256OfFile() of a file that is read anyway, without reading it twice.
class FileHash {
 public:
  FileHash();
  ~FileHash();
  /// The next bytes of the file, from its first one on.
  void add(const unsigned char* bytes, std::size_t count);
  /// Reads the rest of the file, since the reader of a damaged log stops early. Call it once.
  /// Throws DataError.
  std::string finish(const std::string& path);

 private:
  std::unique_ptr<Sha256> hash_;
  std::uint64_t added_ = 0;  ///< [bytes]
};

/// SHA-256 of everything besides the log that determines the results of a run: the effective INI,
/// the files that it names, and the version of the program. Throws DataError.
std::string configurationHash(const std::string& effective_ini, const std::string& version);
/// SHA-256 of everything that determines the results, from sha256OfFile() of the log and
/// configurationHash().
std::string hashOfRun(const std::string& log_sha256, const std::string& configuration_hash);

/// True if `dir` holds the finished run of this hash: there is nothing to do. With `overwrite`
/// there always is; without, throws Error (kBadConfig) if it holds another one.
bool isFinished(const std::string& dir, const std::string& hash, bool overwrite);

/// The id that a run's products carry (runMark()): its hash, of a live run the SHA-256 of the
/// record.
std::string idOfRun(const RunRecord& record);
/// runMark() of the runs in these folders; those that did not finish have no id. Throws DataError.
std::string markOfRuns(const std::vector<std::string>& dirs);

/// Results of other programs about the run in `dir`, as relative paths: tables, page, pictures,
/// film, evaluation, and every file that carries the run's id. Folders of other runs inside are
/// left out. These files would be taken for results of the next run.
std::vector<std::string> productsIn(const std::string& dir);

}  // namespace perception
