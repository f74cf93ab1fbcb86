#include <algorithm>
#include <scaling/job.hpp>

namespace taut::bench {

std::vector<int> Job::thread_counts() const {
  std::vector<int> counts;
  if (!quick)
    for (int t = 1; t < threads; t *= 2) counts.push_back(t);
  counts.push_back(threads);
  return counts;
}

std::int64_t Job::main_particles() const {
  constexpr std::int64_t most = 1'000'000;
  std::int64_t main = 0;
  for (const std::int64_t n : particles)
    if (n <= most) main = std::max(main, n);
  return main > 0 ? main : *std::min_element(particles.begin(), particles.end());
}

std::optional<double> Job::limit(const std::string& quantity, int threads_used) const {
  for (const Row& row : rows)
    if (row.scene == "machine" && row.quantity == quantity && row.threads == threads_used) return row.value;
  return {};
}

std::string thread_label(int threads) { return fmt::format("{} thread{}", threads, threads == 1 ? "" : "s"); }

std::vector<Samples> Job::measure(const std::string& title, const std::vector<Contestant>& contestants,
                                  double scale, const std::string& unit) const {
  progress.begin(0, title);
  const auto total = static_cast<double>(contestants.size()) * repeats;
  std::int64_t done = 0;
  std::vector<Samples> samples = alternate(contestants, repeats, [&] {
    ++done;
    progress.update(done, static_cast<double>(done) / total);
  });
  progress.say(fmt::format("{} [{}; median, min … max of {}]", title, unit, repeats));
  for (std::size_t c = 0; c < contestants.size(); ++c)
    progress.say(fmt::format("  {:<58} {:>9.4g}  {:.4g} … {:.4g}", contestants[c].label,
                             samples[c].median() * scale, samples[c].min() * scale,
                             samples[c].max() * scale));
  return samples;
}

void Job::add(Row like, const std::string& quantity, double value, const std::string& unit) const {
  like.quantity = quantity;
  like.value = value;
  like.unit = unit;
  rows.push_back(std::move(like));
}

void Job::add(Row like, const std::string& quantity, const Samples& samples, const std::string& unit) const {
  add(like, quantity, samples.median(), unit);
  add(like, quantity + "_min", samples.min(), unit);
  add(like, quantity + "_max", samples.max(), unit);
}

}  // namespace taut::bench
