#pragma once
/// \file
/// For programs that add parts of their own: the registries, and what the parts are made from.

#include <taut/base/fields.hpp>
#include <taut/base/parameters.hpp>
#include <taut/base/registry.hpp>
#include <taut/formulations/pairs_at_rest.hpp>
#include <taut/formulations/registry.hpp>
#include <taut/kernels/registry.hpp>
#include <taut/materials/registry.hpp>
#include <taut/neighbors/registry.hpp>
#include <taut/operators/operator_parts.hpp>
#include <taut/operators/registry.hpp>
#include <taut/taut.hpp>
