list(APPEND core_sources src/inverse/built_rows.cpp src/inverse/dark_pixels.cpp src/inverse/operators/linear_operator.cpp src/inverse/operators/csr_matrix.cpp src/inverse/operators/csr_file.cpp
  src/inverse/solvers/penalty.cpp src/inverse/solvers/iteration.cpp src/inverse/solvers/krylov.cpp src/inverse/solvers/nonnegative.cpp
  src/inverse/solvers/row_action.cpp src/inverse/solvers/strength.cpp
  src/inverse/solvers/uncertainty.cpp src/inverse/solvers/posterior_chain.cpp src/inverse/solvers/gauss_newton.cpp
  src/inverse/unknowns/axis_fit.cpp src/inverse/unknowns/flame_block.cpp src/inverse/unknowns/layer_unknowns.cpp
  src/inverse/operators/camera_rays.cpp src/inverse/operators/light_behind.cpp src/inverse/operators/emission_operator.cpp src/inverse/unknowns/flame_estimate.cpp
  src/inverse/measurement.cpp src/inverse/shared_assembly.cpp src/inverse/reconstruction.cpp src/inverse/row_noise.cpp src/inverse/row_results.cpp src/inverse/unknowns/ring_unknowns.cpp src/inverse/unknowns/unknowns_request.cpp src/inverse/unknowns/values_at_places.cpp src/inverse/operators/operator_problem.cpp
  src/inverse/operators/own_rows.cpp src/inverse/operators/sample_bricks.cpp src/inverse/operators/thermal_model.cpp src/inverse/thermal_reconstruction.cpp src/inverse/unknowns/voxel_unknowns.cpp src/inverse/operators/scaled_problem.cpp
  src/inverse/operators/source_table.cpp src/inverse/thermal_start.cpp src/inverse/vector_memory.cpp
  src/inverse/displaced_camera.cpp src/inverse/prior_of_draws.cpp src/inverse/model_test.cpp src/inverse/refine.cpp)
# GCC 12 takes a string that grows by a copied structure for one that stays short.
set_source_files_properties(src/inverse/shared_assembly.cpp PROPERTIES
  COMPILE_OPTIONS "$<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>")
