#pragma once
/// \file
/// Scene files in.

#include <filesystem>
#include <lib/scene.hpp>
#include <string>

namespace taut::bench {

/// Reads a scene; `quick` applies its [quick] table. Paths inside a scene start from the scene's folder.
/// \throws InputError "file:line:column: [table] key: what was wrong; what is valid".
Scene load_scene(const std::filesystem::path& file, bool quick = false);
/// The same from text; `name` stands for the file.
Scene parse_scene(const std::string& text, const std::string& name, bool quick = false);

}  // namespace taut::bench
