#pragma once
/// \file
/// A mechanical system as time integrators see it.

#include <cstddef>
#include <span>
#include <vector>

namespace taut {

/// What a block of variables is to an integrator.
enum class BlockKind {
  position,  ///< its rate is the velocity
  velocity,  ///< its rate is the acceleration
  other      ///< evolves by a rate that follows from all: densities, stresses
};

/// Variables that evolve by their rates, d value / dt = rate, as flat arrays whose meaning the integrator
/// does not know: positions may be counted from anywhere, such as the places at rest.
struct Block {
  std::span<double> value;
  std::span<const double> rate;
  BlockKind kind;
  std::span<const double> mass{};  ///< of each velocity component, for energies and norms; else empty
};

/// What changes fastest in the present state of a system: from this and the limits of an integrator follow
/// its steps. Zero where it is not known; one of the two must be.
struct Fastest {
  double frequency = 0;   ///< highest frequency [rad/s]
  double wave_speed = 0;  ///< of the fastest wave [m/s]
  double length = 0;      ///< with which waves are resolved [m]
};

/// A system is a fixed set of blocks, and what fills their rates. The first block holds the positions, the
/// second the velocities; others may follow. Arrays stay where they are for the life of the object.
class Dynamics {
 public:
  virtual ~Dynamics() = default;
  Dynamics(const Dynamics&) = delete;
  Dynamics& operator=(const Dynamics&) = delete;

  std::span<const Block> blocks() const { return blocks_; }
  std::span<double> positions() const { return blocks_[0].value; }
  std::span<double> velocities() const { return blocks_[1].value; }
  std::span<const double> accelerations() const { return blocks_[1].rate; }
  std::span<const double> masses() const { return blocks_[1].mass; }
  /// The blocks besides positions and velocities; none in most total Lagrangian forms.
  std::span<const Block> others() const { return blocks().subspan(2); }

  /// All rates at time t from all values.
  void update(double t) {
    if (!others().empty()) update_rates(t);
    update_accelerations(t);
  }
  /// Its two halves, for schemes that are symplectic because they take them apart: the rates of `others` from
  /// positions and velocities, and the accelerations from all values.
  virtual void update_rates(double /*t*/) {}
  virtual void update_accelerations(double t) = 0;

  /// Imposes the constraints on the positions at time t (at the end of a step), and on the velocities.
  virtual void constrain_positions(double /*t*/) {}
  virtual void constrain_velocities(double /*t*/) {}
  /// Whether `constrain_velocities` makes something of the velocities that it finds, as projections do, and
  /// does not only put given ones in their place. Then its number of calls has a part in the round-off.
  virtual bool constraints_project() const { return false; }

  /// Bracket a step from t to t + dt, however often rates are updated within it: what remembers its history
  /// takes in the last update before `commit`, and no other.
  virtual void begin_step(double /*t*/, double /*dt*/) {}
  virtual void commit() {}

  virtual Fastest fastest() const = 0;

 protected:
  Dynamics() = default;
  /// To be called once, before any variable is added.
  void set_motion(std::span<double> positions, std::span<double> velocities,
                  std::span<const double> accelerations, std::span<const double> masses) {
    blocks_ = {{positions, velocities, BlockKind::position},
               {velocities, accelerations, BlockKind::velocity, masses}};
  }
  void add_variable(std::span<double> value, std::span<const double> rate) {
    blocks_.push_back({value, rate, BlockKind::other});
  }

 private:
  std::vector<Block> blocks_;
};

}  // namespace taut
