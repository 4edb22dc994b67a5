#include <hdf5.h>

#include <functional>

#include "lightfield/export/array_files.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

/// An HDF5 identifier with its closing function.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const char* what) : id_(id), close_(close) {
    if (id < 0) throw FileError(std::string("HDF5 cannot make ") + what);
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void check(herr_t status, const char* what) {
  if (status < 0) throw FileError(std::string("HDF5 cannot ") + what);
}

hid_t memory_type(const NamedArray& array) {
  if (std::holds_alternative<PixelValues>(array.values) ||
      std::holds_alternative<std::vector<float>>(array.values))
    return H5T_NATIVE_FLOAT;
  if (std::holds_alternative<std::vector<std::int64_t>>(array.values)) return H5T_NATIVE_INT64;
  if (std::holds_alternative<std::vector<double>>(array.values)) return H5T_NATIVE_DOUBLE;
  if (std::holds_alternative<std::vector<std::int16_t>>(array.values)) return H5T_NATIVE_INT16;
  if (std::holds_alternative<std::vector<std::int8_t>>(array.values)) return H5T_NATIVE_INT8;
  return H5T_NATIVE_INT32;
}

/// The same in the file: little endian everywhere.
hid_t file_type(const NamedArray& array) {
  if (std::holds_alternative<PixelValues>(array.values) ||
      std::holds_alternative<std::vector<float>>(array.values))
    return H5T_IEEE_F32LE;
  if (std::holds_alternative<std::vector<std::int64_t>>(array.values)) return H5T_STD_I64LE;
  if (std::holds_alternative<std::vector<double>>(array.values)) return H5T_IEEE_F64LE;
  if (std::holds_alternative<std::vector<std::int16_t>>(array.values)) return H5T_STD_I16LE;
  if (std::holds_alternative<std::vector<std::int8_t>>(array.values)) return H5T_STD_I8LE;
  return H5T_STD_I32LE;
}

}  // namespace

Hdf5File::Hdf5File() {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "a file in memory");
  constexpr std::size_t kGrowth = std::size_t{1} << 22;
  check(H5Pset_fapl_core(access, kGrowth, 0), "keep a file in memory");
  file_ = H5Fcreate("plenoflame.h5", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (file_ < 0) throw FileError("HDF5 cannot make a file in memory");
}

Hdf5File::~Hdf5File() {
  H5Fclose(file_);
}

void Hdf5File::group(const std::string& path) {
  const Handle create(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "a property list");
  check(H5Pset_create_intermediate_group(create, 1), "make groups");
  const Handle made(H5Gcreate2(file_, path.c_str(), create, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                    "a group");
}

void Hdf5File::dataset(const std::string& path, const NamedArray& array) {
  std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  const Handle space(shape.empty()
                         ? H5Screate(H5S_SCALAR)
                         : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose, "a data space");
  const Handle create(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "a property list");
  check(H5Pset_create_intermediate_group(create, 1), "make groups");
  {
    const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "a property list");
    check(H5Pset_obj_track_times(how, false), "leave times away");  // equal runs, equal bytes
    const Handle data(
        H5Dcreate2(file_, path.c_str(), file_type(array), space, create, how, H5P_DEFAULT),
        H5Dclose, "a dataset");
    const void* values =
        std::visit([](const auto& v) { return static_cast<const void*>(v.data()); }, array.values);
    check(H5Dwrite(data, memory_type(array), H5S_ALL, H5S_ALL, H5P_DEFAULT, values),
          "write a dataset");
  }
  if (!array.unit.empty()) attribute(path, "units", array.unit);
  if (!array.axes.empty()) attribute(path, "axes", array.axes);
}

void Hdf5File::attribute(const std::string& path, const std::string& name,
                         const std::string& text) {
  const Handle object(H5Oopen(file_, path.c_str(), H5P_DEFAULT), H5Oclose, "an attribute");
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "a text type");
  // Texts have variable length: readers in Python then get a text, not bytes.
  check(H5Tset_size(type, H5T_VARIABLE), "size a text");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "encode a text");
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "a data space");
  const Handle made(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                    H5Aclose, "an attribute");
  const char* value = text.c_str();
  check(H5Awrite(made, type, &value), "write an attribute");
}

std::string Hdf5File::bytes() {
  check(H5Fflush(file_, H5F_SCOPE_GLOBAL), "finish a file");
  const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
  if (size <= 0) throw FileError("HDF5 cannot give its file");
  std::string image(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file_, image.data(), image.size()) != size)
    throw FileError("HDF5 cannot give its file");
  return image;
}

}  // namespace plenoflame
