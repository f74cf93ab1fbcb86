#pragma once
/// \file
/// The one header for users.

#include <taut/base/error.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/formulations/health.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/materials/material.hpp>
#include <taut/operators/method.hpp>
#include <taut/output/derived.hpp>
#include <taut/output/particle_fields.hpp>
#include <taut/output/stress_recovery.hpp>
#include <taut/simulation/simulation.hpp>
