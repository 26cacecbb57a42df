#pragma once
#include <string>

namespace perception {

/// A raw CAN socket of an interface ("can0"), FD frames as well; -1 with errno if it cannot be
/// opened.
int openCanSocket(const std::string& interface);

}  // namespace perception
