#include <algorithm>
#include <taut/operators/block_dictionary.hpp>

namespace taut {

void BlockDictionary::finish(AlignedArray<Index>& codes, AlignedArray<double>& blocks) {
  std::unordered_map<BlockKey, Index, BlockKey::Hash> numbers;
  std::vector<std::vector<Index>> renumbered(chunks_.size());
  std::vector<std::pair<std::size_t, std::size_t>> source;  // chunk and place in it
  for (std::size_t c = 0; c < chunks_.size(); ++c)
    for (std::size_t i = 0; i < chunks_[c].keys.size(); ++i) {
      const auto [at, fresh] = numbers.try_emplace(chunks_[c].keys[i], static_cast<Index>(source.size()));
      if (fresh) source.emplace_back(c, i);
      renumbered[c].push_back(at->second);
    }
  const auto size = static_cast<std::size_t>(block_);
  blocks = AlignedArray<double>(source.size() * size);
  for (std::size_t n = 0; n < source.size(); ++n)
    std::copy_n(chunks_[source[n].first].blocks.data() + source[n].second * size, size,
                blocks.data() + n * size);
#pragma omp parallel for schedule(static) if (codes_.size() > 4096)
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    if (renumbered[c].empty()) continue;
    for (std::size_t i = chunks_[c].first; i <= chunks_[c].last; ++i)
      codes_[i] = renumbered[c][static_cast<std::size_t>(codes_[i])];
  }
  codes = std::move(codes_);
  chunks_.clear();
}

}  // namespace taut
