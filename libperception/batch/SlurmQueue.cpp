#include "libperception/batch/SlurmQueue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "libperception/core/Error.h"
#include "libperception/core/system/ChildProcess.h"
#include "libperception/core/system/Supervision.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNameDigits = 12;
constexpr std::size_t kUsualArraySize = 1001;  // Slurm's default MaxArraySize
constexpr double kGraceMinutes = 2;            // of the job beyond the shard's own limit
constexpr double kCommandTimeout = 120;        // [s] of sbatch, squeue, scontrol

}  // namespace

std::string arrayRanges(const std::vector<std::size_t>& sorted) {
  std::string text;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t last = i;
    while (last + 1 < sorted.size() && sorted[last + 1] == sorted[last] + 1) ++last;
    text += fmt::format("{}{}", text.empty() ? "" : ",", sorted[i]);
    if (last > i) text += fmt::format("-{}", sorted[last]);
    i = last + 1;
  }
  return text;
}

std::string shellQuoted(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

SlurmQueue::SlurmQueue(const Batch& batch, std::string program, std::string dir)
    : batch_(batch),
      program_(std::move(program)),
      dir_(std::move(dir)),
      name_("perception-" + sha256OfText(dir_ + manifestText(batch)).substr(0, kNameDigits)) {}

std::string SlurmQueue::call(const std::vector<std::string>& words) const {
  createFolder(dir_ + "/log");
  ChildCommand command;
  command.output = partialPath(dir_ + "/log/" + words[0]);
  command.seconds = kCommandTimeout;
  command.words = words;
  const TemporaryPath removed_if_killed(command.output);
  ChildProcess process(command);
  process.wait();
  std::ifstream file(command.output, std::ios::binary);
  std::string said((std::istreambuf_iterator<char>(file)), {});
  std::error_code ignored;
  fs::remove(command.output, ignored);
  if (process.exitCode() == 0) return said;
  while (!said.empty() && said.back() == '\n') said.pop_back();
  throw Error(ExitCode::kUnavailable,
              fmt::format("{}: {}", command.words[0], said.empty() ? "cannot be run" : said));
}

std::size_t SlurmQueue::mostTasks() const {
  std::istringstream lines(call({"scontrol", "show", "config"}));
  lines.exceptions(std::ios::badbit);  // a lack of memory is no end
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("MaxArraySize", 0) != 0) continue;
    const auto number = line.find_first_of("0123456789");
    if (number != std::string::npos) return std::max(2UL, std::stoul(line.substr(number)));
  }
  return kUsualArraySize;
}

std::set<std::size_t> SlurmQueue::queued() const {
  std::istringstream lines(
      call({"squeue", "--noheader", "--array", "--name", name_, "--states",
            "PENDING,CONFIGURING,RUNNING,COMPLETING,SUSPENDED,REQUEUED", "--format", "%K %k %r"}));
  lines.exceptions(std::ios::badbit);
  std::set<std::size_t> places;
  std::size_t task = 0, offset = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    // A task that could not be launched is held for ever: it is as if it were lost.
    const bool held = line.find("requeued held") != std::string::npos;
    if (words >> task >> offset && !held) places.insert(offset + task);
  }
  return places;
}

std::vector<std::string> SlurmQueue::submit(const std::vector<std::size_t>& places,
                                            const std::vector<std::string>& options,
                                            int jobs) const {
  // Indices of an array are below MaxArraySize: larger places are counted from an offset.
  const std::size_t most = mostTasks();
  std::map<std::size_t, std::vector<std::size_t>> arrays;  // tasks by offset
  for (const std::size_t place : places) arrays[place / most * most].push_back(place % most);
  const auto sbatch = [&](std::vector<std::string> words, const std::string& arguments) {
    words.insert(words.begin(),
                 {"sbatch", "--parsable", "--chdir", batch_.folder, "--open-mode=append"});
    words.insert(words.end(), options.begin(), options.end());
    words.insert(words.end(), {"--wrap", "exec " + shellQuoted(program_) + " " + arguments});
    const std::string said = call(words);
    return said.substr(0, said.find_first_of(";\n"));
  };
  const double minutes = std::ceil(batch_.limits.longest() / 60) + kGraceMinutes;
  std::vector<std::string> ids;
  for (auto& [offset, tasks] : arrays) {
    std::sort(tasks.begin(), tasks.end());
    const std::string at_once = jobs > 0 ? fmt::format("%{}", jobs) : "";
    ids.push_back(sbatch(
        {"--requeue", "--array", arrayRanges(tasks) + at_once, "--job-name", name_, "--comment",
         fmt::format("{}", offset), "--time", fmt::format("{:g}", minutes), "--output",
         dir_ + "/log/slurm-%A_%a.log"},
        fmt::format("run -o {} --index $(({} + SLURM_ARRAY_TASK_ID))", shellQuoted(dir_), offset)));
  }
  ids.push_back(
      sbatch({"--dependency", fmt::format("afterany:{}", fmt::join(ids, ":")), "--job-name",
              name_ + "-reduce", "--output", dir_ + "/log/slurm-reduce.log"},
             "reduce -o " + shellQuoted(dir_)));
  return ids;
}

}  // namespace perception
