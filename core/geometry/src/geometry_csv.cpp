#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <system_error>
#include <taut/base/error.hpp>
#include <taut/base/powers.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/geometry/local_origin.hpp>
#include <taut/geometry/spacing.hpp>

namespace taut {
namespace {

std::string_view trim(std::string_view s) {
  const auto from = s.find_first_not_of(" \t\r");
  return from == s.npos ? std::string_view{} : s.substr(from, s.find_last_not_of(" \t\r") - from + 1);
}

// The lines of a file that hold something, one after the other, split at commas.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : name_(file.string()), in_(file, std::ios::binary) {
    std::error_code unknown;
    if (!in_ || std::filesystem::is_directory(file, unknown))
      throw InputError(fmt::format("{}: cannot be opened", name_));
  }

  // False at the end of the file.
  bool next() {
    while (read()) {
      std::string_view line = text_;
      constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
      if (number_ == 1 && line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
      line = trim(line.substr(0, line.find('#')));
      if (line.empty()) continue;
      fields_.clear();
      for (std::size_t from = 0;;) {
        const auto comma = line.find(',', from);
        fields_.push_back(trim(line.substr(from, comma - from)));
        if (comma == line.npos) return true;
        from = comma + 1;
      }
    }
    return false;
  }

  const std::vector<std::string_view>& fields() const { return fields_; }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", name_, std::max(number_, 1), what));
  }

  [[noreturn]] void fail_whole(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", name_, what));
  }

  double number(std::string_view field, std::string_view column) const {
    double value = 0;
    std::string_view digits = field;
    if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
      fail(fmt::format("column {}: \"{}\" is no finite number", column, field));
    return value;
  }

 private:
  // The library's streams throw for files that have a name and no bytes to read (directories,
  // /proc/self/mem).
  int next_byte() {
    try {
      return in_.rdbuf()->sbumpc();
    } catch (const std::ios_base::failure& error) {
      fail_whole(fmt::format("cannot be read: {}", error.what()));
    }
  }
  // The next line, without its end; false where there is none. What has no line ends is no table (/dev/zero
  // has no end either).
  bool read() {
    constexpr std::size_t longest = 1000000;
    text_.clear();
    for (int c = next_byte();; c = next_byte()) {
      if (c == std::char_traits<char>::eof()) {
        if (text_.empty()) return false;
        break;
      }
      if (c == '\n') break;
      text_ += static_cast<char>(c);
      if (text_.size() > longest) {
        ++number_;
        fail(fmt::format("a line of more than {} bytes: this is no table of particles", longest));
      }
    }
    ++number_;
    return true;
  }

  std::string name_, text_;
  std::ifstream in_;
  int number_ = 0;
  std::vector<std::string_view> fields_;
};

template <int D>
struct Columns {
  std::vector<std::string> position{"x", "y", "z"}, area{"bx", "by", "bz"}, centre{"fx", "fy", "fz"};
  std::array<int, D> x, b, f;
  int volume = -1;
  std::size_t count = 0;

  explicit Columns(const Lines& lines) {
    position.resize(D);
    area.resize(D);
    centre.resize(D);
    x.fill(-1);
    b.fill(-1);
    f.fill(-1);
    std::vector<std::string> valid = position;
    valid.emplace_back("volume");
    valid.insert(valid.end(), area.begin(), area.end());
    valid.insert(valid.end(), centre.begin(), centre.end());

    count = lines.fields().size();
    for (std::size_t c = 0; c < count; ++c) {
      const std::string_view name = lines.fields()[c];
      int* column = name == "volume" ? &volume : nullptr;
      for (std::size_t d = 0; d < D; ++d) {
        if (name == position[d]) column = &x[d];
        if (name == area[d]) column = &b[d];
        if (name == centre[d]) column = &f[d];
      }
      if (!column)
        lines.fail(fmt::format("unknown column \"{}\"; valid in {}D: {}", name, D, join_names(valid)));
      if (*column >= 0) lines.fail(fmt::format("column {} twice", name));
      *column = static_cast<int>(c);
    }
    require(lines, position, x, valid);
    if (has_area() || has_centre()) require(lines, area, b, valid);
    if (has_centre()) {
      require(lines, centre, f, valid);
      if (volume < 0)
        lines.fail(fmt::format("missing column volume, which goes with {}", join_names(centre)));
    }
  }

  bool has_area() const { return some(b); }
  bool has_centre() const { return some(f); }

