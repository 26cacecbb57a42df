#include "libperception/interop/bags/SqliteBag.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

#include "libperception/core/Error.h"
#include "libperception/interop/bags/Compression.h"

namespace perception {
namespace {

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

constexpr const char* kRowsBehind =
    "SELECT id, topic_id, timestamp, data FROM messages WHERE id > ? ORDER BY id";

std::uintmax_t sizeOf(const std::string& path) {
  std::error_code none;
  const auto size = std::filesystem::file_size(path, none);
  return none ? 0 : size;
}

/// A journal that was closed is empty, or begins with zeros.
bool isHot(const std::string& journal) {
  std::ifstream file(journal, std::ios::binary);
  return file.get() > 0;
}

/// `path` as sqlite's URI.
std::string uriOf(const std::string& path, bool alone) {
  std::string uri = "file:";
  for (const char c : path)
    uri += c == '?' || c == '#' || c == '%' ? fmt::format("%{:02x}", static_cast<int>(c))
                                            : std::string(1, c);
  return uri + (alone ? "?immutable=1" : "");
}

class SqliteBag final : public ReadingBag {
 public:
  SqliteBag(const std::string& name, const std::string& path);
  ~SqliteBag() override;
  SqliteBag(const SqliteBag&) = delete;
  SqliteBag& operator=(const SqliteBag&) = delete;
  std::uint64_t bytesRead() const override { return std::min(read_, size_); }
  std::uint64_t fileBytes() const override { return size_; }

 private:
  bool nextStored(BagMessage& message) override;
  void open(bool alone);
  bool holds(const char* table);
  void readTopics();
  void readDefinitions();
  bool begin();
  bool skipDamage();
  bool take(BagMessage& message);
  std::string text(sqlite3_stmt* row, int column) const;
  Statement prepared(const char* sql) const;
  void fault(const std::string& what) { faults_.push_back(fmt::format("{}: {}", path_, what)); }

