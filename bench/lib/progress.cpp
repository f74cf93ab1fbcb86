#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <lib/progress.hpp>

namespace taut::bench {

ProgressLine::ProgressLine(bool quiet, std::size_t items)
    : quiet_(quiet), terminal_(isatty(STDOUT_FILENO) == 1), items_(items) {}

void ProgressLine::clear() {
  if (terminal_) std::fputs("\r\033[K", stdout);
}

void ProgressLine::begin(std::size_t item, const std::string& what) {
  item_ = item;
  what_ = what;
  last_ = {};
  update(0, 0);
}

void ProgressLine::update(std::int64_t steps, double fraction) {
  if (quiet_ || !terminal_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  clear();
  fmt::print("[{}/{}] {}  {:3.0f} %  step {}", item_ + 1, items_, what_, 100 * std::clamp(fraction, 0.0, 1.0),
             steps);
  std::fflush(stdout);
}

void ProgressLine::end(const std::string& outcome) {
  if (quiet_) return;
  clear();
  fmt::print("[{}/{}] {}: {}\n", item_ + 1, items_, what_, outcome);
  std::fflush(stdout);
}

void ProgressLine::say(const std::string& line) {
  if (quiet_) return;
  clear();
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

}  // namespace taut::bench
