#pragma once
/// \file
/// Ctrl-C and the like.

#include <string>
#include <taut/base/error.hpp>

namespace taut::bench {

/// For the rest of the program: SIGINT, SIGTERM and SIGHUP remove unfinished files and end it; where
/// something is waiting (`GracefulStop`) the first only asks. Signals that whoever started the program has it
/// ignore stay ignored. Broken pipes and files too large are errors of the call that meets them.
void watch_signals();

/// While one of these lives a signal asks instead of ending the program; the second ends it.
class GracefulStop {
 public:
  GracefulStop();
  GracefulStop(const GracefulStop&) = delete;
  GracefulStop& operator=(const GracefulStop&) = delete;
  ~GracefulStop();
};

/// The signal that asked for an end, or 0.
int asked_to_stop() noexcept;

/// The job ended because it was asked to; the exit code is 128 + signal.
class Interrupted : public RunError {
 public:
  Interrupted(int signal, const std::string& what) : RunError(what), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

}  // namespace taut::bench
