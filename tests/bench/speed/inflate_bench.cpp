// Inflating rawlogs: ISA-L, which RawlogReader uses, beside zlib. The same file in memory, the same
// bytes out, methods in turn, CPU clock of one thread.
//   inflate_bench [LOG.rawlog, default rawlogs/demo.rawlog]
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "libperception/sensors/rawlog/Inflater.h"

namespace perception::bench {
namespace {

constexpr std::size_t kBlock = 1 << 20;  // [bytes] of output at once, for both
constexpr int kRounds = 15;

std::string byOurs(const std::string& file) {
  const auto* data = reinterpret_cast<const unsigned char*>(file.data());
  const auto inflater = inflaterFor(data, file.size());
  Inflater::In in{data, file.size()};
  std::string all;
  std::vector<unsigned char> block(kBlock);
  for (;;) {
    Inflater::Out out{block.data(), block.size()};
    const auto step = inflater->step(in, out);
    all.append(reinterpret_cast<const char*>(block.data()), block.size() - out.size);
    if (step == Inflater::Step::kMemberEnd && in.size == 0) return all;
    if (step == Inflater::Step::kMemberEnd) inflater->reset();
    if (step == Inflater::Step::kBad || (in.size == 0 && out.size > 0)) std::abort();
  }
}

std::string byZlib(const std::string& file) {
  z_stream z{};
  inflateInit2(&z, 15 + 16);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(file.data()));
  z.avail_in = static_cast<uInt>(file.size());
  std::string all;
  std::vector<unsigned char> block(kBlock);
  for (;;) {
    z.next_out = block.data(), z.avail_out = kBlock;
    const int result = inflate(&z, Z_NO_FLUSH);
    all.append(reinterpret_cast<const char*>(block.data()), kBlock - z.avail_out);
    if (result == Z_STREAM_END && z.avail_in == 0) break;
    if (result == Z_STREAM_END) inflateReset(&z);
    if (result < 0) std::abort();
  }
  inflateEnd(&z);
  return all;
}

template <class Method>
double millisecondsOf(const Method& method, const std::string& file, std::string& out) {
  const std::clock_t begin = std::clock();
  out = method(file);
  return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

int run(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string file{std::istreambuf_iterator<char>(in), {}};
  std::vector<double> ours, zlib;
  std::string a, b;
  for (int round = 0; round < kRounds; ++round) {
    if (round % 2 == 0) ours.push_back(millisecondsOf(&byOurs, file, a));
    zlib.push_back(millisecondsOf(&byZlib, file, b));
    if (round % 2 == 1) ours.push_back(millisecondsOf(&byOurs, file, a));
    if (a != b) std::abort();
  }
  const double x = *std::min_element(ours.begin(), ours.end());
  const double y = *std::min_element(zlib.begin(), zlib.end());
  const double megabytes = static_cast<double>(a.size()) * 1e-6;
  fmt::print("{}: {:.1f} MB inflated, the same bytes; least of {}\n", path, megabytes, kRounds);
  fmt::print(
      "  ISA-L {:8.1f} ms  {:6.0f} MB/s\n  zlib  {:8.1f} ms  {:6.0f} MB/s  {:.2f} times ours\n", x,
      1e3 * megabytes / x, y, 1e3 * megabytes / y, y / x);
  return 0;
}

}  // namespace
}  // namespace perception::bench

int main(int argc, char** argv) {
  return perception::bench::run(argc > 1 ? argv[1] : PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog");
}
