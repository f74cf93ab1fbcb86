#include <taut/base/error.hpp>
#include <taut/output/derived.hpp>
#include <taut/output/output_file.hpp>
#include <taut/output/vtkhdf.hpp>
#include <taut/simulation/simulation.hpp>
#include <taut/simulation/simulation_impl.hpp>

#ifdef TAUT_HAS_HDF5
#include <hdf5.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <numeric>
#include <utility>
#endif

namespace taut {
namespace internal {

#ifdef TAUT_HAS_HDF5
namespace {

/// What the system said of the call that failed ("No space left on device"), from HDF5's own record of it;
/// empty where it says nothing.
std::string reason() {
  std::string found;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* entry, void* out) -> herr_t {
        auto& text = *static_cast<std::string*>(out);
        const std::string_view says = entry->desc ? entry->desc : "";
        constexpr std::string_view before = "error message = '";
        if (const std::size_t at = says.find(before); text.empty() && at != says.npos) {
          const std::size_t begin = at + before.size();
          text = says.substr(begin, says.find('\'', begin) - begin);
        }
        return 0;
      },
      &found);
  return found;
}

[[noreturn]] void fail(const char* what) {
  const std::string why = reason();
  throw RunError(std::string("HDF5 cannot ") + what + (why.empty() ? "" : ": " + why));
}

void check(herr_t status, const char* what) {
  if (status < 0) fail(what);
}

/// An HDF5 identifier, closed at the end of its scope.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close closer, const char* what) : id_(id), close_(closer) {
    if (id < 0) fail(what);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  /// Closes now, for what only shows then: data that wait in memory for a disk that is full.
  void close(const char* what) { check(close_(std::exchange(id_, -1)), what); }

 private:
  hid_t id_;
  Close close_;
};

/// HDF5 prints its own error stack by default; ours is the exception.
class QuietErrors {
 public:
  QuietErrors() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;
  ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Without the time of making, so that equal runs write equal files.
hid_t untimed(hid_t kind) {
  const hid_t properties = H5Pcreate(kind);
  H5Pset_obj_track_times(properties, false);
  return properties;
}

void write_dataset(hid_t group, const std::string& name, hid_t type, std::size_t rows, int columns,
                   const void* data) {
  const hsize_t size[2] = {rows, static_cast<hsize_t>(columns)};
  const Handle space(H5Screate_simple(columns > 1 ? 2 : 1, size, nullptr), H5Sclose, "make a data space");
  const Handle how(untimed(H5P_DATASET_CREATE), H5Pclose, "make properties");
  const Handle set(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, how, H5P_DEFAULT), H5Dclose,
                   "make a data set");
  if (rows) check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write a data set");
}

