#pragma once
// The pairs of one slice while they are being found: a byte a particle says which of the eight lanes pair
// with it.

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <taut/core/types.hpp>

namespace taut::detail {

// Zero unless set; whoever sets a byte clears it.
class LaneMasks {
 public:
  explicit LaneMasks(Index particles)
      : memory_(static_cast<std::uint8_t*>(
            std::calloc(padded(static_cast<std::size_t>(particles)) + 2 * margin, 1))) {
    if (!memory_) throw std::bad_alloc();
  }

  // Lanes that pair with each particle; `margin` bytes around them are there to be read.
  std::uint8_t* data() { return memory_.get() + margin; }

  static constexpr int margin = 64;

 private:
  struct Free {
    void operator()(std::uint8_t* p) const { std::free(p); }
  };
  // calloc leaves pages that are never touched without memory: a thread pays for its own part of the cloud
  // only.
  std::unique_ptr<std::uint8_t[], Free> memory_;
};

}  // namespace taut::detail
