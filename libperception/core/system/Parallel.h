#pragma once
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <utility>

#ifdef __SANITIZE_THREAD__
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace perception {

/// The order of begin, bodies and end of a loop, for ThreadSanitizer: TBB is built without it.
/// Empty in all other builds.
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

/// f(0) ... f(n-1), in any order and on any number of threads; the calls must be independent. Runs
/// in the caller for few items or one thread, where tasks cost more than they gain.
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

/// f() and g(), which must be independent, at the same time where there are two threads. A thread
/// that waits for the other starts nothing else in between.
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

/// Whether there is a second thread.
inline bool canRunBoth() {
  return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) > 1;
}

/// f(), which does none of the work of a WorkBehind while it waits for loops of its own.
template <class Function>
auto runAlone(const Function& f) {
  return tbb::this_task_arena::isolate(f);
}

/// Work that is done in the order in which it is given, beside the thread that gives it, where
/// there are two threads. For one giver.
class WorkBehind {
 public:
  WorkBehind() = default;
  WorkBehind(const WorkBehind&) = delete;
  WorkBehind& operator=(const WorkBehind&) = delete;
  ~WorkBehind() { group_.wait(); }

  void add(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
    if (!std::exchange(works_, true)) group_.run([this] { workAll(); });
  }
  /// Returns when all is done. Throws what the first work that failed threw; those after it are
  /// left out.
  void wait() {
    group_.wait();
    const std::lock_guard lock(mutex_);
    if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
  }

 private:
  void workAll() {
    order_.enter();
    for (std::unique_lock lock(mutex_);; lock.lock()) {
      if (fault_) waiting_.clear();
      works_ = !waiting_.empty();
      if (!works_) return;
      const auto work = std::move(waiting_.front());
      waiting_.pop_front();
      lock.unlock();
      try {
        work();
      } catch (...) {
        const std::lock_guard faulty(mutex_);
        fault_ = std::current_exception();
      }
    }
  }

  std::mutex mutex_;
  std::deque<std::function<void()>> waiting_;
  bool works_ = false;
  std::exception_ptr fault_;
  LoopOrder order_;  // of the members before it and of workAll()
  tbb::task_group group_;
};

}  // namespace perception
