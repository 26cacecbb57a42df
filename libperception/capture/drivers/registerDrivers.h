#pragma once

namespace perception {

/// Lets MRPT create our drivers by the names of their classes.
void registerDrivers();

}  // namespace perception
