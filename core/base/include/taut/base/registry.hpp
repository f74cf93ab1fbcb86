#pragma once
/// \file
/// Things that are chosen by name.

#include <deque>
#include <string>
#include <string_view>
#include <taut/base/error.hpp>
#include <utility>
#include <vector>

namespace taut {

/// Whether a name is one: small letters, digits and _, a letter first, so that it stands in scenes, tables
/// and file names as it is.
bool is_valid_name(std::string_view name);

/// One of each dimension, such as what makes a thing; what is empty does not exist there.
template <template <int> class T>
struct PerDimension {
  T<1> in_1d{};
  T<2> in_2d{};
  T<3> in_3d{};

  template <int D>
  const T<D>& get() const {
    if constexpr (D == 1)
      return in_1d;
    else if constexpr (D == 2)
      return in_2d;
    else
      return in_3d;
  }
};

/// Entries by name, in the order in which they were added: taut's own, then those of the program. An entry
/// has a `name`, one line that documents it and whatever its kind needs, with the traits from which the rest
/// of taut knows what it may do with it. Entries stay where they are. Add before simulations are made and
/// scenes are read: a registry that others read must not be changed.
template <class Entry>
class Registry {
 public:
  /// `what` names the kind in errors ("kernel"); names in `reserved` mean something else.
  Registry(std::string what, std::vector<Entry> entries, std::vector<std::string> reserved = {})
      : what_(std::move(what)), reserved_(std::move(reserved)) {
    for (Entry& entry : entries) add(std::move(entry));
  }

  /// \throws InputError for a name that is taken, reserved, or none (see `is_valid_name`).
  const Entry& add(Entry entry) {
    if (!is_valid_name(entry.name))
      throw InputError(what_ + " \"" + entry.name +
                       "\": a name has small letters, digits and _, and begins with a letter");
    if (look_up(entry.name)) throw InputError(what_ + " \"" + entry.name + "\" is there already");
    for (const std::string& name : reserved_)
      if (name == entry.name)
        throw InputError(what_ + " \"" + entry.name + "\": the name means something else");
    return entries_.emplace_back(std::move(entry));
  }

  /// Null where there is none of that name.
  const Entry* look_up(std::string_view name) const {
    for (const Entry& entry : entries_)
      if (entry.name == name) return &entry;
    return nullptr;
  }
  /// \throws InputError listing the valid names.
  const Entry& find(std::string_view name) const {
    if (const Entry* entry = look_up(name)) return *entry;
    throw InputError("unknown " + what_ + " \"" + std::string(name) + "\"; valid: " + join_names(names()));
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const Entry& entry : entries_) all.push_back(entry.name);
    return all;
  }
  const std::deque<Entry>& entries() const { return entries_; }
  const std::string& what() const { return what_; }

 private:
  std::string what_;
  std::vector<std::string> reserved_;
  std::deque<Entry> entries_;
};

/// What makes an entry's things in D dimensions. \throws InputError where nothing does.
template <int D, class Entry>
const auto& maker_of(const Entry& entry, const char* what) {
  const auto& make = entry.make.template get<D>();
  if (!make)
    throw InputError(std::string(what) + " \"" + entry.name + "\" does not exist in " + std::to_string(D) +
                     " dimension" + (D == 1 ? "" : "s"));
  return make;
}

}  // namespace taut
