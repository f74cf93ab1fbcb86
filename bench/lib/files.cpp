#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <lib/files.hpp>
#include <sstream>
#include <taut/core/error.hpp>

namespace taut::bench {

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw RunError(folder.string() + ": cannot make this folder: " + error.message());
}

void write_file(const std::filesystem::path& file, const std::string& content) {
  if (file.has_parent_path()) make_folder(file.parent_path());
  const std::filesystem::path temporary = file.string() + ".tmp";
  std::error_code error;
  errno = 0;
  std::ofstream out(temporary, std::ios::binary);
  out << content;
  out.close();
  if (!out) {
    const std::string why = std::strerror(errno);
    std::filesystem::remove(temporary, error);
    throw RunError(file.string() + ": cannot write: " + why);
  }
  std::filesystem::rename(temporary, file, error);
  if (error) throw RunError(file.string() + ": cannot write: " + error.message());
}

std::string read_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw RunError(file.string() + ": cannot read");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string file_name_of(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-';
    if (plain)
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name.empty() ? "unnamed" : name;
}

}  // namespace taut::bench
