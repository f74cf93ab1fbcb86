#pragma once
// What this program adds, each in its own file.
#include <taut/extend.hpp>

taut::KernelEntry wendland_c4();
taut::MaterialEntry stiffening();
taut::OperatorEntry volume_corrected();
taut::FormulationEntry tl_plain();
