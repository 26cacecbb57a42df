#pragma once
#include <string>

namespace perception {

/// Text as it stands between tags and in attributes of HTML.
std::string escaped(const std::string& text);
/// The same of a name, with blanks for its underscores.
std::string spaced(std::string name);

/// RFC 4648, section 4.
std::string base64(const std::string& bytes);

}  // namespace perception
