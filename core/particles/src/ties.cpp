#include <taut/particles/particles.hpp>

namespace taut {

template <int D>
void Particles<D>::tie(Field& vectors) const {
  const double* mass = m.component(0);
  for (std::size_t k = 0; k + 1 < ties.begin.size(); ++k) {
    const Index *from = ties.particles.data() + ties.begin[k],
                *to = ties.particles.data() + ties.begin[k + 1];
    double masses = 0;
    for (const Index* i = from; i < to; ++i) masses += mass[*i];
    for (int d = 0; d < D; ++d) {
      double* values = vectors.component(d);
      double sum = 0;
      for (const Index* i = from; i < to; ++i) sum += mass[*i] * values[*i];
      const double mean = sum / masses;
      for (const Index* i = from; i < to; ++i) values[*i] = mean;
    }
  }
}

template void Particles<1>::tie(Field&) const;
template void Particles<2>::tie(Field&) const;
template void Particles<3>::tie(Field&) const;

}  // namespace taut
