#pragma once
// A vector for numbers that are written without being initialised first.

#include <algorithm>
#include <cstddef>
#include <memory>

namespace taut::detail {

template <class T>
class Buffer {
 public:
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }
  void clear() { size_ = 0; }

  // Room for `more` beyond the size, where they may be written before `grow` makes them part of it.
  T* room(std::size_t more) {
    if (size_ + more > capacity_) {
      capacity_ = size_ + more + (size_ + more) / growth;
      auto larger = std::make_unique_for_overwrite<T[]>(capacity_);
      std::copy_n(data_.get(), size_, larger.get());
      data_ = std::move(larger);
    }
    return end();
  }
  void grow_to(const T* end) { size_ = static_cast<std::size_t>(end - data()); }

 private:
  // By a quarter at a time: what buffers hold is copied on soon, and many may wait for that.
  static constexpr std::size_t growth = 4;
  std::unique_ptr<T[]> data_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace taut::detail
