#include "plenoflame/inverse/csr_matrix.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "core/inverse/dense.h"
#include "inverse/operators/csr_parts.h"
#include "inverse/operators/followed_rows.h"
#include "inverse/operators/own_rows.h"
#include "inverse/operators/remembered_product.h"
#include "inverse/operators/scaled_problem.h"
#include "inverse/operators/stacked_operator.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::csr_matrix_test {
namespace {

using namespace test;

Execution threads(int count) {
  Execution execution;
  execution.threads = count;
  return execution;
}

TEST(CsrMatrix, TimesVectorsIsTheDenseProduct) {
  const TwinMatrix a = random_matrix(300, 90, 0.2, 1);
  const auto x = random_vector(90, -1, 1, 2), y = random_vector(300, -1, 1, 3);
  const auto operator_of = make_csr_operator(a.sparse, threads(2));
  EXPECT_LT(distance(*operator_of * x, a.dense * dense(x)), 1e-15);
  EXPECT_LT(distance(transposed_times(*operator_of, y), a.dense.transpose() * dense(y)), 1e-15);
  EXPECT_TRUE(relative(operator_of->squared_norm({}), a.dense.squaredNorm(), 1e-14));
  EXPECT_TRUE(relative(operator_of->squared_norm(y),
                       (dense(y).asDiagonal() * a.dense).squaredNorm(), 1e-14));
}

// Large enough that A^T is summed up in parts.
TEST(CsrMatrix, GivesTheSameBitsForAnyNumberOfThreads) {
  const TwinMatrix a = random_matrix(3000, 200, 0.5, 4);
  const auto x = random_vector(200, -1, 1, 5), y = random_vector(3000, -1, 1, 6);
  const auto one = make_csr_operator(a.sparse, threads(1));
  for (const int count : {2, 3, 7}) {
    const auto many = make_csr_operator(a.sparse, threads(count));
    EXPECT_EQ(*one * x, *many * x);
    EXPECT_EQ(transposed_times(*one, y), transposed_times(*many, y));
  }
  EXPECT_LT(distance(transposed_times(*one, y), a.dense.transpose() * dense(y)), 1e-14);
}

// Side by side, in parts and in one; and one after the other, as any operator does.
TEST(CsrMatrix, TimesVectorsTogetherIsOneByOne) {
  for (const std::size_t rows : {300UL, 3000UL}) {
    const TwinMatrix a = random_matrix(rows, 200, 0.5, 4);
    const auto sparse = make_csr_operator(a.sparse, threads(2));
    const std::vector<double> weights = random_vector(rows, 0, 1, 9);
    const RememberedProduct plain(*sparse);
    const ScaledColumns scaled(*sparse, random_vector(200, 0, 1, 8));
    const StackedOperator stacked({&scaled, weights, weights}, {&plain, 0.3});
    const auto x = random_vector(200 * kTogether, -1, 1, 5);
    const auto one = [](const std::vector<double>& all, std::size_t c) {
      std::vector<double> part;
      for (std::size_t n = c; n < all.size(); n += kTogether) part.push_back(all[n]);
      return part;
    };
    for (const LinearOperator* k : {static_cast<const LinearOperator*>(sparse.get()),
                                    static_cast<const LinearOperator*>(&plain),
                                    static_cast<const LinearOperator*>(&stacked)}) {
      const auto y = random_vector(k->rows() * kTogether, -1, 1, 6);
      std::vector<double> forward(y.size()), back(x.size());
      k->apply_together(x, forward);
      k->apply_transpose_together(y, back);
      for (std::size_t c = 0; c < kTogether; ++c) {
        EXPECT_EQ(one(forward, c), *k * one(x, c));
        EXPECT_EQ(one(back, c), transposed_times(*k, one(y, c)));
      }
    }
  }
}

// Cut anywhere: within parts, at their ends, into more pieces than there are parts, and without any
// rows.
TEST(OwnRows, TogetherHaveTheBitsOfTheWhole) {
  const TwinMatrix a = random_matrix(3000, 200, 0.5, 4);
  const auto x = random_vector(200, -1, 1, 5), y = random_vector(3000, -1, 1, 6);
  const auto whole = make_csr_operator(a.sparse, threads(2));
  const std::vector<std::size_t> parts = csr_parts(a.sparse.row_starts(), 200);
  ASSERT_EQ(parts.size(), 5U);
  for (const std::vector<std::size_t>& cuts : {std::vector<std::size_t>{0, 1000, 3000},
                                               {0, parts[1], parts[3], 3000},
                                               {0, 0, 10, 20, 20, 800, 2990, 3000, 3000},
                                               {0, parts[2] - 1, parts[2], parts[2] + 1, 3000}}) {
    std::vector<double> product;
    TransposedSum sum{std::vector(200, 0.0), {}};
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      CsrRows<float> some;
      std::vector<std::size_t> first;
      for (std::size_t row = cuts[k]; row < cuts[k + 1]; ++row) {
        const auto begin = a.sparse.row_starts()[row], end = a.sparse.row_starts()[row + 1];
        some.counts.push_back(static_cast<std::size_t>(end - begin));
        for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
          some.columns.push_back(a.sparse.column_indices()[e]);
          some.values.push_back(a.sparse.values()[e]);
        }
      }
      for (const std::size_t row : parts)
        if (row >= cuts[k] && row <= cuts[k + 1]) first.push_back(row - cuts[k]);
      OwnRows own(join_rows<float>({some}, 200), threads(2));
      own.set_parts(first);
      for (const double value : own.times(x)) product.push_back(value);
      own.sum_up(std::span(y).subspan(cuts[k], cuts[k + 1] - cuts[k]));
      own.add_to(sum);
    }
    EXPECT_EQ(product, *whole * x);
    EXPECT_EQ(sum.whole, transposed_times(*whole, y));
  }
}

