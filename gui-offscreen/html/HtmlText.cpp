#include "gui-offscreen/html/HtmlText.h"

#include <algorithm>
#include <cstdint>
#include <fstream>

#include "libperception/core/Error.h"

namespace perception {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return escaped(name);
}

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) -> std::uint32_t {
      return k < bytes.size() ? static_cast<std::uint8_t>(bytes[k]) : 0;
    };
    const std::uint32_t bits = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    text += kDigits[bits >> 18];
    text += kDigits[bits >> 12 & 63];
    text += i + 1 < bytes.size() ? kDigits[bits >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? kDigits[bits & 63] : '=';
  }
  return text;
}

void putBase64(const std::string& file, const TextSink& sink) {
  constexpr std::size_t kPiece = 3 << 16;  // [bytes] a multiple of three: only the last is padded
  std::ifstream bytes(file, std::ios::binary);
  std::string piece(kPiece, '\0');
  while (bytes.read(piece.data(), kPiece) || bytes.gcount() > 0) {
    piece.resize(static_cast<std::size_t>(bytes.gcount()));
    sink(base64(piece));
    piece.resize(kPiece);
  }
  if (!bytes.eof()) throw DataError(file + ": cannot be read");
}

}  // namespace perception
