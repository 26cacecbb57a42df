#pragma once
#include <string>

namespace perception {

/// A raw CAN socket of an interface ("can0"), FD frames as well; -1 with errno where it cannot be
/// had.
int openCanSocket(const std::string& interface);

}  // namespace perception
