# Compile settings shared by every target of the project, and the function that defines a library.

add_library(plenoflame_private_options INTERFACE)
target_compile_options(plenoflame_private_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual
  -Woverloaded-virtual -Wno-psabi
  # sqrt() without errno is what lets GCC vectorise the ray loops; NaN and Inf keep their meaning.
  -fno-math-errno)
if(PLENOFLAME_WERROR)
  target_compile_options(plenoflame_private_options INTERFACE -Werror)
endif()
if(PLENOFLAME_SANITIZE)
  target_compile_options(plenoflame_private_options INTERFACE
    -fsanitize=${PLENOFLAME_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(plenoflame_private_options INTERFACE -fsanitize=${PLENOFLAME_SANITIZE})
  if(PLENOFLAME_SANITIZE MATCHES "address")
    # A third of the compile time. The address sanitizer finds null pointers and accesses beyond an object itself.
    target_compile_options(plenoflame_private_options INTERFACE -fno-sanitize=null,object-size,pointer-overflow,vptr)
  endif()
endif()
if(PLENOFLAME_COVERAGE)
  target_compile_options(plenoflame_private_options INTERFACE --coverage)
  target_link_options(plenoflame_private_options INTERFACE --coverage)
endif()

# VTK's own macros end with a semicolon that its convention then adds again. To be linked after the options above.
add_library(plenoflame_vtk_options INTERFACE)
target_compile_options(plenoflame_vtk_options INTERFACE -Wno-pedantic)

# plenoflame_library(NAME core SOURCES ... HEADERS ... PUBLIC_LINKS ... PRIVATE_LINKS ...)
# defines plenoflame_NAME with the alias plenoflame::NAME, its public headers and its install rules.
function(plenoflame_library)
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;HEADERS;PUBLIC_LINKS;PRIVATE_LINKS" ${ARGN})
  set(target plenoflame_${ARG_NAME})
  add_library(${target} ${ARG_SOURCES})
  plenoflame_compile_together(${target})
  plenoflame_precompile(${target} <fmt/format.h>)
  add_library(plenoflame::${ARG_NAME} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS
    BASE_DIRS "${CMAKE_CURRENT_SOURCE_DIR}/include" FILES ${ARG_HEADERS})
  target_include_directories(${target} PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}/src")
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${ARG_NAME} POSITION_INDEPENDENT_CODE ON
    INSTALL_RPATH "$ORIGIN"
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC_LINKS}
    PRIVATE ${ARG_PRIVATE_LINKS} $<BUILD_INTERFACE:plenoflame_private_options>)
  install(TARGETS ${target} EXPORT plenoflame-${ARG_NAME}-targets
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT ${ARG_NAME}
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT dev
    FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT dev)
  install(EXPORT plenoflame-${ARG_NAME}-targets NAMESPACE plenoflame::
    DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/plenoflame" COMPONENT dev)
endfunction()
