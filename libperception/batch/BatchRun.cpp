#include "libperception/batch/BatchRun.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <thread>

#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr double kBytesOfGigabyte = 1e9;
constexpr int kNoProgram = 127;

std::string logFile(const std::string& dir, const Shard& shard) {
  return fmt::format("{}/log/{}.log", dir, shard.id);
}

/// The last error that a program said, or its last line, without the program's name.
std::string lastWords(const std::string& log) {
  std::ifstream file(log, std::ios::binary);
  std::string last, error;
  const std::string mark = ": error: ";
  for (std::string line; std::getline(file, line);) {
    if (line.find_first_not_of(" \r\t") == std::string::npos) continue;
    const auto at = line.find(mark);
    if (at != std::string::npos) error = line.substr(at + mark.size());
    last = line;
  }
  return error.empty() ? last : error;
}

/// Code and reason of a process that did not do its work.
std::pair<ExitCode, std::string> failureOf(const ChildProcess& process, const ShardLimits& limits,
                                           const std::string& program, const std::string& said) {
  // It waited for something: by itself it would have used up its processor time before.
  if (process.wasOutOfTime())
    return {ExitCode::kUnavailable, fmt::format("did not end within {:g} s", limits.longest())};
  // From outside, or of a machine out of memory: no fault of the shard.
  const int signal = process.signal();
  if (process.wasStopped() || signal == SIGTERM || signal == SIGINT || signal == SIGKILL)
    return {ExitCode::kTryAgain, "stopped or killed from outside"};
  if (signal == SIGXCPU) {
    return {ExitCode::kBadInput,
            fmt::format("took more than {:g} s of processor time", limits.time)};
  }
  if (signal != 0) {
    return {ExitCode::kInternal,
            fmt::format("ended by signal {} ({})", signal, ::strsignal(signal))};
  }
  if (process.exitCode() == kNoProgram)
    return {ExitCode::kUnavailable, program + ": cannot be run"};
  if (isExitCode(process.exitCode())) return {static_cast<ExitCode>(process.exitCode()), said};
  return {ExitCode::kInternal, fmt::format("ended with code {}: {}", process.exitCode(), said)};
}

}  // namespace

struct BatchRun::Job {
  std::size_t place;
  std::string log;  ///< temporary name
  std::unique_ptr<TemporaryPath> removed_if_killed;
  std::unique_ptr<ChildProcess> process;
};

BatchRun::BatchRun(const Batch& batch, std::string dir, BatchRunOptions options)
    : batch_(batch), dir_(std::move(dir)), options_(std::move(options)) {}

BatchRun::~BatchRun() {
  for (Job& job : jobs_) job.process->stop();  // all at once, then each waits for its own
}

std::vector<std::size_t> BatchRun::pending(const std::vector<std::size_t>& places) const {
  std::vector<std::size_t> out;
  std::map<std::string, std::string> checked;  // configurations by arguments
  for (const std::size_t place : places) {
    const Shard& shard = batch_.shards.at(place);
    const ShardStatus status = statusOf(shard, dir_);
    if (status.hasResult()) continue;
    if (status.state == ShardState::kStale && !options_.overwrite) {
      throw Error(ExitCode::kBadConfig, fmt::format("{}; --overwrite replaces it", status.reason));
    }
    if (status.state == ShardState::kFailed && !options_.retry && !isWorthRetry(status.code))
      continue;
    Shard settings = shard;
    settings.input.clear();
    std::string& sha = checked[fmt::format("{}", fmt::join(trackArguments(settings), "\n"))];
    if (sha.empty()) sha = configurationHash(effectiveIniOf(shard), batch_.version);
    if (sha != shard.config_sha) {
      throw Error(ExitCode::kBadConfig,
                  fmt::format("{}: has changed since the batch was planned; plan again with "
                              "--overwrite",
                              shard.config));
    }
    out.push_back(place);
  }
  std::stable_sort(out.begin(), out.end(), [&](std::size_t a, std::size_t b) {
    return batch_.shards[a].bytes > batch_.shards[b].bytes;
  });
  return out;
}

void BatchRun::start(std::size_t place) {
  const Shard& shard = batch_.shards.at(place);
  ChildCommand command;
  command.words = trackArguments(shard);
  command.words.insert(command.words.begin(), options_.program);
  command.words.insert(command.words.end(), {"-o", dir_ + "/" + shard.id, "--threads",
                                             fmt::format("{}", options_.threads)});
  if (options_.overwrite) command.words.emplace_back("--overwrite");
  command.memory = static_cast<std::uint64_t>(batch_.limits.memory * kBytesOfGigabyte);
  command.processor_seconds = static_cast<std::uint64_t>(batch_.limits.time);
  command.seconds = batch_.limits.longest();
  Job job;
  job.place = place;
  // Named by shard and process: another machine may run the same one.
  command.output = job.log = partialPath(logFile(dir_, shard));
  job.removed_if_killed = std::make_unique<TemporaryPath>(job.log);
  job.process = std::make_unique<ChildProcess>(command);
  jobs_.push_back(std::move(job));
}

ShardStatus BatchRun::statusAfter(const Job& job) const {
  const Shard& shard = batch_.shards.at(job.place);
  const ChildProcess& process = *job.process;
  ShardStatus status = statusOf(shard, dir_);
  if (status.hasResult()) return status;
  const std::string said = lastWords(job.log);
  std::tie(status.code, status.reason) = failureOf(process, batch_.limits, options_.program, said);
  if (status.code == ExitCode::kTryAgain) {
    status.state = ShardState::kMissing;
    return status;
  }
  if (status.code == ExitCode::kOk || status.code == ExitCode::kDataWarnings) {
    status.code = ExitCode::kBadConfig;
    status.reason = shard.input + ": log or configuration has changed since the batch was planned";
  }
  status.state = ShardState::kFailed;
  return status;
}

void BatchRun::collect(const Report& report) {
  for (auto job = jobs_.begin(); job != jobs_.end();) {
    if (job->process->running()) {
      ++job;
      continue;
    }
    const Shard& shard = batch_.shards.at(job->place);
    const ShardStatus status = statusAfter(*job);
    if (status.hasResult()) removeFailure(shard, dir_);
    if (status.state == ShardState::kFailed) writeFailure(shard, dir_, status.code, status.reason);
    std::error_code ignored;
    fs::rename(job->log, logFile(dir_, shard), ignored);
    report(shard, status, job->process->seconds());
    job = jobs_.erase(job);
  }
}

void BatchRun::run(const std::vector<std::size_t>& places, const Report& report) {
  constexpr auto kLook = std::chrono::milliseconds(10);
  createFolder(dir_ + "/log");
  auto next = places.begin();
  while (next != places.end() || !jobs_.empty()) {
    while (next != places.end() && jobs_.size() < static_cast<std::size_t>(options_.jobs))
      start(*next++);
    std::this_thread::sleep_for(kLook);
    collect(report);
    if (!stopAsked()) continue;
    next = places.end();
    for (Job& job : jobs_) job.process->stop();
  }
  stopIfAsked();
}

}  // namespace perception
