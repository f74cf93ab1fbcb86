#pragma once
/// \file
/// The keys a scene may have, table by table. The loader accepts these and no others; a test asserts that
/// bench/scenes/README.md documents each of them.

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace taut::bench {

struct SceneTable {
  std::string table;    ///< name of the table, as in the documentation's headings
  std::string variant;  ///< value of its `type` or `mode` that has these keys; empty: whatever it is
  std::vector<std::string> keys;
};

/// Those of runs and materials are their own, the parameters of formulations, operators and materials between
/// them: also of those that the program has added.
std::vector<SceneTable> scene_tables();
/// Keys of a table, those of one variant included.
std::vector<std::string> keys_of(std::string_view table, std::string_view variant = "");
/// The stresses that pictures may show.
std::vector<std::string> picture_fields();
/// The named views of pictures: the direction in which the viewer stands.
const std::vector<std::pair<std::string, std::array<double, 3>>>& picture_views();
/// The variants of a table ("box", "sphere", …).
std::vector<std::string> variants_of(std::string_view table);

}  // namespace taut::bench
