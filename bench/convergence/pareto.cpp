#include <algorithm>
#include <cmath>
#include <convergence/pareto.hpp>
#include <limits>
#include <tuple>

namespace taut::bench {

std::vector<std::size_t> pareto_front(const std::vector<double>& cost, const std::vector<double>& error) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < cost.size(); ++i)
    if (std::isfinite(cost[i]) && std::isfinite(error[i])) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(cost[a], error[a], a) < std::tie(cost[b], error[b], b);
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order)
    if (error[i] < least) {
      front.push_back(i);
      least = error[i];
    }
  return front;
}

}  // namespace taut::bench
