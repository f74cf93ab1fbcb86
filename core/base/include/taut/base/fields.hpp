#pragma once
/// \file
/// Aligned arrays and structure-of-arrays fields.

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <taut/base/types.hpp>
#include <type_traits>
#include <utility>

namespace taut {

/// Zeroed memory on a 64-byte boundary, to be given to std::free. Its pages are first touched by the threads
/// of a static OpenMP schedule, the same that later loop over it. \throws std::bad_alloc
void* allocate_zeroed(std::size_t bytes);
/// The same without zeros: pages that are never written take no memory. Huge ones are for the first `sure`
/// bytes at most, those that will be written, as they count as a whole.
void* allocate(std::size_t bytes, std::size_t sure);

/// A fixed-size array on 64-byte boundaries, zeroed (see `allocate_zeroed`). Copyable; never grows.
template <class T>
class AlignedArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t n) : size_(n) {
    if (n) data_.reset(static_cast<T*>(allocate_zeroed(n * sizeof(T))));
  }
  /// Not zeroed, to be written before it is read. Where fewer than n elements are `sure` to be written, the
  /// others take no memory until they are.
  static AlignedArray for_overwrite(std::size_t n, std::size_t sure) {
    AlignedArray a;
    a.size_ = n;
    if (n) a.data_.reset(static_cast<T*>(allocate(n * sizeof(T), std::min(n, sure) * sizeof(T))));
    return a;
  }
  static AlignedArray for_overwrite(std::size_t n) { return for_overwrite(n, n); }
  AlignedArray(const AlignedArray& o) : AlignedArray(o.size_) {
    if (size_) std::memcpy(data_.get(), o.data_.get(), size_ * sizeof(T));
  }
  AlignedArray(AlignedArray&& o) noexcept : data_(std::move(o.data_)), size_(std::exchange(o.size_, 0)) {}
  AlignedArray& operator=(AlignedArray o) noexcept {
    std::swap(data_, o.data_);
    std::swap(size_, o.size_);
    return *this;
  }
  ~AlignedArray() = default;

  /// Leaves the first n of the elements. Gives no memory back.
  void truncate(std::size_t n) { size_ = std::min(n, size_); }

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  operator std::span<T>() { return {data(), size_}; }
  operator std::span<const T>() const { return {data(), size_}; }
  std::size_t bytes() const { return size_ * sizeof(T); }

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  std::unique_ptr<T[], Free> data_;
  std::size_t size_ = 0;
};

/// `components` values a particle, stored component by component: component c of particle i is
/// `component(c)[i]`. Each component is padded to whole packs; the padding is zero unless written.
class Field {
 public:
  Field() = default;
  Field(std::size_t particles, int components)
      : data_(padded(particles) * static_cast<std::size_t>(components)),
        stride_(padded(particles)),
        particles_(particles),
        components_(components) {}

  double* component(int c) { return data_.data() + static_cast<std::size_t>(c) * stride_; }
  const double* component(int c) const { return data_.data() + static_cast<std::size_t>(c) * stride_; }
  std::size_t stride() const { return stride_; }
  std::size_t particles() const { return particles_; }
  int components() const { return components_; }
  bool empty() const { return components_ == 0; }
  std::span<double> flat() { return data_; }
  std::span<const double> flat() const { return data_; }
  double* data() { return data_.data(); }
  const double* data() const { return data_.data(); }
  std::size_t bytes() const { return data_.bytes(); }

  template <int D>
  Vec<D> vec(std::size_t i) const {
    Vec<D> v;
    for (int d = 0; d < D; ++d) v[d] = component(d)[i];
    return v;
  }
  template <int D>
  void set_vec(std::size_t i, const Vec<D>& v) {
    for (int d = 0; d < D; ++d) component(d)[i] = v[d];
  }
  /// Row-major matrix of D×D components.
  template <int D>
  Mat<D> mat(std::size_t i) const {
    Mat<D> m;
    for (int r = 0; r < D; ++r)
      for (int c = 0; c < D; ++c) m(r, c) = component(r * D + c)[i];
    return m;
  }
  template <int D>
  void set_mat(std::size_t i, const Mat<D>& m) {
    for (int r = 0; r < D; ++r)
      for (int c = 0; c < D; ++c) component(r * D + c)[i] = m(r, c);
  }

 private:
  AlignedArray<double> data_;
  std::size_t stride_ = 0, particles_ = 0;
  int components_ = 0;
};

}  // namespace taut
