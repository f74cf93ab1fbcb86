#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <taut/base/error.hpp>
#include <taut/output/output_file.hpp>
#include <utility>

namespace taut::internal {
namespace {

/// Names of temporary files, where a signal handler can read them: nothing of it is ever moved.
struct Slot {
  std::atomic<int> state{0};  // 0 free, 1 being filled, 2 holds a name
  std::array<char, 4096> name{};
};
std::array<Slot, 64> slots;

int occupy(const std::string& name) {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    int free = 0;
    if (name.size() >= slots[i].name.size() || !slots[i].state.compare_exchange_strong(free, 1)) continue;
    std::memcpy(slots[i].name.data(), name.c_str(), name.size() + 1);
    slots[i].state = 2;
    return static_cast<int>(i);
  }
  return -1;  // more than ever are open at once: that file alone is not removed on a signal
}

}  // namespace

void remove_temporaries() noexcept {
  for (Slot& slot : slots)
    if (slot.state == 2) unlink(slot.name.data());
}

OutputFile::OutputFile(const std::filesystem::path& target) : target_(target) {
  struct stat there {};
  if (lstat(target.c_str(), &there) == 0 && !S_ISREG(there.st_mode) && !S_ISLNK(there.st_mode))
    throw RunError(target.string() + ": is no regular file, and is not replaced");
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
  temporary_ = (folder / ".taut-XXXXXX.tmp").string();
  descriptor_ = mkostemps(temporary_.data(), 4, O_CLOEXEC);
  if (descriptor_ < 0) fail("write", errno);
  slot_ = occupy(temporary_);
  // As for any other file; mkostemps keeps it to its owner.
  const mode_t mask = umask(0);
  umask(mask);
  fchmod(descriptor_, 0666 & ~mask);
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  close(descriptor_);
  unlink(temporary_.c_str());
  if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].state = 0;
}

void OutputFile::fail(const std::string& what, int error) const {
  throw RunError(target_.string() + ": cannot " + what + ": " + std::strerror(error) +
                 (error == ENOSPC || error == EDQUOT ? " (the disk is full)" : ""));
}

void OutputFile::write(std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor_, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write", errno);
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

void OutputFile::reserve(std::size_t bytes) {
  const int error = posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes));
  if (error == ENOSPC || error == EDQUOT || error == EFBIG) fail("write", error);
}

void OutputFile::cut(std::size_t bytes) {
  if (ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) fail("write", errno);
}

void OutputFile::commit() {
  // Some file systems cannot: what cannot be made sure of is not an error.
  if (fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail("write", errno);
  if (rename(temporary_.c_str(), target_.c_str()) != 0) fail("write", errno);
  if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].state = 0;
  const int descriptor = std::exchange(descriptor_, -1);
  if (close(descriptor) != 0 && errno != EINTR) fail("write", errno);
  const std::filesystem::path folder = target_.has_parent_path() ? target_.parent_path() : ".";
  if (const int at = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); at >= 0) {
    fsync(at);
    close(at);
  }
}

}  // namespace taut::internal
