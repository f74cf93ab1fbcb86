#pragma once
/// \file
/// The one header for users.

#include <taut/core/auto_method.hpp>
#include <taut/core/derived.hpp>
#include <taut/core/error.hpp>
#include <taut/core/geometry.hpp>
#include <taut/core/health.hpp>
#include <taut/core/kernel.hpp>
#include <taut/core/method.hpp>
#include <taut/core/simulation.hpp>
#include <taut/core/stress_recovery.hpp>
#include <taut/materials/material.hpp>
