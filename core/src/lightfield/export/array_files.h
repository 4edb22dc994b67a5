#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "plenoflame/image/image.h"

namespace plenoflame {

/// Numbers with a name, unit and shape, last axis fastest.
struct NamedArray {
  std::string name;
  std::string unit;                ///< attribute `units` (HDF5)
  std::string axes;                ///< attribute `axes` (HDF5); empty: none
  std::vector<std::size_t> shape;  ///< empty: a scalar
  std::variant<PixelValues, std::vector<double>, std::vector<std::int32_t>, std::vector<float>,
               std::vector<std::int64_t>, std::vector<std::int8_t>, std::vector<std::int16_t>>
      values;
};

/// A numpy .npz file: an uncompressed ZIP archive (PKWARE APPNOTE 6.3.10) of .npy files (format
/// 1.0).
/// @throws InputError beyond 4 GiB, where ZIP needs its 64-bit records
/// @param texts scalars of bytes by name, as numpy stores short words
std::string npz_bytes(const std::vector<NamedArray>& arrays,
                      const std::vector<std::pair<std::string, std::string>>& texts = {});

/// An HDF5 file that is made in memory.
class Hdf5File {
 public:
  Hdf5File();
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  /// Makes a group and those above it.
  void group(const std::string& path);
  /// Writes a dataset with the attributes `units` and `axes`; groups above it are made.
  void dataset(const std::string& path, const NamedArray& array);
  /// A text attribute of something that is there.
  void attribute(const std::string& path, const std::string& name, const std::string& text);
  /// The whole file.
  std::string bytes();

 private:
  std::int64_t file_ = -1;
};

}  // namespace plenoflame
