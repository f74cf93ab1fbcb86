#include <taut/neighbors/pair_list.hpp>

namespace taut {

double PairList::contiguous_fraction() const {
  std::int64_t contiguous = 0;
  for (Index s = 0; s < slices(); ++s) contiguous += gathered(s) - begin(s);
  return slots() ? static_cast<double>(contiguous) / static_cast<double>(slots()) : 0;
}

std::int64_t PairList::find(Index a, Index b) const {
  if (a < 0 || a >= particles_) return -1;
  const Index s = a / lanes;
  const int lane = a % lanes;
  std::int64_t k = begin(s);
  for (; k < gathered(s); ++k)
    if (first_[k] + lane == b && mask_[k] >> lane & 1) return k;
  for (; k < begin(s + 1); ++k)
    if (block(k)[lane] == b && mask_[k] >> lane & 1) return k;
  return -1;
}

}  // namespace taut