void write_header(hid_t group) {
  const hsize_t two = 2;
  const std::int64_t version[2] = {1, 0};
  const Handle pair(H5Screate_simple(1, &two, nullptr), H5Sclose, "make a data space");
  const Handle attribute(H5Acreate2(group, "Version", H5T_NATIVE_INT64, pair, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "make an attribute");
  check(H5Awrite(attribute, H5T_NATIVE_INT64, version), "write an attribute");

  const std::string name = "UnstructuredGrid";
  const Handle text(H5Tcopy(H5T_C_S1), H5Tclose, "make a string type");
  check(H5Tset_size(text, name.size()), "size a string type");
  check(H5Tset_strpad(text, H5T_STR_NULLPAD), "pad a string type");
  const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose, "make a data space");
  const Handle type(H5Acreate2(group, "Type", text, scalar, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                    "make an attribute");
  check(H5Awrite(type, text, name.data()), "write an attribute");
}

void write_contents(hid_t out, std::span<const double> xyz, std::span<const PointArray> arrays) {
  const std::size_t n = xyz.size() / 3;
  const Handle how(untimed(H5P_GROUP_CREATE), H5Pclose, "make properties");
  const Handle root(H5Gcreate2(out, "VTKHDF", H5P_DEFAULT, how, H5P_DEFAULT), H5Gclose, "make a group");
  write_header(root);

  const auto count = static_cast<std::int64_t>(n);
  write_dataset(root, "NumberOfPoints", H5T_NATIVE_INT64, 1, 1, &count);
  write_dataset(root, "NumberOfCells", H5T_NATIVE_INT64, 1, 1, &count);
  write_dataset(root, "NumberOfConnectivityIds", H5T_NATIVE_INT64, 1, 1, &count);
  write_dataset(root, "Points", H5T_NATIVE_DOUBLE, n, 3, xyz.data());
  std::vector<std::int64_t> indices(n + 1);
  std::iota(indices.begin(), indices.end(), 0);
  write_dataset(root, "Connectivity", H5T_NATIVE_INT64, n, 1, indices.data());
  write_dataset(root, "Offsets", H5T_NATIVE_INT64, n + 1, 1, indices.data());
  const unsigned char vtk_vertex = 1;
  const std::vector<unsigned char> types(n, vtk_vertex);
  write_dataset(root, "Types", H5T_NATIVE_UCHAR, n, 1, types.data());

  const Handle points(H5Gcreate2(root, "PointData", H5P_DEFAULT, how, H5P_DEFAULT), H5Gclose, "make a group");
  write_dataset(points, "id", H5T_NATIVE_INT64, n, 1, indices.data());
  for (const PointArray& array : arrays)
    write_dataset(points, array.name, H5T_NATIVE_DOUBLE, n, array.components, array.values.data());
}

/// What HDF5 still wants to write goes to memory.
void write_no_more(hid_t file) {
  int* descriptor = nullptr;
  if (H5Fget_vfd_handle(file, H5P_DEFAULT, reinterpret_cast<void**>(&descriptor)) < 0 || !descriptor) return;
  const int memory = memfd_create("taut", MFD_CLOEXEC);
  if (memory < 0) return;
  dup2(memory, *descriptor);
  close(memory);
}

/// HDF5 1.10 crashes at the program's end where one of its writes has failed. So none may: there is room for
/// `bytes`, which are no fewer than it needs, before the first.
void write_file(OutputFile& file, std::size_t bytes, std::span<const double> xyz,
                std::span<const PointArray> arrays) {
  file.reserve(bytes);  // before HDF5 knows of it; it gives the room up
  Handle out(H5Fcreate(file.temporary().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
             "create the file");
  try {
    file.reserve(bytes);
  } catch (const Error&) {
    write_no_more(out);
    throw;
  }
  write_contents(out, xyz, arrays);
  check(H5Fflush(out, H5F_SCOPE_GLOBAL), "write the file");
  hsize_t size = 0;
  check(H5Fget_filesize(out, &size), "measure the file");
  out.close("close the file");
  file.cut(size);
}

}  // namespace

void write_vtkhdf_points(const std::string& file, std::span<const double> xyz,
                         std::span<const PointArray> arrays) {
  const QuietErrors quiet;
  OutputFile out(file);
  try {
    std::size_t bytes = sizeof(double) * xyz.size() + 25 * (xyz.size() / 3) + (std::size_t{1} << 16);
    for (const PointArray& array : arrays) bytes += sizeof(double) * array.values.size();
    write_file(out, bytes, xyz, arrays);
    out.commit();
  } catch (const std::exception& error) {
    throw RunError(file + ": cannot write the fields: " + error.what());
  }
}

#else

void write_vtkhdf_points(const std::string& file, std::span<const double>, std::span<const PointArray>) {
  throw RunError(
      file +
      ": this build of taut has no field output, for HDF5 was not found when it was configured; install "
      "HDF5 (Debian: libhdf5-dev) and configure again");
}

#endif

}  // namespace internal

bool has_field_output() {
#ifdef TAUT_HAS_HDF5
  return true;
#else
  return false;
#endif
}

template <int D>
void write_vtkhdf(const std::string& file, const Simulation<D>& simulation) {
  using internal::PointArray;
  const std::size_t n = simulation.size();
  std::vector<double> xyz(3 * n, 0.0);
  PointArray displacement{"displacement", 3, std::vector<double>(3 * n, 0.0)};
  PointArray velocity{"velocity", 3, std::vector<double>(3 * n, 0.0)};
  PointArray stress{"cauchy_stress", 9, std::vector<double>(9 * n, 0.0)};
  PointArray mises{"von_mises", 1, std::vector<double>(n)};
  PointArray mass{"mass", 1, std::vector<double>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    const Vec<D> x = simulation.position(i), u = simulation.displacement(i), v = simulation.velocity(i);
    // NaN rather than no file where a user's material does not say what is out of the plane.
    const Mat<3> sigma = simulation.impl().formulation->full_cauchy_stress(simulation.impl().place(i));
    for (int r = 0; r < D; ++r) {
      xyz[3 * i + static_cast<std::size_t>(r)] = x[r];
      displacement.values[3 * i + static_cast<std::size_t>(r)] = u[r];
      velocity.values[3 * i + static_cast<std::size_t>(r)] = v[r];
    }
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) stress.values[9 * i + static_cast<std::size_t>(3 * r + c)] = sigma(r, c);
    mises.values[i] = von_mises(sigma);
    mass.values[i] = simulation.mass(i);
  }
  const PointArray arrays[] = {std::move(displacement), std::move(velocity), std::move(stress),
                               std::move(mises), std::move(mass)};
  internal::write_vtkhdf_points(file, xyz, arrays);
}

template void write_vtkhdf<1>(const std::string&, const Simulation<1>&);
template void write_vtkhdf<2>(const std::string&, const Simulation<2>&);
template void write_vtkhdf<3>(const std::string&, const Simulation<3>&);

}  // namespace taut
