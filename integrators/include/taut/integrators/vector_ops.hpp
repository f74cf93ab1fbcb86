#pragma once
/// \file
/// Loops over flat arrays that every integrator needs. Sums are made in fixed blocks, so that they have the
/// same bits for any number of threads.

#include <span>

namespace taut {

/// y += factor * x
void add_scaled(std::span<double> y, double factor, std::span<const double> x);
/// v += kick * a, then x += drift * v, in one pass over memory.
void kick_drift(std::span<double> x, std::span<double> v, std::span<const double> a, double kick,
                double drift);
/// v += first * a, then v += second * a, each rounded as by itself, then x += drift * v, in one pass.
void kick_kick_drift(std::span<double> x, std::span<double> v, std::span<const double> a, double first,
                     double second, double drift);
/// start = y, then y += factor * x.
void keep_and_add(std::span<double> start, std::span<double> y, double factor, std::span<const double> x);
/// y = of_start * start + of_y * y + factor * x
void blend(std::span<double> y, double of_start, std::span<const double> start, double of_y, double factor,
           std::span<const double> x);
/// sum of x * y
double dot(std::span<const double> x, std::span<const double> y);
/// sum of weight * x * y
double weighted_dot(std::span<const double> weight, std::span<const double> x, std::span<const double> y);

}  // namespace taut
