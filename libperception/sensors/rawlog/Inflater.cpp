#include "libperception/sensors/rawlog/Inflater.h"

#include <isa-l/igzip_lib.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace perception {
namespace {

class GzipInflater final : public Inflater {
 public:
  GzipInflater() : state_(std::make_unique<inflate_state>()) {
    isal_inflate_init(state_.get());
    state_->crc_flag = ISAL_GZIP;
  }
  const char* name() const override { return "gzip"; }
  bool begins(unsigned char byte) const override { return byte == 0x1f; }
  void reset() override {
    isal_inflate_reset(state_.get());
    state_->crc_flag = ISAL_GZIP;
  }
  Step step(In& in, Out& out) override {
    const auto sized = [](std::size_t size) {
      return static_cast<std::uint32_t>(
          std::min<std::size_t>(size, std::numeric_limits<std::uint32_t>::max()));
    };
    state_->next_in = const_cast<unsigned char*>(in.data);  // it is not written to
    const std::uint32_t given = state_->avail_in = sized(in.size);
    state_->next_out = out.data;
    const std::uint32_t room = state_->avail_out = sized(out.size);
    const int result = isal_inflate(state_.get());
    in = {in.data + (given - state_->avail_in), in.size - (given - state_->avail_in)};
    out = {out.data + (room - state_->avail_out), out.size - (room - state_->avail_out)};
    if (result < 0) {
      fault_ = faultOf(result);
      return Step::kBad;
    }
    return state_->block_state == ISAL_BLOCK_FINISH ? Step::kMemberEnd : Step::kMore;
  }

 private:
  static const char* faultOf(int result) {
    switch (result) {
      case ISAL_INVALID_BLOCK:
        return "invalid block";
      case ISAL_INVALID_SYMBOL:
        return "invalid symbol";
      case ISAL_INVALID_LOOKBACK:
        return "invalid distance";
      case ISAL_INVALID_WRAPPER:
        return "invalid header";
      case ISAL_UNSUPPORTED_METHOD:
        return "unknown method of compression";
      case ISAL_INCORRECT_CHECKSUM:
        return "incorrect checksum";
    }
    return "invalid data";
  }
  std::unique_ptr<inflate_state> state_;
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
