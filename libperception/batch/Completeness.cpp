#include "libperception/batch/Completeness.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

std::string failureFile(const Shard& shard, const std::string& dir) {
  return fmt::format("{}/failed/{}.json", dir, shard.id);
}

std::optional<ShardStatus> failureOf(const Shard& shard, const std::string& dir) {
  std::ifstream file(failureFile(shard, dir), std::ios::binary);
  if (!file) return std::nullopt;
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object() || json.value("hash", "") != shard.runHash()) return std::nullopt;
  ShardStatus status;
  status.state = ShardState::kFailed;
  status.code = static_cast<ExitCode>(json.value("code", static_cast<int>(ExitCode::kInternal)));
  status.reason = json.value("reason", "");
  return status;
}

}  // namespace

std::string shortened(const std::string& reason) {
  constexpr std::size_t kLongest = 160;
  return reason.size() > kLongest ? reason.substr(0, kLongest) + " ..." : reason;
}

const char* nameOf(ShardState state) {
  constexpr const char* kNames[kShardStates] = {"done", "warnings", "failed", "missing", "stale"};
  return kNames[static_cast<int>(state)];
}

ShardStatus statusOf(const Shard& shard, const std::string& dir) {
  ShardStatus status;
  const std::string done = fmt::format("{}/{}/done.json", dir, shard.id);
  std::error_code ignored;
  if (!fs::exists(done, ignored)) return failureOf(shard, dir).value_or(status);
  status.state = ShardState::kStale;
  try {
    RunRecord record = readRunRecord(done);
    if (record.hash != shard.runHash()) {
      status.reason = fmt::format("{} holds the run of another log, configuration or version ({})",
                                  done, record.version);
      return status;
    }
    status.state = record.warnings.empty() ? ShardState::kDone : ShardState::kWarnings;
    status.record = std::move(record);
  } catch (const DataError& error) {
    status.reason = error.what();
  }
  return status;
}

bool isWorthRetry(ExitCode code) {
  switch (code) {
    case ExitCode::kNoInput:
    case ExitCode::kUnavailable:
    case ExitCode::kCannotCreate:
    case ExitCode::kIoError:
    case ExitCode::kTryAgain:
      return true;
    default:
      return false;
  }
}

void writeFailure(const Shard& shard, const std::string& dir, ExitCode code,
                  const std::string& reason) {
  const nlohmann::ordered_json json = {{"id", shard.id},
                                       {"hash", shard.runHash()},
                                       {"code", static_cast<int>(code)},
                                       {"reason", reason}};
  createFolder(dir + "/failed");
  writeFile(failureFile(shard, dir),
            json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void removeFailure(const Shard& shard, const std::string& dir) {
  std::error_code ignored;
  fs::remove(failureFile(shard, dir), ignored);
}

std::size_t Completeness::count(ShardState state) const {
  return static_cast<std::size_t>(std::count_if(
      shards.begin(), shards.end(), [&](const ShardStatus& s) { return s.state == state; }));
}

bool Completeness::complete() const {
  return std::all_of(shards.begin(), shards.end(),
                     [](const ShardStatus& s) { return s.hasResult(); });
}

bool Completeness::clean() const { return count(ShardState::kDone) == shards.size(); }

Completeness completenessOf(const Batch& batch, const std::string& dir) {
  Completeness completeness;
  for (const Shard& shard : batch.shards) completeness.shards.push_back(statusOf(shard, dir));
  return completeness;
}

std::string completenessTable(const Batch& batch, const Completeness& completeness) {
  constexpr std::size_t kMostListed = 20;
  std::size_t listed = 0;
  std::string text = fmt::format("{} shards", batch.shards.size());
  for (int s = 0; s < kShardStates; ++s) {
    const auto state = static_cast<ShardState>(s);
    if (const auto n = completeness.count(state); n > 0)
      text += fmt::format(", {} {}", n, nameOf(state));
  }
  text += '\n';
  for (std::size_t i = 0; i < batch.shards.size(); ++i) {
    const ShardStatus& status = completeness.shards[i];
    if (status.reason.empty()) continue;
    if (++listed > kMostListed) continue;
    text += fmt::format("{} {} {}: {}{}\n", batch.shards[i].id, batch.shards[i].input,
                        nameOf(status.state),
                        status.state == ShardState::kFailed
                            ? fmt::format("code {}: ", static_cast<int>(status.code))
                            : "",
                        shortened(status.reason));
  }
  if (listed > kMostListed) text += fmt::format("and {} more\n", listed - kMostListed);
  return text;
}

}  // namespace perception
