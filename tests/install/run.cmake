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

# What is installed may not point back to where it was built.
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
if(WITH_CLI)
  run("the installed command" "${prefix}/${BINDIR}/plenoflame" --version)
  if(NOT output MATCHES "${VERSION}")
    message(FATAL_ERROR "the installed command printed: ${output}")
  endif()
endif()
