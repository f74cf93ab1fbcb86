#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <lib/gnuplot.hpp>
#include <lib/signals.hpp>
#include <taut/output/output_file.hpp>

namespace taut::bench {
namespace {

std::atomic<int> asked{0}, waiting{0};
static_assert(std::atomic<int>::is_always_lock_free, "signal handlers may use nothing else");

extern "C" void on_signal(int number) {
  int none = 0;
  if (waiting > 0 && asked.compare_exchange_strong(none, number)) return;
  gnuplot::stop();
  internal::remove_temporaries();
  signal(number, SIG_DFL);
  raise(number);
}

}  // namespace

void watch_signals() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction old {};
    if (sigaction(number, nullptr, &old) == 0 && old.sa_handler == SIG_IGN) continue;
    struct sigaction now {};
    now.sa_handler = on_signal;
    sigemptyset(&now.sa_mask);
    now.sa_flags = SA_RESTART;
    sigaction(number, &now, nullptr);
  }
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
}

GracefulStop::GracefulStop() { ++waiting; }
GracefulStop::~GracefulStop() { --waiting; }

int asked_to_stop() noexcept { return asked; }

}  // namespace taut::bench
