# Finds the serial C library of HDF5 (target Plenoflame::hdf5). CMake's own FindHDF5 takes whatever
# h5cc points to, which with MPI installed is not the serial one, and wants the language C.
include(FindPackageHandleStandardArgs)
include(GNUInstallDirs)

find_path(PlenoflameHdf5_INCLUDE_DIR hdf5.h PATH_SUFFIXES hdf5/serial)
find_library(PlenoflameHdf5_LIBRARY NAMES hdf5_serial hdf5
  PATH_SUFFIXES hdf5/serial "${CMAKE_LIBRARY_ARCHITECTURE}/hdf5/serial")
mark_as_advanced(PlenoflameHdf5_INCLUDE_DIR PlenoflameHdf5_LIBRARY)
find_package_handle_standard_args(PlenoflameHdf5
  REQUIRED_VARS PlenoflameHdf5_LIBRARY PlenoflameHdf5_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "install HDF5 (Debian: libhdf5-dev)")
if(PlenoflameHdf5_FOUND AND NOT TARGET Plenoflame::hdf5)
  add_library(Plenoflame::hdf5 UNKNOWN IMPORTED)
  set_target_properties(Plenoflame::hdf5 PROPERTIES IMPORTED_LOCATION "${PlenoflameHdf5_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${PlenoflameHdf5_INCLUDE_DIR}")
endif()
