#include "plenoflame/image/array_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <utility>

#include "image/hdf5_id.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"

namespace plenoflame {
namespace {

/// Text of the error that the system gave HDF5 when it failed just now: "errno = 28"; 0: nothing.
/// It cleans up after that, and errno need not be the same any more.
int system_error_of_stack() {
  int found = 0;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* entry, void* data) -> herr_t {
        constexpr std::string_view kBefore = "errno = ";
        const std::string_view text = entry->desc ? entry->desc : "";
        if (const auto at = text.find(kBefore); at != std::string_view::npos)
          *static_cast<int*>(data) = std::atoi(text.data() + at + kBefore.size());
        return 0;
      },
      &found);
  return found;
}

std::vector<hsize_t> sizes(const std::vector<std::size_t>& shape) {
  return {shape.begin(), shape.end()};
}

}  // namespace

void ArraySetWriter::fail(const std::string& what) const {
  const int own = errno, told = system_error_of_stack();
  const int error = told != 0 ? told : own;
  const bool no_room = error == ENOSPC || error == EFBIG || error == EDQUOT;
  throw FileError(fmt::format("cannot write '{}': {}", path_,
                              no_room ? std::string(std::strerror(error)) : "HDF5 cannot " + what));
}

void ArraySetWriter::check(std::int64_t status, const char* what) const {
  if (status < 0) fail(what);
}

ArraySetWriter::ArraySetWriter(const std::string& path) : path_(path) {
  keep_hdf5_quiet();
  errno = 0;
  const Hdf5Id create(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  file_ = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, create, H5P_DEFAULT);
  check(file_, "make the file");
}

ArraySetWriter::~ArraySetWriter() {
  if (file_ >= 0) H5Fclose(file_);
}

void ArraySetWriter::rows(const std::string& path, std::size_t rows, std::vector<std::size_t> shape,
                          const std::string& unit, const std::string& axes) {
  shape.insert(shape.begin(), rows);
  const std::vector<hsize_t> whole = sizes(shape);
  std::vector<hsize_t> chunk = whole;
  chunk.front() = 1;
  // Chunks beyond some MB do not fit HDF5's cache of them.
  constexpr hsize_t kMostValues = hsize_t{1} << 20;
  hsize_t count = 1;
  for (const hsize_t side : chunk) count *= side;
  for (std::size_t axis = 1; axis + 2 < chunk.size() && count > kMostValues; ++axis) {
    count /= chunk[axis];
    chunk[axis] = 1;
  }
  const Hdf5Id space(H5Screate_simple(static_cast<int>(whole.size()), whole.data(), nullptr),
                     H5Sclose);
  const Hdf5Id links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  check(H5Pset_create_intermediate_group(links, 1), "make groups");
  const Hdf5Id create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  check(H5Pset_chunk(create, static_cast<int>(chunk.size()), chunk.data()), "divide an array");
  check(H5Pset_shuffle(create), "pack an array");
  constexpr unsigned kDeflate = 4;
  check(H5Pset_deflate(create, kDeflate), "pack an array");
  check(H5Pset_obj_track_times(create, false), "leave times away");
  const Hdf5Id data(
      H5Dcreate2(file_, path.c_str(), H5T_IEEE_F32LE, space, links, create, H5P_DEFAULT), H5Dclose);
  check(data, "make an array");
  if (!unit.empty()) attribute(path, "units", unit);
  if (!axes.empty()) attribute(path, "axes", axes);
}

void ArraySetWriter::put(const std::string& path, std::size_t row, std::span<const float> values) {
  errno = 0;
  const Hdf5Id data(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
  check(data, "open an array");
  const Hdf5Id space(H5Dget_space(data), H5Sclose);
  const int axes = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> begin(static_cast<std::size_t>(axes)), count(begin.size());
  H5Sget_simple_extent_dims(space, count.data(), nullptr);
  begin.front() = row;
  count.front() = 1;
  hsize_t all = 1;
  for (const hsize_t side : count) all *= side;
  if (all != values.size())
    throw InputError(fmt::format("{}: a row has {} values, not {}", path, all, values.size()));
  const Hdf5Id memory(H5Screate_simple(axes, count.data(), nullptr), H5Sclose);
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, begin.data(), nullptr, count.data(), nullptr),
        "choose a row");
  check(H5Dwrite(data, H5T_NATIVE_FLOAT, memory, space, H5P_DEFAULT, values.data()), "write");
}

