# Installs, moves the prefix (the package must not know where it was), builds the consumer, runs it.
file(REMOVE_RECURSE "${WORK_DIR}")
file(MAKE_DIRECTORY "${WORK_DIR}")
set(prefix "${WORK_DIR}/moved")

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${what} failed (${status}): ${ARGN}\n${text}")
  endif()
  set(output "${text}" PARENT_SCOPE)
endfunction()

run("installing" "${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${WORK_DIR}/prefix")
file(RENAME "${WORK_DIR}/prefix" "${prefix}")

# Installed files may not point back to the folder that they were built in.
file(GLOB_RECURSE installed "${prefix}/*.cmake" "${prefix}/*.h")
if(NOT installed)
  message(FATAL_ERROR "nothing was installed")
endif()
foreach(file IN LISTS installed)
  file(READ "${file}" text)
  string(FIND "${text}" "${BUILD_DIR}" position)
  if(NOT position EQUAL -1)
    message(FATAL_ERROR "${file} names the build folder")
  endif()
endforeach()

run("configuring the consumer" "${CMAKE_COMMAND}" -G "${GENERATOR}" -S "${CONSUMER}"
  -B "${WORK_DIR}/build" "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${CXX}"
  "-DCOMPONENTS=${COMPONENTS}" "-DVERSION=${VERSION}" -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
run("building the consumer" "${CMAKE_COMMAND}" --build "${WORK_DIR}/build")
foreach(component IN LISTS COMPONENTS)
  run("the consumer of ${component}" "${WORK_DIR}/build/${component}_consumer" "${WORK_DIR}")
  if(NOT output MATCHES "plenoflame ${VERSION}")
    message(FATAL_ERROR "the consumer of ${component} printed: ${output}")
  endif()
endforeach()
# The example programs, and what their comments promise: the rays make the picture.
if("${COMPONENTS}" STREQUAL "core")
  run("configuring the examples" "${CMAKE_COMMAND}" -G "${GENERATOR}" -S "${EXAMPLES}/cpp"
    -B "${WORK_DIR}/examples" "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${CXX}"
    "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror" -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
  run("building the examples" "${CMAKE_COMMAND}" --build "${WORK_DIR}/examples")
  run("pixel_flux" "${WORK_DIR}/examples/pixel_flux" "${EXAMPLES}/lenslets-30.toml" 150 150)
  if(NOT output MATCHES "streamed ([1-9.]+[0-9e.-]*) W\npicture  ([0-9e.-]+) W"
     OR NOT CMAKE_MATCH_1 STREQUAL CMAKE_MATCH_2)
    message(FATAL_ERROR "the flux of the streamed rays is not the picture's: ${output}")
  endif()
  run("ray_voxels" "${WORK_DIR}/examples/ray_voxels" "${EXAMPLES}/lenslets-30.toml" 140 140)
  # Pixels of the picture are single precision.
  if(NOT output MATCHES "farthest from the picture: [0-9.]+e-0[89] of [1-9.]+[0-9e.-]* W")
    message(FATAL_ERROR "the operator does not make the picture: ${output}")
  endif()
  if(VOLUMES)
    set(scene "${EXAMPLES}/lenslets-30.toml")
    run("render" "${WORK_DIR}/examples/render" "${scene}" "${WORK_DIR}/field.exr")
    run("matrix" "${WORK_DIR}/examples/matrix" "${scene}" "${WORK_DIR}/A.npz")
    if(NOT output MATCHES "^[1-9][0-9]+ rows, 256 unknowns\n$" OR NOT EXISTS "${WORK_DIR}/A.npz")
      message(FATAL_ERROR "the matrix: ${output}")
    endif()
    run("reconstruct" "${WORK_DIR}/examples/reconstruct" "${scene}" "${WORK_DIR}/field.exr" "${WORK_DIR}/found.vdb")
    if(NOT output MATCHES "in words: .*The emission of a voxel is known to" OR NOT EXISTS "${WORK_DIR}/found.vdb")
      message(FATAL_ERROR "the reconstruction: ${output}")
    endif()
  endif()
endif()
if(WITH_CLI)
  run("the installed command" "${prefix}/${BINDIR}/plenoflame" --version)
  if(NOT output MATCHES "${VERSION}")
    message(FATAL_ERROR "the installed command printed: ${output}")
  endif()
endif()
