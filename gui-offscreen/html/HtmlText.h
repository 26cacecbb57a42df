#pragma once
#include <string>

#include "libperception/core/system/SpoolFile.h"

namespace perception {

/// Escapes text for HTML content and attributes.
std::string escaped(const std::string& text);
/// The same, with spaces for underscores.
std::string spaced(std::string name);

/// Base64 encoding, RFC 4648 section 4.
std::string base64(const std::string& bytes);
/// That of a file, read piece by piece. Throws DataError.
void putBase64(const std::string& file, const TextSink& sink);

}  // namespace perception
