// A matrix of a camera's rays, taken to SciPy and back, and through a sparse QR.
#include <Eigen/Sparse>
#include <Eigen/SparseQR>
#include <cstdlib>
#include <fstream>

#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/solvers.h"
#include "support/small_scene.h"
#include "support/source_folder.h"
#include "support/temporary_folder.h"
#include "validation/cases.h"

namespace plenoflame::test::scipy_test {
namespace {

/// Rings that one camera with microlenses sees, and noisy data of a smooth emission.
struct Exported {
  CsrMatrix<float> matrix;
  std::vector<double> b;

  Exported() {
    Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
    scene.camera.sensor = {40, 60, 0.25e-3};
    const CompiledScene compiled = compile(scene);
    RingGrid grid;
    grid.base = {1, 0, -6e-3};
    grid.radial_step = 0.6e-3;
    grid.height_step = 2e-3;
    grid.rings = 7;
    grid.heights = 7;
    const auto unknowns = make_ring_unknowns(grid);
    CameraRaySettings settings;
    settings.samples = 16;
    const CameraRays rays = draw_camera_rays({{&compiled, {}}}, unknowns->bounds(), settings);
    matrix = make_emission_matrix({&rays, unknowns.get(), RowModel::emission, {}}, {});
    std::vector<double> x;
    for (std::size_t j = 0; j < unknowns->size(); ++j)
      x.push_back(std::max(0.0, 1 - 0.3 * static_cast<double>(j / 7)) *
                  (1 + 0.3 * std::cos(static_cast<double>(j % 7))));
    b = *make_csr_operator(matrix) * x;
    // In units in which numbers are around 1.
    const double unit = *std::max_element(b.begin(), b.end());
    std::vector<float> values;
    for (const float value : matrix.values())
      values.push_back(static_cast<float>(static_cast<double>(value) / unit));
    matrix = CsrMatrix<float>(
        matrix.columns(), {matrix.row_starts().begin(), matrix.row_starts().end()},
        {matrix.column_indices().begin(), matrix.column_indices().end()}, std::move(values));
    for (std::size_t i = 0; i < b.size(); ++i)
      b[i] = b[i] / unit + 0.02 * NoiseStream(2, i).gaussian();
  }
};

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double away = 0, all = 0;
  for (std::size_t j = 0; j < b.size(); ++j) away += std::pow(a[j] - b[j], 2), all += b[j] * b[j];
  return std::sqrt(away / all);
}

std::vector<double> read_numbers(const std::string& path) {
  std::ifstream file(path);
  std::vector<double> numbers;
  for (double value = 0; file >> value;) numbers.push_back(value);
  return numbers;
}

SolverOptions to_the_end() {
  SolverOptions options;
  options.iterations = 50000;
  options.relative_change = 0;
  return options;
}

TEST(ExportedMatrix, SciPySolvesItAlike) {
  const Exported exported;
  const TemporaryFolder folder;
  write_csr(folder.file("A.npz"), exported.matrix);
  std::ofstream data(folder.file("b.txt"));
  data.precision(17);
  for (const double value : exported.b) data << value << '\n';
  data.close();
  constexpr double kDamp = 0.1;
  const std::string command = "'" PLENOFLAME_PYTHON "' -B '" PLENOFLAME_SOURCE_DIR
                              "/tests/validation/scipy_solvers.py' " +
                              folder.path() + " " + std::to_string(kDamp);
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
  const auto a = make_csr_operator(exported.matrix);
  const LinearProblem problem{a.get(), exported.b};
  CsrRows<float> ones;
  for (std::size_t j = 0; j < exported.matrix.columns(); ++j) {
    ones.counts.push_back(1);
    ones.columns.push_back(static_cast<std::int32_t>(j));
    ones.values.push_back(1);
  }
  const CsrMatrix<float> unit = join_rows<float>({ones}, ones.counts.size());
  const auto identity = make_csr_operator(unit);
  const std::vector<double> lsqr = read_numbers(folder.file("lsqr.txt")),
                            nnls = read_numbers(folder.file("nnls.txt"));
  ASSERT_EQ(lsqr.size(), exported.matrix.columns());
  const double by_lsqr =
      distance(solve_lsqr(problem, {identity.get(), kDamp * kDamp}, to_the_end()).x, lsqr);
  const double by_cgls =
      distance(solve_cgls(problem, {identity.get(), kDamp * kDamp}, to_the_end()).x, lsqr);
  const double by_set = distance(solve_nnls_active_set(problem, {}).x, nnls);
  EXPECT_LT(by_lsqr, 1e-6);
  EXPECT_LT(by_cgls, 1e-6);
  EXPECT_LT(by_set, 1e-6);
  note("lsqr", 0, by_lsqr);
  note("cgls", 0, by_cgls);
  note("nnls", 0, by_set);
  const CsrMatrix<float> back = read_csr(folder.file("back.npz"));
  EXPECT_TRUE(std::ranges::equal(back.values(), exported.matrix.values()));
  EXPECT_TRUE(std::ranges::equal(back.column_indices(), exported.matrix.column_indices()));
}

TEST(ExportedMatrix, SparseQrSolvesItAlike) {
  const Exported exported;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t row = 0; row < exported.matrix.rows(); ++row)
    for (auto k = exported.matrix.row_starts()[row]; k < exported.matrix.row_starts()[row + 1]; ++k)
      entries.emplace_back(
          static_cast<int>(row), exported.matrix.column_indices()[static_cast<std::size_t>(k)],
          static_cast<double>(exported.matrix.values()[static_cast<std::size_t>(k)]));
  Eigen::SparseMatrix<double> sparse(static_cast<Eigen::Index>(exported.matrix.rows()),
                                     static_cast<Eigen::Index>(exported.matrix.columns()));
  sparse.setFromTriplets(entries.begin(), entries.end());
  sparse.makeCompressed();
  const Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> qr(sparse);
  const Eigen::VectorXd solved =
      qr.solve(Eigen::Map<const Eigen::VectorXd>(exported.b.data(), sparse.rows()));
  const std::vector<double> expected(solved.data(), solved.data() + solved.size());
  const auto a = make_csr_operator(exported.matrix);
  const double by_lsqr = distance(solve_lsqr({a.get(), exported.b}, {}, to_the_end()).x, expected);
  EXPECT_LT(by_lsqr, 1e-6);
  note("lsqr against sparse QR", 0, by_lsqr);
}

}  // namespace
}  // namespace plenoflame::test::scipy_test
