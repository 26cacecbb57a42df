#include "libperception/interop/bags/Compression.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <memory>
#include <stdexcept>

namespace perception {
namespace {

// Each gives the number of bytes that came out; what does not fit or is damaged throws.
std::size_t fromBz2(std::string_view bytes, std::string& out) {
  auto size = static_cast<unsigned>(out.size());
  const int result = BZ2_bzBuffToBuffDecompress(out.data(), &size, const_cast<char*>(bytes.data()),
                                                static_cast<unsigned>(bytes.size()), 0, 0);
  if (result != BZ_OK) throw std::runtime_error(fmt::format("bad bz2 data (error {})", result));
  return size;
}

std::size_t fromLz4(std::string_view bytes, std::string& out) {
  LZ4F_dctx* raw = nullptr;
  LZ4F_createDecompressionContext(&raw, LZ4F_VERSION);
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, &LZ4F_freeDecompressionContext);
  std::size_t done = 0, used = 0, hint = 1;
  while (hint != 0) {
    std::size_t out_size = out.size() - done, in_size = bytes.size() - used;
    hint = LZ4F_decompress(context.get(), out.data() + done, &out_size, bytes.data() + used,
                           &in_size, nullptr);
    if (LZ4F_isError(hint) != 0)
      throw std::runtime_error(fmt::format("bad lz4 data ({})", LZ4F_getErrorName(hint)));
    done += out_size;
    used += in_size;
    if (hint != 0 && out_size == 0 && in_size == 0)
      throw std::runtime_error("the lz4 data do not end where they should");
  }
  return done;
}

std::size_t fromZstd(std::string_view bytes, std::string& out) {
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(size) != 0)
    throw std::runtime_error(fmt::format("bad zstd data ({})", ZSTD_getErrorName(size)));
  return size;
}

}  // namespace

std::string inflated(std::string_view method, std::string_view bytes, std::uint64_t size) {
  if (size > kMostInflated)
    throw std::runtime_error(fmt::format("a size of {} bytes, at most {}", size, kMostInflated));
  std::size_t got = bytes.size();
  std::string out;
  if (method.empty() || method == "none") {
    out = bytes;
  } else {
    out.resize(size);
    if (method == "bz2")
      got = fromBz2(bytes, out);
    else if (method == "lz4")
      got = fromLz4(bytes, out);
    else if (method == "zstd")
      got = fromZstd(bytes, out);
    else
      throw std::runtime_error(
          fmt::format("compression \"{}\", expected none, bz2, lz4 or zstd", method));
  }
  if (got != size) throw std::runtime_error(fmt::format("{} bytes, expected {}", got, size));
  return out;
}

std::string inflatedZstd(std::string_view frame) {
  const auto size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN)
    throw std::runtime_error("a zstd frame that does not tell its size");
  return inflated("zstd", frame, size);
}

}  // namespace perception
