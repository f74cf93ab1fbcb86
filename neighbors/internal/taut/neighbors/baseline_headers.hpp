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
#include <taut/base/fields.hpp>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/clusters.hpp>
#include <taut/neighbors/encoded_slices.hpp>
#include <taut/neighbors/pair_list_builder.hpp>
#include <taut/neighbors/point_check.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/neighbors/slice_group.hpp>
#include <taut/neighbors/sort_by_key.hpp>
#include <utility>
#include <vector>
