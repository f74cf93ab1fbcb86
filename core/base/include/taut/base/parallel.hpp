#pragma once
/// \file
/// Loops on all threads that carry exceptions out.

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <type_traits>

// A program that is compiled without OpenMP loops on one thread, without a warning of pragmas that it does
// not know.
#ifdef _OPENMP
#define TAUT_OMP(...) _Pragma(#__VA_ARGS__)
#else
#define TAUT_OMP(...)
#endif

namespace taut {

/// Fewer particles are done sooner than threads are woken.
inline bool worth_threads(std::int64_t particles) { return particles >= 4096; }

/// Carries the first exception out of a parallel region, from which none may escape.
class ParallelError {
 public:
  template <class F>
  void guard(F&& f) noexcept {
    try {
      f();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      thrown_.store(true, std::memory_order_relaxed);
    }
  }
  /// Whether there is one: the rest of the region is for nothing.
  bool thrown() const noexcept { return thrown_.load(std::memory_order_relaxed); }
  void rethrow() {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr error_;
  std::atomic<bool> thrown_{false};
};

// The loops below call a body for each of `count` indices, on all threads where that is `worth` it. Whatever
// it throws ends the loop and reaches the caller, the first of several. Everything that calls what is the
// user's (materials, functions) or takes memory is looped over like this: an exception that leaves an OpenMP
// region ends the program. Regions of pure arithmetic may do without (.ci/check_parallel.py lists them).

// It takes these macros for calls.
// clang-format off
/// Contiguous shares, which depend on the numbers of indices and threads alone.
template <class Count, class Body>
void parallel_for(Count count, bool worth, Body&& body) {
  ParallelError error;
TAUT_OMP(omp parallel for schedule(static) if (worth))
  for (Count i = 0; i < count; ++i)
    if (!error.thrown()) error.guard([&] { body(i); });
  error.rethrow();
}

/// The same with a state for each thread, a copy of `initial`, as the second argument of the body; then
/// `merge(state)` thread by thread, in any order.
template <class Count, class State, class Body, class Merge>
void parallel_for(Count count, bool worth, const State& initial, Body&& body, Merge&& merge) {
  static_assert(std::is_nothrow_copy_constructible_v<State>);
  ParallelError error;
TAUT_OMP(omp parallel if (worth))
  {
    State mine = initial;
TAUT_OMP(omp for schedule(static))
    for (Count i = 0; i < count; ++i)
      if (!error.thrown()) error.guard([&] { body(i, mine); });
TAUT_OMP(omp critical)
    error.guard([&] { merge(mine); });
  }
  error.rethrow();
}

/// `grain` indices at a time to whichever thread is free.
template <class Count, class Body>
void parallel_for_dynamic(Count count, int grain, bool worth, Body&& body) {
  ParallelError error;
TAUT_OMP(omp parallel for schedule(dynamic, grain) if (worth))
  for (Count i = 0; i < count; ++i)
    if (!error.thrown()) error.guard([&] { body(i); });
  error.rethrow();
}

/// `body()` once on each thread.
template <class Body>
void on_threads(bool worth, Body&& body) {
  ParallelError error;
TAUT_OMP(omp parallel if (worth))
  error.guard([&] { body(); });
  error.rethrow();
}
// clang-format on

}  // namespace taut

#undef TAUT_OMP