 private:
  static bool some(const std::array<int, D>& columns) {
    return std::any_of(columns.begin(), columns.end(), [](int c) { return c >= 0; });
  }
  static void require(const Lines& lines, const std::vector<std::string>& names,
                      const std::array<int, D>& found, const std::vector<std::string>& valid) {
    std::vector<std::string> missing;
    for (std::size_t d = 0; d < D; ++d)
      if (found[d] < 0) missing.push_back(names[d]);
    if (!missing.empty())
      lines.fail(
          fmt::format("missing column {}; valid in {}D: {}", join_names(missing), D, join_names(valid)));
  }
};

// Where particles have stood, for rows that add a facet to one.
template <int D>
class Places {
 public:
  // The particle at X, or `next`, which then stands there.
  Index particle(const Vec<D>& X, Index next) {
    std::array<double, D> key;
    for (std::size_t d = 0; d < D; ++d) key[d] = X[static_cast<Eigen::Index>(d)] + 0.0;  // -0 is 0
    return places_.try_emplace(key, next).first->second;
  }

 private:
  std::map<std::array<double, D>, Index> places_;
};

// Volumes where the file has none, and the spacing.
template <int D>
void complete(Cloud<D>& cloud, double dx, const Lines& lines) {
  double nearest = dx;
  if (dx == 0) {
    if (cloud.size() == 1) lines.fail("the spacing dx must be given for a single particle");
    nearest = median_distance<D>(cloud.X);
    if (!(nearest > 0)) lines.fail("no spacing dx to be found: most particles coincide with another");
  }
  if (cloud.V.empty()) {
    try {
      find_volumes(cloud);
      cloud.guessed_volumes = true;
    } catch (const InputError& e) {
      lines.fail_whole(fmt::format("there is no column volume, and from the points alone: {}", e.what()));
    }
  }
  cloud.dx = dx == 0 ? std::max(nearest, spacing_by_volume(cloud.V, D)) : dx;
  double extent = 0, total = 0;
  for (const Vec<D>& X : cloud.X) extent = std::max(extent, (X - cloud.X[0]).squaredNorm());
  for (const double V : cloud.V) total += V;
  if (!std::isfinite(extent) || !std::isfinite(total) || !std::isfinite(cloud.dx))
    lines.fail_whole("coordinates or volumes too large to be computed with");
}

}  // namespace

template <int D>
Cloud<D> read_cloud(const std::filesystem::path& file, double dx) {
  if (!(dx >= 0) || !std::isfinite(dx))
    throw InputError(fmt::format("{}: spacing {} is negative or not finite", file.string(), dx));
  Lines lines(file);
  if (!lines.next()) lines.fail("no header line");
  const Columns<D> columns(lines);

  Cloud<D> cloud;
  Places<D> places;
  while (lines.next()) {
    const auto& fields = lines.fields();
    if (fields.size() != columns.count)
      lines.fail(fmt::format("{} fields where the header names {}", fields.size(), columns.count));
    const auto vector = [&](const std::array<int, D>& column, const std::vector<std::string>& names) {
      Vec<D> v;
      for (std::size_t d = 0; d < D; ++d)
        v[static_cast<Eigen::Index>(d)] = lines.number(fields[static_cast<std::size_t>(column[d])], names[d]);
      return v;
    };
    const Vec<D> X = vector(columns.x, columns.position);
    const Index next = static_cast<Index>(cloud.size());
    const Index owner = columns.has_centre() ? places.particle(X, next) : next;
    if (owner == next) {
      cloud.X.push_back(X);
      if (columns.volume >= 0) {
        const std::string_view field = fields[static_cast<std::size_t>(columns.volume)];
        cloud.V.push_back(lines.number(field, "volume"));
        if (!(cloud.V.back() > 0)) lines.fail(fmt::format("column volume: {} is not positive", field));
      }
    } else if (!fields[static_cast<std::size_t>(columns.volume)].empty()) {
      lines.fail(
          fmt::format("the position of particle {} again: another facet of it has an empty volume, another "
                      "particle a place of its own",
                      owner));
    }
    if (columns.has_centre()) {
      const Vec<D> A = vector(columns.b, columns.area);
      if (!A.isZero(0)) cloud.facets.push_back({vector(columns.f, columns.centre), A, owner});
    } else if (columns.has_area()) {
      cloud.B.push_back(vector(columns.b, columns.area));
    }
    if (cloud.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max() - lanes))
      lines.fail("more particles than an index can count");
  }
  if (cloud.size() == 0) lines.fail("no particles after the header");
  if (columns.has_centre() && cloud.facets.empty()) lines.fail("columns of facets, but all areas are zero");
  make_local(cloud);
  complete(cloud, dx, lines);
  grade_spacing(cloud);
  return cloud;
}

template Cloud<1> read_cloud<1>(const std::filesystem::path&, double);
template Cloud<2> read_cloud<2>(const std::filesystem::path&, double);
template Cloud<3> read_cloud<3>(const std::filesystem::path&, double);

}  // namespace taut
