#include "libperception/batch/BatchDatabase.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <memory>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr const char* kSchema = R"sql(
CREATE TABLE figures (shard TEXT REFERENCES shards (id), name TEXT, value REAL,
  PRIMARY KEY (shard, name)) WITHOUT ROWID;
CREATE VIEW conditions AS
  SELECT config, sensors, particles, name, count(*) AS shards, avg(value) AS mean,
    min(value) AS least, max(value) AS largest
  FROM figures JOIN shards ON shards.id = figures.shard
  GROUP BY config, sensors, particles, name;
BEGIN;
)sql";

class Database {
 public:
  explicit Database(const std::string& path) : path_(path) {
    sqlite3* raw = nullptr;
    const int code = sqlite3_open(path.c_str(), &raw);
    db_.reset(raw);
    if (code != SQLITE_OK) fail();
  }
  sqlite3* get() const { return db_.get(); }
  void execute(const char* sql) const {
    if (sqlite3_exec(get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }
  [[noreturn]] void fail() const {
    throw OutputError(fmt::format("{}: cannot be written: {}", path_,
                                  db_ ? sqlite3_errmsg(get()) : "out of memory"),
                      ExitCode::kIoError);
  }

 private:
  std::string path_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> db_{nullptr, &sqlite3_close};
};

/// A statement whose parameters are bound one after the other.
class Insert {
 public:
  Insert(const Database& db, const char* sql) : db_(db) {
    sqlite3_stmt* raw = nullptr;
    if (sqlite3_prepare_v2(db.get(), sql, -1, &raw, nullptr) != SQLITE_OK) db.fail();
    statement_.reset(raw);
  }
  Insert& text(const std::string& value) {
    return checked(sqlite3_bind_text(statement_.get(), ++bound_, value.c_str(),
                                     static_cast<int>(value.size()), SQLITE_TRANSIENT));
  }
  Insert& real(double value) {
    return checked(sqlite3_bind_double(statement_.get(), ++bound_, value));
  }
  Insert& null() { return checked(sqlite3_bind_null(statement_.get(), ++bound_)); }
  void row() {
    if (sqlite3_step(statement_.get()) != SQLITE_DONE) db_.fail();
    sqlite3_reset(statement_.get());
    bound_ = 0;
  }

 private:
  Insert& checked(int code) {
    if (code != SQLITE_OK) db_.fail();
    return *this;
  }
  const Database& db_;
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement_{nullptr, &sqlite3_finalize};
  int bound_ = 0;
};

/// "CREATE TABLE shards (id TEXT PRIMARY KEY, ...": numbers given as text become numbers there.
std::string shardsTable() {
  std::string columns;
  for (const ShardColumn& column : shardColumns()) {
    columns += columns.empty() ? fmt::format("{} {} PRIMARY KEY", column.name, column.type)
                               : fmt::format(", {} {}", column.name, column.type);
  }
  return fmt::format("CREATE TABLE shards ({}) WITHOUT ROWID", columns);
}

std::string insertIntoShards() {
  std::string places = "?";
  for (std::size_t i = 1; i < shardColumns().size(); ++i) places += ",?";
  return fmt::format("INSERT INTO shards VALUES ({})", places);
}

}  // namespace

void writeDatabase(const BatchResults& results, const std::string& path) {
  const Database db(path);
  db.execute("PRAGMA journal_mode = OFF");
  db.execute(shardsTable().c_str());
  db.execute(kSchema);
  {
    Insert shards(db, insertIntoShards().c_str());
    Insert figures(db, "INSERT INTO figures VALUES (?,?,?)");
    for (const ShardResult& result : results.shards) {
      for (const ShardColumn& column : shardColumns()) {
        const std::string text = column.text(result);
        text.empty() ? shards.null() : shards.text(text);
      }
      shards.row();
      for (const auto& [name, value] : result.figures)
        figures.text(result.shard.id).text(name).real(value).row();
    }
  }
  db.execute("COMMIT");
}

}  // namespace perception
