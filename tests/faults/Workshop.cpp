#include "tests/faults/Workshop.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"

namespace perception::test {
namespace {

namespace fs = std::filesystem;

constexpr double kHung = 60;  // [s] a job takes less than one

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string textOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

/// LD_PRELOAD takes no path with a space: of a build in such a folder it gets a copy.
std::string preloadable() {
  static const TemporaryFolder folder;
  const std::filesystem::path built = PERCEPTION_FAILING_CALLS;
  if (built.string().find(' ') == std::string::npos) return built.string();
  const std::filesystem::path copy = std::filesystem::path(folder.path()) / built.filename();
  std::filesystem::copy_file(built, copy);
  return copy.string();
}
const std::string kFailingCalls = preloadable();

/// In the child, between fork and exec.
[[noreturn]] void become(const std::vector<std::string>& words, const std::string& said,
                         const FailingCall& failing) {
  const int out = ::open("/dev/null", O_WRONLY);
  const int err = ::open(said.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  if (!failing.kind.empty()) {
    ::setenv("LD_PRELOAD", kFailingCalls.c_str(), 1);
    ::setenv("FAILING_CALLS", failing.kind.c_str(), 1);
    ::setenv("FAILING_AT", std::to_string(failing.at).c_str(), 1);
    ::setenv("FAILING_MODE", failing.on ? "on" : "once", 1);
    if (!failing.report.empty()) ::setenv("FAILING_REPORT", failing.report.c_str(), 1);
    if (!failing.places.empty()) ::setenv("FAILING_PLACES", failing.places.c_str(), 1);
  }
  std::vector<char*> argv;
  for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

/// True before and while the dynamic loader is at work: the process is still a copy of this one, or
/// SIGTERM has its default action and is not held back.
bool isLoading(pid_t process) {
  std::error_code none;
  if (fs::read_symlink(fmt::format("/proc/{}/exe", process), none) ==
      fs::read_symlink("/proc/self/exe", none))
    return true;
  std::ifstream file(fmt::format("/proc/{}/status", process));
  std::uint64_t heard = 0;
  for (std::string line; std::getline(file, line);)
    if (line.rfind("SigBlk:", 0) == 0 || line.rfind("SigCgt:", 0) == 0)
      heard |= std::stoull(line.substr(7), nullptr, 16);
  return (heard >> (SIGTERM - 1) & 1U) == 0;
}

/// Of a file that differs from run to run: it must at least be whole.
bool isWholeJson(const std::string& text) { return nlohmann::json::accept(text); }

}  // namespace

bool isWhole() {
  const char* const asked = std::getenv("PERCEPTION_FAULTS");
  return asked != nullptr && std::string(asked) == "all";
}

Contents contentsOf(const std::string& folder) {
  Contents out;
  std::error_code none;
  for (const auto& entry : fs::recursive_directory_iterator(folder, none)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (entry.is_regular_file()) out[name] = textOf(entry.path().string());
  }
  return out;
}

std::string faultIn(const std::string& out, const Job& job, const Contents& whole, bool complete,
                    bool leftovers) {
  const Contents there = contentsOf(out);
  for (const auto& [name, text] : there) {
    const auto expected = whole.find(name);
    if (expected == whole.end()) {
      if (!leftovers) return name + " is left over";
    } else if (job.varying.count(name) != 0 ? !isWholeJson(text) : text != expected->second) {
      return fmt::format("{} is not whole: {} bytes of {}", name, text.size(),
                         expected->second.size());
    }
  }
  for (const auto& [name, text] : whole)
    if (complete && there.count(name) == 0) return name + " is missing";
  // The truth of a log comes before it, the record of a run after all others.
  if (there.count("log.rawlog") != 0 && whole.count("log.truth.csv") > there.count("log.truth.csv"))
    return "a log without its truth";
  for (const std::string last : {"run/done.json", "evaluation/report.json"}) {
    if (there.count(last) == 0) continue;
    for (const auto& [name, text] : whole)
      if (there.count(name) == 0) return last + " is there without " + name;
  }
  return "";
}

Workshop::Workshop() {
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // who loses its parent is waited for here
  const std::string ini = PERCEPTION_SOURCE_DIR "/ini/demo.ini";
  jobs_ = {
      {"track",
       {"perception-track", "-c", ini, "-i", "{in}/log.rawlog", "-o", "{out}/run", "--threads", "1",
        "--measurements"},
       0,
       {"run/timing.json"}},
      {"import",
       {"perception-import", "udacity", "--measurements", "{in}/udacity.txt", "-o",
        "{out}/log.rawlog"},
       0,
       {}},
      {"evaluate",
       {"perception-evaluate", "-r", "{in}/run", "-t",
        PERCEPTION_SOURCE_DIR "/rawlogs/demo.truth.csv", "--any-truth", "-o", "{out}/evaluation",
        "--no-plots"},
       0,
       {}},
      {"report", {"perception-report", "-r", "{in}/run", "-o", "{out}/index.html"}, 0, {}},
      {"export",
       {"perception-export", "-r", "{in}/run", "-i", "{in}/log.rawlog", "-o", "{out}/log.mcap"},
       0,
       {}},
      {"snapshot",
       {"perception-snapshot", "-r", "{in}/run", "-i", "{in}/log.rawlog", "--time", "0.1", "-o",
        "{out}/scene.png", "--scene", "{out}/scene.3Dscene", "--grid", "{out}/grid.bt", "--grid",
        "{out}/grid.gridmap.gz", "--grid", "{out}/grid.png"},
       0,
       {}},
  };
  makeInputs();
}

void Workshop::makeInputs() {
  registerPerceptionClasses();
  const std::string in = folder_ / "in";
  fs::create_directories(in);
  {
    RawlogReader reader(PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog");
    RawlogWriter writer(in + "/log.rawlog");
    std::optional<Stamp> first;
    while (const auto o = reader.next()) {
      const auto stamp = toStamp(o->timestamp);
      if (!first) first = stamp;
      if (stamp && *stamp - *first > 0.15) break;  // two scans of each sensor
      writer.write(*o);
    }
    writer.close();
  }
  put(in + "/udacity.txt",
      "L\t1.5\t2.5\t1477010443000000\t1\t2\t3\t4\n"
      "R\t5\t0.5\t-1\t1477010443050000\t1.1\t2.1\t3\t4\t0.9\t0.1\n");
  const Ending tracked = run(job("track"), in);
  if (tracked.code != 0) throw std::runtime_error("no run to start from: " + tracked.said);
}

const Job& Workshop::job(const std::string& name) const {
  return *std::find_if(jobs_.begin(), jobs_.end(), [&](const Job& j) { return j.name == name; });
}

const Contents& Workshop::results(const Job& job) {
  const auto known = results_.find(job.name);
  if (known != results_.end()) return known->second;
  const TemporaryFolder out;
  const Ending ending = run(job, out.path());
  if (ending.code != job.code)
    throw std::runtime_error(
        fmt::format("{} ends with {}: {}", job.name, ending.code, ending.said));
  return results_[job.name] = contentsOf(out.path());
}

Ending Workshop::run(const Job& job, const std::string& out, const FailingCall& failing,
                     const Blow& blow) const {
  std::vector<std::string> words;
  for (const auto& word : job.words)
    words.push_back(replaced(replaced(word, "{in}", folder_ / "in"), "{out}", out));
  words[0] = std::string(PERCEPTION_BINARY_DIR "/bin/") + words[0];
  const std::string said = folder_ / "said";
  const double start = now();
  const pid_t process = ::fork();
  if (process == 0) become(words, said, failing);
  Ending ending;
  bool struck = blow.signal == 0, ended = false;
  while (true) {
    int status = 0;
    const pid_t who = ::waitpid(-1, &status, WNOHANG);
    if (who < 0) break;  // no process is left
    if (who == process) {
      ended = true;
      ending.seconds = now() - start;
      if (WIFEXITED(status)) ending.code = WEXITSTATUS(status);
      if (WIFSIGNALED(status)) ending.signal = WTERMSIG(status);
    }
    if (!struck && now() - start >= blow.after && (!blow.once_loaded || !isLoading(process))) {
      struck = true;
      ending.loading = !ended && isLoading(process);
      if (!ended) ::kill(process, blow.signal);
    }
    if (!ended && now() - start > kHung) {
      ending.hung = true;
      ::kill(process, SIGKILL);
    }
    if (who == 0) std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  ending.said = textOf(said);
  return ending;
}

long Workshop::calls(const Job& job, const std::string& kind) const {
  const TemporaryFolder out;
  FailingCall counted;
  counted.kind = kind;
  counted.report = folder_ / "calls";
  fs::remove(counted.report);
  run(job, out.path(), counted);
  std::ifstream file(counted.report);
  long most = 0;
  for (long number = 0; file >> number;) most = std::max(most, number);
  return most;
}

std::vector<long> Workshop::firstCalls(const Job& job, const std::string& kind) const {
  const TemporaryFolder out;
  FailingCall counted;
  counted.kind = kind;
  counted.places = folder_ / "places";
  fs::remove(counted.places);
  run(job, out.path(), counted);
  std::ifstream file(counted.places);
  std::set<long> numbers;
  for (long number = 0; file >> number;) numbers.insert(number);
  return {numbers.begin(), numbers.end()};
}

Workshop& workshop() {
  static Workshop made;
  return made;
}

}  // namespace perception::test