/// Rows of a formula: contributions of 1, 2 or 3 to columns that some of them meet twice.
struct FormulaRows {
  std::size_t count;
  std::size_t rows() const { return count; }
  std::size_t columns() const { return 37; }
  struct Walk {
    template <class Use>
    void follow(std::size_t row, const Use& use) {
      for (std::size_t k = 0; k < row % 7; ++k)
        use((row * row + 11 * k * k) % 37, static_cast<double>(1 + (row + k) % 3));
    }
  };
  Walk walk() const { return {}; }
  RowPieces pieces() const {
    RowPieces all;
    for (std::size_t row = 0; row < count; ++row) all.rows.push_back(row);
    all.ends.push_back(count);
    return all;
  }
};

// More rows than are gathered at once, and a last batch that is not full.
TEST(CsrMatrix, StoredRowsAreThoseOfTheFormula) {
  const FormulaRows rows{2 * kRowsOfBatch + 3 * kFollowedRows + 5};
  const CsrMatrix<float> matrix = store_rows(rows, threads(3));
  ASSERT_EQ(matrix.rows(), rows.count);
  std::size_t k = 0;
  for (std::size_t row = 0; row < rows.count; ++row) {
    std::map<std::int32_t, float> expected;
    for (std::size_t n = 0; n < row % 7; ++n)
      expected[static_cast<std::int32_t>((row * row + 11 * n * n) % 37)] +=
          static_cast<float>(1 + (row + n) % 3);
    ASSERT_EQ(matrix.row_starts()[row], static_cast<std::int64_t>(k)) << row;
    for (const auto& [column, value] : expected) {
      ASSERT_LT(k, matrix.entries());
      ASSERT_EQ(matrix.column_indices()[k], column) << row;
      ASSERT_EQ(matrix.values()[k], value) << row;
      ++k;
    }
  }
  EXPECT_EQ(k, matrix.entries());
}

TEST(CsrMatrix, LargestSingularValueIsThatOfTheDenseMatrix) {
  const TwinMatrix a = random_matrix(80, 40, 0.4, 7);
  const auto w = random_vector(80, 0.5, 2, 8);
  const double exact = (dense(w).asDiagonal() * a.dense).jacobiSvd().singularValues()[0];
  const double found = largest_singular_value(*make_csr_operator(a.sparse), w, 60);
  EXPECT_LE(found, exact * (1 + 1e-12));
  EXPECT_GT(found, exact * (1 - 1e-6));
}

