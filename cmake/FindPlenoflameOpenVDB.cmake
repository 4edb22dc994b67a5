# Finds OpenVDB (target OpenVDB::openvdb) with the find module that the library installs itself,
# which is not on CMake's module path. Its folder also holds modules for TBB and OpenEXR that would
# shadow better ones, so it is on the path during this call only.
include(FindPackageHandleStandardArgs)
include(GNUInstallDirs)

find_path(PlenoflameOpenVDB_MODULE_DIR FindOpenVDB.cmake
  PATHS "/usr/${CMAKE_INSTALL_LIBDIR}/cmake/OpenVDB" "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB"
        /usr/lib/cmake/OpenVDB /usr/local/lib/cmake/OpenVDB
  PATH_SUFFIXES lib/cmake/OpenVDB lib64/cmake/OpenVDB
  DOC "Folder of FindOpenVDB.cmake")
mark_as_advanced(PlenoflameOpenVDB_MODULE_DIR)

if(PlenoflameOpenVDB_MODULE_DIR)
  find_package(TBB QUIET CONFIG)
  find_package(Imath QUIET CONFIG)
  find_package(OpenEXR QUIET CONFIG)
  set(_plenoflame_module_path "${CMAKE_MODULE_PATH}")
  list(APPEND CMAKE_MODULE_PATH "${PlenoflameOpenVDB_MODULE_DIR}")
  set(_plenoflame_shared "${BUILD_SHARED_LIBS}")  # the module sets it for its own tests
  # Old modules: their use of FOUND variables with another case is none of our business.
  set(_plenoflame_mismatch "${FPHSA_NAME_MISMATCHED}")
  set(FPHSA_NAME_MISMATCHED ON)
  find_package(OpenVDB 10 QUIET COMPONENTS openvdb)
  set(FPHSA_NAME_MISMATCHED "${_plenoflame_mismatch}")
  set(CMAKE_MODULE_PATH "${_plenoflame_module_path}")
  set(BUILD_SHARED_LIBS "${_plenoflame_shared}")
endif()

find_package_handle_standard_args(PlenoflameOpenVDB
  REQUIRED_VARS PlenoflameOpenVDB_MODULE_DIR OpenVDB_FOUND
  VERSION_VAR OpenVDB_VERSION
  REASON_FAILURE_MESSAGE "install OpenVDB 10 or newer (Debian: libopenvdb-dev libboost-iostreams-dev)")
