#pragma once
#include <functional>
#include <string>

#include "libperception/dds/Network.h"

namespace perception {

/// What a running ROS 2 graph writes, a line a topic: name, type, writers, what they offer,
/// messages a second over the given time, and what the import makes of them. Ends early where
/// `stop` says so. Throws Error (kUnavailable).
std::string listOfGraph(const NetworkName& network, double seconds,
                        const std::function<bool()>& stop);

}  // namespace perception
