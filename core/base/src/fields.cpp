#include <algorithm>
#include <cstdint>
#include <taut/base/fields.hpp>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace taut {

namespace {

// Pair loops walk through dozens of places at once: more pages of 4 KB than the processor keeps track of.
constexpr std::size_t huge_page = std::size_t{1} << 21;

std::size_t alignment_of(std::size_t bytes) { return bytes >= 2 * huge_page ? huge_page : 64; }

}  // namespace

void* allocate(std::size_t bytes, std::size_t sure) {
  const std::size_t align = alignment_of(bytes), rounded = (bytes + align - 1) / align * align;
  void* memory = std::aligned_alloc(align, rounded);
  if (!memory) throw std::bad_alloc();
#ifdef __linux__
  if (align == huge_page)
    madvise(memory, sure == bytes ? rounded : sure / huge_page * huge_page, MADV_HUGEPAGE);
#endif
  return memory;
}

void* allocate_zeroed(std::size_t bytes) {
  void* memory = allocate(bytes, bytes);
  constexpr std::size_t chunk = 1 << 16;
  char* p = static_cast<char*>(memory);
  const auto chunks = static_cast<std::int64_t>((bytes + chunk - 1) / chunk);
#pragma omp parallel for schedule(static) if (chunks > 16)
  for (std::int64_t c = 0; c < chunks; ++c) {
    const std::size_t at = static_cast<std::size_t>(c) * chunk;
    std::memset(p + at, 0, std::min(chunk, bytes - at));
  }
  return memory;
}

}  // namespace taut
