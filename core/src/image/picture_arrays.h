#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "plenoflame/image/raw_picture.h"

/// Pictures in files of arrays: HDF5 (.h5, .mat of MATLAB 7.3) and MAT 5.
namespace plenoflame {

/// @throws FileError: cannot read 'path': why
[[noreturn]] void refuse_picture(const std::string& path, const std::string& why);

/// An array that may hold pictures.
struct PictureArray {
  std::string name;
  std::vector<std::size_t> sides;  ///< as the file's program counts them
  int bits = 16;                   ///< 8 for numbers of one byte
  /// Rows vary fastest, and frames are last (MATLAB). Otherwise columns do, and frames are first.
  bool by_columns = false;
};

/// Which side of an array means what. Colours may be one: H x W x 1 x 3 are three grey frames.
struct PictureSides {
  std::size_t rows = 0, columns = 0, colours = 1, frames = 1;
  std::size_t frame() const { return rows * columns * colours; }
};

/// @throws FileError for an array that is none or several pictures of counts
PictureSides picture_sides(const std::string& path, const PictureArray& array);

/// The array of a name, or the only one that may be a picture where the name is empty.
/// @throws FileError with a list of the arrays
const PictureArray& chosen_array(const std::string& path, const std::string& name,
                                 const std::vector<PictureArray>& arrays);

/// One frame of an array. @param kind RawPicture::kind @param values the frame's, in the file's
/// order
/// @throws FileError for numbers that are no counts
RawPicture picture_of_array(const std::string& path, const std::string& kind,
                            const PictureArray& array, const std::vector<double>& values);

/// @param name of the dataset, or empty
void read_hdf5_pictures(const std::string& path, const std::string& name,
                        const std::function<void(RawPicture&&)>& take);

/// @param name of the variable, or empty
void read_mat_pictures(const std::string& path, const std::string& bytes, const std::string& name,
                       const std::function<void(RawPicture&&)>& take);

/// The picture of a Lytro camera's file: .lfp, .lfr, or one of its data base of white pictures.
/// @param name of a picture in the data base, or empty
void read_lytro_pictures(const std::string& path, const std::string& bytes, const std::string& name,
                         const std::function<void(RawPicture&&)>& take);

/// True for the size of a raw picture without a header of a Lytro camera.
bool is_lytro_raw(std::size_t bytes);
RawPicture lytro_raw_picture(const std::string& path, const std::string& bytes);

}  // namespace plenoflame
