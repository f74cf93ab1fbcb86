#pragma once
// Everything that does not depend on registers and that the search by cells uses: to be included before a
// pragma chooses registers, or inline functions that the whole program shares would be built for them.

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <taut/core/fields.hpp>
#include <taut/neighbors/search.hpp>
#include <utility>
#include <vector>

#include "clusters.hpp"
#include "encoded_slices.hpp"
#include "pair_list_builder.hpp"
#include "parallel.hpp"
#include "point_check.hpp"
#include "slice_group.hpp"
#include "sort_by_key.hpp"
