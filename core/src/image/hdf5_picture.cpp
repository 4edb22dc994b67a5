#include <filesystem>
#include <string>

#include "image/hdf5_id.h"
#include "image/picture_arrays.h"

namespace plenoflame {
namespace {

#if H5_VERSION_GE(1, 12, 0)
using ObjectInfo = H5O_info2_t;
constexpr auto visit_objects = H5Ovisit3;
#else
using ObjectInfo = H5O_info_t;
constexpr auto visit_objects = H5Ovisit2;
#endif

/// Adds each dataset of numbers. @param data std::vector<PictureArray>
herr_t add_dataset(hid_t file, const char* name, const ObjectInfo* info, void* data) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  const Hdf5Id set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  if (set < 0) return 0;
  const Hdf5Id type(H5Dget_type(set), H5Tclose), space(H5Dget_space(set), H5Sclose);
  const H5T_class_t kind = H5Tget_class(type);
  const int axes = H5Sget_simple_extent_ndims(space);
  if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || axes < 1) return 0;
  std::vector<hsize_t> sides(static_cast<std::size_t>(axes));
  H5Sget_simple_extent_dims(space, sides.data(), nullptr);
  PictureArray array;
  array.name = std::string("/") + name;
  array.bits = kind == H5T_INTEGER && H5Tget_size(type) == 1 ? 8 : 16;
  // MATLAB stores its arrays as they lie in memory, and the sides in reverse order.
  array.by_columns = H5Aexists(set, "MATLAB_class") > 0;
  if (array.by_columns)
    array.sides.assign(sides.rbegin(), sides.rend());
  else
    array.sides.assign(sides.begin(), sides.end());
  static_cast<std::vector<PictureArray>*>(data)->push_back(array);
  return 0;
}

}  // namespace

void read_hdf5_pictures(const std::string& path, const std::string& name,
                        const std::function<void(RawPicture&&)>& take) {
  keep_hdf5_quiet();
  const Hdf5Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file < 0) refuse_picture(path, "this HDF5 file is damaged");
  std::vector<PictureArray> arrays;
  if (visit_objects(file, H5_INDEX_NAME, H5_ITER_INC, add_dataset, &arrays, H5O_INFO_BASIC) < 0)
    refuse_picture(path, "this HDF5 file is damaged");
  const PictureArray& array = chosen_array(path, name, arrays);
  const PictureSides sides = picture_sides(path, array);
  // Deflate makes nothing more than 1032 times smaller.
  constexpr std::uintmax_t kMostShrunk = 1040;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || sides.frames > kMostShrunk * size / sides.frame())
    refuse_picture(path, array.name + " claims more numbers than the file can hold: damaged");
  const Hdf5Id set(H5Dopen2(file, array.name.c_str(), H5P_DEFAULT), H5Dclose);
  const Hdf5Id space(H5Dget_space(set), H5Sclose);
  // Frames are the first side in the file, MATLAB's too.
  std::vector<hsize_t> begin(array.sides.size(), 0), count(array.sides.begin(), array.sides.end());
  if (array.by_columns) count.assign(array.sides.rbegin(), array.sides.rend());
  const bool divided = sides.frames > 1;
  if (divided) count.front() = 1;
  const Hdf5Id memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                      H5Sclose);
  std::vector<double> values(sides.frame());
  for (std::size_t frame = 0; frame < sides.frames; ++frame) {
    if (divided) begin.front() = frame;
    if (H5Sselect_hyperslab(space, H5S_SELECT_SET, begin.data(), nullptr, count.data(), nullptr) <
            0 ||
        H5Dread(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()) < 0)
      refuse_picture(path, array.name +
                               " cannot be read: the file is damaged, or packed by a "
                               "filter that is not installed");
    take(picture_of_array(path, "HDF5", array, values));
  }
}

}  // namespace plenoflame
