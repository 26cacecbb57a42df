#pragma once
#include <exception>
#include <shared_mutex>

namespace perception::python {

/// Lives while a function of Python runs that the pipeline calls: it must not come back to us,
/// whose locks are held.
class CallbackScope {
 public:
  CallbackScope();
  ~CallbackScope();
  CallbackScope(const CallbackScope&) = delete;
  CallbackScope& operator=(const CallbackScope&) = delete;
  /// Throws Error (kUsage) within one, on its thread.
  static void refuse();
};

/// What a function of Python threw, on its way out. No std::exception, which MRPT would replace by
/// one of its own.
struct CallbackFailure {
  std::exception_ptr cause;
};

/// Locked shared by whoever reads the tables of variants (a configuration), alone by whoever adds
/// to them. To be waited for without Python's lock.
std::shared_mutex& variantsMutex();

}  // namespace perception::python
