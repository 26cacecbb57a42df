#include "libperception/core/Supervision.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
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

bool isAlive(pid_t process) { return process > 0 && (::kill(process, 0) == 0 || errno != ESRCH); }

std::string hostName() {
  char name[256] = {};
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "localhost";
}

std::string partialPath(const std::string& path) {
  const fs::path whole(path), folder = whole.parent_path();
  const std::string begin = fmt::format(".{}.{}.", whole.filename().string(), hostName());
  const std::string end = ".part";
  std::error_code error;
  for (fs::directory_iterator i(folder.empty() ? "." : folder, error), none; !error && i != none;
       i.increment(error)) {
    const std::string name = i->path().filename().string();
    if (name.size() <= begin.size() + end.size() || name.compare(0, begin.size(), begin) != 0 ||
        name.compare(name.size() - end.size(), end.size(), end) != 0)
      continue;
    const auto process = static_cast<pid_t>(std::strtol(name.c_str() + begin.size(), nullptr, 10));
    std::error_code ignored;
    if (process > 0 && !isAlive(process)) fs::remove(i->path(), ignored);
  }
  return (folder / fmt::format("{}{}{}", begin, ::getpid(), end)).string();
}

}  // namespace perception
