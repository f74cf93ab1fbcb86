#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <lib/files.hpp>
#include <taut/base/error.hpp>
#include <taut/output/output_file.hpp>

namespace taut::bench {

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw RunError(folder.string() + ": cannot make this folder: " + error.message());
}

void write_file(const std::filesystem::path& file, const std::string& content) {
  if (file.has_parent_path()) make_folder(file.parent_path());
  internal::OutputFile out(file);
  out.write(content);
  out.commit();
}

std::string read_file(const std::filesystem::path& file, std::size_t limit) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) throw RunError(file.string() + ": cannot read");
  std::string text;
  std::string part(std::size_t{1} << 16, '\0');
  while (in) {
    in.read(part.data(), static_cast<std::streamsize>(part.size()));
    text.append(part, 0, static_cast<std::size_t>(in.gcount()));
    if (text.size() > limit)
      throw RunError(fmt::format("{}: is larger than {} bytes, the most that is read", file.string(), limit));
  }
  if (in.bad()) throw RunError(file.string() + ": cannot read all of it");
  return text;
}

namespace {

std::uint64_t hash_of(const std::string& text) {  // FNV-1a
  std::uint64_t hash = 14695981039346656037u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return hash;
}

/// The code point at `at`, of valid UTF-8; moves on. Bytes that are none stand for themselves.
unsigned next_code(const std::string& text, std::size_t& at) {
  const auto lead = static_cast<unsigned char>(text[at++]);
  if (lead < 0xc0) return lead;
  unsigned code = lead & (lead >= 0xf0 ? 0x07u : lead >= 0xe0 ? 0x0fu : 0x1fu);
  while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80)
    code = code << 6 | (static_cast<unsigned char>(text[at++]) & 0x3f);
  return code;
}

constexpr const char* lock_name = ".taut-lock";

/// What `internal::OutputFile` leaves when its process is killed.
void clear_leftovers(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.size() == 16 && name.starts_with(".taut-") && name.ends_with(".tmp") &&
        entry.symlink_status(ignored).type() == std::filesystem::file_type::regular)
      std::filesystem::remove(entry.path(), ignored);
  }
}

}  // namespace

std::string file_name_of(const std::string& text) {
  std::string name;
  const auto gap = [&] {
    if (!name.empty() && name.back() != '_') name += '_';
  };
  for (std::size_t at = 0; at < text.size();) {
    const unsigned c = next_code(text, at);
    if (c >= 0x80)
      name += fmt::format("u{:04x}", c);
    else if (std::isalnum(static_cast<int>(c)) || c == '-' || (c == '.' && !name.empty()))
      name += static_cast<char>(std::tolower(static_cast<int>(c)));
    else
      gap();
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  // Most file systems take 255 bytes; endings and "_error" come behind.
  constexpr std::size_t most = 180;
  if (name.size() > most) name = fmt::format("{}_{:016x}", name.substr(0, most - 17), hash_of(text));
  return name.empty() ? "unnamed" : name;
}

OutputFolder::OutputFolder(const std::filesystem::path& folder) {
  make_folder(folder);
  const std::filesystem::path file = folder / lock_name;
  lock_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (lock_ < 0) throw RunError(file.string() + ": cannot write: " + std::strerror(errno));
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(lock_);
    throw RunError(folder.string() +
                   ": another job is writing to this folder; wait for it, or give another --out");
  }
  clear_leftovers(folder);
  for (const char* part : {"fields", "charts", "pictures", "histories"}) clear_leftovers(folder / part);
}

OutputFolder::~OutputFolder() {
  if (lock_ >= 0) close(lock_);
}

}  // namespace taut::bench
