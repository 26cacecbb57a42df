#pragma once

namespace perception {

/// No operation; makes the linker take the checked allocation: MRPT's aligned allocation, whose
/// failure MRPT 2.5.8 does not look at, then throws std::bad_alloc in the whole program.
void linkCheckedAllocation();

}  // namespace perception
