#pragma once

namespace perception {

/// Makes our observation classes and those of mrpt-obs and mrpt-maps known to MRPT's readers. Every
/// program that reads or writes a rawlog calls it first: the linker drops libraries of which no
/// symbol is used, and their classes with them. May be called any number of times.
void registerPerceptionClasses();

}  // namespace perception
