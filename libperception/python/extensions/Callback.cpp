#include "libperception/python/extensions/Callback.h"

#include "libperception/core/Error.h"

namespace perception::python {
namespace {

thread_local int callbacks = 0;

}  // namespace

CallbackScope::CallbackScope() { ++callbacks; }
CallbackScope::~CallbackScope() { --callbacks; }

void CallbackScope::refuse() {
  if (callbacks > 0)
    throw Error(
        ExitCode::kUsage,
        "a front end or motion model cannot use a tracker or a program: it runs within one");
}

std::shared_mutex& variantsMutex() {
  static std::shared_mutex mutex;
  return mutex;
}

}  // namespace perception::python
