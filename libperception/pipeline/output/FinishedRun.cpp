#include "libperception/pipeline/output/FinishedRun.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <sstream>

#include "libperception/core/Error.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/RunMark.h"
#include "libperception/scene/files/RunRecord.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

/// Written by perception-track, -report, -snapshot and -evaluate as the README and the page have
/// it.
constexpr const char* kProducts[] = {
    "tracks.csv",    "scenes.csv",    "weather.csv", "ledger.csv",       "innovations.csv",
    "events.jsonl",  "effective.ini", "timing.json", "measurements.csv", "scans.csv",
    "sensors.csv",   "index.html",    "scene.png",   "contact.png",      "scene.mp4",
    "scene.3Dscene", "evaluation"};

}  // namespace

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
      throw Error(ExitCode::kInternal, "SHA-256 is not available");
  }
  void add(const void* data, std::size_t bytes) { EVP_DigestUpdate(context_.get(), data, bytes); }
  void add(const std::string& text) {
    add(text.data(), text.size());
    add("", 1);  // "ab", "c" is not "a", "bc"
  }
  /// From the byte `begin` on.
  void addFile(const std::string& path, std::uint64_t begin = 0) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0)
      throw DataError(fmt::format("{}: {}", path, std::strerror(errno)), ExitCode::kNoInput);
    const std::unique_ptr<const int, void (*)(const int*)> closer(
        &file, [](const int* f) { ::close(*f); });
    std::vector<char> part(1U << 20);
    while (true) {
      stopIfAsked();
      const ssize_t got = ::pread(file, part.data(), part.size(), static_cast<off_t>(begin));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0)
        throw DataError(fmt::format("{}: reading failed: {}", path, std::strerror(errno)),
                        ExitCode::kIoError);
      if (got == 0) return;
      add(part.data(), static_cast<std::size_t>(got));
      begin += static_cast<std::uint64_t>(got);
    }
  }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
    std::string out;
    for (unsigned i = 0; i < size; ++i) out += fmt::format("{:02x}", digest[i]);
    return out;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

namespace {

/// Values of an INI that are files: models, maps.
std::vector<std::string> filesNamedIn(const std::string& ini) {
  std::vector<std::string> out;
  std::istringstream lines(ini);
  lines.exceptions(std::ios::badbit);  // a lack of memory is no end
  for (std::string line; std::getline(lines, line);) {
    const auto equals = line.find(" = ");
    if (line.empty() || line[0] == ';' || equals == std::string::npos) continue;
    std::string value = line.substr(equals + 3, line.find(" ;") - equals - 3);
    value.erase(value.find_last_not_of(" \t") + 1);
    std::error_code ignored;
    if (!value.empty() && fs::is_regular_file(value, ignored)) out.push_back(value);
  }
  return out;
}

bool carries(const fs::path& file, const std::string& id) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return false;
  const auto ids = markedRunsOf(file.string());
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

/// Files below `dir`, and folders of evaluations, that carry the id and are not in `out` yet.
void addMarked(const std::string& dir, const std::string& id, std::vector<std::string>& out) {
  std::error_code error;
  fs::recursive_directory_iterator i(dir, error), end;
  for (; !error && i != end; i.increment(error)) {
    stopIfAsked();
    const std::string name = i->path().lexically_relative(dir).string();
    const bool known = std::find(out.begin(), out.end(), name) != out.end();
    std::error_code ignored;
    if (i->is_directory(ignored)) {
      const bool other = fs::exists(i->path() / "done.json", ignored);
      const bool evaluation = !known && !other && carries(i->path() / "report.json", id);
      if (evaluation) out.push_back(name);
      if (known || other || evaluation) i.disable_recursion_pending();
    } else if (!known && name != "done.json") {
      if (carries(i->path(), id)) out.push_back(name);
    }
  }
}

}  // namespace

std::string sha256OfFile(const std::string& path) {
  Sha256 hash;
  hash.addFile(path);
  return hash.hex();
}

FileHash::FileHash() : hash_(std::make_unique<Sha256>()) {}
FileHash::~FileHash() = default;

void FileHash::add(const unsigned char* bytes, std::size_t count) {
  hash_->add(bytes, count);
  added_ += count;
}

std::string FileHash::finish(const std::string& path) {
  hash_->addFile(path, added_);
  return hash_->hex();
}

std::string sha256OfText(const std::string& text) {
  Sha256 hash;
  hash.add(text);
  return hash.hex();
}

std::string configurationHash(const std::string& effective_ini, const std::string& version) {
  Sha256 hash;
  hash.add(version);
  hash.add(effective_ini);
  for (const auto& file : filesNamedIn(effective_ini)) hash.addFile(file);
  return hash.hex();
}

std::string hashOfRun(const std::string& log_sha256, const std::string& configuration_hash) {
  return sha256OfText(configuration_hash + log_sha256);
}

bool isFinished(const std::string& dir, const std::string& hash, bool overwrite) {
  const std::string done = dir + "/done.json";
  std::error_code ignored;
  if (overwrite || hash.empty() || !fs::exists(done, ignored)) return false;
  std::string there;
  try {
    there = readRunRecord(done).hash;
  } catch (const DataError&) {  // of another version or program: another run
  }
  if (!there.empty() && there == hash) return true;
  throw Error(ExitCode::kBadConfig,
              fmt::format("{}: holds the results of another log, configuration or version; give "
                          "another folder, or --overwrite to remove them",
                          dir));
}

std::string idOfRun(const RunRecord& record) {
  return record.hash.empty() ? sha256OfText(toJson(record)) : record.hash;
}

std::string markOfRuns(const std::vector<std::string>& dirs) {
  std::vector<std::string> ids;
  for (const std::string& dir : dirs) {
    const std::string done = dir + "/done.json";
    if (!dir.empty() && fs::exists(done)) ids.push_back(idOfRun(readRunRecord(done)));
  }
  return runMark(ids);
}

std::vector<std::string> productsIn(const std::string& dir) {
  std::vector<std::string> out;
  std::error_code ignored;
  if (!fs::exists(dir + "/done.json", ignored)) return out;
  for (const char* name : kProducts) {
    if (fs::exists(dir + "/" + name, ignored)) out.emplace_back(name);
  }
  try {
    addMarked(dir, idOfRun(readRunRecord(dir + "/done.json")), out);
  } catch (const DataError&) {  // of another version or program: its products carry no known id
  }
  return out;
}

}  // namespace perception
