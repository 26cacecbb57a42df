#include "libperception/sensors/Inflater.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace perception {
namespace {

class GzipInflater final : public Inflater {
 public:
  GzipInflater() { inflateInit2(&z_, kWindow); }
  ~GzipInflater() override { inflateEnd(&z_); }
  const char* name() const override { return "gzip"; }
  bool begins(unsigned char byte) const override { return byte == 0x1f; }
  void reset() override { inflateReset2(&z_, kWindow); }
  Step step(In& in, Out& out) override {
    const auto sized = [](std::size_t size) {
      return static_cast<uInt>(std::min<std::size_t>(size, std::numeric_limits<uInt>::max()));
    };
    z_.next_in = const_cast<unsigned char*>(in.data);  // zlib does not write to it
    const uInt given = z_.avail_in = sized(in.size);
    z_.next_out = out.data;
    const uInt room = z_.avail_out = sized(out.size);
    const int result = inflate(&z_, Z_NO_FLUSH);
    in = {in.data + (given - z_.avail_in), in.size - (given - z_.avail_in)};
    out = {out.data + (room - z_.avail_out), out.size - (room - z_.avail_out)};
    if (result == Z_STREAM_END) return Step::kMemberEnd;
    if (result == Z_OK || result == Z_BUF_ERROR) return Step::kMore;
    fault_ = z_.msg != nullptr ? z_.msg : "zlib error";
    return Step::kBad;
  }

 private:
  static constexpr int kWindow = 15 + 16;  ///< largest window, gzip with check of CRC and length
  z_stream z_{};
};

class ZstdInflater final : public Inflater {
 public:
  ~ZstdInflater() override { ZSTD_freeDStream(stream_); }
  const char* name() const override { return "zstd"; }
  bool begins(unsigned char byte) const override { return byte == 0x28 || byte >> 4 == 5; }
  void reset() override { ZSTD_initDStream(stream_); }
  Step step(In& in, Out& out) override {
    ZSTD_inBuffer from{in.data, in.size, 0};
    ZSTD_outBuffer to{out.data, out.size, 0};
    const std::size_t result = ZSTD_decompressStream(stream_, &to, &from);
    in = {in.data + from.pos, in.size - from.pos};
    out = {out.data + to.pos, out.size - to.pos};
    if (ZSTD_isError(result) == 0) return result == 0 ? Step::kMemberEnd : Step::kMore;
    fault_ = ZSTD_getErrorName(result);
    return Step::kBad;
  }

 private:
  ZSTD_DStream* stream_ = ZSTD_createDStream();
};

}  // namespace

std::unique_ptr<Inflater> inflaterFor(const unsigned char* bytes, std::size_t size) {
  if (size >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b) return std::make_unique<GzipInflater>();
  if (size < 4) return nullptr;
  const std::uint32_t magic = static_cast<std::uint32_t>(bytes[0]) | bytes[1] << 8 |
                              bytes[2] << 16 | static_cast<std::uint32_t>(bytes[3]) << 24;
  if (magic == ZSTD_MAGICNUMBER ||
      (magic & ZSTD_MAGIC_SKIPPABLE_MASK) == ZSTD_MAGIC_SKIPPABLE_START)
    return std::make_unique<ZstdInflater>();
  return nullptr;
}

}  // namespace perception
