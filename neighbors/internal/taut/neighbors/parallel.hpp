#pragma once
#include <cstdint>
#include <exception>
#include <mutex>

namespace taut::detail {

// Fewer particles are done sooner than threads are woken.
inline bool worth_threads(std::int64_t particles) { return particles >= 4096; }

// Carries the first exception out of a parallel region, from which none may escape.
class ParallelError {
 public:
  template <class F>
  void guard(F&& f) noexcept {
    try {
      f();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
  }
  void rethrow() {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace taut::detail
