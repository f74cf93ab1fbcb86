#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <taut/base/error.hpp>
#include <taut/geometry/delaunay.hpp>

#ifdef TAUT_HAS_QHULL
extern "C" {
#include <libqhull_r/qhull_ra.h>
}
#endif

namespace taut {
namespace {

template <int D>
double determinant(const std::vector<Vec<D>>& X, const Simplex<D>& s) {
  Mat<D> edges;
  for (int d = 0; d < D; ++d)
    edges.col(d) =
        X[static_cast<std::size_t>(s[static_cast<std::size_t>(d) + 1])] - X[static_cast<std::size_t>(s[0])];
  return edges.determinant();
}

#ifdef TAUT_HAS_QHULL
// What a C library prints, as a string.
class Captured {
 public:
  Captured() : file_(open_memstream(&text_, &size_)) {}
  Captured(const Captured&) = delete;
  Captured& operator=(const Captured&) = delete;
  ~Captured() {
    if (file_) std::fclose(file_);
    std::free(text_);
  }
  std::FILE* file() { return file_ ? file_ : stderr; }
  std::string first_line() {
    if (!file_) return "";
    std::fflush(file_);
    const std::string text(text_, size_);
    return text.substr(0, text.find('\n'));
  }

 private:
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* file_ = nullptr;
};

template <int D>
std::vector<Simplex<D>> by_qhull(const std::vector<Vec<D>>& X) {
  std::vector<coordT> points;
  points.reserve(X.size() * D);
  for (const Vec<D>& x : X) points.insert(points.end(), x.data(), x.data() + D);
  Captured said;
  qhT state;
  qhT* const qh = &state;  // the name that Qhull's macros use
  qh_zero(qh, said.file());
  // d: Delaunay, Qbb: scaled lifted coordinate, Qt: simplices where roundoff merged some, Qz: a point at
  // infinity, which lets D + 1 points do.
  char command[] = "qhull d Qbb Qt Qz";
  const int code =
      qh_new_qhull(qh, D, static_cast<int>(X.size()), points.data(), False, command, nullptr, said.file());
  std::vector<Simplex<D>> simplices;
  if (!code) {
    facetT* facet;
    FORALLfacets {
      if (facet->upperdelaunay || !facet->simplicial) continue;
      Simplex<D> s{};
      std::size_t k = 0;
      vertexT *vertex, **vertexp;
      FOREACHvertex_(facet->vertices) {
        const int id = qh_pointid(qh, vertex->point);
        if (id >= 0 && static_cast<std::size_t>(id) < X.size() && k < s.size())
          s[k] = static_cast<Index>(id);
        else
          k = s.size();
        ++k;
      }
      if (k == s.size()) simplices.push_back(s);
    }
  }
  const std::string why = said.first_line();
  qh_freeqhull(qh, !qh_ALL);
  int blocks = 0, bytes = 0;
  qh_memfreeshort(qh, &blocks, &bytes);
  if (code) throw InputError(fmt::format("the points cannot be triangulated; Qhull says: {}", why));
  return simplices;
}
#endif

}  // namespace

template <int D>
std::vector<Simplex<D>> delaunay(const std::vector<Vec<D>>& X) {
  if (X.size() < D + 1) throw InputError(fmt::format("{} points do not enclose a body in {}D", X.size(), D));
  std::vector<Simplex<D>> simplices;
  if constexpr (D == 1) {
    std::vector<Index> order(X.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](Index a, Index b) {
      return X[static_cast<std::size_t>(a)][0] < X[static_cast<std::size_t>(b)][0];
    });
    for (std::size_t i = 1; i < order.size(); ++i) simplices.push_back({order[i - 1], order[i]});
  } else {
#ifdef TAUT_HAS_QHULL
    simplices = by_qhull<D>(X);
    for (Simplex<D>& s : simplices)
      if (determinant<D>(X, s) < 0) std::swap(s[0], s[1]);
#else
    throw InputError(
        "this build of taut cannot find the body that points alone describe, for Qhull was not found when it "
        "was configured: give the volumes and boundary facets (columns volume, bx, by, fx, fy, …), or "
        "install "
        "Qhull (Debian: libqhull-dev) and configure again");
#endif
  }
  return simplices;
}

template std::vector<Simplex<1>> delaunay<1>(const std::vector<Vec<1>>&);
template std::vector<Simplex<2>> delaunay<2>(const std::vector<Vec<2>>&);
template std::vector<Simplex<3>> delaunay<3>(const std::vector<Vec<3>>&);

}  // namespace taut
