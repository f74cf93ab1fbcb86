// A step takes no memory: what it needs was taken before the first one. Every way to memory is counted:
// malloc and its kin themselves where the C library lets them be replaced, else operator new.
#include <doctest/doctest.h>

#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <string>
#include <taut/taut.hpp>
#include <vector>

namespace {
std::atomic<std::int64_t> taken{0};
}

#if defined(__SANITIZE_ADDRESS__)
#define TAUT_COUNTS_MALLOC 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TAUT_COUNTS_MALLOC 0
#endif
#endif
#if !defined(TAUT_COUNTS_MALLOC)
#if defined(__GLIBC__)
#define TAUT_COUNTS_MALLOC 1
#else
#define TAUT_COUNTS_MALLOC 0
#endif
#endif

#if TAUT_COUNTS_MALLOC
#include <link.h>

#include <cstring>

namespace {
struct Range {
  std::uintptr_t begin = 0, end = 0;
};
// Where the code of OpenMP lies.
Range openmp;
int find_openmp(dl_phdr_info* object, std::size_t, void*) {
  if (!std::strstr(object->dlpi_name, "libgomp") && !std::strstr(object->dlpi_name, "libomp")) return 0;
  for (int k = 0; k < object->dlpi_phnum; ++k)
    if (const auto& part = object->dlpi_phdr[k]; part.p_type == PT_LOAD && (part.p_flags & PF_X))
      openmp = {object->dlpi_addr + part.p_vaddr, object->dlpi_addr + part.p_vaddr + part.p_memsz};
  return 1;
}
const int found_openmp = dl_iterate_phdr(find_openmp, nullptr);

void count(void* caller) {
  const auto at = reinterpret_cast<std::uintptr_t>(caller);
  if (at < openmp.begin || at >= openmp.end) ++taken;
}
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  count(__builtin_return_address(0));
  return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) {
  count(__builtin_return_address(0));
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t size) {
  count(__builtin_return_address(0));
  return __libc_realloc(p, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count(__builtin_return_address(0));
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count(__builtin_return_address(0));
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  count(__builtin_return_address(0));
  *p = __libc_memalign(alignment, size);
  return *p || size == 0 ? 0 : ENOMEM;
}
}
#else
void* operator new(std::size_t size) {
  ++taken;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif

using namespace taut;

namespace {

/// How often memory is taken in thirty steps, after five that are not counted.
std::int64_t in_thirty_steps(Simulation<2>& s, const std::string& integrator) {
  std::int64_t first = 0, last = 0;
  const auto result =
      s.run(1e9, {.integrator = integrator, .progress = [&](std::int64_t steps, double, double) {
                    (steps == 5 ? first : last) = taken;
                    return steps < 35;
                  }});
  CHECK(result.status == Status::ok);
  CHECK(result.steps == 35);
  CHECK(result.rebuilds == 0);
  return last - first;
}

Simulation<2> body(const std::string& formulation) {
  const bool updated = formulation == "ul_basic";
  Method method{.formulation = formulation};
  if (updated) method.support_dx = 2.4;
  Simulation<2> s(
      make_cloud(box<2>({0, 0}, {1, 0.6}), {.dx = 0.1, .cells = formulation == "tl_stress_points"}),
      make_material<2>(updated ? "hypoelastic" : "neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
      method);
  s.clamp(s.face("x_min"));
  s.prescribe(s.face("x_max"), 0, [](double t) { return 1e-3 * t; });
  s.prescribe(s.face("x_max"), 1, [](const Vec<2>& X, double t) { return 1e-3 * t * X[1]; });
  s.body_force({0, -0.1}, [](double t) { return std::cos(t); });
  s.load(s.face("y_max"), {1, 1});
  return s;
}

}  // namespace

TEST_CASE("what is counted is counted") {
#if TAUT_COUNTS_MALLOC
  REQUIRE(found_openmp == 1);
#endif
  const std::int64_t before = taken;
  std::vector<double> v(100);
  const std::int64_t after = taken;
  CHECK(after - before == 1);
  CHECK(v.size() == 100);
}

TEST_CASE("steps take no memory") {
  for (const std::string formulation :
       {"tl_displacement", "tl_stress_points", "tl_bond_associated", "ul_basic"})
    for (const std::string integrator : {"leapfrog", "central_difference", "tvd_rk2", "ssp_rk3"}) {
      CAPTURE(formulation);
      CAPTURE(integrator);
      auto s = body(formulation);
      CHECK(in_thirty_steps(s, integrator) == 0);
    }
}

TEST_CASE("steps take no memory for walls between particles, symmetry planes and two materials") {
  for (const std::string integrator : {"leapfrog", "ssp_rk3"}) {
    CAPTURE(integrator);
    const auto soft = make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000});
    Simulation<2> walls(
        make_cloud(box<2>({0, 0}, {1, 0.6}), {.dx = 0.1, .lattice = Lattice::cell_centred}), soft,
        {.formulation = "tl_displacement", .operators = "compatible", .zero_energy_control = 0.1});
    walls.clamp(walls.face("x_min"));
    walls.prescribe(walls.face("x_max"), 0, [](double t) { return 1e-3 * t; });
    CHECK(in_thirty_steps(walls, integrator) == 0);

    Simulation<2> half(make_cloud(box<2>({0, 0}, {1, 0.6}), {.dx = 0.1}), soft,
                       {.formulation = "tl_displacement"});
    half.symmetry_plane(0, 0);
    half.set_material([](const Vec<2>& X) { return X[1] > 0.3; },
                      make_material<2>("neo_hookean", {.E = 3e6, .nu = 0.3, .density = 1000}));
    half.load(half.face("x_max"), {10, 0});
    CHECK(in_thirty_steps(half, integrator) == 0);
  }
}

TEST_CASE("steps of a relaxation take no memory") {
  auto s = body("tl_displacement");
  std::int64_t first = 0, last = 0;
  // It asks every 32 steps.
  s.relax({.tolerance = 1e-12, .progress = [&](std::int64_t steps, double, double) {
             (steps == 32 ? first : last) = taken;
             return steps < 96;
           }});
  CHECK(first > 0);
  CHECK(last - first == 0);
}
