#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <nanoflann.hpp>
#include <string>
#include <taut/core/error.hpp>
#include <taut/core/geometry.hpp>

namespace taut {
namespace {

std::string_view trim(std::string_view s) {
  const auto from = s.find_first_not_of(" \t\r");
  return from == s.npos ? std::string_view{} : s.substr(from, s.find_last_not_of(" \t\r") - from + 1);
}

// The lines of a file that hold something, one after the other, split at commas.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : name_(file.string()) {
    std::ifstream in(file, std::ios::binary);
    if (!in || std::filesystem::is_directory(file))
      throw InputError(fmt::format("{}: cannot be opened", name_));
    text_.assign(std::istreambuf_iterator<char>(in), {});
    if (in.bad()) throw InputError(fmt::format("{}: cannot be read", name_));
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (text_.starts_with(byte_order_mark)) at_ = byte_order_mark.size();
  }

  // False at the end of the file.
  bool next() {
    while (at_ < text_.size()) {
      const auto end = std::min(text_.find('\n', at_), text_.size());
      std::string_view line = std::string_view(text_).substr(at_, end - at_);
      at_ = end + 1;
      ++number_;
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
  std::string name_, text_;
  std::size_t at_ = 0;
  int number_ = 0;
  std::vector<std::string_view> fields_;
};

template <int D>
struct Columns {
  std::vector<std::string> position{"x", "y", "z"}, area{"bx", "by", "bz"};
  std::array<int, D> x, b;
  int volume = -1;
  std::size_t count = 0;

  explicit Columns(const Lines& lines) {
    position.resize(D);
    area.resize(D);
    x.fill(-1);
    b.fill(-1);
    std::vector<std::string> valid = position;
    valid.emplace_back("volume");
    valid.insert(valid.end(), area.begin(), area.end());

    count = lines.fields().size();
    for (std::size_t c = 0; c < count; ++c) {
      const std::string_view name = lines.fields()[c];
      int* column = name == "volume" ? &volume : nullptr;
      for (std::size_t d = 0; d < D; ++d) {
        if (name == position[d]) column = &x[d];
        if (name == area[d]) column = &b[d];
      }
      if (!column)
        lines.fail(fmt::format("unknown column \"{}\"; valid in {}D: {}", name, D, join_names(valid)));
      if (*column >= 0) lines.fail(fmt::format("column {} twice", name));
      *column = static_cast<int>(c);
    }
    require(lines, position, x, valid);
    if (has_area()) require(lines, area, b, valid);
  }

  bool has_area() const {
    return std::any_of(b.begin(), b.end(), [](int c) { return c >= 0; });
  }

 private:
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

template <int D>
struct Points {
  const std::vector<Vec<D>>& X;
  std::size_t kdtree_get_point_count() const { return X.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t d) const { return X[i][static_cast<Eigen::Index>(d)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// The median over all particles, or over an even choice of them where they are many.
template <int D>
double median_distance(const std::vector<Vec<D>>& X) {
  const Points<D> points{X};
  const nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points<D>>, Points<D>, D>
      tree(D, points, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  const std::size_t step = (X.size() + 99999) / 100000;
  std::vector<double> nearest;
  for (std::size_t p = 0; p < X.size(); p += step) {
    std::array<std::uint32_t, 2> index{};
    std::array<double, 2> squared{};
    tree.knnSearch(X[p].data(), 2, index.data(), squared.data());
    nearest.push_back(std::sqrt(squared[1]));  // the first is the particle itself
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
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
    cloud.X.push_back(vector(columns.x, columns.position));
    if (columns.has_area()) cloud.B.push_back(vector(columns.b, columns.area));
    if (columns.volume >= 0) {
      const std::string_view field = fields[static_cast<std::size_t>(columns.volume)];
      cloud.V.push_back(lines.number(field, "volume"));
      if (!(cloud.V.back() > 0)) lines.fail(fmt::format("column volume: {} is not positive", field));
    }
    if (cloud.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max() - lanes))
      lines.fail("more particles than an index can count");
  }
  if (cloud.size() == 0) lines.fail("no particles after the header");

  if (dx == 0) {
    if (cloud.size() == 1) lines.fail("the spacing dx must be given for a single particle");
    dx = median_distance<D>(cloud.X);
    if (!(dx > 0)) lines.fail("no spacing dx to be found: most particles coincide with another");
  }
  cloud.dx = dx;
  if (cloud.V.empty()) {
    cloud.V.assign(cloud.size(), std::pow(dx, D));
    cloud.guessed_volumes = true;
  }
  return cloud;
}

template Cloud<1> read_cloud<1>(const std::filesystem::path&, double);
template Cloud<2> read_cloud<2>(const std::filesystem::path&, double);
template Cloud<3> read_cloud<3>(const std::filesystem::path&, double);

}  // namespace taut
