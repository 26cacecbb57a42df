#include "libperception/core/system/Supervision.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <system_error>

namespace perception {
namespace {

namespace fs = std::filesystem;

SupervisionRecord* shared = nullptr;
std::mutex places;

template <std::size_t N>
void put(std::array<char, N>& to, const std::string& text) {
  const std::size_t size = std::min(text.size(), N - 1);
  std::memcpy(to.data(), text.data(), size);
  to[size] = '\0';
}

constexpr char kPartialEnd[] = ".part";

/// Partial files of killed processes of this host, ".NAME.HOST.PID.part"; once for each folder.
void removeLeftovers(const fs::path& folder) {
  static std::set<std::string> done;
  const std::lock_guard<std::mutex> lock(places);
  std::error_code error;
  if (!done.insert(fs::absolute(folder, error).lexically_normal().string()).second) return;
  const std::string host = "." + hostName() + ".", end = kPartialEnd;
  for (fs::directory_iterator i(folder, error), none; !error && i != none; i.increment(error)) {
    const std::string name = i->path().filename().string();
    if (name.size() <= end.size() || name[0] != '.') continue;
    const std::size_t tail = name.size() - end.size(), at = name.rfind(host);
    if (name.compare(tail, end.size(), end) != 0 || at == std::string::npos) continue;
    char* stop = nullptr;
    const auto process =
        static_cast<pid_t>(std::strtol(name.c_str() + at + host.size(), &stop, 10));
    std::error_code ignored;
    if (stop == name.c_str() + tail && process > 0 && !isAlive(process))
      fs::remove(i->path(), ignored);
  }
}

}  // namespace

SupervisionRecord& SupervisionRecord::ofThisProcess() {
  static SupervisionRecord own;
  return shared != nullptr ? *shared : own;
}

void SupervisionRecord::set(SupervisionRecord* record) { shared = record; }

ReadingScope::ReadingScope(const std::string& path, std::uint64_t position) {
  auto& record = SupervisionRecord::ofThisProcess();
  outer_ = record.reading % 2 == 0;
  if (!outer_) return;
  put(record.read_from, path);
  record.position = position;
  ++record.reading;
}

ReadingScope::~ReadingScope() {
  if (outer_) ++SupervisionRecord::ofThisProcess().reading;
}

TemporaryPath::TemporaryPath(const std::string& path) : place_(SupervisionRecord::kMostPaths) {
  if (path.empty()) return;
  std::error_code error;
  const std::string whole = fs::absolute(path, error).string();
  auto& all = SupervisionRecord::ofThisProcess().temporaries;
  const std::lock_guard<std::mutex> lock(places);
  const auto free = std::find_if(all.begin(), all.end(), [](const auto& p) { return p[0] == 0; });
  if (error || free == all.end() || whole.size() >= SupervisionRecord::kLongestPath) return;
  put(*free, whole);
  place_ = static_cast<std::size_t>(free - all.begin());
}

TemporaryPath::~TemporaryPath() {
  const std::lock_guard<std::mutex> lock(places);
  if (place_ < SupervisionRecord::kMostPaths)
    SupervisionRecord::ofThisProcess().temporaries[place_][0] = '\0';
}

bool TemporaryPath::holds(const std::string& path) {
  std::error_code error;
  const std::string whole = fs::absolute(path, error).string();
  const std::lock_guard<std::mutex> lock(places);
  const auto& all = SupervisionRecord::ofThisProcess().temporaries;
  return !error && std::any_of(all.begin(), all.end(), [&](const auto& p) {
    const std::string folder(p.data());
    return !folder.empty() && whole.compare(0, folder.size() + 1, folder + "/") == 0;
  });
}

bool isAlive(pid_t process) {
  if (process <= 0 || (::kill(process, 0) != 0 && errno == ESRCH)) return false;
  // A zombie that is not reaped (a container without init) keeps its number.
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string stat;
  std::getline(file, stat);
  const auto name_end = stat.rfind(')');
  return name_end == std::string::npos || name_end + 2 >= stat.size() ||
         (stat[name_end + 2] != 'Z' && stat[name_end + 2] != 'X');
}

std::string hostName() {
  char name[256] = {};
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "localhost";
}

std::string partialPath(const std::string& path) {
  const fs::path whole(path), folder = whole.parent_path();
  removeLeftovers(folder.empty() ? "." : folder);
  return (folder / fmt::format(".{}.{}.{}{}", whole.filename().string(), hostName(), ::getpid(),
                               kPartialEnd))
      .string();
}

}  // namespace perception
