#pragma once
#include <string>

namespace perception {

/// Escapes text for HTML content and attributes.
std::string escaped(const std::string& text);
/// The same, with spaces for underscores.
std::string spaced(std::string name);

/// Base64 encoding, RFC 4648 section 4.
std::string base64(const std::string& bytes);

}  // namespace perception