  std::string file_, index_;  ///< of the write-ahead log, if it was made for us
  std::uint64_t size_ = 0, read_ = 0;
  Database db_{nullptr, &sqlite3_close};
  Statement rows_{nullptr, &sqlite3_finalize};
  std::map<std::int64_t, BagTopic> topics_;
  std::int64_t last_ = std::numeric_limits<std::int64_t>::min();  ///< row
  std::int64_t stride_ = 0;                                       ///< [rows] over damage
  std::uint64_t damages_ = 0, orphans_ = 0, odd_ = 0;
  bool done_ = false;
};

SqliteBag::SqliteBag(const std::string& name, const std::string& path)
    : ReadingBag(name), file_(path), size_(sizeOf(path)) {
  const std::string log = path + "-wal";
  const bool logged = sizeOf(log) > 0;
  if (logged) {
    const std::string index = path + "-shm";
    if (!std::filesystem::exists(index)) index_ = index;
    fault(fmt::format("the recording was not closed: {}-wal is beside it", name));
  }
  if (isHot(path + "-journal"))
    fault(
        fmt::format("the recording was not closed: {}-journal is beside it; what it would take "
                    "back stays",
                    name));
  open(!logged);
  if (logged && !holds("messages")) {
    fault(fmt::format("{}-wal cannot be read ({}): the messages in it are left out", name,
                      sqlite3_errmsg(db_.get())));
    open(true);
  }
  if (!holds("topics") || !holds("messages")) {
    throw DataError(
        fmt::format("{}: an sqlite file without the tables topics and messages of "
                    "rosbag2 ({})",
                    name, sqlite3_errmsg(db_.get())));
  }
  readTopics();
  readDefinitions();
  done_ = !begin();
}

SqliteBag::~SqliteBag() {
  rows_.reset();
  db_.reset();
  std::error_code ignored;
  if (!index_.empty()) std::filesystem::remove(index_, ignored);
}

/// `alone`: without the journals beside it, which a reader must not roll back.
void SqliteBag::open(bool alone) {
  rows_.reset();
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(uriOf(file_, alone).c_str(), &raw,
                                   SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  db_.reset(raw);
  if (code != SQLITE_OK)
    throw DataError(
        fmt::format("{}: {}", path_, raw != nullptr ? sqlite3_errmsg(raw) : "no memory"),
        ExitCode::kNoInput);
  sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, static_cast<int>(kMostInflated));
  sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  // A file that is cut off is read as far as it goes; without this sqlite refuses it.
  sqlite3_exec(raw, "PRAGMA writable_schema = ON; PRAGMA cell_size_check = ON", nullptr, nullptr,
               nullptr);
}

Statement SqliteBag::prepared(const char* sql) const {
  sqlite3_stmt* raw = nullptr;
  sqlite3_prepare_v2(db_.get(), sql, -1, &raw, nullptr);
  return {raw, &sqlite3_finalize};
}

bool SqliteBag::holds(const char* table) {
  const Statement row =
      prepared("SELECT 1 FROM sqlite_master WHERE type = 'table' AND lower(name) = ?");
  if (!row) return false;
  sqlite3_bind_text(row.get(), 1, table, -1, SQLITE_STATIC);
  return sqlite3_step(row.get()) == SQLITE_ROW;
}

std::string SqliteBag::text(sqlite3_stmt* row, int column) const {
  const auto* const bytes = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
  const int size = sqlite3_column_bytes(row, column);
  return bytes == nullptr ? "" : std::string(bytes, static_cast<std::size_t>(size));
}

void SqliteBag::readTopics() {
  const Statement row = prepared("SELECT id, name, type, serialization_format FROM topics");
  int code = SQLITE_ERROR;
  while (row && (code = sqlite3_step(row.get())) == SQLITE_ROW) {
    BagTopic& topic = topics_[sqlite3_column_int64(row.get(), 0)];
    topic.name = text(row.get(), 1);
    topic.type = shortType(text(row.get(), 2));
    topic.encoding = ros::Encoding::kCdr;
    const std::string encoding = text(row.get(), 3);
    topic.unknown_encoding = encoding == "cdr" ? "" : encoding;
  }
  if (code != SQLITE_DONE) fault(fmt::format("table topics: {}", sqlite3_errmsg(db_.get())));
}

void SqliteBag::readDefinitions() {
  if (!holds("message_definitions")) return;
  const Statement row = prepared(
      "SELECT topic_type, encoded_message_definition FROM message_definitions WHERE encoding = "
      "'ros2msg'");
  while (row && sqlite3_step(row.get()) == SQLITE_ROW) {
    const std::string type = shortType(text(row.get(), 0));
    for (auto& [id, topic] : topics_) {
      if (topic.type == type) topic.definition = text(row.get(), 1);
    }
  }
}

/// Rows behind the last one and the stride.
bool SqliteBag::begin() {
  rows_ = prepared(kRowsBehind);
  if (!rows_) {
    fault(fmt::format("table messages: {}", sqlite3_errmsg(db_.get())));
    return false;
  }
  constexpr auto kMost = std::numeric_limits<std::int64_t>::max();
  if (last_ >= 0 && stride_ > kMost - last_) return false;
  sqlite3_bind_int64(rows_.get(), 1, last_ + stride_);
  return true;
}

/// Looks for rows behind damage, twice as far each time.
bool SqliteBag::skipDamage() {
  if (damages_++ == 0) {
    fault(fmt::format("behind row {}: {}: rows there are left out",
                      std::max<std::int64_t>(last_, 0), sqlite3_errmsg(db_.get())));
  }
  if (last_ < 0) last_ = 0;
  constexpr std::int64_t kFarthest = std::int64_t{1} << 40;
  if (stride_ >= kFarthest) return false;
  stride_ = std::max<std::int64_t>(1, 2 * stride_);
  return begin();
}

bool SqliteBag::take(BagMessage& message) {
  sqlite3_stmt* const row = rows_.get();
  last_ = sqlite3_column_int64(row, 0);
  stride_ = 0;
  const auto topic = topics_.find(sqlite3_column_int64(row, 1));
  const auto* const bytes = static_cast<const char*>(sqlite3_column_blob(row, 3));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, 3));
  read_ += size;
  if (topic == topics_.end()) {
    if (orphans_++ == 0)
      fault(
          fmt::format("row {}: a message of topic {}, which is not declared: left out, and "
                      "others like it",
                      last_, sqlite3_column_int64(row, 1)));
    return false;
  }
  if (sqlite3_column_type(row, 2) != SQLITE_INTEGER || bytes == nullptr) {
    if (odd_++ == 0)
      fault(fmt::format("row {}: no bytes or no time: left out, and others like it", last_));
    return false;
  }
  message.topic = &topic->second;
  message.stamp.ns = sqlite3_column_int64(row, 2);
  message.bytes = {bytes, size};
  message.offset = static_cast<std::uint64_t>(last_);
  message.in_row = true;
  return true;
}

bool SqliteBag::nextStored(BagMessage& message) {
  while (!done_) {
    const int code = sqlite3_step(rows_.get());
    if (code == SQLITE_DONE) break;
    // Rows of a damaged tree may come again.
    const bool ahead = code == SQLITE_ROW && sqlite3_column_int64(rows_.get(), 0) > last_;
    if (!ahead && !skipDamage()) break;
    if (ahead && take(message)) return true;
  }
  done_ = true;
  return false;
}

}  // namespace

std::unique_ptr<ReadingBag> sqliteBag(const std::string& name, const std::string& path) {
  return std::make_unique<SqliteBag>(name, path);
}

}  // namespace perception
