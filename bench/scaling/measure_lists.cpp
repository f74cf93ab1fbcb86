#include <omp.h>

#include <algorithm>
#include <optional>
#include <scaling/job.hpp>
#include <scaling/lists.hpp>
#include <taut/base/error.hpp>

namespace taut::bench {
namespace {

void compare_lists(const Job& job, const std::string& kind, std::int64_t points) {
  const ListCloud cloud = list_cloud(kind, points);
  const std::vector<int> counts = job.thread_counts();
  const auto with_threads = [](int threads, const auto& work) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    work();
    omp_set_num_threads(before);
  };
  std::size_t pairs = 0;
  double bytes = 0;
  {
    const PairList list = taut_list(cloud);
    pairs = static_cast<std::size_t>(list.pairs());
    bytes = static_cast<double>(list.bytes()) / static_cast<double>(cloud.size());
    const std::size_t ours = pairs_within_own_radius(cloud, list),
                      theirs = nanoflann_lists(cloud, job.threads).pairs();
    if (ours != theirs)
      throw RunError(fmt::format("lists of {} points, {}: taut finds {} pairs, nanoflann {}", cloud.size(),
                                 kind, ours, theirs));
  }
  std::vector<Contestant> contestants;
  for (const int t : counts) {
    contestants.push_back(
        {"taut, " + thread_label(t), [&, t] {
           double seconds = 0;
           with_threads(t, [&] { seconds = seconds_per_call([&] { taut_list(cloud); }, job.least_seconds); });
           return seconds;
         }});
    contestants.push_back({"nanoflann radiusSearch, " + thread_label(t), [&, t] {
                             return seconds_per_call([&] { nanoflann_lists(cloud, t); }, job.least_seconds);
                           }});
  }
  const auto measured =
      job.measure(fmt::format("Pair lists, {} points, {}, {:.1f} neighbours", cloud.size(), kind,
                              static_cast<double>(pairs) / static_cast<double>(cloud.size())),
                  contestants, 1e3, "ms");
  for (std::size_t k = 0; k < counts.size(); ++k) {
    Row row;
    row.scene = kind + "_3d";
    row.particles = static_cast<std::int64_t>(cloud.size());
    row.pairs = static_cast<std::int64_t>(pairs);
    row.threads = counts[k];
    Row ours = row, theirs = row;
    ours.formulation = "list_taut";
    ours.bytes_per_particle = bytes;
    theirs.formulation = "list_nanoflann";
    job.add(ours, "list_seconds", measured[2 * k], "s");
    job.add(theirs, "list_seconds", measured[2 * k + 1], "s");
    job.add(ours, "ratio_to_nanoflann", measured[2 * k + 1].median() / measured[2 * k].median(), "1");
  }
}

}  // namespace

void measure_lists(const Job& job) {
  for (const std::string& kind : list_clouds()) compare_lists(job, kind, job.main_particles());
}

}  // namespace taut::bench
