#pragma once
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace perception {

/// Allocates as std::allocator does, but leaves elements without arguments unset.
template <class T>
struct RawAllocator : std::allocator<T> {
  template <class Other>
  struct rebind {
    using other = RawAllocator<Other>;
  };
  template <class Element>
  void construct(Element* at) noexcept {
    ::new (static_cast<void*>(at)) Element;
  }
  template <class Element, class... From>
  void construct(Element* at, From&&... from) {
    ::new (static_cast<void*>(at)) Element(std::forward<From>(from)...);
  }
};

/// A vector of numbers that resize() and the constructor by size leave unset: for those that are
/// all written before they are read.
template <class T>
using RawVector = std::vector<T, RawAllocator<T>>;

}  // namespace perception
