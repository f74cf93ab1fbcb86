#pragma once
/// \file
/// Files that are there whole or not at all.

#include <filesystem>
#include <string>

namespace taut::bench {

/// Writes under a temporary name, then renames; makes the folder where it is missing. \throws RunError
void write_file(const std::filesystem::path& file, const std::string& content);
/// \throws RunError
std::string read_file(const std::filesystem::path& file);
/// \throws RunError
void make_folder(const std::filesystem::path& folder);
/// Letters and digits as they are (lower case), everything else as single underscores: a name for a file.
std::string file_name_of(const std::string& text);

}  // namespace taut::bench