void ArraySetWriter::make(const std::string& path, std::int64_t type, std::int64_t memory_type,
                          const std::vector<std::size_t>& shape, const void* values) {
  errno = 0;
  const std::vector<hsize_t> whole = sizes(shape);
  const Hdf5Id space(H5Screate_simple(static_cast<int>(whole.size()), whole.data(), nullptr),
                     H5Sclose);
  const Hdf5Id links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  check(H5Pset_create_intermediate_group(links, 1), "make groups");
  const Hdf5Id create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  check(H5Pset_obj_track_times(create, false), "leave times away");
  const Hdf5Id data(H5Dcreate2(file_, path.c_str(), type, space, links, create, H5P_DEFAULT),
                    H5Dclose);
  check(data, "make an array");
  check(H5Dwrite(data, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write");
}

void ArraySetWriter::numbers(const std::string& path, std::span<const double> values,
                             const std::string& unit, std::vector<std::size_t> shape) {
  if (shape.empty()) shape = {values.size()};
  make(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, shape, values.data());
  if (!unit.empty()) attribute(path, "units", unit);
}

void ArraySetWriter::whole_numbers(const std::string& path, std::span<const std::int64_t> values) {
  make(path, H5T_STD_I64LE, H5T_NATIVE_INT64, {values.size()}, values.data());
}

void ArraySetWriter::texts(const std::string& path, const std::vector<std::string>& values) {
  const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  check(H5Tset_size(type, H5T_VARIABLE), "size a text");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "encode a text");
  std::vector<const char*> pointers;
  for (const std::string& text : values) pointers.push_back(text.c_str());
  make(path, type, type, {values.size()}, pointers.data());
}

void ArraySetWriter::attribute(const std::string& path, const std::string& name,
                               const std::string& text) {
  const Hdf5Id object(H5Oopen(file_, path.c_str(), H5P_DEFAULT), H5Oclose);
  // A text of variable length is a text to readers in Python, not bytes.
  const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  check(H5Tset_size(type, H5T_VARIABLE), "size a text");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "encode a text");
  const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id made(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                    H5Aclose);
  const char* const value = text.c_str();
  check(H5Awrite(made, type, &value), "write an attribute");
}

void ArraySetWriter::attribute(const std::string& path, const std::string& name,
                               std::span<const double> values) {
  const Hdf5Id object(H5Oopen(file_, path.c_str(), H5P_DEFAULT), H5Oclose);
  const hsize_t count = values.size();
  const Hdf5Id space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Hdf5Id made(
      H5Acreate2(object, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  check(H5Awrite(made, H5T_NATIVE_DOUBLE, values.data()), "write an attribute");
}

void ArraySetWriter::close() {
  errno = 0;
  check(H5Fflush(file_, H5F_SCOPE_GLOBAL), "finish the file");
  const std::int64_t file = std::exchange(file_, -1);
  check(H5Fclose(file), "finish the file");
}

StoredArray read_stored_array(const std::string& file, const std::string& path) {
  keep_hdf5_quiet();
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw FileError(fmt::format("cannot read '{}': {}", file, error.message()));
  const Hdf5Id opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (opened < 0) throw FileError(file + ": this is no HDF5 file, or it is damaged");
  const Hdf5Id data(H5Dopen2(opened, path.c_str(), H5P_DEFAULT), H5Dclose);
  if (data < 0) throw FileError(fmt::format("{}: there is no array '{}' in it", file, path));
  const Hdf5Id space(H5Dget_space(data), H5Sclose);
  const int axes = H5Sget_simple_extent_ndims(space);
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(axes, 0)));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  // Deflate makes nothing more than 1032 times smaller: what claims more is not believed.
  constexpr hsize_t kMostShrunk = 1040;
  if (count < 0 || static_cast<hsize_t>(count) > kMostShrunk * static_cast<hsize_t>(size))
    throw FileError(fmt::format("{}: the array '{}' is damaged", file, path));
  StoredArray array;
  array.shape.assign(shape.begin(), shape.end());
  array.values.resize(static_cast<std::size_t>(count));
  if (H5Dread(data, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()) < 0)
    throw FileError(fmt::format("{}: the array '{}' is damaged", file, path));
  return array;
}

}  // namespace plenoflame
