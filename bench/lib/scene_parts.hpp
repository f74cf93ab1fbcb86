#pragma once
/// \file
/// Loader of the single tables of a scene; see scene_loader.hpp.

#include <filesystem>
#include <lib/scene.hpp>
#include <lib/table_reader.hpp>

namespace taut::bench {

/// What the readers of tables need to know of the scene around them.
struct SceneContext {
  std::size_t dimension = 2;
  std::filesystem::path folder;  ///< of the scene file

  std::vector<std::string> axes() const;   ///< "x" …
  std::vector<std::string> faces() const;  ///< "x_min" …
  /// A file named in a scene, as found from its folder.
  std::string resolve(const std::string& file) const { return (folder / file).lexically_normal().string(); }
};

/// Axis of "x", "y", "z".
int axis_number(const std::string& name);

/// Reader of a table whose valid keys depend on its `key` ("type"): reads that first, then takes the keys of
/// that variant alone.
TableReader variant_reader(const Node& node, const std::string& table, const std::string& key);

// [geometry], [lattice], [material]: scene_parts.cpp
ShapeSpec read_shape(const Node& node, const SceneContext& context);
LatticeSpec read_lattice(const Node& node);
MaterialSpec read_material(const Node& node);
RegionSpec read_region(const Node& node, const MaterialSpec& base, const SceneContext& context);
Selection read_selection(const TableReader& reader, const SceneContext& context, bool required);
SolveSpec read_solve(const Node& node, const SolveSpec* base);

// scene_boundary.cpp
HistorySpec read_history(const Node& node);
BoundarySpec read_boundary(const Node& node, const SceneContext& context);
InitialSpec read_initial(const Node& node, const SceneContext& context);

// scene_probe.cpp
ProbeSpec read_probe(const Node& node, const SceneContext& context);
PictureSpec read_picture(const Node& node, const SceneContext& context);

// scene_run.cpp
/// \throws InputError at a key that the method's formulation and operators do not have, listing those they
/// have, and for one that they need. Of `auto` none is known before it has chosen.
void check_method_keys(const TableReader& reader, const Method& method);
RunSpec read_run(const Node& node, const LatticeSpec* lattice, const SolveSpec& solve);

}  // namespace taut::bench
