// Writes the sparse matrix from the samples of voxels to the fluxes of the pixels.
//   matrix SCENE.toml A.npz
#include <cstdio>

#include "plenoflame/inverse/operator_problem.h"
#include "plenoflame/volumes/load_medium.h"

using namespace plenoflame;

int main(int count, char** arguments) try {
  if (count != 3) return std::fprintf(stderr, "usage: matrix SCENE.toml A.npz\n"), 2;
  const CompiledScene scene = compile_scene(read_scene_file(arguments[1]));
  OperatorRequest request;
  request.unknowns.grid = {4, 8, 8};
  const auto made = make_operator_problem(request, {&scene});
  const CsrMatrix<float> a = make_emission_matrix(made->problem, {});
  write_csr(arguments[2], a);
  std::printf("%zu rows, %zu unknowns\n", a.rows(), a.columns());
  return 0;
} catch (const std::exception& error) {
  return std::fprintf(stderr, "matrix: %s\n", error.what()), 1;
}
