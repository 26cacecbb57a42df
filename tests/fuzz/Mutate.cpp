// Parsers on changed seeds, without a fuzzer: perception_mutate INPUTS SEED [NAME...]. Prints for
// each parser the number of inputs, the longest and the memory. An input that crashes it, takes
// more than a second of processor time or makes it throw something else than an Error stays as
// NAME-crash in the working folder, and the program ends with 1. The memory of the process is
// limited.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "libperception/core/system/MemoryLimit.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "tests/fuzz/Parsers.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongest = 40000;        // [bytes] of an input
constexpr std::uint64_t kMemory = 1ULL << 30;  // [bytes] of address space; half of it are libraries

std::string input, name;  // at work

/// Leaves the input behind; the file is small, and a handler has nothing better.
[[noreturn]] void leave(const char* why) {
  std::signal(SIGABRT, SIG_DFL);
  std::ofstream(name + "-crash", std::ios::binary) << input;
  fmt::print(stderr, "{}: {}, see {}-crash\n", name, why, name);
  std::_Exit(1);
}

extern "C" void onSignal(int number) {
  leave(number == SIGVTALRM ? "takes more than a second" : "crashes");
}

void setTimer(int seconds) {
  const itimerval timer{{0, 0}, {seconds, 0}};
  ::setitimer(ITIMER_VIRTUAL, &timer, nullptr);
}

std::vector<std::string> seedsOf(const char* parser) {
  std::vector<std::string> seeds = {std::string(16, '\0')};
  std::error_code none;
  for (const auto& entry :
       fs::directory_iterator(fs::path(PERCEPTION_SOURCE_DIR "/tests/fuzz/seeds") / parser, none)) {
    std::ifstream file(entry.path(), std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

/// One of the changes that damage and carelessness make.
void change(std::string& bytes, const std::vector<std::string>& seeds, std::mt19937_64& random) {
  static const char* const kNumbers[] = {"-1", "0",   "1e300",      "nan",         "-inf", "1e-320",
                                         "",   "1,5", "4294967296", "99999999999", "+1",   "0x7f"};
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  const std::size_t at = below(bytes.size() + 1), length = below(bytes.size() - at + 1);
  switch (below(8)) {
    case 0:
      if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
      break;
    case 1:
      if (at < bytes.size()) bytes[at] = static_cast<char>(below(256));
      break;
    case 2:
      bytes.erase(at, length);
      break;
    case 3:
      bytes.insert(at, bytes.substr(below(bytes.size() + 1), below(200)));
      break;
    case 4: {
      const std::string& other = seeds[below(seeds.size())];
      bytes.insert(at, other.substr(below(other.size() + 1), below(200)));
      break;
    }
    case 5: {  // the number there
      const std::string digits = "+-.0123456789eE";
      const std::size_t first = bytes.find_first_of(digits, at);
      if (first == std::string::npos) break;
      const std::size_t end = std::min(bytes.find_first_not_of(digits, first), bytes.size());
      bytes.replace(first, end - first, kNumbers[below(std::size(kNumbers))]);
      break;
    }
    case 6:
      bytes.insert(at, std::string(below(8) + 1, static_cast<char>(below(256))));
      break;
    default:
      if (at + 4 <= bytes.size()) {
        const std::uint32_t sizes[] = {0, 1, 0x7fffffffU, 0x80000000U, 0xffffffffU};
        bytes.replace(at, 4, reinterpret_cast<const char*>(&sizes[below(5)]), 4);
      }
  }
  if (bytes.size() > kLongest) bytes.resize(kLongest);
}

void tryOut(const Parser& parser, std::uint64_t inputs, std::uint64_t seed) {
  const std::vector<std::string> seeds = seedsOf(parser.name);
  std::mt19937_64 random(seed);
  name = parser.name;
  double longest = 0;  // [s]
  const std::clock_t begin = std::clock();
  for (std::uint64_t i = 0; i < inputs; ++i) {
    input = seeds[random() % seeds.size()];
    for (auto changes = 1 + random() % 8; changes > 0; --changes) change(input, seeds, random);
    setTimer(2);  // at least one second: it is counted in ticks
    const std::clock_t start = std::clock();
    try {
      parse(parser, input);
    } catch (const std::exception& error) {
      leave(error.what());
    }
    longest = std::max(longest, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  setTimer(0);
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  fmt::print("{:<18} {:>8} inputs {:7.1f} s, longest {:6.1f} ms, at most {:4} MB so far\n", name,
             inputs, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, longest * 1e3,
             usage.ru_maxrss / 1000);
  std::fflush(stdout);
}

int mutate(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("usage: perception_mutate INPUTS SEED [NAME...]\n", stderr);
    return 64;
  }
  registerPerceptionClasses();
  for (const int number : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGVTALRM})
    std::signal(number, &onSignal);
  if (MemoryLimit::supported()) {  // sanitizers have max_allocation_size_mb
    const rlimit limit{kMemory, kMemory};
    ::setrlimit(RLIMIT_AS, &limit);
  }
  const std::vector<std::string> names(argv + 3, argv + argc);
  for (const std::string& name : names) {
    if (std::any_of(parsers().begin(), parsers().end(),
                    [&](const Parser& parser) { return name == parser.name; }))
      continue;
    fmt::print(stderr, "perception_mutate: no parser {}\n", name);
    return 64;
  }
  for (const Parser& parser : parsers()) {
    if (names.empty() || std::find(names.begin(), names.end(), parser.name) != names.end())
      tryOut(parser, std::strtoull(argv[1], nullptr, 10), std::strtoull(argv[2], nullptr, 10));
  }
  return 0;
}

}  // namespace
}  // namespace perception

int main(int argc, char** argv) { return perception::mutate(argc, argv); }
