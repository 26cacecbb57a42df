#pragma once

namespace perception {

/// Registers this library's observation classes and those of mrpt-obs and mrpt-maps with MRPT.
/// Every program that reads or writes a rawlog calls it first: otherwise the linker drops libraries
/// without used symbols, and their classes. May be called repeatedly.
void registerPerceptionClasses();

}  // namespace perception
