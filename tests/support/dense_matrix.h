// Small symmetric systems solved in the plainest way: the reference of iterative solvers. All in double.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace soapfilm::test {

/// A symmetric matrix, stored whole.
class DenseMatrix {
 public:
  explicit DenseMatrix(size_t size) : size_(size), values_(size * size) {}

  size_t size() const { return size_; }
  double* operator[](size_t row) { return values_.data() + row * size_; }
  const double* operator[](size_t row) const { return values_.data() + row * size_; }

  /// += scale f f^T, f = sum of weight[k] at index[k].
  template <class Indices, class Weights>
  void add_square(const Indices& index, const Weights& weight, double scale) {
    for (size_t i = 0; i < index.size(); ++i)
      for (size_t j = 0; j < index.size(); ++j) (*this)[index[i]][index[j]] += scale * weight[i] * weight[j];
  }

  std::vector<double> times(const std::vector<double>& x) const {
    std::vector<double> product(size_);
    for (size_t i = 0; i < size_; ++i)
      for (size_t j = 0; j < size_; ++j) product[i] += (*this)[i][j] * x[j];
    return product;
  }

  /// Replaces the lower half by L, L L^T the matrix; false where it is not positive definite.
  bool factorize() {
    for (size_t i = 0; i < size_; ++i) {
      double* row = (*this)[i];
      for (size_t j = 0; j <= i; ++j) {
        const double* other = (*this)[j];
        double sum = row[j];
        for (size_t k = 0; k < j; ++k) sum -= row[k] * other[k];
        if (j < i)
          row[j] = sum / other[j];
        else if (!(sum > 0))
          return false;
        else
          row[i] = std::sqrt(sum);
      }
    }
    return true;
  }
  /// After factorize().
  std::vector<double> solve(std::vector<double> b) const {
    for (size_t i = 0; i < size_; ++i) {
      for (size_t k = 0; k < i; ++k) b[i] -= (*this)[i][k] * b[k];
      b[i] /= (*this)[i][i];
    }
    for (size_t i = size_; i-- > 0;) {
      b[i] /= (*this)[i][i];
      for (size_t k = 0; k < i; ++k) b[k] -= (*this)[i][k] * b[i];
    }
    return b;
  }

 private:
  size_t size_;
  std::vector<double> values_;
};

}  // namespace soapfilm::test