/// Asks for a stop as soon as it is used, and counts its uses.
class StoppingOperator final : public LinearOperator {
 public:
  StoppingOperator(const LinearOperator& a, std::stop_source& stop) : a_(a), stop_(stop) {}
  std::size_t rows() const override { return a_.rows(); }
  std::size_t columns() const override { return a_.columns(); }
  void apply(std::span<const double> x, std::span<double> y) const override {
    ++uses;
    stop_.request_stop();
    a_.apply(x, y);
  }
  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    a_.apply_transpose(y, x);
  }
  mutable int uses = 0;

 private:
  const LinearOperator& a_;
  std::stop_source& stop_;
};

// Thirty iterations after a stop are minutes where rays are followed each time. The value that a
// few of them have found still is a step that leads downhill: the step is its inverse square, and
// twice the right one is the end of that.
TEST(CsrMatrix, LargestSingularValueEndsSoonAfterAStop) {
  const TwinMatrix a = random_matrix(80, 40, 0.4, 7);
  const double exact = a.dense.jacobiSvd().singularValues()[0];
  const auto all = make_csr_operator(a.sparse);
  std::stop_source stop;
  const StoppingOperator stopping(*all, stop);
  const double found = largest_singular_value(stopping, {}, kPowerIterations, stop.get_token());
  EXPECT_LE(stopping.uses, 4);
  EXPECT_GT(found, exact / std::sqrt(2));
}

TEST(CsrMatrix, RefusesWhatIsNoMatrix) {
  using Matrix = CsrMatrix<float>;
  EXPECT_THROW(Matrix(3, {0, 2}, {0}, {1}), InputError);
  EXPECT_THROW(Matrix(3, {0, 2, 1}, {0}, {1}), InputError);
  EXPECT_THROW(Matrix(3, {0, 2}, {1, 1}, {1, 1}), InputError);
  EXPECT_THROW(Matrix(3, {0, 1}, {3}, {1}), InputError);
  EXPECT_THROW(Matrix(3, {0, 1}, {-1}, {1}), InputError);
  EXPECT_THROW(Matrix(3, {0, 1}, {0}, {std::nanf("")}), InputError);
}

TEST(CsrMatrix, InterleavedRowsAreThoseRows) {
  const TwinMatrix a = random_matrix(10, 6, 0.5, 9);
  const CsrMatrix<float> part = interleaved_rows(a.sparse, 1, 3);
  Eigen::MatrixXd rows(3, 6);
  rows << a.dense.row(1), a.dense.row(4), a.dense.row(7);
  EXPECT_EQ(dense(*make_csr_operator(part)), rows);
}

class CsrFile : public testing::TestWithParam<const char*> {};

TEST_P(CsrFile, ComesBackAsItWas) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/matrix" + GetParam();
  const TwinMatrix a = random_matrix(23, 11, 0.3, 10);
  write_csr(path, a.sparse);
  const CsrMatrix<float> back = read_csr(path);
  EXPECT_EQ(back.columns(), a.sparse.columns());
  EXPECT_TRUE(std::ranges::equal(back.row_starts(), a.sparse.row_starts()));
  EXPECT_TRUE(std::ranges::equal(back.column_indices(), a.sparse.column_indices()));
  EXPECT_TRUE(std::ranges::equal(back.values(), a.sparse.values()));
}

TEST_P(CsrFile, CutOffOrChangedIsRefusedInOneLine) {
  const TemporaryFolder folder;
  const std::string path = folder.path() + "/matrix" + GetParam();
  write_csr(path, random_matrix(23, 11, 0.3, 11).sparse);
  const std::string whole = read_file(path);
  for (std::size_t cut = 0; cut < whole.size(); cut += 1 + whole.size() / 97) {
    write_file(path, std::string_view(whole).substr(0, cut));
    EXPECT_THROW(read_csr(path), FileError) << cut;
  }
  // A changed byte may give another matrix, but nothing that ends the process or spans lines.
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 499) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x45);
    write_file(path, changed);
    try {
      read_csr(path);
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, CsrFile, testing::Values(".npz", ".h5", ".mtx"),
                         [](const auto& name) { return std::string(name.param + 1); });

TEST(CsrFileNames, OtherEndingsAreRefused) {
  EXPECT_THROW(write_csr("matrix.txt", CsrMatrix<float>()), UsageError);
  EXPECT_THROW(read_csr("matrix.txt"), UsageError);
}

}  // namespace
}  // namespace plenoflame::csr_matrix_test
