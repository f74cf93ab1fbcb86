#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <lib/progress.hpp>
#include <lib/terminal.hpp>

namespace taut::bench {

ProgressLine::ProgressLine(bool quiet, std::size_t items)
    : quiet_(quiet), terminal_(isatty(STDOUT_FILENO) == 1), items_(items) {}

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
  erase_line();
  print_out(fmt::format("[{}/{}] {}  {:3.0f} %  step {}", item_ + 1, items_, what_,
                        100 * std::clamp(fraction, 0.0, 1.0), steps));
}

void ProgressLine::end(const std::string& outcome) {
  if (quiet_) return;
  erase_line();
  print_out(fmt::format("[{}/{}] {}: {}\n", item_ + 1, items_, what_, outcome));
}

void ProgressLine::say(const std::string& line) {
  if (quiet_) return;
  erase_line();
  print_out(line + '\n');
}

}  // namespace taut::bench
