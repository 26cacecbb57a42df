#include "libperception/scene/files/RunMark.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

constexpr std::string_view kWords = "perception run ";
constexpr std::size_t kIdLength = 64;  // hexadecimal digits of SHA-256

bool startsWith(std::string_view bytes, std::string_view start) {
  return bytes.substr(0, start.size()) == start;
}

std::string bigEndian(std::uint32_t value, int bytes) {
  std::string out;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
    out += static_cast<char>((value >> shift) & 255U);
  return out;
}

/// Length, type, text and CRC: https://www.w3.org/TR/png/#11tEXt
std::string pngChunk(const std::string& mark) {
  const std::string body = std::string("tEXtComment") + '\0' + mark;
  const auto crc =
      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return bigEndian(static_cast<std::uint32_t>(body.size() - 4), 4) + body +
         bigEndian(static_cast<std::uint32_t>(crc), 4);
}

void addMarks(std::string_view bytes, std::vector<std::string>& ids) {
  const auto isDigit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  for (std::size_t at = bytes.find(kWords); at != std::string_view::npos;
       at = bytes.find(kWords, at + 1)) {
    const std::string_view id = bytes.substr(at + kWords.size(), kIdLength);
    if (id.size() == kIdLength && std::all_of(id.begin(), id.end(), isDigit) &&
        std::find(ids.begin(), ids.end(), id) == ids.end())
      ids.emplace_back(id);
  }
}

}  // namespace

std::string runMark(const std::vector<std::string>& ids) {
  std::string mark;
  for (const std::string& id : ids) {
    if (!id.empty()) mark += fmt::format("{}{}{}", mark.empty() ? "" : ", ", kWords, id);
  }
  return mark;
}

std::vector<std::string> markedRunsOf(const std::string& path) {
  if (const auto what = irregularity(path); !what.empty())
    throw DataError(fmt::format("{}: is {}, expected a file", path, what));
  std::ifstream file(path, std::ios::binary);
  std::vector<std::string> ids;
  constexpr std::size_t kPart = 1U << 20, kOverlap = kWords.size() + kIdLength - 1;
  std::string bytes;
  do {
    const std::size_t kept = std::min(bytes.size(), kOverlap);
    bytes.erase(0, bytes.size() - kept);
    bytes.resize(kept + kPart);
    file.read(&bytes[kept], kPart);
    bytes.resize(kept + static_cast<std::size_t>(file.gcount()));
    addMarks(bytes, ids);
  } while (file);
  if (!file.eof()) throw DataError(path + ": cannot be read", ExitCode::kNoInput);
  return ids;
}

std::string withMark(std::string bytes, const std::string& mark) {
  if (mark.empty()) return bytes;
  constexpr std::size_t kPngHeader = 8 + 25, kGzipHeader = 10;  // signature and IHDR; RFC 1952
  constexpr char kGzipComment = 16;
  if (startsWith(bytes, "\x89PNG\r\n\x1a\n") && bytes.size() >= kPngHeader) {
    bytes.insert(kPngHeader, pngChunk(mark));
  } else if (startsWith(bytes, "\xff\xd8")) {
    bytes.insert(2, "\xff\xfe" + bigEndian(static_cast<std::uint32_t>(mark.size() + 2), 2) + mark);
  } else if (startsWith(bytes, std::string_view("\x1f\x8b\x08\0", 4)) &&
             bytes.size() >= kGzipHeader) {
    bytes[3] = kGzipComment;
    bytes.insert(kGzipHeader, mark + '\0');
  } else if (startsWith(bytes, "# Octomap")) {
    bytes.insert(bytes.find('\n') + 1, "# " + mark + "\n");
  }
  return bytes;
}

void markFile(const std::string& path, const std::string& mark) {
  if (mark.empty()) return;
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), {});
  if (!file && !file.eof()) throw DataError(path + ": cannot be read", ExitCode::kNoInput);
  file.close();
  writeFile(path, withMark(std::move(bytes), mark));
}

void markPictures(const std::string& dir, const std::string& mark) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(dir)) {
    if (entry.path().extension() == ".png") markFile(entry.path().string(), mark);
  }
}

}  // namespace perception
