#include <algorithm>
#include <taut/integrators/step_control.hpp>

namespace taut {

double StepControl::next(double bound) {
  if (step_ <= 0 || !(bound >= step_)) step_ = bound;
  least_ = std::min(least_, bound);
  if (++seen_ == window) {
    if (least_ > worthwhile * step_) step_ = least_;
    least_ = std::numeric_limits<double>::infinity();
    seen_ = 0;
  }
  return step_;
}

}  // namespace taut
