#pragma once
/// \file
/// Files that are there whole or not at all, and the folder of a job.

#include <filesystem>
#include <string>

namespace taut::bench {

/// Writes under a name of its own, to the disk, then renames; makes the folder where it is missing. What is
/// there and no regular file is not replaced. \throws RunError
void write_file(const std::filesystem::path& file, const std::string& content);
/// At most `limit` bytes: larger files are refused before they fill the memory. \throws RunError
std::string read_file(const std::filesystem::path& file, std::size_t limit = std::size_t{1} << 31);
/// \throws RunError
void make_folder(const std::filesystem::path& folder);

/// Letters and digits as they are (lower case), other ASCII as single underscores, other characters by their
/// number (ν: u03bd): a name for a file, on any system. Of names too long for a file system the end is
/// replaced by a hash of the whole.
std::string file_name_of(const std::string& text);

/// The output folder of a job, made where it is missing: locked until the end of the scope, and cleared of
/// what jobs that were killed left unfinished. \throws RunError where another job writes there
class OutputFolder {
 public:
  explicit OutputFolder(const std::filesystem::path& folder);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

 private:
  int lock_ = -1;
};

}  // namespace taut::bench
