#pragma once
#include <string_view>

namespace perception {

/// Script of the interactive page, gui-offscreen/page bundled with its libraries.
std::string_view pageScript();
/// Style sheet of the interactive page.
std::string_view pageStyle();

}  // namespace perception
