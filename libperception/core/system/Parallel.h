#pragma once
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

#ifdef __SANITIZE_THREAD__
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace perception {

/// Shows ThreadSanitizer that a loop begins before its bodies and ends after them, since TBB is not
/// instrumented. Empty in all other builds.
class LoopOrder {
 public:
#ifdef __SANITIZE_THREAD__
  LoopOrder() { __tsan_release(&begin_); }
  ~LoopOrder() { __tsan_acquire(&end_); }
  void enter() const { __tsan_acquire(&begin_); }
  void leave() const { __tsan_release(&end_); }

 private:
  mutable char begin_ = 0, end_ = 0;
#else
  void enter() const {}
  void leave() const {}
#endif
};

/// f(0) ... f(n-1), in any order and on any number of threads; no call may write what another one
/// reads or writes. Throws what one of them threw. Runs in the caller if n is below 24 or there is
/// only one thread: tasks would not pay.
template <class Function>
void parallelFor(std::size_t n, const Function& f) {
  constexpr std::size_t kWorthThreads = 24;
  if (n < kWorthThreads ||
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) == 1) {
    for (std::size_t i = 0; i < n; ++i) f(i);
  } else {
    const LoopOrder order;
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      order.enter();
      f(i);
      order.leave();
    });
  }
}

/// f() and g(), which must be independent, at the same time where there are two threads. While one
/// thread waits for the other, it takes no work from outside of them.
template <class First, class Second>
void runBoth(const First& f, const Second& g) {
  tbb::this_task_arena::isolate([&] {
    const LoopOrder order;
    tbb::parallel_for(
        0, 2,
        [&](int i) {
          order.enter();
          i == 0 ? f() : g();
          order.leave();
        },
        tbb::simple_partitioner());
  });
}

/// Whether more than one thread is allowed.
inline bool canRunBoth() {
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) > 1;
}

/// Does what is added on a thread of its own, in that order. Only one thread may call add() and
/// wait(). The destructor waits, too.
class WorkBehind {
 public:
  WorkBehind() = default;
  WorkBehind(const WorkBehind&) = delete;
  WorkBehind& operator=(const WorkBehind&) = delete;
  ~WorkBehind() {
    if (!thread_.joinable()) return;
    change([this] { ends_ = true; });
    thread_.join();
  }

  /// The number of functions that were added so far.
  std::size_t add(std::function<void()> work) {
    change([&] { waiting_.push_back(std::move(work)); });
    if (!thread_.joinable()) thread_ = std::thread([this] { workAll(); });
    return ++added_;
  }
  /// Returns when the first `count` of all are done. Rethrows what the first function that failed
  /// threw; those added after it, before this call, are skipped.
  void wait(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return done_ >= count; });
    if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
  }
  void wait() { wait(added_); }

 private:
  template <class Function>
  void change(const Function& f) {
    {
      const std::lock_guard lock(mutex_);
      f();
    }
    changed_.notify_all();
  }
  void workAll() {
    for (;;) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      const auto work = std::move(waiting_.front());
      waiting_.pop_front();
      const bool skipped = fault_ != nullptr;
      lock.unlock();
      std::exception_ptr fault;
      try {
        if (!skipped) work();
      } catch (...) {
        fault = std::current_exception();
      }
      change([&] {
        ++done_;
        if (fault) fault_ = fault;
      });
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  std::size_t done_ = 0;
  std::exception_ptr fault_;
  bool ends_ = false;
  std::size_t added_ = 0;  // of the thread that adds
  std::thread thread_;
};

}  // namespace perception
