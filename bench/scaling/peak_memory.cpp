#include <malloc.h>

#include <fstream>
#include <scaling/peak_memory.hpp>
#include <string>

namespace taut::bench {
namespace {

/// A line of /proc/self/status [bytes].
std::optional<double> status(const std::string& key) {
  std::ifstream in("/proc/self/status");
  std::string word;
  while (in >> word)
    if (word == key + ':') {
      double kilobytes = 0;
      if (in >> kilobytes) return kilobytes * 1024;
    }
  return {};
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);
  // "5" brings the high-water mark down to what is resident now (proc(5)).
  std::ofstream reset("/proc/self/clear_refs");
  reset << "5" << std::flush;
  if (reset) start_ = status("VmRSS");
}

std::optional<double> PeakMemory::growth() const {
  const std::optional<double> peak = status("VmHWM");
  if (!start_ || !peak) return {};
  return *peak - *start_;
}

}  // namespace taut::bench
