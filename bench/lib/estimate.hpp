#pragma once
/// \file
/// What a case will cost, before it is spent.

#include <cstdint>
#include <lib/scene.hpp>
#include <lib/text_table.hpp>
#include <string>
#include <vector>

namespace taut::bench {

/// Rough figures, from counting and a table of measured ones (estimate.cpp): memory within a factor of two,
/// steps of three (bench/README.md has a table). A run that breaks ends before.
struct Estimate {
  double particles = 0, pairs = 0;
  double bytes = 0;  ///< at the most at one time, cloud and set-up included
  double steps = 0, seconds = 0;
};
/// \throws InputError for a shape, material or cloud that cannot be made
Estimate estimate(const Scene& scene, const RunSpec& run, const SweepPoint& point, int threads);

/// Memory that this process may use: the machine's, or less where a control group or `ulimit -v` says so
/// [bytes].
double memory_limit();

/// \throws InputError at the lattice or the solver for a case that takes more than `limit` bytes, or more
/// steps than anyone can wait for
void check_size(const Scene& scene, const RunSpec& run, const SweepPoint& point, double limit);

/// A row a case.
TextTable dry_run(const Scene& scene, int threads, double limit);

}  // namespace taut::bench
