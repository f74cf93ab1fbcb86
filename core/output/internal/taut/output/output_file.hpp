#pragma once
/// \file
/// Files that are there whole or not at all.

#include <filesystem>
#include <string>
#include <string_view>

namespace taut::internal {

/// A file that takes its name when it is whole. Until then it has a name that nobody else has, in the same
/// folder (".taut-XXXXXX.tmp"), made so that no link is followed; it is removed when it is given up, and by
/// `remove_temporaries`.
class OutputFile {
 public:
  /// \throws RunError where the file cannot be made, or `target` is there and no regular file: a device, a
  /// pipe or a folder is never replaced. A link is replaced, what it points to is left alone.
  explicit OutputFile(const std::filesystem::path& target);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  /// The name until `commit`, for writers that open it themselves.
  const std::string& temporary() const { return temporary_; }
  /// \throws RunError with what the system said, such as a disk that is full.
  void write(std::string_view content);
  /// Takes room for so many bytes, for writers that do not bear its end well: the file has them then.
  /// \throws RunError where there is not
  void reserve(std::size_t bytes);
  /// Cuts it off behind so many bytes. \throws RunError
  void cut(std::size_t bytes);
  /// To the disk, then to its name. \throws RunError
  void commit();

 private:
  [[noreturn]] void fail(const std::string& what, int error) const;
  std::filesystem::path target_;
  std::string temporary_;
  int descriptor_ = -1, slot_ = -1;
};

/// Removes what is not whole. May be called from a signal handler.
void remove_temporaries() noexcept;

}  // namespace taut::internal
